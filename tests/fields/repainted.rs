//! A room that is painted after it was planned: the plan, its samples and weights stay.

use crate::{room, shipped_scene};
use isolux::shoot::Stop;
use isolux_host::bake;
use isolux_host::compare::{self, Answers, Errors};
use isolux_host::occlusion::{Occlusion, Solids};
use isolux_host::plan::{Plan, file};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::camera::View;
use isolux_host::scene::{Rungs, Scene};
use isolux_host::solve::{self, Rung, Sight};

/// Pixels along each side of the picture.
const PIXELS: u32 = 64;

/// Cells along each side of a surface, for its full scale.
const CELLS: usize = 12;

/// How well two meshes of the reference agree.
const AGREEMENT: f64 = 3e-3;

/// What a plan errs by over the pixels of the scene's camera.
fn seen(scene: &Scene, plan: &Plan) -> Errors {
    let vertices = scene.surfaces.iter().flat_map(|s| s.vertices.clone());
    let occlusion = Occlusion::for_receivers_within(scene, vertices).expect("occluders");
    let tables = bake::bake(scene, plan, Some(occlusion)).expect("tables");
    let stop = Stop::below(1e-3);
    let solution = solve::solve(&tables, Rung::default(), Sight::Exact, stop).expect("light");
    let all = Reflections::UntilUnshot(1e-4);
    let judge = Reference::to_within(scene, all, AGREEMENT, &mut |_| {}).expect("a reference");
    let answers = Answers {
        scene,
        plan,
        reference: &judge,
        solution: &solution,
        baseline: None,
    };
    let solids = Solids::of(scene);
    let full_scale = |index: usize| match scene.surfaces[index].reflects() {
        true => {
            let of = compare::surface(&answers, &solids, index, CELLS, &mut |_| {});
            of.expect("a surface").full_scale
        }
        false => 0.0,
    };
    let full_scale: Vec<f64> = (0..scene.surfaces.len()).map(full_scale).collect();
    let view = View::new(&scene.camera.expect("a camera"), PIXELS, PIXELS);
    let seen = compare::camera(&answers, &view, &full_scale, &mut |_| {});
    seen.expect("a picture").errors
}

/// The floor of the Cornell box from 0.7 to 0.3: at most 3 % of the pixels err by more
/// than 5 %, as the plan file says it and as it was planned.
#[test]
fn a_painted_floor_needs_no_new_plan() {
    let scene = shipped_scene("cornell.toml");
    let (plan, _) = room(&scene);
    let mut painted = scene.clone();
    let floor = scene.surface_named("floor").expect("a floor");
    painted.surfaces[floor].reflectance = [0.3; 3];
    let text = file::text(&scene, &Rungs::default(), &plan);
    let saved = file::parse("cornell.plan", &text, &painted).expect("the plan of the same room");
    let errors = seen(&painted, &saved.plan);
    let [_, _, over_5, _, over_15] = errors.relative.over;
    println!("{over_5} % of the pixels beyond 5 %, {over_15} % beyond 15 %");
    assert!(over_5 <= 3.0, "{over_5} % of the pixels beyond 5 %");
    assert!(over_15 <= 1.0, "{over_15} % of the pixels beyond 15 %");
}
