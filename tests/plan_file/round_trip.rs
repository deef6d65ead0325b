//! A plan that was written and read bakes to the same bytes.

use crate::{answered, directory, planned, write};
use glam::DVec3;
use isolux_host::bake::bake;
use isolux_host::occlusion::Occlusion;
use isolux_host::pilot;
use isolux_host::plan::file::{parse, text};
use isolux_host::plan::{self, Plan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{Rungs, Scene, file};
use isolux_host::solve::Sight;

fn parsed(name: &str) -> Scene {
    file::parse(name, &crate::scene(name)).unwrap_or_else(|error| panic!("{error}"))
}

fn light(scene: &Scene, reflections: usize) -> Reference {
    Reference::new(scene, Reflections::AtMost(reflections), &mut |_| {}).expect("a reference")
}

fn same_bytes(scene: &Scene, plan: &Plan, occlusion: Option<&Occlusion>, what: &str) {
    let rungs = Rungs {
        arithmetic: Some("poly5".to_owned()),
        ..Rungs::default()
    };
    let written = text(scene, &rungs, plan);
    let read = parse("a.plan", &written, scene).unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!(read.rungs, rungs, "{what}");
    let [before, after] = [plan, &read.plan].map(|plan| {
        let tables = bake(scene, plan, occlusion.cloned()).expect("tables");
        tables.bytes().to_vec()
    });
    assert!(before == after, "{what}: other tables");
    assert_eq!(text(scene, &rungs, &read.plan), written, "{what}");
    let samples = |plan: &Plan| (plan.samples(), plan.free_samples());
    assert_eq!(samples(plan), samples(&read.plan), "{what}");
    let [before, after] = [plan, &read.plan].map(Plan::predicted_by_tag);
    assert_eq!(before.len(), after.len(), "{what}");
    for (before, after) in before.iter().zip(&after) {
        assert_eq!(before.tag, after.tag, "{what}");
        assert!(
            (before.rms - after.rms).abs() <= 1e-6 * before.rms,
            "{what}"
        );
    }
    let areas = || scene.surfaces.iter().map(|surface| surface.area);
    let [before, after] = [plan, &read.plan].map(|plan| plan.predicted_error(areas()));
    match (before, after) {
        (Some(before), Some(after)) => assert!((before - after).abs() <= 1e-6 * before, "{what}"),
        (before, after) => assert_eq!(before, after, "{what}"),
    }
}

#[test]
fn bands_layers_points_and_tensor_grids() {
    let scene = parsed("paper");
    let once = light(&scene, 1);
    let field = |places: &[(DVec3, DVec3)]| once.irradiance_at(places);
    let bands = plan::isolux(&scene, &scene.budget, &field).expect("a plan");
    let layers = plan::layer_cake(&scene, &scene.budget, &field).expect("a plan");
    let points = plan::error_driven(&scene, &scene.budget, &field, &[]).expect("a plan");
    let points = points.expect("points stand for the surfaces");
    let areas = || scene.surfaces.iter().map(|surface| surface.area);
    assert_eq!(
        bands.predicted_error(areas()),
        None,
        "the paper's way predicts nothing"
    );
    for (plan, what) in [(bands, "bands"), (layers, "layers"), (points, "points")] {
        same_bytes(&scene, &plan, None, what);
    }
}

#[test]
fn patches_and_meshes_past_occluders() {
    let scene = parsed("penumbra");
    let occlusion = Occlusion::of(&scene).expect("few vertices");
    let looking = (Some(&occlusion), Sight::Exact);
    let direct = light(&scene, 0);
    let field = |places: &[(DVec3, DVec3)]| direct.irradiance_at(places);
    let room = pilot::room(
        &scene,
        &scene.budget,
        looking,
        pilot::Manner::default(),
        &field,
    )
    .expect("a plan");
    assert!(room.free_samples() > 0 && room.is_linear());
    same_bytes(&scene, &room, Some(&occlusion), "meshes");
    let linear = pilot::linear(&scene, &scene.budget, looking, &field).expect("a plan");
    same_bytes(&scene, &linear, Some(&occlusion), "patches");
}

#[test]
fn the_same_scene_gives_the_same_file_and_leaves_nothing_else() {
    let directory = directory();
    let first = planned("penumbra", directory.path(), "a.plan");
    let second = planned("penumbra", directory.path(), "a.plan");
    assert!(first == second, "two plans of one scene differ");
    let left = std::fs::read_dir(directory.path())
        .expect("a directory")
        .count();
    assert_eq!(left, 1, "a temporary file is left");
}

#[test]
fn a_plan_answers_as_planning_does() {
    let directory = directory();
    write(
        directory.path(),
        "a.pts",
        "0.3 1.2 0 0 0 1\n-1 -2 0 0 0 1\n5 0.5 2.2 0 0 -1\n",
    );
    planned("paper", directory.path(), "a.plan");
    for how in [&[][..], &["--reconstructed"]] {
        let mut solve = vec!["solve", "paper", "--points", "a.pts"];
        solve.extend(how);
        let without = answered(&solve, directory.path());
        solve.extend(["--plan", "a.plan"]);
        assert_eq!(answered(&solve, directory.path()), without, "{how:?}");
    }
}

#[test]
fn a_flag_goes_before_the_plan_and_the_plan_before_the_scene() {
    let directory = directory();
    let path = directory.path();
    write(path, "a.pts", "0.3 1.2 0 0 0 1\n5 0.5 2.2 0 0 -1\n");
    let scene = crate::scene("paper") + "[rungs]\narithmetic = \"poly8\"\n";
    write(path, "scene.toml", &scene);
    let solve = |more: &[&str]| {
        let mut arguments = vec!["solve", "scene.toml", "--points", "a.pts"];
        arguments.extend(more);
        answered(&arguments, path)
    };
    answered(
        &[
            "plan",
            "scene.toml",
            "--arithmetic",
            "poly3",
            "-o",
            "a.plan",
        ],
        path,
    );
    let [poly3, poly8] = ["poly3", "poly8"].map(|rung| solve(&["--arithmetic", rung]));
    assert_ne!(poly3, poly8, "rungs that show");
    assert_eq!(solve(&[]), poly8, "the scene's own");
    assert_eq!(solve(&["--plan", "a.plan"]), poly3);
    assert_eq!(solve(&["--plan", "a.plan", "--arithmetic", "poly8"]), poly8);
}
