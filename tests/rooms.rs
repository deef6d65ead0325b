//! Rooms as the kernel lights them: occluders, many reflections, colour, patches
//! with linear radiosity.

#[path = "reference/fixtures.rs"]
#[allow(dead_code, reason = "the reference's tests use the rest")]
mod fixtures;

#[path = "rooms/patches.rs"]
mod patches;

#[path = "rooms/published.rs"]
mod published;

#[path = "rooms/laws.rs"]
mod laws;

use glam::DVec3;
use isolux_host::bake::{self, Tables};
use isolux_host::occlusion::Occlusion;
use isolux_host::plan::{self, Plan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::Scene;

/// A place with its normal.
pub(crate) type Place = (DVec3, DVec3);

/// A scene planned with linear patches.
pub(crate) fn planned(scene: &Scene) -> Plan {
    let direct = Reference::to_within(scene, Reflections::AtMost(0), 1.0, &mut |_| {});
    let direct = direct.expect("a reference");
    let field = |places: &[Place]| -> Vec<f64> {
        let light = direct.light_at(places).into_iter();
        light.map(|[r, g, b]| (r + g + b) / 3.0).collect()
    };
    plan::patches::linear(scene, &scene.budget, &field).expect("a plan")
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
