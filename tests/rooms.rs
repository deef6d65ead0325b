//! Rooms as the kernel lights them: occluders, many reflections, colour, patches
//! with linear radiosity.

#[path = "reference/fixtures.rs"]
#[allow(dead_code, reason = "the reference's tests use the rest")]
mod fixtures;

#[path = "rooms/layers.rs"]
mod layers;

#[path = "rooms/patches.rs"]
mod patches;

#[path = "rooms/published.rs"]
mod published;

#[path = "rooms/laws.rs"]
mod laws;

use glam::DVec3;
use isolux_host::bake::{self, Tables};
use isolux_host::occlusion::Occlusion;
use isolux_host::pilot;
use isolux_host::plan::{self, Plan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::Scene;
use isolux_host::solve::Sight;

/// A place with its normal.
pub(crate) type Place = (DVec3, DVec3);

/// A scene planned with linear patches by direct light alone.
pub(crate) fn planned(scene: &Scene) -> Plan {
    let direct = direct(scene);
    let field = |places: &[Place]| means(&direct, places);
    plan::patches::linear(scene, &scene.budget, &field).expect("a plan")
}

/// A scene planned as the program does it: by the light of a first solution.
pub(crate) fn followed(scene: &Scene) -> Plan {
    let direct = direct(scene);
    let field = |places: &[Place]| means(&direct, places);
    let occlusion = Occlusion::of(scene).expect("few vertices");
    let looking = (Some(&occlusion), Sight::Exact);
    pilot::linear(scene, &scene.budget, looking, &field).expect("a plan")
}

fn direct(scene: &Scene) -> Reference {
    let direct = Reference::to_within(scene, Reflections::AtMost(0), 1.0, &mut |_| {});
    direct.expect("a reference")
}

fn means(light: &Reference, places: &[Place]) -> Vec<f64> {
    let light = light.light_at(places).into_iter();
    light.map(|[r, g, b]| (r + g + b) / 3.0).collect()
}

/// Its tables, with everything as an occluder.
pub(crate) fn baked(scene: &Scene) -> Tables {
    let occlusion = Occlusion::of(scene).expect("few vertices");
    bake::bake(scene, &planned(scene), Some(occlusion)).expect("tables")
}

/// Places as the kernel takes them.
pub(crate) fn single(places: &[Place]) -> Vec<([f32; 3], [f32; 3])> {
    let single = |v: DVec3| v.as_vec3().to_array();
    places
        .iter()
        .map(|&(p, n)| (single(p), single(n)))
        .collect()
}
