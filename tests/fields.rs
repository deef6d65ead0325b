//! Surfaces put together from fields: tensor grids, meshes and their products, as
//! laws, against the promises for the shipped scenes, and with changed tables.

#[path = "fields/accuracy.rs"]
mod accuracy;
#[path = "shadow/any_room.rs"]
mod any_room;
#[path = "fields/changed.rs"]
mod changed;
#[path = "fields/for_camera.rs"]
mod for_camera;
#[path = "fields/generated.rs"]
mod generated;
#[path = "visibility/lit.rs"]
#[allow(dead_code, reason = "the tests of visibility use the rest")]
mod lit;
#[path = "fields/meshes.rs"]
mod meshes;
#[path = "visibility/random.rs"]
#[allow(dead_code, reason = "the tests of visibility use the rest")]
mod random;

#[path = "fields/tags.rs"]
mod tags;

#[path = "fields/repainted.rs"]
mod repainted;

use glam::DVec3;
use isolux_host::bake::{self, Tables};
use isolux_host::occlusion::Occlusion;
use isolux_host::pilot;
use isolux_host::plan::{self, Plan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{Scene, Surface, file, shipped};
use isolux_host::solve::Sight;

/// A shipped scene.
fn shipped_scene(name: &str) -> Scene {
    let source = shipped::ALL.iter().find(|(file, _)| *file == name);
    let (name, source) = source.expect("a shipped scene");
    file::parse(name, source).unwrap_or_else(|error| panic!("{error}"))
}

fn reference(scene: &Scene, reflections: usize) -> Reference {
    Reference::new(scene, Reflections::AtMost(reflections), &mut |_| {}).expect("a reference")
}

/// An open scene with tensor grids, whose nodes shoot.
fn open(scene: &Scene) -> (Plan, Tables) {
    let once = reference(scene, 1);
    let field = |places: &[(DVec3, DVec3)]| once.irradiance_at(places);
    let plan = plan::error_driven(scene, &scene.budget, &field, &[]).expect("a plan");
    let plan = plan.expect("points stand for their surfaces");
    let tables = bake::bake(scene, &plan, None).expect("tables");
    (plan, tables)
}

/// A room with shadows.
fn room(scene: &Scene) -> (Plan, Tables) {
    let vertices = scene.surfaces.iter().flat_map(|s| s.vertices.clone());
    let occlusion = Occlusion::for_receivers_within(scene, vertices).expect("occluders");
    let direct = reference(scene, 0);
    let field = |places: &[(DVec3, DVec3)]| direct.irradiance_at(places);
    let looking = (Some(&occlusion), Sight::Exact);
    let plan = pilot::room(
        scene,
        &scene.budget,
        looking,
        pilot::Manner::default(),
        &field,
    )
    .expect("a plan");
    let tables = bake::bake(scene, &plan, Some(occlusion)).expect("tables");
    (plan, tables)
}

/// A polygon through these corners.
fn polygon(name: &str, corners: &[[f64; 3]], radiance: f64) -> Surface {
    let corners = corners.iter().map(|&corner| DVec3::from(corner)).collect();
    Surface {
        name: name.to_owned(),
        ..lit::surface(corners, radiance)
    }
}
