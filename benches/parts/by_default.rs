//! Scenes planned and baked as the program does it where nothing is asked for.

use glam::DVec3;
use isolux_host::bake::{self, Tables};
use isolux_host::occlusion::Occlusion;
use isolux_host::pilot::{self, Manner};
use isolux_host::plan::{self, Plan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::requires::requirements;
use isolux_host::scene::{Scene, file, shipped};
use isolux_host::solve::Sight;

/// An error that may leave a thread.
pub(crate) type Failed = Box<dyn std::error::Error + Send + Sync>;

/// Surfaces that reflect, above which light goes to and fro so much that a scene is a
/// room.
const OPEN: usize = 2;

/// A shipped scene by its name.
pub(crate) fn shipped_scene(name: &str) -> Scene {
    let file_name = format!("{name}.toml");
    let found = shipped::ALL.iter().find(|(name, _)| *name == file_name);
    let (name, source) = found.expect("a shipped scene");
    file::parse(name, source).expect("a shipped scene is sound")
}

/// How occlusion is found in it.
pub(crate) fn sight(scene: &Scene) -> Sight {
    match requirements(scene).visibility {
        Some(_) => Sight::Exact,
        None => Sight::None,
    }
}

/// The plan by error within the scene's budget: points on tensor grids where they stand
/// for their surfaces, else patches and meshes; for its camera where `for_camera`.
pub(crate) fn planned(scene: &Scene, for_camera: bool) -> Result<Plan, Failed> {
    match by_points(scene)? {
        Some(plan) => Ok(plan),
        None => by_patches(scene, for_camera),
    }
}

/// Points on tensor grids, where they stand for their surfaces.
pub(crate) fn by_points(scene: &Scene) -> Result<Option<Plan>, Failed> {
    let needs = requirements(scene);
    if needs.visibility.is_some() || needs.reflectors.len() > OPEN {
        return Ok(None);
    }
    let once = Reference::new(scene, Reflections::AtMost(1), &mut |_| {})?;
    let field = |places: &[(DVec3, DVec3)]| once.irradiance_at(places);
    let plan = plan::error_driven(scene, &scene.budget, &field, &[]);
    Ok(plan.map_err(|error| error.to_string())?)
}

/// Patches and meshes.
pub(crate) fn by_patches(scene: &Scene, for_camera: bool) -> Result<Plan, Failed> {
    let direct = Reference::new(scene, Reflections::AtMost(0), &mut |_| {})?;
    let mean = |[r, g, b]: [f64; 3]| (r + g + b) / 3.0;
    let field = |places: &[(DVec3, DVec3)]| direct.light_at(places).into_iter().map(mean).collect();
    let occlusion = occlusion(scene);
    let manner = Manner {
        for_camera,
        ..Manner::default()
    };
    let looking = (occlusion.as_ref(), sight(scene));
    let plan = pilot::room(scene, &scene.budget, looking, manner, &field);
    Ok(plan.map_err(|error| error.to_string())?)
}

/// Its tables.
pub(crate) fn baked(scene: &Scene, plan: &Plan) -> Result<Tables, Failed> {
    let tables = bake::bake(scene, plan, occlusion(scene));
    Ok(tables.map_err(|error| error.to_string())?)
}

/// What can hide anything from the surfaces and the named points, where anything can.
pub(crate) fn occlusion(scene: &Scene) -> Option<Occlusion> {
    requirements(scene).visibility.as_ref()?;
    let vertices = scene.surfaces.iter().flat_map(|surface| &surface.vertices);
    let points = scene.points.iter().map(|point| &point.position);
    let reach = vertices.chain(points).copied();
    Some(Occlusion::for_receivers_within(scene, reach).expect("a shipped scene fits the tables"))
}
