//! What every rung of arithmetic gives and what it costs.
//!
//! [`form_factors`] measures each rung of [`FormFactorRung::ALL`] on a suite of cases
//! ([`suite`]) and on the emulated device; [`scene()`] does the same with a baked
//! scene. Nothing here knows the rungs by name: one more on the ladder is one
//! more line of every table.

pub mod error;
pub mod front;
mod host;
pub mod scene;
pub mod suite;
pub mod table;

pub use scene::scene;

use crate::device::{self, Core, Traced};
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
    /// Bytes of tables the rung needs beside the scene's own.
    pub table_bytes: u64,
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
/// scene's tables. Root: the FPU's where the rung takes one.
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
    /// Bytes of code that the form factor can reach.
    pub code_bytes: Option<u64>,
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

/// Every rung on the suite, and why costs on the device are missing, if so.
///
/// # Errors
/// [`device::Error`] where the device's program does not build or end; what is
/// missing is no error.
pub fn form_factors(
    mut progress: impl FnMut(&str),
) -> Result<(Vec<FormFactors>, Option<device::Error>), device::Error> {
    progress("counting instructions");
    let (measured, mut missing) = optional(device::costs(
        &[Core::CortexM4F, Core::CortexM7],
        TIME_LIMIT,
    ))?;
    let mut traced = Vec::new();
    if measured.is_some() {
        progress("tracing instructions");
        let (found, lacks) = optional(device::traces(TIME_LIMIT))?;
        traced = found.unwrap_or_default();
        missing = missing.or(lacks);
    }
    progress("judging form factors");
    let suite = error::suite();
    let mut rows: Vec<FormFactors> = FormFactorRung::ALL
        .into_iter()
        .map(|rung| FormFactors {
            rung: rung.name(),
            error: error::judge(rung, &suite),
            host_nanoseconds: host::nanoseconds(rung),
            device: measured
                .as_deref()
                .and_then(|costs| device_cost(rung.name(), costs, &traced)),
            table_bytes: 0,
            on_front: false,
            on_relative_front: false,
        })
        .collect();
    mark(&mut rows);
    Ok((rows, missing))
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

/// The costs of a rung; `None` where the device's program lacks it.
fn device_cost(
    rung: &str,
    measured: &[Vec<device::Cost>],
    traced: &[Traced],
) -> Option<DeviceCost> {
    let [m4f, m7] = measured else { return None };
    // The rungs that take a root from outside are measured with several.
    let roots = ["fpu", "own", "-"];
    let of = |cost: &device::Cost| cost.operation == "form-factor" && cost.rung == rung;
    let root = roots
        .into_iter()
        .find(|root| m4f.iter().any(|cost| of(cost) && cost.root == *root))?;
    let this = |cost: &&device::Cost| of(cost) && cost.root == root;
    let quads = |costs: &[device::Cost]| {
        let quads = costs.iter().filter(this).filter(|cost| cost.size == QUAD);
        mean(quads.map(device::Cost::mean))
    };
    let dearest = m4f.iter().filter(this).filter(|cost| cost.size == QUAD);
    let traced: Vec<&Traced> = traced.iter().filter(|traced| this(&&traced.cost)).collect();
    let cycles = |traced: &&&Traced| traced.cycles as f64 / f64::from(traced.cost.calls.max(1));
    let whole = |size: usize| {
        let mut of_whole = traced.iter();
        let found = of_whole.find(|traced| traced.cost.size == size && traced.cost.case == WHOLE);
        found.as_ref().map(cycles)
    };
    let of_quads = traced.iter().filter(|traced| traced.cost.size == QUAD);
    Some(DeviceCost {
        m4f_instructions: quads(m4f)?,
        m4f_largest: dearest.map(|cost| cost.largest).max()?,
        m7_instructions: quads(m7)?,
        m4f_cycles: mean(of_quads.map(|traced| cycles(&traced))),
        m4f_cycles_per_edge: whole(OCTAGON)
            .zip(whole(QUAD))
            .map(|(octagon, quad)| (octagon - quad) / (OCTAGON - QUAD) as f64),
        code_bytes: traced.first().map(|traced| traced.code_bytes),
    })
}

/// The mean; `None` of nothing.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}
