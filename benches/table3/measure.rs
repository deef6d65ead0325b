//! The figures: errors, counts and times of both methods.

use super::clock::{least, on_one_thread, once};
use super::pixels::{self, Pixels};
use super::room;
use isolux::shoot::Stop;
use isolux_host::bake::Tables;
use isolux_host::baseline::{self, Baseline, Parameters};
use isolux_host::compare::Errors;
use isolux_host::plan::{self, Plan};
use isolux_host::reference::Reflections;
use isolux_host::scene::Scene;
use isolux_host::scene::camera::Hit;
use isolux_host::solve::{self, Rung, Sight, Solution};
use std::hint::black_box;

/// Light is followed until less than this fraction of it is unshot, by every
/// method.
const UNSHOT: f32 = 0.001;

/// Runs whose least is the time of a solution of ours.
const ROUNDS: usize = 5;

/// How far inside a border's vertices are drawn in, in elements.
const DRAWN_IN: f64 = 0.25;

/// One column of the table.
pub(crate) struct Column {
    /// Errors at the pixels.
    pub(crate) errors: Errors,
    /// Those of the classical method with the vertices of borders drawn in.
    pub(crate) drawn_in: Option<Errors>,
    /// Samples or element vertices on the floor, and on all other surfaces.
    pub(crate) on_floor: usize,
    pub(crate) elsewhere: usize,
    /// Polygons or patches that shoot reflected light, and all shots taken.
    pub(crate) emitters: usize,
    pub(crate) shots: usize,
    /// Form factors, or delta form factors of the classical method.
    pub(crate) evaluations: u64,
    /// Rays, where they are counted.
    pub(crate) rays: Option<u64>,
    /// Seconds of the solution, without planning.
    pub(crate) seconds: f64,
    /// Seconds of all pixels then.
    pub(crate) pixels: f64,
}

/// All columns, in the order of the table.
pub(crate) fn columns() -> Result<Vec<Column>, Failed> {
    let pixels = Pixels::new()?;
    let once = pixels::reference(&pixels.scene, Reflections::AtMost(1))?;
    let field = |places: &[_]| once.irradiance_at(places);
    let bands = plan::isolux(&pixels.scene, &pixels.scene.budget, &field)?;
    let patches = room::plan(&pixels.scene);
    let [of_bands, of_patches] = [&bands, &patches].map(|plan| room::bake(&pixels.scene, plan));
    on_one_thread(|| {
        let mut columns = Vec::new();
        let rays = ours(&pixels, &bands, &of_bands, Sight::VertexRays)?;
        columns.push(rays.resampled()?);
        let exact = ours(&pixels, &patches, &of_patches, Sight::Exact)?;
        columns.push(exact.resampled()?);
        columns.push(exact.evaluated()?);
        for parameters in Parameters::table_3(&pixels.scene) {
            columns.push(theirs(&pixels, &parameters)?);
        }
        Ok(columns)
    })
}

/// An error that may leave the thread of the measurement.
pub(crate) type Failed = Box<dyn std::error::Error + Send + Sync>;

/// A solved plan of ours.
struct Ours<'a> {
    pixels: &'a Pixels,
    plan: &'a Plan,
    solution: Solution<'a>,
    seconds: f64,
}

fn ours<'a>(
    pixels: &'a Pixels,
    plan: &'a Plan,
    tables: &'a Tables,
    sight: Sight,
) -> Result<Ours<'a>, Failed> {
    let solve = || solve::solve(tables, Rung::Best, sight, Stop::below(UNSHOT));
    let solution = solve().map_err(failed)?;
    let seconds = least(ROUNDS, || {
        black_box(solve().is_ok());
    });
    Ok(Ours {
        pixels,
        plan,
        solution,
        seconds,
    })
}

fn failed(error: isolux::Error) -> Failed {
    error.to_string().into()
}

impl Ours<'_> {
    /// The picture by the cone filter.
    fn resampled(&self) -> Result<Column, Failed> {
        let (seconds, answers) = once(|| {
            let value = |hit: &Hit| {
                let frame = &self.plan.surfaces[hit.surface].frame;
                let (u, v) = frame.to_local(hit.position);
                let found = self.solution.resampled(hit.surface, [u as f32, v as f32]);
                found.map(|value| value.map_or(0.0, |[grey, ..]| f64::from(grey)))
            };
            let values = self.pixels.hits.iter().map(value);
            values.collect::<Result<Vec<f64>, _>>()
        });
        Ok(self.column(seconds, &answers.map_err(failed)?))
    }

    /// The picture evaluated at its pixels.
    fn evaluated(&self) -> Result<Column, Failed> {
        let receivers = self.pixels.receivers();
        let (seconds, answers) = once(|| self.solution.at(&receivers));
        let answers = answers.map_err(failed)?;
        let answers: Vec<f64> = answers.iter().map(|at| f64::from(at.value[0])).collect();
        Ok(self.column(seconds, &answers))
    }

    fn column(&self, pixels: f64, answers: &[f64]) -> Column {
        let counts = self.plan.surfaces.iter().map(|s| s.samples.len());
        let (on_floor, elsewhere) = divided(&self.pixels.scene, counts);
        let emitters = self.plan.surfaces.iter();
        Column {
            errors: self.pixels.errors(answers),
            drawn_in: None,
            on_floor,
            elsewhere,
            emitters: emitters.map(|s| s.bands.len() + s.patches.len()).sum(),
            shots: self.solution.solved.shots as usize,
            evaluations: self.solution.solved.form_factors.into(),
            rays: None,
            seconds: self.seconds,
            pixels,
        }
    }
}

/// The classical method.
fn theirs(pixels: &Pixels, parameters: &Parameters) -> Result<Column, Failed> {
    let scene = &pixels.scene;
    let (seconds, solved) = once(|| baseline::solve(scene, parameters));
    let solved = solved?;
    let (shading, answers) = once(|| shaded(pixels, &solved));
    let inset = Parameters {
        inset: DRAWN_IN,
        ..parameters.clone()
    };
    let drawn_in = baseline::solve(scene, &inset)?;
    let counts = (0..scene.surfaces.len()).map(|k| solved.vertices(k).unwrap_or(0));
    let (on_floor, elsewhere) = divided(scene, counts);
    let patches = parameters.surfaces.iter();
    Ok(Column {
        errors: pixels.errors(&answers),
        drawn_in: Some(pixels.errors(&shaded(pixels, &drawn_in))),
        on_floor,
        elsewhere,
        emitters: patches.map(|(_, r)| r.patches[0] * r.patches[1]).sum(),
        shots: solved.patch_shots() + 1,
        evaluations: solved.evaluations(),
        rays: Some(solved.rays()),
        seconds,
        pixels: shading,
    })
}

/// The picture of the classical method.
fn shaded(pixels: &Pixels, solved: &Baseline) -> Vec<f64> {
    let value = |hit: &Hit| solved.irradiance_at(hit.surface, hit.position);
    let values = pixels.hits.iter().map(value);
    values.map(|value| value.unwrap_or(0.0)).collect()
}

/// Counts of surfaces on the floor, and on all others.
fn divided(scene: &Scene, counts: impl Iterator<Item = usize>) -> (usize, usize) {
    let mut sums = (0, 0);
    for (surface, count) in scene.surfaces.iter().zip(counts) {
        if surface.name == "floor" {
            sums.0 += count;
        } else {
            sums.1 += count;
        }
    }
    sums
}
