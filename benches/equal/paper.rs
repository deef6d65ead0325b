//! The paper's scene: Scene 1 of its Table 2, and the ways of planning by error.

use super::by_default::{self, Failed, shipped_scene};
use super::ours::Ours;
use super::prices::Prices;
use glam::DVec3;
use isolux::shoot::Stop;
use isolux_host::baseline::{self, Baseline, Parameters};
use isolux_host::compare::{self, Answers, Compared, Errors};
use isolux_host::occlusion::Solids;
use isolux_host::plan::{self, Plan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::report::quantity;
use isolux_host::scene::Scene;
use isolux_host::solve::{Rung, Sight};

/// Cells along each side of the grids that errors are taken on.
const GRID: usize = 200;

/// Surfaces of the paper's scene.
const A: usize = 0;
const B: usize = 2;

/// The rungs of arithmetic that are tried: of those that err by less than the paper's
/// method does.
const RUNGS: [Rung; 3] = [Rung::Poly3, Rung::Poly5, Rung::Best];

/// Light is reflected once, as in the paper.
const ONCE: Stop = Stop::Reflections(1);

pub(crate) fn rows(prices: &Prices) -> Result<Vec<Vec<String>>, Failed> {
    let scene = shipped_scene("paper");
    let once = Reference::new(&scene, Reflections::AtMost(1), &mut |_| {})?;
    let [parameters, ..] = Parameters::table_2();
    let solved = baseline::solve(&scene, &parameters)?;
    let deltas = |round: usize| -> f64 {
        let shots = solved.shots().iter().filter(|shot| shot.round == round);
        shots.map(|shot| shot.evaluations as f64).sum()
    };
    let theirs = deltas(0) * prices.on_source + deltas(1) * prices.on_patch;
    let patches = |scene: &Scene| by_default::by_patches(scene, false).map(Some);
    let ours = [
        smallest(&scene, &once, &solved, &by_default::by_points)?,
        smallest(&scene, &once, &solved, &by_few_points)?,
        smallest(&scene, &once, &solved, &patches)?,
    ];
    let line = |name: &str, theirs: String, of: &dyn Fn(&Found) -> String| {
        let own = [name.to_owned(), theirs].into_iter();
        own.chain(ours.iter().map(of)).collect::<Vec<String>>()
    };
    let vertices = |surface: usize| solved.vertices(surface).unwrap_or(0).to_string();
    let samples = |of: &Found, surface: usize| of.plan.surfaces[surface].samples.len().to_string();
    let rms = |errors: &Errors| {
        let [relative, full_scale] =
            [&errors.relative, &errors.full_scale].map(|of| quantity(of.rms));
        format!("{relative} \\| {full_scale}")
    };
    let [theirs_a, theirs_b] = &ours[0].allowed;
    Ok(vec![
        line("", "classical".to_owned(), &|of| {
            format!("isolux, {}", shooting(&of.plan))
        }),
        line("arithmetic", "-".to_owned(), &|of| {
            format!("`{}`", of.arithmetic.name())
        }),
        line("vertices or samples on A", vertices(A), &|of| {
            samples(of, A)
        }),
        line("vertices or samples on B", vertices(B), &|of| {
            samples(of, B)
        }),
        line("what shoots on A", "-".to_owned(), &|of| {
            of.plan.surfaces[A].areas().len().to_string()
        }),
        line(
            "rms error on A, %, relative \\| full scale",
            rms(theirs_a),
            &|of| rms(&of.errors[0]),
        ),
        line("rms error on B, %", rms(theirs_b), &|of| rms(&of.errors[1])),
        line(
            "delta form factors, or form factors and points",
            format!("{}", deltas(0) + deltas(1)),
            &|of| of.form_factors.to_string(),
        ),
        line("instructions, thousands", quantity(theirs / 1e3), &|of| {
            quantity(of.instructions / 1e3)
        }),
        line("ratio", "1".to_owned(), &|of| {
            quantity(theirs / of.instructions)
        }),
    ])
}

/// What shoots reflected light.
fn shooting(plan: &Plan) -> &'static str {
    match plan.is_linear() {
        true => "patches",
        false if plan.surfaces[A].points.len() < plan.surfaces[A].samples.len() => "few points",
        false => "points",
    }
}

/// Few points for what surfaces receive, as `--emitters few-points` plans it.
fn by_few_points(scene: &Scene) -> Result<Option<Plan>, Failed> {
    let once = Reference::new(scene, Reflections::AtMost(1), &mut |_| {})?;
    let field = |places: &[(DVec3, DVec3)]| once.irradiance_at(places);
    let plan = plan::error_driven_with_few_points(scene, &scene.budget, &field);
    Ok(plan.map_err(|error| error.to_string())?)
}

/// A plan that errs no more than is allowed on either surface.
struct Found {
    plan: Plan,
    arithmetic: Rung,
    errors: [Errors; 2],
    allowed: [Errors; 2],
    form_factors: u32,
    instructions: f64,
}

/// Plans a scene within its budget; `None` where that is no plan of the kind.
type Planner<'a> = dyn Fn(&Scene) -> Result<Option<Plan>, Failed> + 'a;

/// The plan with the fewest samples that errs no more, by rms in either metric on
/// either surface, than the classical method does.
fn smallest(
    scene: &Scene,
    once: &Reference,
    solved: &Baseline,
    planner: &Planner<'_>,
) -> Result<Found, Failed> {
    let most = scene.budget.samples.expect("it has a budget");
    let mut known = 0;
    for samples in 2..=most {
        let mut budget = scene.clone();
        budget.budget.samples = Some(samples);
        // So few samples may be none.
        let Ok(Some(plan)) = planner(&budget) else {
            continue;
        };
        if plan.samples() <= known {
            continue;
        }
        known = plan.samples();
        let mut least: Option<Found> = None;
        for arithmetic in RUNGS {
            let tables = Ours {
                scene,
                tables: by_default::baked(scene, &plan)?,
                arithmetic,
                sight: Sight::None,
                stop: ONCE,
            };
            let [errors, allowed] = judged(&tables, &plan, once, solved)?;
            eprintln!(
                "paper, {known} samples, {}: {:?}, allowed {:?}",
                arithmetic.name(),
                errors.map(|of| of.relative.rms),
                allowed.map(|of| of.relative.rms)
            );
            if !errors.iter().zip(&allowed).all(within) {
                continue;
            }
            let instructions = tables.instructions()?;
            if least
                .as_ref()
                .is_none_or(|least| instructions < least.instructions)
            {
                least = Some(Found {
                    form_factors: tables.solved()?.solved.form_factors,
                    plan: plan.clone(),
                    arithmetic,
                    instructions,
                    errors,
                    allowed,
                });
            }
        }
        if let Some(found) = least {
            return Ok(found);
        }
    }
    Err("no plan of `paper` within its budget errs as little".into())
}

/// What a plan errs by on A and B, and what it may.
fn judged(
    tables: &Ours<'_>,
    plan: &Plan,
    once: &Reference,
    solved: &Baseline,
) -> Result<[[Errors; 2]; 2], Failed> {
    let scene = tables.scene;
    let solution = tables.solved()?;
    let answers = Answers {
        scene,
        plan,
        reference: once,
        solution: &solution,
        baseline: Some(solved),
    };
    let solids = Solids::of(scene);
    let of = |surface| compare::surface(&answers, &solids, surface, GRID, &mut |_| {});
    let [a, b] = [of(A), of(B)].map(|of| of.map_err(|error| error.to_string()));
    let both: [Compared; 2] = [a?, b?];
    let theirs = |of: &Compared| of.baseline_errors.unwrap_or_default();
    let ours = [both[0].errors, both[1].errors];
    Ok([ours, [theirs(&both[0]), theirs(&both[1])]])
}

/// Whether errors are no larger by rms, in either metric.
fn within((ours, theirs): (&Errors, &Errors)) -> bool {
    ours.relative.rms <= theirs.relative.rms && ours.full_scale.rms <= theirs.full_scale.rms
}
