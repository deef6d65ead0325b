//! What is promised of reconstructions with few samples.

use crate::{open, reference, room, shipped_scene};
use glam::DVec3;
use isolux::shoot::Stop;
use isolux_host::bake::{self, Tables};
use isolux_host::plan;
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::Scene;
use isolux_host::scene::frame::Frame;
use isolux_host::solve::{self, Rung, Sight};

/// Cells along each side of a surface.
const CELLS: usize = 200;

/// Relative errors on a surface, in percent, largest first.
fn errors(scene: &Scene, tables: &Tables, judge: &Reference, name: &str) -> Vec<f64> {
    let sight = Sight::Exact;
    let solution = solve::solve(tables, Rung::default(), sight, Stop::below(1e-3)).expect("light");
    let index = scene.surface_named(name).expect("a surface");
    let frame = Frame::new(&scene.surfaces[index]);
    let grid = solution.resample(index, CELLS as u32).expect("a grid");
    let cells: Vec<usize> = (0..CELLS * CELLS)
        .filter(|k| {
            let (u, v) = frame.cell_center(k % CELLS, k / CELLS, CELLS, CELLS);
            frame.contains(u, v)
        })
        .collect();
    let places: Vec<_> = cells
        .iter()
        .map(|k| {
            let (u, v) = frame.cell_center(k % CELLS, k / CELLS, CELLS, CELLS);
            (frame.to_world(u, v), frame.normal)
        })
        .collect();
    let truth = judge.irradiance_at(&places);
    let brightest = truth.iter().copied().fold(0.0, f64::max);
    let mut errors: Vec<f64> = cells
        .iter()
        .zip(&truth)
        .filter(|(_, truth)| **truth > 1e-3 * brightest)
        .map(|(&k, truth)| 100.0 * (f64::from(grid.values[k][0]) - truth).abs() / truth)
        .collect();
    errors.sort_by(|a, b| b.total_cmp(a));
    errors
}

fn over(errors: &[f64], percent: f64) -> f64 {
    let beyond = errors.iter().filter(|&&error| error > percent).count();
    100.0 * beyond as f64 / errors.len() as f64
}

/// 49 samples on A and 9 on B: within 0.25 % and 2 %.
#[test]
fn the_papers_scene_is_right_with_the_papers_samples() {
    let scene = shipped_scene("paper.toml");
    let (plan, tables) = open(&scene);
    let count = |name: &str| {
        let index = scene.surface_named(name).expect("a surface");
        plan.surfaces[index].samples.len()
    };
    assert!(
        count("A") <= 49 && count("B") <= 10,
        "{} {}",
        count("A"),
        count("B")
    );
    let judge = Reference::new(&scene, Reflections::UntilUnshot(1e-5), &mut |_| {});
    let judge = judge.expect("a reference");
    let (a, b) = (
        errors(&scene, &tables, &judge, "A"),
        errors(&scene, &tables, &judge, "B"),
    );
    println!("A at most {} %, B at most {} %", a[0], b[0]);
    assert!(a[0] <= 0.25, "A: {} %", a[0]);
    assert!(b[0] <= 2.0, "B: {} %", b[0]);
}

/// The same with the other shape of the light: twice that.
#[test]
fn the_other_light_shape_is_right_too() {
    let scene = shipped_scene("paper-aspect.toml");
    let (plan, tables) = open(&scene);
    assert!(plan.samples() <= 59, "{} samples", plan.samples());
    let judge = Reference::new(&scene, Reflections::UntilUnshot(1e-5), &mut |_| {});
    let judge = judge.expect("a reference");
    let (a, b) = (
        errors(&scene, &tables, &judge, "A"),
        errors(&scene, &tables, &judge, "B"),
    );
    println!("A at most {} %, B at most {} %", a[0], b[0]);
    assert!(a[0] <= 0.5, "A: {} %", a[0]);
    assert!(b[0] <= 4.0, "B: {} %", b[0]);
}

/// 50 samples in the penumbra scene: nothing beyond 5 %, hardly anything beyond 2 %.
#[test]
fn a_penumbra_is_right_with_50_samples() {
    let mut scene = shipped_scene("penumbra.toml");
    scene.budget.samples = Some(50);
    let (plan, tables) = room(&scene);
    assert!(plan.samples() <= 50, "{} samples", plan.samples());
    let judge = reference(&scene, 0);
    let errors = errors(&scene, &tables, &judge, "receiver");
    let beyond = over(&errors, 2.0);
    println!(
        "at most {} %, {beyond} % of the places beyond 2 %",
        errors[0]
    );
    assert!(errors[0] <= 5.0, "{} %", errors[0]);
    assert!(beyond <= 0.2, "{beyond} %");
}

/// A few samples more, up to 16 on B: all of B within 0.7 %, without a word about how.
#[test]
fn sixteen_samples_are_enough_for_light_that_is_reflected() {
    let mut scene = shipped_scene("paper.toml");
    scene.budget.samples = Some(65);
    let (plan, tables) = open(&scene);
    let counts = ["A", "B"].map(|name| {
        let index = scene.surface_named(name).expect("a surface");
        plan.surfaces[index].samples.len()
    });
    assert!(counts[0] <= 49 && counts[1] <= 16, "{counts:?}");
    let judge = Reference::new(&scene, Reflections::UntilUnshot(1e-5), &mut |_| {});
    let judge = judge.expect("a reference");
    let [a, b] = ["A", "B"].map(|name| errors(&scene, &tables, &judge, name)[0]);
    println!("{counts:?} samples: A at most {a} %, B at most {b} %");
    assert!(a <= 0.25 && b <= 0.7, "A: {a} %, B: {b} %");
}

/// Few points light B as well as all samples of A do, for a tenth of the terms.
#[test]
fn few_points_light_a_surface_as_well_as_many() {
    let mut scene = shipped_scene("paper.toml");
    scene.budget.samples = Some(29);
    let once = reference(&scene, 1);
    let field = |places: &[(DVec3, DVec3)]| once.irradiance_at(places);
    let plan = plan::error_driven_with_few_points(&scene, &scene.budget, &field);
    let plan = plan.expect("a plan").expect("areas that suffice");
    let [samples, points] = [
        plan.surfaces.iter().map(|s| s.samples.len()).sum::<usize>(),
        plan.surfaces.iter().map(|s| s.points.len()).sum::<usize>(),
    ];
    assert!(
        samples <= 29 && (1..=8).contains(&points),
        "{samples} {points}"
    );
    let tables = bake::bake(&scene, &plan, None).expect("tables");
    let stop = Stop::Reflections(1);
    let light = solve::solve(&tables, Rung::default(), Sight::None, stop).expect("light");
    // What is sent is what is reflected, to a fifth.
    for (index, planned) in plan.surfaces.iter().enumerate() {
        let Some(tensor) = planned.fields.first().and_then(|f| f.tensor.as_ref()) else {
            continue;
        };
        let frame = Frame::new(&scene.surfaces[index]);
        let value = |[u, v]: [f64; 2]| field(&[(frame.to_world(u, v), frame.normal)])[0];
        let of_all: f64 = (tensor.places().into_iter().zip(tensor.areas()))
            .map(|(place, area)| area * value(place))
            .sum();
        let of_few: f64 = (planned.points.iter())
            .map(|point| point.area * value(planned.samples[point.sample].place))
            .sum();
        assert!((of_few / of_all - 1.0).abs() <= 0.2, "{of_few} {of_all}");
    }
    let b = scene.surface_named("B").expect("a surface");
    let frame = Frame::new(&scene.surfaces[b]);
    let mut worst = 0.0_f64;
    for k in 0..40 * 40 {
        let (u, v) = frame.cell_center(k % 40, k / 40, 40, 40);
        let truth = field(&[(frame.to_world(u, v), frame.normal)])[0];
        let found = light.resampled(b, [u as f32, v as f32]).expect("light");
        let found = f64::from(found.expect("a place")[0]);
        worst = worst.max((found / truth - 1.0).abs());
    }
    println!("{samples} samples, {points} points: B within {}", worst);
    assert!(worst <= 0.05, "{worst}");
}
