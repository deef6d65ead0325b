//! What the rungs of visibility, emitters and transfer give and cost in a scene.
//!
//! [`mod@super::scene`] keeps the plan and changes the arithmetic; here the
//! arithmetic stays and what is planned and baked changes. Every place on a grid
//! over every reflecting surface is answered from the emitters, without
//! reconstruction: errors are those of the rungs alone.

use super::scene::Error;
use super::table::{finished, plain};
use super::{TIME_LIMIT, front, optional};
use crate::bake::Tables;
use crate::compare::{Errors, errors_by_scale, mean};
use crate::device::{self, Core, Job, Options};
use crate::occlusion::Solids;
use crate::plan::Plan;
use crate::reference::Reference;
use crate::report::quantity;
use crate::scene::Scene;
use crate::scene::frame::Frame;
use crate::scene::memory::Memory;
use crate::solve::{self, Rung, Sight, Solution};
use glam::DVec3;
use isolux::shoot::Stop;
use serde::Serialize;

/// Places along each side of a surface.
const GRID: usize = 24;

/// Rows and columns of the grid that the device resamples: not what is measured
/// here.
const RESAMPLED: usize = 1;

/// One rung of each ladder, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Choice {
    /// How occlusion is found.
    pub visibility: &'static str,
    /// What shoots reflected light.
    pub emitters: &'static str,
    /// How emitter-to-receiver terms are had.
    pub transfer: &'static str,
}

/// What is compared: each ladder's rungs, the others on their best. Rungs of
/// visibility only where something can hide anything.
#[must_use]
pub fn choices(occluded: bool) -> Vec<Choice> {
    let best = Choice {
        visibility: if occluded { "exact" } else { "none" },
        emitters: "linear",
        transfer: "exact",
    };
    let lesser = ["none", "vertex-rays"].map(|visibility| Choice { visibility, ..best });
    let outlines = ["isolux", "layer-cake"].map(|emitters| Choice { emitters, ..best });
    let written = ["codes", "matrix"].map(|transfer| Choice { transfer, ..best });
    let lesser = lesser.into_iter().filter(|_| occluded);
    lesser
        .chain(outlines)
        .chain([best])
        .chain(written)
        .collect()
}

/// A combination of rungs in a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InRoom {
    /// The rungs.
    #[serde(flatten)]
    pub choice: Choice,
    /// Samples and emitters of its plan.
    pub samples: u32,
    /// Luminaires and what reflects.
    pub shooters: u32,
    /// Shots until the stop.
    pub shots: u32,
    /// Errors of irradiance, in percent.
    pub error: Errors,
    /// Bytes of flash that the tables take.
    pub table_bytes: usize,
    /// Bytes of RAM that the light and the workspace take.
    pub ram_bytes: usize,
    /// Instructions of direct light and shots on the Cortex-M4F; `None` where
    /// there is no emulator, or the device has no room.
    pub m4f_instructions: Option<u64>,
    /// Whether no other combination is both as cheap and as good, by p95.
    pub on_front: bool,
}

impl InRoom {
    /// What it is placed by in the plot: instructions, else bytes.
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.m4f_instructions
            .map_or(self.table_bytes as f64, |count| count as f64)
    }
}

/// Places that can be seen, with the reference's answers.
#[derive(Clone, Debug)]
pub struct Field {
    places: Vec<([f32; 3], [f32; 3])>,
    /// The same: the surface, and where on it.
    on_surfaces: Vec<(usize, [f32; 2])>,
    /// By place: the reference and its surface's largest value.
    exact: Vec<[f64; 2]>,
}

impl Field {
    /// A grid over every surface that reflects, without what bodies stand on.
    #[must_use]
    pub fn new(scene: &Scene, reference: &Reference) -> Self {
        let solids = Solids::of(scene);
        let mut field = Self {
            places: Vec::new(),
            on_surfaces: Vec::new(),
            exact: Vec::new(),
        };
        let surfaces = scene.surfaces.iter().enumerate();
        for (index, surface) in surfaces.filter(|(_, surface)| surface.reflects()) {
            let frame = Frame::new(surface);
            let cells: Vec<(f64, f64)> = (0..GRID * GRID)
                .map(|k| frame.cell_center(k % GRID, k / GRID, GRID, GRID))
                .filter(|&(u, v)| frame.contains(u, v))
                .filter(|&(u, v)| !solids.hide(index, frame.to_world(u, v), frame.normal))
                .collect();
            let place = |&(u, v): &(f64, f64)| (frame.to_world(u, v), frame.normal);
            let places: Vec<(DVec3, DVec3)> = cells.iter().map(place).collect();
            let on_surface = |&(u, v): &(f64, f64)| (index, [u as f32, v as f32]);
            field.on_surfaces.extend(cells.iter().map(on_surface));
            let values: Vec<f64> = reference.light_at(&places).into_iter().map(mean).collect();
            let largest = values.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
            let single = |v: DVec3| v.as_vec3().to_array();
            let places = places.iter().map(|&(p, n)| (single(p), single(n)));
            field.places.extend(places);
            field
                .exact
                .extend(values.iter().map(|&value| [value, largest]));
        }
        field
    }

    /// What a solution errs by there, reconstructed from its samples.
    ///
    /// # Errors
    /// Where the solution is of another scene.
    pub fn reconstructed(&self, solution: &Solution<'_>) -> Result<Errors, isolux::Error> {
        let of = |&(surface, place): &(usize, [f32; 2])| {
            let value = solution.resampled(surface, place)?;
            Ok(value.map_or(0.0, |value| mean(value.map(f64::from))))
        };
        let got: Vec<f64> = self.on_surfaces.iter().map(of).collect::<Result<_, _>>()?;
        Ok(self.errors(got.into_iter()))
    }

    fn errors(&self, got: impl Iterator<Item = f64>) -> Errors {
        let of_places = got.zip(&self.exact);
        errors_by_scale(of_places.map(|(got, &[exact, largest])| (got, exact, largest)))
    }
}

/// A scene planned and baked for a combination of rungs.
#[derive(Clone, Copy, Debug)]
pub struct Baked<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Its plan.
    pub plan: &'a Plan,
    /// What the device reads.
    pub tables: &'a Tables,
    /// How occlusion is found.
    pub sight: Sight,
    /// Bytes of RAM for the kernel's state.
    pub ram_bytes: usize,
    /// When to stop.
    pub stop: Stop,
}

/// Measures a combination; on the device where `on_device`.
///
/// # Errors
/// See [`Error`]; what is missing for the device is no error, nor is a scene that
/// it has no room for.
pub fn measure(
    choice: Choice,
    baked: &Baked<'_>,
    field: &Field,
    on_device: bool,
) -> Result<InRoom, Error> {
    let solution = solve::solve(baked.tables, Rung::default(), baked.sight, baked.stop);
    let solution = solution.map_err(Error::Kernel)?;
    let got = solution.at(&field.places).map_err(Error::Kernel)?;
    let answers = got.iter().map(|at| mean(at.value.map(f64::from)));
    let error = field.errors(answers);
    Ok(InRoom {
        choice,
        samples: baked.tables.counts.samples,
        shooters: baked.tables.counts.emitters,
        shots: solution.solved.shots,
        error,
        table_bytes: baked.tables.bytes().len(),
        ram_bytes: baked.ram_bytes,
        m4f_instructions: match on_device {
            true => instructions(baked)?,
            false => None,
        },
        on_front: false,
    })
}

/// Instructions of direct light and shots on the Cortex-M4F; `None` where there is no
/// emulator, or the device has no room.
///
/// # Errors
/// See [`Error`].
pub fn instructions(baked: &Baked<'_>) -> Result<Option<u64>, Error> {
    let board = Memory::of_the_board();
    let fits =
        baked.tables.bytes().len() as u64 <= board.flash && baked.ram_bytes as u64 <= board.ram;
    if !fits {
        return Ok(None);
    }
    let job = Job {
        scene: &baked.scene.name,
        tables: baked.tables.bytes(),
        arithmetic: Rung::default().name(),
        visibility: baked.sight.name(),
        stop: baked.stop,
        resolution: RESAMPLED,
        // Whether the bits are the host's is `isolux device`'s business.
        expected: &[],
        budget: baked.scene.budget,
    };
    let options = Options {
        cores: vec![Core::CortexM4F],
        software_root: false,
        negative_control: false,
        time_limit: TIME_LIMIT,
    };
    let run = optional(device::run(&job, &options))
        .map_err(Error::Device)?
        .0;
    let steps = run.map(|run| run.instructions_by_step);
    Ok(steps.map(|steps| steps.direct + steps.shoot))
}

/// Marks the combinations on the front of instructions and p95.
pub fn mark(rows: &mut [InRoom]) {
    let points: Vec<(f64, f64)> = rows
        .iter()
        .map(|row| (row.cost(), row.error.relative.p95))
        .collect();
    for (row, on_front) in rows.iter_mut().zip(front::pareto(&points)) {
        row.on_front = on_front;
    }
}

/// The columns of [`csv`]; errors in percent: relative, then of full scale.
pub const COLUMNS: &str = "scene,visibility,emitters,transfer,samples,shooters,shots,\
max,p95,rms,over_5,over_15,full_scale_max,full_scale_p95,full_scale_rms,\
m4f_instructions,table_bytes,ram_bytes,on_front";

/// The combinations, one a line.
#[must_use]
pub fn csv(name: &str, rows: &[InRoom]) -> String {
    let mut text = format!("{COLUMNS}\n");
    for row in rows {
        let Choice {
            visibility,
            emitters,
            transfer,
        } = row.choice;
        let mut cells = [name, visibility, emitters, transfer]
            .map(str::to_owned)
            .to_vec();
        cells.extend([row.samples, row.shooters, row.shots].map(|count| count.to_string()));
        cells.extend(error_cells(&row.error));
        cells.push(
            row.m4f_instructions
                .map_or_else(String::new, |n| n.to_string()),
        );
        cells.extend([row.table_bytes, row.ram_bytes].map(|bytes| bytes.to_string()));
        cells.push(row.on_front.to_string());
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}

/// The cells of errors: max, p95, rms and the parts above 5 and 15 % of relative ones, then
/// the first three of full scale.
pub(super) fn error_cells(errors: &Errors) -> impl Iterator<Item = String> {
    let (relative, full_scale) = (&errors.relative, &errors.full_scale);
    let [_, _, over_5, _, over_15] = relative.over;
    let of_scale = [full_scale.max, full_scale.p95, full_scale.rms];
    let errors = [relative.max, relative.p95, relative.rms, over_5, over_15];
    let errors = errors.into_iter().chain(of_scale);
    errors.map(|error| format!("{error:.3e}"))
}

/// The combinations for a person; a star marks the front.
#[must_use]
pub fn terminal(rows: &[InRoom]) -> String {
    let mut table = plain([
        "visibility",
        "emitters",
        "transfer",
        "max %",
        "p95 %",
        "rms %",
        "> 5 %",
        "> 15 %",
        "instructions",
        "tables",
        "RAM",
        "front",
    ]);
    for row in rows {
        let relative = &row.error.relative;
        let [_, _, over_5, _, over_15] = relative.over;
        let errors = [relative.max, relative.p95, relative.rms, over_5, over_15];
        let Choice {
            visibility,
            emitters,
            transfer,
        } = row.choice;
        let counted = row.m4f_instructions.map(|count| count.to_string());
        let names = [visibility, emitters, transfer].map(str::to_owned);
        let rest = [
            counted.unwrap_or_else(|| "-".to_owned()),
            row.table_bytes.to_string(),
            row.ram_bytes.to_string(),
            if row.on_front { "*" } else { "" }.to_owned(),
        ];
        let errors = errors.map(quantity);
        table.add_row(names.into_iter().chain(errors).chain(rest));
    }
    finished(table)
}
