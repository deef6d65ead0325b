//! The budget sheet: what a planned scene holds, costs and is predicted to err by.

mod text;

use super::failure::Failure;
use super::pipeline::Planned;
use super::render::GRID;
use crate::device::model::{self, Model, Predicted, PredictedSteps};
use crate::device::operations::{Done, Operations};
use crate::plan::{PredictedAt, SurfacePlan, Tag};
use crate::solve::FormFactorRung;
use isolux::budget;
use isolux::shoot::Stop;
use serde::Serialize;
use std::collections::BTreeMap;

/// The budget sheet of a planned scene.
#[derive(Clone, Serialize)]
pub(super) struct Sheet {
    scene: String,
    rungs: RungNames,
    samples: usize,
    /// Values on outlines of shadows that are known without a sample.
    free_samples: usize,
    luminaires: usize,
    /// Emitters that reflect.
    emitters: usize,
    /// Light, workspace and room together.
    ram_bytes: u64,
    light_bytes: usize,
    workspace_bytes: usize,
    room_bytes: usize,
    table_bytes: u64,
    /// In percent; `null` where the planner made no prediction.
    predicted_error: Option<f64>,
    /// The same by what light does at a place.
    predicted_by_tag: Vec<OfTag>,
    surfaces: Vec<OfSurface>,
    /// `null` for rungs that no costs were measured for.
    cost: Option<Cost>,
}

/// What a run costs, predicted.
#[derive(Clone, Serialize)]
struct Cost {
    core: &'static str,
    #[serde(skip)]
    arithmetic: &'static str,
    instructions: PredictedSteps,
    instructions_total: Predicted,
    /// What a step may be above its prediction, in percent of it.
    error: Errors,
    shots: u64,
    /// Rows and columns of the grids of the step `resample`.
    resolution: usize,
    /// Estimated, from flash without wait states.
    cycles: u64,
    milliseconds: Vec<AtClock>,
    /// Of the stated current for a megahertz.
    microcoulombs: Option<f64>,
}

#[derive(Clone, Copy, Serialize)]
struct Errors {
    load: f64,
    light: f64,
    resample: f64,
}

#[derive(Clone, Copy, Serialize)]
struct AtClock {
    megahertz: f64,
    milliseconds: f64,
}

/// Clocks that times are given for.
const CLOCKS: [f64; 3] = [16.0, 64.0, 168.0];

#[derive(Clone, Serialize)]
struct RungNames {
    arithmetic: &'static str,
    visibility: &'static str,
    emitters: &'static str,
    transfer: &'static str,
    placement: &'static str,
    reconstruction: &'static str,
}

#[derive(Clone, Serialize)]
struct OfSurface {
    name: String,
    samples: usize,
    by_tag: BTreeMap<&'static str, usize>,
    free_samples: usize,
    emitters: usize,
    predicted_error: Option<f64>,
    /// The same of every part of its light.
    parts: Vec<OfPart>,
    /// And by what light does at a place.
    predicted_by_tag: Vec<OfTag>,
}

#[derive(Clone, Serialize)]
struct OfPart {
    part: &'static str,
    /// In percent of all light there.
    error: f64,
    /// The area in m² that it is the mean over.
    area: f64,
}

#[derive(Clone, Serialize)]
struct OfTag {
    tag: &'static str,
    /// In percent of all light there.
    error: f64,
    /// The area in m² of its places.
    area: f64,
}

impl Sheet {
    /// The sheet of a planned scene.
    ///
    /// # Errors
    /// Where the kernel does not take its tables.
    pub(super) fn of(planned: &Planned) -> Result<Self, Failure> {
        let (ram, sight) = planned.ram()?;
        let workspace = budget::sight_bytes(&sight);
        let room = match planned.rung.is_integer() {
            true => 0,
            false => budget::room_bytes(&planned.tables.counts),
        };
        let areas = planned.scene.surfaces.iter().map(|surface| surface.area);
        let error = planned.plan.predicted_error(areas);
        let (scene, plan) = (&planned.scene, &planned.plan);
        let counts = &planned.tables.counts;
        let surfaces = scene.surfaces.iter().zip(&plan.surfaces);
        let looked_at = surfaces.filter(|(_, planned)| !planned.samples.is_empty());
        let of_surface = |(surface, planned): (&crate::scene::Surface, &SurfacePlan)| OfSurface {
            name: surface.name.clone(),
            samples: planned.samples.len(),
            by_tag: by_tag(planned),
            free_samples: planned.free_samples(),
            emitters: planned.areas().len(),
            predicted_error: planned
                .predicted_error(surface.area)
                .map(|error| 100.0 * error),
            parts: parts(planned),
            predicted_by_tag: predicted_by_tag(&planned.predicted_by_tag),
        };
        Ok(Self {
            scene: scene.name.clone(),
            rungs: RungNames {
                arithmetic: planned.rung.name(),
                visibility: planned.sight.name(),
                emitters: planned.emitters.name(),
                transfer: planned.transfer.name(),
                placement: planned.placement.name(),
                reconstruction: planned.reconstruction(),
            },
            samples: plan.samples(),
            free_samples: plan.free_samples(),
            luminaires: counts.luminaires as usize,
            emitters: counts.emitters.saturating_sub(counts.luminaires) as usize,
            ram_bytes: ram as u64,
            light_bytes: ram - workspace - room,
            workspace_bytes: workspace,
            room_bytes: room,
            table_bytes: planned.tables.bytes().len() as u64,
            predicted_error: error.map(|error| 100.0 * error),
            predicted_by_tag: predicted_by_tag(&plan.predicted_by_tag()),
            surfaces: looked_at.map(of_surface).collect(),
            cost: None,
        })
    }

    /// The sheet with what a run will cost, where the costs of its rung are known; of the
    /// charge where a current in µA for a megahertz is given.
    pub(super) fn with_cost(mut self, operations: &Operations, microamperes: Option<f64>) -> Self {
        let model = Model::committed();
        if !model.knows(operations) {
            return self;
        }
        let error = |step, done| 100.0 * model.error(step, &operations.kind, done).unwrap_or(0.0);
        let instructions = model.steps(operations);
        let total = instructions.total();
        let cycles = total.expected as f64 * model::cycles(&operations.kind);
        let at_clock = |megahertz: f64| AtClock {
            megahertz,
            milliseconds: cycles / (1e3 * megahertz),
        };
        let shots = |done: &Done| done.get("shot").copied().unwrap_or(0);
        self.cost = Some(Cost {
            core: model::core(&operations.kind).name(),
            arithmetic: self.rungs.arithmetic,
            instructions,
            instructions_total: total,
            error: Errors {
                load: error("load", &operations.load),
                light: error("direct", &operations.direct),
                resample: error("resample", &operations.resample),
            },
            shots: shots(&operations.direct) + shots(&operations.shoot),
            resolution: GRID,
            cycles: cycles as u64,
            milliseconds: CLOCKS.map(at_clock).to_vec(),
            microcoulombs: microamperes.map(|current| cycles * current * 1e-6),
        });
        self
    }

    /// What was predicted of the steps.
    pub(super) fn predicted(&self) -> Option<PredictedSteps> {
        self.cost.as_ref().map(|cost| cost.instructions)
    }
}

/// What the runs of a planned scene do on the device.
///
/// # Errors
/// Where the kernel does not take its tables.
pub(super) fn operations(planned: &Planned, stop: Stop) -> Result<Operations, Failure> {
    let tables = &planned.tables;
    let counted = match planned.rung {
        FormFactorRung::Float(rung) => Operations::of(tables, (rung, planned.sight), stop, GRID),
        FormFactorRung::Q24 => Operations::in_integers(tables, true, stop, GRID),
        FormFactorRung::Q29 => Operations::in_integers(tables, false, stop, GRID),
    };
    counted.map_err(|error| Failure::limit(error, "lower [budget] samples or split the scene"))
}

fn parts(planned: &SurfacePlan) -> Vec<OfPart> {
    let of = |part: &crate::plan::Predicted| OfPart {
        part: part.part.name(),
        error: 100.0 * part.rms,
        area: part.area,
    };
    planned.predicted.iter().map(of).collect()
}

fn predicted_by_tag(predicted: &[PredictedAt]) -> Vec<OfTag> {
    let of = |at: &PredictedAt| OfTag {
        tag: at.tag.name(),
        error: 100.0 * at.rms,
        area: at.area,
    };
    predicted.iter().map(of).collect()
}

fn by_tag(planned: &SurfacePlan) -> BTreeMap<&'static str, usize> {
    let mut counts = BTreeMap::new();
    let tags = planned.samples.iter().map(|sample| sample.tag);
    tags.for_each(|tag: Tag| *counts.entry(tag.name()).or_insert(0) += 1);
    counts
}
