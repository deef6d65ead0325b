//! The shipped rooms, planned and baked as the program does it by default.

use isolux_host::bake::{self, Tables};
use isolux_host::occlusion::Occlusion;
use isolux_host::plan::{self, Plan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{Scene, file};

/// A scene of shipped text.
pub(crate) fn scene(name: &str, source: &str) -> Scene {
    file::parse(name, source).expect("a shipped scene is sound")
}

/// Patches of linear radiosity within the scene's own budget, smaller where
/// direct light asks for it.
pub(crate) fn plan(scene: &Scene) -> Plan {
    let direct = Reference::new(scene, Reflections::AtMost(0), &mut |_| {});
    let direct = direct.expect("a shipped scene has a reference");
    let mean = |[r, g, b]: [f64; 3]| (r + g + b) / 3.0;
    let field = |places: &[_]| direct.light_at(places).into_iter().map(mean).collect();
    plan::patches::linear(scene, &scene.budget, &field).expect("a shipped scene has a plan")
}

/// Its tables, for receivers on the surfaces and at the named points, with the
/// survey that sizes the workspace.
pub(crate) fn bake(scene: &Scene, plan: &Plan) -> Tables {
    let vertices = scene.surfaces.iter().flat_map(|surface| &surface.vertices);
    let points = scene.points.iter().map(|point| &point.position);
    let reach = vertices.chain(points).copied();
    let occlusion = Occlusion::for_receivers_within(scene, reach);
    let occlusion = occlusion.expect("a shipped scene fits the tables");
    bake::bake(scene, plan, Some(occlusion)).expect("a shipped scene fits the tables")
}
