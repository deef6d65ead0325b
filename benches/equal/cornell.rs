//! The Cornell box: the column "same quality" of the paper's Table 3.

use super::by_default::{self, Failed};
use super::ours::Ours;
use super::pixels::Pixels;
use super::prices::Prices;
use super::room;
use isolux::shoot::Stop;
use isolux_host::bake::{self, Tables};
use isolux_host::baseline::{self, Parameters};
use isolux_host::compare::Errors;
use isolux_host::plan::Plan;
use isolux_host::report::quantity;
use isolux_host::scene::camera::Hit;
use isolux_host::scene::{Scene, shipped};
use isolux_host::solve::{Rung, Sight, Solution};

/// Light is followed until less than this fraction of it is unshot, by both methods.
const UNSHOT: Stop = Stop::below(0.001);

/// Samples that are tried, fewest first.
const BUDGETS: [u64; 10] = [120, 140, 160, 180, 200, 220, 240, 300, 400, 687];

/// Samples of the plan that rays are priced in: one whose tables the device holds.
const PRICED: u64 = 200;

/// Bits of a term's factor in the rung `matrix`, as the program has it.
const TERM_BITS: u32 = 8;

/// Instructions of a ray on the device: what the rung `vertex-rays` takes more than the
/// rung `none` for the same plan and light reflected once, by the rays to the corners of
/// all emitters from all samples. What can be in the way is on lists that the host wrote.
pub(crate) fn price_of_a_ray() -> Result<f64, Failed> {
    let mut scene = room::scene("cornell", shipped::CORNELL);
    scene.budget.samples = Some(PRICED);
    let plan = room::plan(&scene);
    let once = |sight, tables| Ours {
        scene: &scene,
        tables,
        arithmetic: Rung::Best,
        sight,
        stop: Stop::Reflections(1),
    };
    let unseen = bake::bake(&scene, &plan, None).map_err(|error| error.to_string())?;
    let [with, without] = [
        once(Sight::VertexRays, room::bake(&scene, &plan)),
        once(Sight::None, unseen),
    ];
    let [with, without] = [with.on_device()?, without.on_device()?];
    let steps = [&with, &without].map(|run| {
        let steps = run.instructions_by_step;
        (steps.direct + steps.shoot) as f64
    });
    const CORNERS: f64 = 4.0;
    Ok((steps[0] - steps[1]) / (CORNERS * f64::from(without.form_factors)))
}

/// One way of ours.
struct Column {
    transfer: &'static str,
    samples: usize,
    table_bytes: usize,
    errors: Errors,
    form_factors: u32,
    instructions: f64,
}

pub(crate) fn rows(prices: &Prices, ray: f64) -> Result<Vec<Vec<String>>, Failed> {
    let pixels = Pixels::new()?;
    let [_, parameters, _] = Parameters::table_3(&pixels.scene);
    let solved = baseline::solve(&pixels.scene, &parameters)?;
    let value = |hit: &Hit| {
        solved
            .irradiance_at(hit.surface, hit.position)
            .unwrap_or(0.0)
    };
    let theirs = pixels.errors(&pixels.hits.iter().map(value).collect::<Vec<_>>());
    let deltas = |first: bool| -> f64 {
        let shots = solved
            .shots()
            .iter()
            .filter(|shot| (shot.round == 0) == first);
        shots.map(|shot| shot.evaluations as f64).sum()
    };
    let of_deltas = deltas(true) * prices.on_source + deltas(false) * prices.on_patch;
    let of_rays = solved.rays() as f64 * ray;
    let total = of_deltas + of_rays;
    let vertices: usize = (0..pixels.scene.surfaces.len())
        .filter_map(|surface| solved.vertices(surface))
        .sum();
    let ours = columns(&pixels, &theirs)?;
    let line = |name: &str, theirs: String, of: &dyn Fn(&Column) -> String| {
        let own = [name.to_owned(), theirs].into_iter();
        own.chain(ours.iter().map(of)).collect::<Vec<String>>()
    };
    let both = |errors: &Errors, of: fn(&isolux_host::compare::Statistics) -> f64| {
        let [relative, full_scale] =
            [&errors.relative, &errors.full_scale].map(|s| quantity(of(s)));
        format!("{relative} \\| {full_scale}")
    };
    let rms = |errors: &Errors| both(errors, |s| s.rms);
    let over = |errors: &Errors| both(errors, |s| s.over[4]);
    let none = || "-".to_owned();
    Ok(vec![
        line("", "classical".to_owned(), &|c| {
            format!("isolux, `{}`", c.transfer)
        }),
        line("vertices or samples", vertices.to_string(), &|c| {
            c.samples.to_string()
        }),
        line(
            "rms error, %, relative \\| full scale",
            rms(&theirs),
            &|c| rms(&c.errors),
        ),
        line("error > 15 %, % of the pixels", over(&theirs), &|c| {
            over(&c.errors)
        }),
        line(
            "delta form factors, or terms",
            solved.evaluations().to_string(),
            &|c| c.form_factors.to_string(),
        ),
        line("rays", solved.rays().to_string(), &|_| none()),
        line("bytes of tables", none(), &|c| c.table_bytes.to_string()),
        line(
            "instructions of delta form factors, millions",
            quantity(of_deltas / 1e6),
            &|_| none(),
        ),
        line(
            "instructions of rays, millions",
            quantity(of_rays / 1e6),
            &|_| none(),
        ),
        line("instructions, millions", quantity(total / 1e6), &|c| {
            quantity(c.instructions / 1e6)
        }),
        line("ratio", "1".to_owned(), &|c| {
            quantity(total / c.instructions)
        }),
        line("ratio without rays", none(), &|c| {
            quantity(of_deltas / c.instructions)
        }),
    ])
}

/// Every rung of transfer that computes the light on the device, with the smallest plan
/// that errs no more by rms in either metric.
fn columns(pixels: &Pixels, theirs: &Errors) -> Result<Vec<Column>, Failed> {
    let mut columns = Vec::new();
    for transfer in ["exact", "codes", "matrix"] {
        columns.push(smallest(pixels, theirs, transfer)?);
    }
    Ok(columns)
}

fn smallest(pixels: &Pixels, theirs: &Errors, transfer: &'static str) -> Result<Column, Failed> {
    for samples in BUDGETS {
        let mut scene = pixels.scene.clone();
        scene.budget.samples = Some(samples);
        // So few samples may be none.
        let Ok(plan) = by_default::planned(&scene, false) else {
            continue;
        };
        let ours = Ours {
            scene: &pixels.scene,
            tables: tables(&scene, &plan, transfer)?,
            arithmetic: Rung::Best,
            sight: Sight::Exact,
            stop: UNSHOT,
        };
        let solution = ours.solved()?;
        let errors = pixels.errors(&picture(pixels, &plan, &solution)?);
        eprintln!(
            "cornell, {transfer}, {samples} samples: rms {}",
            errors.relative.rms
        );
        let within = errors.relative.rms <= theirs.relative.rms
            && errors.full_scale.rms <= theirs.full_scale.rms;
        if within {
            return Ok(Column {
                transfer,
                samples: plan.samples(),
                table_bytes: ours.tables.bytes().len(),
                errors,
                form_factors: solution.solved.form_factors,
                instructions: ours.instructions()?,
            });
        }
    }
    Err(format!("no plan of `cornell` with transfer `{transfer}` errs as little").into())
}

fn tables(scene: &Scene, plan: &Plan, transfer: &str) -> Result<Tables, Failed> {
    let occlusion = by_default::occlusion(scene);
    let tables = match transfer {
        "codes" => bake::bake_coded(scene, plan, occlusion),
        "matrix" => bake::bake_matrix(scene, plan, occlusion, TERM_BITS),
        _ => bake::bake(scene, plan, occlusion),
    };
    tables.map_err(|error| error.to_string().into())
}

/// The pixels as they are reconstructed from the samples.
fn picture(pixels: &Pixels, plan: &Plan, solution: &Solution<'_>) -> Result<Vec<f64>, Failed> {
    let value = |hit: &Hit| {
        let (u, v) = plan.surfaces[hit.surface].frame.to_local(hit.position);
        let found = solution.resampled(hit.surface, [u as f32, v as f32]);
        found.map(|value| value.map_or(0.0, |[grey, ..]| f64::from(grey)))
    };
    let values = pixels
        .hits
        .iter()
        .map(value)
        .collect::<Result<Vec<f64>, _>>();
    values.map_err(|error| error.to_string().into())
}
