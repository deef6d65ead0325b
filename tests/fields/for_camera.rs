//! What is promised of plans for a camera.

use crate::{reference, shipped_scene};
use glam::DVec3;
use isolux::shoot::Stop;
use isolux_host::bake;
use isolux_host::occlusion::Occlusion;
use isolux_host::pilot::{self, Manner};
use isolux_host::plan::Plan;
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::Scene;
use isolux_host::scene::camera::{Hit, View};
use isolux_host::solve::{self, Rung, Sight};

/// Pixels along each side of the picture.
const PIXELS: u32 = 200;

/// What the camera's pixels see of what reflects, and how much light there is.
fn seen(scene: &Scene) -> Vec<(Hit, f64)> {
    let judge = Reference::new(scene, Reflections::UntilUnshot(1e-5), &mut |_| {});
    let view = View::new(scene.camera.as_ref().expect("a camera"), PIXELS, PIXELS);
    let hits = view.hits(scene).into_iter().flatten();
    let hits: Vec<Hit> = hits
        .filter(|hit| hit.front && scene.surfaces[hit.surface].reflects())
        .collect();
    let places: Vec<_> = hits
        .iter()
        .map(|hit| (hit.position, scene.surfaces[hit.surface].normal))
        .collect();
    let truth = judge.expect("a reference").irradiance_at(&places);
    hits.into_iter().zip(truth).collect()
}

/// What a plan errs by at these pixels relative to the value, and what it is predicted to, both
/// the root of the mean square in percent.
fn errors(scene: &Scene, plan: &Plan, seen: &[(Hit, f64)]) -> [f64; 2] {
    let tables = bake::bake(scene, plan, Some(occlusion(scene))).expect("tables");
    let stop = Stop::below(1e-3);
    let light = solve::solve(&tables, Rung::default(), Sight::Exact, stop).expect("light");
    let square = |(hit, truth): &(Hit, f64)| {
        let (u, v) = plan.surfaces[hit.surface].frame.to_local(hit.position);
        let found = light.resampled(hit.surface, [u as f32, v as f32]);
        let found = found.expect("a surface").expect("samples")[0];
        (f64::from(found) / truth - 1.0).powi(2)
    };
    let mean = seen.iter().map(square).sum::<f64>() / seen.len() as f64;
    let areas = scene.surfaces.iter().map(|surface| surface.area);
    let predicted = plan.predicted_error(areas).expect("a prediction");
    [mean.sqrt(), predicted].map(|error| 100.0 * error)
}

fn occlusion(scene: &Scene) -> Occlusion {
    let vertices = scene.surfaces.iter().flat_map(|s| s.vertices.clone());
    Occlusion::for_receivers_within(scene, vertices).expect("occluders")
}

/// For the scene's camera where it is asked for.
pub(crate) fn planned(scene: &Scene, for_camera: bool) -> Plan {
    let direct = reference(scene, 0);
    let field = |places: &[(DVec3, DVec3)]| direct.irradiance_at(places);
    let occlusion = occlusion(scene);
    let looking = (Some(&occlusion), Sight::Exact);
    let manner = Manner {
        for_camera,
        ..Manner::default()
    };
    pilot::room(scene, &scene.budget, looking, manner, &field).expect("a plan")
}

/// With as many samples the picture of the Cornell box errs by seven tenths at the most of
/// what it errs by with a plan for all surfaces alike, and by less than is predicted.
#[test]
fn a_picture_is_the_better_for_a_plan_for_its_camera() {
    let scene = shipped_scene("cornell.toml");
    let pixels = seen(&scene);
    let [alike, of_camera] = [false, true].map(|for_camera| planned(&scene, for_camera));
    let [before, _] = errors(&scene, &alike, &pixels);
    let [rms, predicted] = errors(&scene, &of_camera, &pixels);
    println!("rms {rms} % in place of {before} %, predicted {predicted} %");
    assert!(of_camera.samples() <= alike.samples());
    assert!(rms <= 0.7 * before, "{rms} % in place of {before} %");
    assert!(rms <= predicted, "{rms} %, predicted {predicted} %");
}
