//! What reconstructions err by, on surfaces and in the camera's picture.

use super::by_default::{Failed, baked, sight};
use super::variants::Variant;
use isolux::shoot::Stop;
use isolux_host::compare::{self, Answers, Compared, Errors, errors_by_scale};
use isolux_host::occlusion::Solids;
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::camera::View;
use isolux_host::scene::requires::requirements;
use isolux_host::solve::{self, Rung};

/// Cells along each side of a surface's grid, in open scenes and in rooms.
const OPEN: usize = 200;
const IN_ROOMS: usize = 60;

/// Surfaces that reflect, above which errors are of all together.
const FEW: usize = 2;

/// Pixels along each side of the camera's picture.
const PIXELS: u32 = 200;

/// The part of the emitted power below which light is left unshot, by the kernel and by
/// the reference.
const UNSHOT: f32 = 1e-3;
const CONVERGED: f64 = 1e-5;

/// Errors over some places.
pub(crate) struct Row {
    pub(crate) scene: String,
    /// Which places.
    pub(crate) places: String,
    pub(crate) samples: usize,
    pub(crate) table_bytes: usize,
    pub(crate) errors: Errors,
}

/// One row a surface where there are few, else one of all; and one of the camera.
pub(crate) fn rows(variant: &Variant) -> Result<Vec<Row>, Failed> {
    let Variant { what, scene, plan } = variant;
    let tables = baked(scene, plan)?;
    let stop = Stop::below(UNSHOT);
    let solution = solve::solve(&tables, Rung::default(), sight(scene), stop);
    let solution = solution.map_err(|error| error.to_string())?;
    let judge = Reference::new(scene, Reflections::UntilUnshot(CONVERGED), &mut |_| {})?;
    let answers = Answers {
        scene,
        plan,
        reference: &judge,
        solution: &solution,
        baseline: None,
    };
    let reflecting: Vec<usize> = (0..scene.surfaces.len())
        .filter(|&index| scene.surfaces[index].reflects())
        .collect();
    let few = reflecting.len() <= FEW;
    let side = if requirements(scene).visibility.is_some() && !few {
        IN_ROOMS
    } else {
        OPEN
    };
    let solids = Solids::of(scene);
    let mut full_scale = vec![0.0; scene.surfaces.len()];
    let mut compared = Vec::new();
    for index in reflecting {
        let surface = compare::surface(&answers, &solids, index, side, &mut |_| {});
        let surface = surface.map_err(|error| error.to_string())?;
        full_scale[index] = surface.full_scale;
        compared.push(surface);
    }
    let row = |places: String, samples: usize, errors: Errors| Row {
        scene: what.clone(),
        places,
        samples,
        table_bytes: tables.bytes().len(),
        errors,
    };
    let mut rows = Vec::new();
    if few {
        rows.extend(compared.iter().map(|of| {
            let samples = plan.surfaces[of.surface].samples.len();
            row(scene.surfaces[of.surface].name.clone(), samples, of.errors)
        }));
    } else {
        rows.push(row(
            "all surfaces".to_owned(),
            plan.samples(),
            together(&compared),
        ));
    }
    if let Some(camera) = &scene.camera {
        let view = View::new(camera, PIXELS, PIXELS);
        let seen = compare::camera(&answers, &view, &full_scale, &mut |_| {});
        let seen = seen.map_err(|error| error.to_string())?;
        rows.push(row("camera".to_owned(), plan.samples(), seen.errors));
    }
    Ok(rows)
}

/// The errors of all surfaces' cells.
fn together(compared: &[Compared]) -> Errors {
    errors_by_scale(compared.iter().flat_map(|of| {
        let cells = (0..of.inside.len()).filter(|&k| of.inside[k]);
        cells.map(|k| (of.structured[k], of.reference[k], of.full_scale))
    }))
}
