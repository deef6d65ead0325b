//! The scenes, and what was changed in them.

use super::by_default::{Failed, planned, shipped_scene};
use isolux_host::plan::Plan;
use isolux_host::scene::Scene;

/// A scene with its plan.
pub(crate) struct Variant {
    /// What it is called.
    pub(crate) what: String,
    pub(crate) scene: Scene,
    pub(crate) plan: Plan,
}

/// Heights of the light of `paper` beside its own, in metres.
const HEIGHTS: [f64; 2] = [1.2, 5.0];

/// The height of the light, and of B beside it, in `paper`.
const OWN_HEIGHT: f64 = 2.2;

/// The reflectance that the floor of `cornell` is changed to.
const DARK_FLOOR: f64 = 0.3;

/// Samples of `penumbra`.
const IN_PENUMBRA: u64 = 50;

/// All of them, in the order of the table.
pub(crate) fn all() -> Result<Vec<Variant>, Failed> {
    let mut all = vec![planned_anew("paper", shipped_scene("paper"))?];
    for height in HEIGHTS {
        let what = format!("paper, the light at {height} m");
        all.push(planned_anew(&what, at_height(height))?);
    }
    all.push(planned_anew("paper-aspect", shipped_scene("paper-aspect"))?);
    let mut penumbra = shipped_scene("penumbra");
    penumbra.budget.samples = Some(IN_PENUMBRA);
    all.push(planned_anew("penumbra", penumbra)?);
    let cornell = shipped_scene("cornell");
    let dark = with_dark_floor(&cornell);
    let office = at_the_density_of(&cornell, shipped_scene("office"));
    let plan = planned(&cornell, false)?;
    all.push(Variant {
        what: "cornell, its floor then 0.3, not planned anew".to_owned(),
        scene: dark.clone(),
        plan: plan.clone(),
    });
    all.push(planned_anew("the same, planned anew", dark)?);
    all.push(Variant {
        what: "cornell, for its camera".to_owned(),
        plan: planned(&cornell, true)?,
        scene: cornell.clone(),
    });
    let first_of_rooms = all.len() - 3;
    all.insert(
        first_of_rooms,
        Variant {
            what: "cornell".to_owned(),
            scene: cornell,
            plan,
        },
    );
    all.push(planned_anew("office, as densely as cornell", office)?);
    Ok(all)
}

fn planned_anew(what: &str, scene: Scene) -> Result<Variant, Failed> {
    Ok(Variant {
        what: what.to_owned(),
        plan: planned(&scene, false)?,
        scene,
    })
}

/// `paper` with the light and B, which is in its plane, at another height over A.
fn at_height(height: f64) -> Scene {
    let mut scene = shipped_scene("paper");
    let vertices = scene.surfaces.iter_mut().flat_map(|s| &mut s.vertices);
    for vertex in vertices.filter(|vertex| vertex.z == OWN_HEIGHT) {
        vertex.z = height;
    }
    scene
}

/// The scene with another reflectance of its floor.
fn with_dark_floor(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let floor = scene.surface_named("floor").expect("a room has a floor");
    scene.surfaces[floor].reflectance = [DARK_FLOOR; 3];
    scene
}

/// A scene with as many samples for a square metre that reflects as another one has.
fn at_the_density_of(other: &Scene, mut scene: Scene) -> Scene {
    let reflecting = |scene: &Scene| -> f64 {
        let surfaces = scene.surfaces.iter().filter(|s| s.reflects());
        surfaces.map(|surface| surface.area).sum()
    };
    let samples = other.budget.samples.expect("it has a budget") as f64;
    let density = samples / reflecting(other);
    scene.budget.samples = Some((density * reflecting(&scene)).round() as u64);
    scene
}
