//! The shipped rooms, planned and baked as the program does it by default.

use isolux_host::bake::{self, Tables};
use isolux_host::occlusion::Occlusion;
use isolux_host::pilot;
use isolux_host::plan::Plan;
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{Scene, file};
use isolux_host::solve::Sight;

/// A scene of shipped text.
pub(crate) fn scene(name: &str, source: &str) -> Scene {
    file::parse(name, source).expect("a shipped scene is sound")
}

/// Patches of linear radiosity within the scene's own budget, smaller where the
/// light of a first solution asks for it.
pub(crate) fn plan(scene: &Scene) -> Plan {
    let direct = Reference::new(scene, Reflections::AtMost(0), &mut |_| {});
    let direct = direct.expect("a shipped scene has a reference");
    let mean = |[r, g, b]: [f64; 3]| (r + g + b) / 3.0;
    let field = |places: &[_]| direct.light_at(places).into_iter().map(mean).collect();
    let occlusion = occlusion(scene);
    let looking = (Some(&occlusion), Sight::Exact);
    let plan = pilot::linear(scene, &scene.budget, looking, &field);
    plan.expect("a shipped scene has a plan")
}

/// Its tables, for receivers on the surfaces and at the named points, with the
/// survey that sizes the workspace.
pub(crate) fn bake(scene: &Scene, plan: &Plan) -> Tables {
    bake::bake(scene, plan, Some(occlusion(scene))).expect("a shipped scene fits the tables")
}

/// What can hide anything from the surfaces and the named points.
fn occlusion(scene: &Scene) -> Occlusion {
    let vertices = scene.surfaces.iter().flat_map(|surface| &surface.vertices);
    let points = scene.points.iter().map(|point| &point.position);
    let reach = vertices.chain(points).copied();
    let occlusion = Occlusion::for_receivers_within(scene, reach);
    occlusion.expect("a shipped scene fits the tables")
}
