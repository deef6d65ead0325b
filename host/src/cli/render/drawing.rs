//! The pictures of a judged scene.

use super::Judged;
use crate::cli::failure::Failure;
use crate::compare::{self, Compared, Seen};
use crate::picture::{
    self, CameraView, EmitterShape, Picture, PictureError, Pixel, SampleMark, SamplePlan,
    SurfaceField,
};
use crate::scene::camera::View;
use std::f64::consts::PI;
use std::path::Path;

/// Draws everything; gives the files' names.
pub(super) fn draw(judged: &Judged<'_>, directory: &Path) -> Result<Vec<String>, Failure> {
    let mut album = Album {
        directory,
        files: Vec::new(),
    };
    if let Some((view, seen)) = &judged.camera {
        camera(judged, view, seen, &mut album)?;
    }
    for compared in &judged.surfaces {
        surface(judged, compared, &mut album)?;
    }
    Ok(album.files)
}

/// Pictures on their way to a directory.
struct Album<'a> {
    directory: &'a Path,
    files: Vec<String>,
}

impl Album<'_> {
    fn add(&mut self, name: &str, picture: Result<Picture, PictureError>) -> Result<(), Failure> {
        let file = format!("{name}.png");
        let path = self.directory.join(&file);
        let trouble = |error: PictureError| Failure::usage(error, "");
        picture.map_err(trouble)?.write(&path).map_err(trouble)?;
        self.files.push(file);
        Ok(())
    }
}

fn camera(
    judged: &Judged<'_>,
    view: &View,
    seen: &Seen,
    album: &mut Album<'_>,
) -> Result<(), Failure> {
    let scene = &judged.planned.scene;
    let exact = pixels(judged, view, seen, &seen.reference);
    let structured = pixels(judged, view, seen, &seen.structured);
    let evaluated = seen.evaluated.as_ref();
    let evaluated = evaluated.map(|evaluated| pixels(judged, view, seen, &evaluated.values));
    let baseline = seen.baseline.as_ref();
    let baseline = baseline.map(|values| pixels(judged, view, seen, values));
    // Where the kernel has evaluated every pixel that is its picture.
    let (best, how) = match &evaluated {
        Some(evaluated) => (evaluated, "evaluated at each pixel"),
        None => (&structured, "structured"),
    };
    album.add("picture", picture::camera_picture(best))?;
    let mut panels = vec![("exact reference", &exact)];
    panels.extend(
        evaluated
            .iter()
            .map(|view| ("evaluated at each pixel", view)),
    );
    panels.push(match evaluated {
        Some(_) => ("reconstructed from the samples", &structured),
        None => ("structured sampling", &structured),
    });
    panels.extend(
        baseline
            .iter()
            .map(|view| ("ray-traced form factors", view)),
    );
    album.add(
        "side-by-side",
        picture::side_by_side(&panels, scene.quantity),
    )?;
    let title = format!(
        "{}: {}, {how}",
        scene.name,
        scene.quantity.irradiance_name()
    );
    album.add(
        "false-colour",
        picture::camera_false_colour(best, &title, scene.quantity),
    )?;
    let mut full_scale = vec![0.0; scene.surfaces.len()];
    for compared in &judged.surfaces {
        full_scale[compared.surface] = compared.full_scale;
    }
    let mut error = |name: &str, of: &str, view: &CameraView| {
        let title = format!("{}: error of {of}", scene.name);
        let map = picture::camera_error_map(view, &exact, &full_scale, &title);
        album.add(name, map)
    };
    if let Some(evaluated) = &evaluated {
        error("error-evaluated", "the kernel at each pixel", evaluated)?;
    }
    error("error", "structured sampling", &structured)
}

/// A camera's pixels with one of the answers as their irradiance.
fn pixels(judged: &Judged<'_>, view: &View, seen: &Seen, irradiance: &[[f64; 3]]) -> CameraView {
    let pixel = |(hit, &irradiance): (&Option<_>, &[f64; 3])| {
        let hit: &crate::scene::camera::Hit = hit.as_ref()?;
        let surface = &judged.planned.scene.surfaces[hit.surface];
        let of = |k: usize| surface.radiance[k] + surface.reflectance[k] * irradiance[k] / PI;
        let radiance = if hit.front {
            std::array::from_fn(of)
        } else {
            [0.0; 3]
        };
        Some(Pixel {
            surface: hit.surface,
            luminaire: hit.front && surface.emits() && !surface.reflects(),
            irradiance: compare::mean(irradiance),
            radiance,
        })
    };
    CameraView {
        width: view.width() as usize,
        height: view.height() as usize,
        pixels: seen.hits.iter().zip(irradiance).map(pixel).collect(),
    }
}

fn surface(judged: &Judged<'_>, compared: &Compared, album: &mut Album<'_>) -> Result<(), Failure> {
    let file = file_name(judged, compared.surface);
    let exact = field(judged, compared, &compared.reference);
    let structured = field(judged, compared, &compared.structured);
    album.add(&format!("{file}-exact"), picture::false_colour(&exact))?;
    album.add(
        &format!("{file}-structured"),
        picture::false_colour(&structured),
    )?;
    let samples = sample_plan(judged, compared, exact.clone());
    album.add(&format!("{file}-samples"), picture::samples(&samples))?;
    album.add(
        &format!("{file}-error"),
        picture::error_map(&structured, &exact),
    )
}

/// A surface's name as part of a file's: letters, digits, `-` and `_` stay;
/// the index keeps two names apart that would become the same.
fn file_name(judged: &Judged<'_>, index: usize) -> String {
    let plain = |name: &str| -> String {
        let keep = |c: char| {
            if c.is_alphanumeric() || c == '_' {
                c
            } else {
                '-'
            }
        };
        name.chars().map(keep).collect()
    };
    let name = plain(judged.name(index));
    let surfaces = &judged.planned.scene.surfaces;
    let twins = surfaces
        .iter()
        .filter(|s| plain(&s.name).to_lowercase() == name.to_lowercase());
    if twins.count() > 1 {
        format!("surface-{index}-{name}")
    } else {
        format!("surface-{name}")
    }
}

fn outline(judged: &Judged<'_>, surface: usize) -> Vec<[f64; 2]> {
    let frame = &judged.planned.plan.surfaces[surface].frame;
    frame.vertices.iter().map(|&(u, v)| [u, v]).collect()
}

fn field(judged: &Judged<'_>, compared: &Compared, values: &[f64]) -> SurfaceField {
    let frame = &judged.planned.plan.surfaces[compared.surface].frame;
    SurfaceField {
        name: judged.name(compared.surface).to_owned(),
        quantity: judged.planned.scene.quantity,
        low: [0.0; 2],
        size: [frame.size_u, frame.size_v],
        columns: compared.resolution,
        rows: compared.resolution,
        values: values.to_vec(),
        inside: compared.inside.clone(),
        outline: outline(judged, compared.surface),
    }
}

fn sample_plan(judged: &Judged<'_>, compared: &Compared, beneath: SurfaceField) -> SamplePlan {
    let planned = &judged.planned.plan.surfaces[compared.surface];
    // Emitters in the tables: luminaires first, then bands surface by surface.
    let scene = &judged.planned.scene;
    let luminaires = scene
        .surfaces
        .iter()
        .filter(|surface| surface.emits())
        .count();
    let before = &judged.planned.plan.surfaces[..compared.surface];
    let first = luminaires
        + before
            .iter()
            .map(|surface| surface.bands.len() + surface.patches.len())
            .sum::<usize>();
    let radiosity = |k: usize| {
        let channels = judged.solution.radiosity(first + k);
        compare::mean(channels.map(f64::from))
    };
    let outlines = planned.outlines().into_iter().enumerate();
    let emitters = outlines.map(|(k, loops)| EmitterShape {
        loops,
        radiosity: radiosity(k),
    });
    // In the order of the tags, so that each tag has the same mark on every
    // surface.
    let mut ordered = planned.samples.clone();
    ordered.sort_by_key(|sample| sample.tag);
    let samples = ordered.iter().map(|sample| SampleMark {
        position: sample.place,
        tag: sample.tag.name().to_owned(),
    });
    SamplePlan {
        name: judged.name(compared.surface).to_owned(),
        quantity: scene.quantity,
        low: [0.0; 2],
        size: [planned.frame.size_u, planned.frame.size_v],
        outline: outline(judged, compared.surface),
        samples: samples.collect(),
        emitters: emitters.collect(),
        field: Some(beneath),
    }
}
