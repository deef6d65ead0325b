//! The shipped scenes of the paper, planned and baked as the program does it.

use isolux_host::bake::{self, Tables};
use isolux_host::plan::{self, Plan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{Scene, file, shipped};

/// A scene with its plan and its tables.
pub(crate) struct Planned {
    /// The scene.
    pub(crate) scene: Scene,
    /// Where its samples are.
    pub(crate) plan: Plan,
    /// What the device reads.
    pub(crate) tables: Tables,
}

/// Both of the paper's light shapes.
pub(crate) fn scenes() -> Vec<Planned> {
    let paper = shipped::ALL
        .iter()
        .filter(|(name, _)| name.starts_with("paper"));
    paper.map(|(name, source)| planned(name, source)).collect()
}

fn planned(name: &str, source: &str) -> Planned {
    let scene = file::parse(name, source).expect("a shipped scene is sound");
    let once = reference(&scene);
    let field = |places: &[_]| once.irradiance_at(places);
    let plan = plan::isolux(&scene, &scene.budget, &field).expect("a shipped scene has a plan");
    let tables = bake::bake(&scene, &plan, None).expect("a shipped scene fits the tables");
    Planned {
        scene,
        plan,
        tables,
    }
}

/// Exact light, reflected at most once: what the samples follow.
pub(crate) fn reference(scene: &Scene) -> Reference {
    Reference::new(scene, Reflections::AtMost(1), &mut |_| {})
        .expect("a shipped scene has a reference")
}
