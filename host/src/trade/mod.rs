//! What every rung of arithmetic gives and what it costs.
//!
//! [`form_factors`] measures each rung of [`FormFactorRung::ALL`] on a suite of cases
//! ([`suite`]) and on the emulated device; [`scene()`] does the same with a baked
//! scene, [`room`] with the rungs that change what is baked, [`whole`] with those that
//! change what is planned. Nothing here knows the rungs by name: one more on the ladder
//! is one more line of every table.

pub mod error;
pub mod front;
mod host;
pub mod room;
pub mod scene;
pub mod suite;
pub mod table;
pub mod whole;

pub use scene::scene;

use crate::device::{self, Core, Extent, Flash, Traced};
use crate::solve::FormFactorRung;
use error::SuiteErrors;
use serde::Serialize;
use std::time::Duration;

/// Vertices of the emitter whose form factor is quoted.
const QUAD: usize = 4;

/// Vertices of the emitter that tells what one edge more costs.
const OCTAGON: usize = 8;

/// The case from which the cost of an edge is taken.
const WHOLE: &str = "large-unclipped";

/// That from which the cost of an edge seen under at most 45° is taken.
const NARROW: &str = "small-unclipped";

/// The rung whose form factor is measured without its clip as well.
const CLIPPING: &str = "poly5";

/// How long one emulation may take; a trace writes a line an instruction.
const TIME_LIMIT: Duration = Duration::from_secs(300);

/// What a rung gives and costs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FormFactors {
    /// The rung.
    pub rung: &'static str,
    /// How wrong it is on the suite.
    pub error: SuiteErrors,
    /// Nanoseconds of a form factor on this machine: of the class `ordinary`,
    /// the quickest of several rounds.
    pub host_nanoseconds: f64,
    /// Costs on the device; `None` where there is no emulator.
    pub device: Option<DeviceCost>,
    /// Whether no other rung is both as cheap and as good, by
    /// [`SuiteErrors::max`].
    pub on_front: bool,
    /// The same by [`SuiteErrors::tiny_relative`].
    pub on_relative_front: bool,
}

/// What a form factor of a rung costs on the device.
///
/// Of a quad, mean over large and small ones, clipped by the horizon or not
/// (four cases of 36 receivers each); its plane and reach are known, as in a
/// scene's tables. Root: the FPU's where the rung takes one and there is one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeviceCost {
    /// Exact instructions on the Cortex-M4F.
    pub m4f_instructions: f64,
    /// Those of the dearest call.
    pub m4f_largest: u64,
    /// Exact instructions on the Cortex-M7.
    pub m7_instructions: f64,
    /// Cycles on the Cortex-M4F by the model of [`device::traces`]; `None`
    /// where the emulator cannot trace.
    pub m4f_cycles: Option<f64>,
    /// Cycles of one edge more: a quarter of octagon less quad, both large and
    /// unclipped. With translation, test of the horizon and loop.
    pub m4f_cycles_per_edge: Option<f64>,
    /// The same of a small emitter, whose edges are seen under at most 45°.
    pub m4f_cycles_per_narrow_edge: Option<f64>,
    /// Exact instructions on the Cortex-M3, where every operation of `f32` is
    /// a call; `None` where its Rust target is missing.
    pub m3_instructions: Option<f64>,
    /// Bytes of code in a program for the M4F with this form factor alone.
    pub code_bytes: u64,
    /// Bytes of constants there that are not part of the code: the tables of
    /// the arithmetic, beside the scene's own.
    pub table_bytes: u64,
    /// Bytes of code in a program for the M3, its runtime's `f32` included.
    pub m3_code_bytes: Option<u64>,
}

impl FormFactors {
    /// What a rung is placed by in the plot: estimated cycles, else
    /// instructions, else nanoseconds here.
    #[must_use]
    pub fn cost(&self) -> f64 {
        match &self.device {
            Some(device) => device.m4f_cycles.unwrap_or(device.m4f_instructions),
            None => self.host_nanoseconds,
        }
    }
}

/// What is no rung but measured beside them, on the Cortex-M4F.
///
/// `clip` is what a loop above the horizon pays for the horizon and for being
/// brought to the receiver: a form factor of `poly5` less the same sum over vertices
/// that are relative to the receiver already and are not tested. `table` is `best`
/// with a table of its edges, of a small emitter above the horizon.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Part {
    /// Its name.
    pub name: &'static str,
    /// Estimated cycles of a quad, the test of its facing included.
    pub m4f_cycles: f64,
    /// Those of one edge more.
    pub m4f_cycles_per_edge: f64,
}

/// Every rung measured.
#[derive(Debug)]
pub struct Trade {
    /// The rungs, in the order of the ladder.
    pub rungs: Vec<FormFactors>,
    /// What was measured beside them; none where nothing was traced.
    pub parts: Vec<Part>,
    /// Why costs on the device are missing, if so.
    pub missing: Option<device::Error>,
}

/// Every rung on the suite.
///
/// # Errors
/// [`device::Error`] where the device's program does not build or end; what is
/// missing is no error.
pub fn form_factors(mut progress: impl FnMut(&str)) -> Result<Trade, device::Error> {
    progress("counting instructions");
    let (measured, missing) = optional(OnDevice::measure(&mut progress))?;
    progress("judging form factors");
    let suite = error::suite();
    let mut rows: Vec<FormFactors> = FormFactorRung::ALL
        .into_iter()
        .map(|rung| FormFactors {
            rung: rung.name(),
            error: error::judge(rung, &suite),
            host_nanoseconds: host::nanoseconds(rung),
            device: measured
                .as_ref()
                .and_then(|measured| measured.cost(rung.name())),
            on_front: false,
            on_relative_front: false,
        })
        .collect();
    mark(&mut rows);
    let parts = measured.as_ref().map(OnDevice::parts).unwrap_or_default();
    let missing = missing.or(measured.and_then(|measured| measured.missing));
    Ok(Trade {
        rungs: rows,
        parts,
        missing,
    })
}

/// Marks the rungs on the fronts.
fn mark(rows: &mut [FormFactors]) {
    let by = |error: fn(&SuiteErrors) -> f64, rows: &[FormFactors]| {
        let points: Vec<_> = rows
            .iter()
            .map(|row| (row.cost(), error(&row.error)))
            .collect();
        front::pareto(&points)
    };
    let absolute = by(|error| error.max, rows);
    let relative = by(SuiteErrors::tiny_relative, rows);
    for ((row, absolute), relative) in rows.iter_mut().zip(absolute).zip(relative) {
        (row.on_front, row.on_relative_front) = (absolute, relative);
    }
}

/// What is missing is kept apart from what went wrong.
fn optional<T>(
    found: Result<T, device::Error>,
) -> Result<(Option<T>, Option<device::Error>), device::Error> {
    match found {
        Ok(found) => Ok((Some(found), None)),
        Err(error) if error.is_missing() => Ok((None, Some(error))),
        Err(error) => Err(error),
    }
}

/// What was measured of all rungs on the device.
struct OnDevice {
    m4f: Vec<device::Cost>,
    m7: Vec<device::Cost>,
    m3: Vec<device::Cost>,
    traced: Vec<Traced>,
    flash: Vec<Flash>,
    m3_flash: Vec<Flash>,
    /// Why some of it is missing.
    missing: Option<device::Error>,
}

impl OnDevice {
    /// Measures it. Traces and the M3 may be missing.
    fn measure(progress: &mut impl FnMut(&str)) -> Result<Self, device::Error> {
        let costs = |core| {
            let found = device::costs(&[core], TIME_LIMIT)?;
            Ok(found.into_iter().flatten().collect())
        };
        let flash = |core| {
            let rungs = FormFactorRung::ALL.map(FormFactorRung::name);
            device::flash(core, &rungs, Extent::FormFactor)
        };
        let (m4f, m7) = (costs(Core::CortexM4F)?, costs(Core::CortexM7)?);
        let (m3, no_m3) = optional(costs(Core::CortexM3))?;
        progress("tracing instructions");
        let (traced, no_trace) = optional(device::traces(TIME_LIMIT))?;
        progress("linking each rung alone");
        Ok(Self {
            m4f,
            m7,
            m3: m3.unwrap_or_default(),
            traced: traced.unwrap_or_default(),
            flash: flash(Core::CortexM4F)?,
            m3_flash: optional(flash(Core::CortexM3))?.0.unwrap_or_default(),
            missing: no_m3.or(no_trace),
        })
    }

    /// Cycles of a call of an operation on an emitter that is seen whole.
    fn seen(&self, case: &str, of: impl Fn(&device::Cost) -> bool, size: usize) -> Option<f64> {
        let is_it = |cost: &device::Cost| of(cost) && cost.size == size && cost.case == case;
        let found = self.traced.iter().find(|traced| is_it(&traced.cost))?;
        Some(cycles(found))
    }

    /// What is measured beside the rungs.
    fn parts(&self) -> Vec<Part> {
        let part = |name, of: &dyn Fn(usize) -> Option<f64>| {
            let (quad, octagon) = (of(QUAD)?, of(OCTAGON)?);
            Some(Part {
                name,
                m4f_cycles: quad,
                m4f_cycles_per_edge: (octagon - quad) / (OCTAGON - QUAD) as f64,
            })
        };
        let clip = part("clip", &|size| {
            let whole = self.seen(WHOLE, |cost| cost.rung == CLIPPING, size)?;
            Some(whole - self.seen(WHOLE, |cost| cost.operation == "ready-sum", size)?)
        });
        let baked = part("table", &|size| {
            self.seen(NARROW, |cost| cost.rung == "baked", size)
        });
        clip.into_iter().chain(baked).collect()
    }

    /// The costs of a rung; `None` where the device's program lacks it.
    fn cost(&self, rung: &str) -> Option<DeviceCost> {
        let of = |cost: &device::Cost| cost.operation == "form-factor" && cost.rung == rung;
        // The rungs that take a root from outside are measured with several.
        let of_root = |costs: &[device::Cost]| -> Vec<device::Cost> {
            let first = ["fpu", "own", "-", "libm"]
                .into_iter()
                .find(|root| costs.iter().any(|cost| of(cost) && cost.root == *root));
            let these = costs
                .iter()
                .filter(|cost| of(cost) && Some(&*cost.root) == first);
            these.cloned().collect()
        };
        let quads = |costs: &[device::Cost]| {
            let costs = of_root(costs);
            let quads = costs.iter().filter(|cost| cost.size == QUAD);
            mean(quads.map(device::Cost::mean))
        };
        let m4f = of_root(&self.m4f);
        let root = m4f.first().map(|cost| &cost.root);
        let dearest = m4f.iter().filter(|cost| cost.size == QUAD);
        let this = |cost: &device::Cost| of(cost) && Some(&cost.root) == root;
        let traced = self.traced.iter().filter(|traced| this(&traced.cost));
        let of_quads = traced.filter(|traced| traced.cost.size == QUAD);
        let per_edge = |case| {
            let (quad, octagon) = (
                self.seen(case, this, QUAD)?,
                self.seen(case, this, OCTAGON)?,
            );
            Some((octagon - quad) / (OCTAGON - QUAD) as f64)
        };
        let alone = |flash: &'_ [Flash]| {
            let found = flash.iter().find(|flash| flash.rung == rung)?;
            Some((found.code_bytes, found.constant_bytes))
        };
        let (code_bytes, table_bytes) = alone(&self.flash)?;
        Some(DeviceCost {
            m4f_instructions: quads(&self.m4f)?,
            m4f_largest: dearest.map(|cost| cost.largest).max()?,
            m7_instructions: quads(&self.m7)?,
            m4f_cycles: mean(of_quads.map(cycles)),
            m4f_cycles_per_edge: per_edge(WHOLE),
            m4f_cycles_per_narrow_edge: per_edge(NARROW),
            m3_instructions: quads(&self.m3),
            code_bytes,
            table_bytes,
            m3_code_bytes: alone(&self.m3_flash).map(|(code, _)| code),
        })
    }
}

/// Cycles of a call on the average.
fn cycles(traced: &Traced) -> f64 {
    traced.cycles as f64 / f64::from(traced.cost.calls.max(1))
}

/// The mean; `None` of nothing.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}
