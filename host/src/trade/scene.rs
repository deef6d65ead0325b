//! What every rung gives and costs in a scene.

use super::error::largest_and_p95;
use super::{TIME_LIMIT, optional};
use crate::bake::{self, Tables};
use crate::device::{self, Core, Job, Options};
use crate::plan::Plan;
use crate::reference::Reference;
use crate::scene::Scene;
use crate::solve::{self, FormFactorRung, Sight};
use glam::DVec3;
use isolux::shoot::Stop;
use serde::Serialize;

/// Places along each side of a surface.
const GRID: usize = 24;

/// Rows and columns of the grid that the device resamples: not what is
/// measured here.
const RESAMPLED: usize = 2;

/// Errors of irradiance at places, in percent of the largest irradiance of the
/// surface that the place is on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PlaceErrors {
    /// The largest.
    pub max: f64,
    /// 95 % of the places err by no more.
    pub p95: f64,
    /// Root of the mean square.
    pub rms: f64,
}

/// A rung in a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InScene {
    /// The rung.
    pub rung: &'static str,
    /// Errors of direct light: the rung's own, for nothing else errs there.
    pub direct: PlaceErrors,
    /// Errors of all light: the rung's and those of what shoots the reflected
    /// light.
    pub all: PlaceErrors,
    /// Costs on the device; `None` where there is no emulator.
    pub device: Option<SceneCost>,
}

/// What direct light and shots cost on the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct SceneCost {
    /// Instructions on the Cortex-M4F: direct light and shots.
    pub m4f_instructions: u64,
    /// Instructions on the Cortex-M7.
    pub m7_instructions: u64,
    /// Instructions on the Cortex-M3 of the rungs in integers; `None` of the
    /// others, and where its Rust target is missing.
    pub m3_instructions: Option<u64>,
    /// Bytes of kernel code in a program with this rung alone.
    pub kernel_code_bytes: u64,
}

/// A planned and baked scene, and the light it is judged by.
#[derive(Clone, Copy, Debug)]
pub struct Judged<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Where its samples are.
    pub plan: &'a Plan,
    /// What the device reads.
    pub tables: &'a Tables,
    /// How occlusion is found.
    pub sight: Sight,
    /// How often light is reflected.
    pub reflections: u32,
    /// Light reflected never.
    pub direct: &'a Reference,
    /// Light reflected at most that often.
    pub all: &'a Reference,
}

/// Why a scene has no table.
#[derive(Debug)]
pub enum Error {
    /// The kernel refused the scene or a place in it.
    Kernel(isolux::Error),
    /// The device's program does not build or end.
    Device(device::Error),
}

impl std::fmt::Display for Error {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Kernel(error) => error.fmt(formatter),
            Self::Device(error) => error.fmt(formatter),
        }
    }
}

impl std::error::Error for Error {}

/// Places on a surface with the reference's answers there.
struct Field {
    places: Vec<([f32; 3], [f32; 3])>,
    direct: Vec<f64>,
    all: Vec<f64>,
}

/// Every rung in a scene: irradiance by the kernel at a grid of places on every
/// surface that has samples, with the reference's number of reflections;
/// direct light and shots on the device where `on_device`.
///
/// # Errors
/// See [`Error`]; what is missing for the device is no error.
pub fn scene(
    judged: &Judged<'_>,
    on_device: bool,
    mut progress: impl FnMut(&str),
) -> Result<Vec<InScene>, Error> {
    progress("evaluating the reference");
    let fields = fields(judged);
    let mut rows = Vec::new();
    let words = in_words(judged);
    for rung in FormFactorRung::ALL {
        let tables = match (rung.is_integer(), &words) {
            (false, _) => judged.tables,
            (true, Some(words)) => words,
            (true, None) => continue,
        };
        progress(&format!("{} in {}", rung.name(), judged.scene.name));
        let errors = |reflections, exact: fn(&Field) -> &[f64]| {
            let stop = Stop::Reflections(reflections);
            let solution = solve::solve(tables, rung, judged.sight, stop).map_err(Error::Kernel)?;
            let mut errors = Vec::new();
            for field in &fields {
                let exact = exact(field);
                let full_scale = exact.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
                let got = solution.at(&field.places).map_err(Error::Kernel)?;
                let pairs = got.iter().zip(exact);
                errors.extend(pairs.map(|(got, exact)| {
                    100.0 * (f64::from(got.value[0]) - exact).abs() / full_scale
                }));
            }
            Ok(summary(errors))
        };
        rows.push(InScene {
            rung: rung.name(),
            direct: errors(0, |field| &field.direct)?,
            all: errors(judged.reflections, |field| &field.all)?,
            device: match on_device {
                true => {
                    optional(cost(judged, tables, rung))
                        .map_err(Error::Device)?
                        .0
                }
                false => None,
            },
        });
    }
    Ok(rows)
}

fn fields(judged: &Judged<'_>) -> Vec<Field> {
    let surfaces = judged.plan.surfaces.iter();
    let received = surfaces.filter(|surface| !surface.samples.is_empty());
    received
        .map(|surface| {
            let frame = &surface.frame;
            let places: Vec<(DVec3, DVec3)> = (0..GRID * GRID)
                .map(|k| frame.cell_center(k % GRID, k / GRID, GRID, GRID))
                .filter(|&(u, v)| frame.contains(u, v))
                .map(|(u, v)| (frame.to_world(u, v), frame.normal))
                .collect();
            let single = |v: DVec3| v.as_vec3().to_array();
            Field {
                direct: judged.direct.irradiance_at(&places),
                all: judged.all.irradiance_at(&places),
                places: places
                    .iter()
                    .map(|&(p, n)| (single(p), single(n)))
                    .collect(),
            }
        })
        .collect()
}

fn summary(mut errors: Vec<f64>) -> PlaceErrors {
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    let rms = (squares / errors.len().max(1) as f64).sqrt();
    let (max, p95) = largest_and_p95(&mut errors).unwrap_or_default();
    PlaceErrors { max, p95, rms }
}

/// The same plan for the rungs in integers; `None` where they do not serve: in
/// colour, with occluders, with linear radiosities.
fn in_words(judged: &Judged<'_>) -> Option<Tables> {
    let is_open = judged.sight == Sight::None;
    is_open.then(|| bake::integers::bake(judged.scene, judged.plan).ok())?
}

/// Direct light and shots on every core that the rung is for. One run a core:
/// only the first of a run is told by step.
fn cost(
    judged: &Judged<'_>,
    tables: &Tables,
    rung: FormFactorRung,
) -> Result<SceneCost, device::Error> {
    let run = |core| {
        let job = Job {
            scene: &judged.scene.name,
            tables: tables.bytes(),
            arithmetic: rung.name(),
            visibility: judged.sight.name(),
            stop: Stop::Reflections(judged.reflections),
            resolution: RESAMPLED,
            // Whether the bits are the host's is `isolux device`'s business.
            expected: &[],
            budget: judged.scene.budget,
        };
        let options = Options {
            cores: vec![core],
            software_root: false,
            negative_control: false,
            time_limit: TIME_LIMIT,
        };
        let measured = device::run(&job, &options)?;
        let steps = measured.instructions_by_step;
        let both = steps.direct + steps.shoot;
        Ok((both, measured.flash_kernel_code_bytes))
    };
    let (m4f_instructions, kernel_code_bytes) = run(Core::CortexM4F)?;
    let (m7_instructions, _) = run(Core::CortexM7)?;
    let m3 = match rung.is_integer() {
        true => optional(run(Core::CortexM3))?.0,
        false => None,
    };
    Ok(SceneCost {
        m4f_instructions,
        m7_instructions,
        m3_instructions: m3.map(|(instructions, _)| instructions),
        kernel_code_bytes,
    })
}
