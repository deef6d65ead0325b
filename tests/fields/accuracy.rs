//! What is promised of reconstructions with few samples.

use crate::{open, reference, room, shipped_scene};
use isolux::shoot::Stop;
use isolux_host::bake::Tables;
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
