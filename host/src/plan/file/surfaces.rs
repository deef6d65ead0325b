//! The surfaces of a plan file: that they are the scene's, and what each holds.

use super::super::{MOST_SAMPLES, Part, Predicted, PredictedAt, SurfacePlan, Tag};
use super::samples::Samples;
use super::{ANEW, SAME, emitters, fields};
use crate::scene::diagnostic::{Diagnostic, nearest_name};
use crate::scene::document::{Field, Table, listed};
use crate::scene::frame::Frame;
use crate::scene::{Scene, Surface};
use emitters::Kind;
use glam::DVec3;

const KEYS: [&str; 15] = [
    "name",
    "emits",
    "origin",
    "u",
    "v",
    "size",
    "area",
    "filter-radius",
    "predicted",
    "predicted-by-tag",
    "samples",
    "points",
    "band",
    "patch",
    "field",
];

/// Every surface of the scene, in its order.
pub(super) fn read(root: &Table<'_>, scene: &Scene) -> Result<Vec<SurfacePlan>, Diagnostic> {
    let mut found: Vec<Option<SurfacePlan>> = vec![None; scene.surfaces.len()];
    let mut samples = 0;
    let mut kind = None;
    let tables = root.required("surface", "[[surface]]")?;
    for table in tables.tables("a surface")? {
        let table = table.only(&KEYS)?;
        let name = table.required("name", "name = \"A\"")?;
        let index = named(&name, scene)?;
        if found[index].is_some() {
            return Err(name.error(
                format!("surface `{}` is planned twice", scene.surfaces[index].name),
                "remove one of the two",
            ));
        }
        let planned = surface(&table, &scene.surfaces[index], &mut kind)?;
        samples += planned.samples.len();
        if samples as u64 > MOST_SAMPLES {
            return Err(name.error(
                format!("the plan has more than {MOST_SAMPLES} samples, which are the most"),
                "plan the scene with fewer: `isolux plan --samples N`",
            ));
        }
        found[index] = Some(planned);
    }
    let surfaces = scene.surfaces.iter().zip(found);
    let there = |(surface, found): (&Surface, Option<SurfacePlan>)| {
        found.ok_or_else(|| {
            root.error(
                format!(
                    "the plan knows nothing of the scene's surface `{}`",
                    surface.name
                ),
                ANEW,
            )
        })
    };
    surfaces.map(there).collect()
}

/// The scene's surface of that name.
fn named(name: &Field<'_>, scene: &Scene) -> Result<usize, Diagnostic> {
    let text = name.name()?;
    scene.surface_named(&text).ok_or_else(|| {
        let names = scene.surfaces.iter().map(|surface| surface.name.as_str());
        let guess = nearest_name(&text, names).map_or(String::new(), |near| {
            format!("did you mean `{near}`? else ")
        });
        name.error(
            format!("the scene has no surface `{text}`"),
            format!("{guess}name the scene that the plan was made for, or {ANEW}"),
        )
    })
}

fn surface(
    table: &Table<'_>,
    surface: &Surface,
    kind: &mut Option<Kind>,
) -> Result<SurfacePlan, Diagnostic> {
    let frame = Frame::new(surface);
    same_geometry(table, surface, &frame)?;
    let emits = table.required("emits", "emits = false")?;
    let emitted = emits.truth("`emits = false`")?;
    if surface.emits() && !emitted {
        return Err(emits.error(
            format!("surface `{}` emits now, and did not when this was planned: its shadows are not known", surface.name),
            ANEW,
        ));
    }
    let samples = Samples::read(table, &frame)?;
    if surface.reflects() && samples.all.is_empty() {
        return Err(table.error(
            format!(
                "surface `{}` reflects now, and did not when this was planned: it has no samples",
                surface.name
            ),
            ANEW,
        ));
    }
    let fields = fields::read(table, &samples, &frame)?;
    let emitters = emitters::read(table, &samples, surface.area, &frame, kind)?;
    let filter_radius = match table.optional("filter-radius") {
        Some(radius) => within(&radius, 0.0..=1e8, "`filter-radius = 1.5`")?,
        None => 0.0,
    };
    if !samples.all.is_empty() && fields.is_empty() && filter_radius <= 0.0 {
        return Err(table.error(
            "nothing reconstructs the light of this surface: it has samples, but no `filter-radius` and no `[[surface.field]]`",
            "give it one of them",
        ));
    }
    Ok(SurfacePlan {
        samples: samples.all,
        bands: emitters.bands,
        patches: emitters.patches,
        points: emitters.points,
        fields,
        filter_radius,
        predicted: predicted(table)?,
        predicted_by_tag: predicted_by_tag(table)?,
        ..SurfacePlan::without_samples(frame)
    })
}

/// Refuses a surface that lies elsewhere, or is larger or smaller, than when it was
/// planned.
fn same_geometry(table: &Table<'_>, surface: &Surface, frame: &Frame) -> Result<(), Diagnostic> {
    let other = |field: &Field<'_>, what: &str| {
        field.error(
            format!(
                "the {what} of surface `{}` is another one in the scene",
                surface.name
            ),
            format!("name the scene that the plan was made for, or {ANEW}"),
        )
    };
    let length = frame.size_u.max(frame.size_v);
    let size = table.required("size", "size = [5.0, 5.0]")?;
    let [size_u, size_v] = pair(&size, "two lengths [u, v]", "`size = [5.0, 5.0]`")?;
    let same = |a: f64, b: f64| (a - b).abs() <= SAME * length;
    if !(same(size_u, frame.size_u) && same(size_v, frame.size_v)) {
        return Err(other(&size, "size"));
    }
    let area = table.required("area", "area = 25.0")?;
    if (area.number("`area = 25.0`")? - surface.area).abs() > SAME * surface.area {
        return Err(other(&area, "area"));
    }
    // Coordinates are no better than their own size.
    let reach = length + frame.origin.abs().max_element();
    let vectors: [(&'static str, &str, DVec3, f64); 3] = [
        ("origin", "place", frame.origin, reach),
        ("u", "direction", frame.u, 1.0),
        ("v", "direction", frame.v, 1.0),
    ];
    for (key, what, scenes, unit) in vectors {
        let field = table.required(key, "origin = [0.0, 0.0, 0.0]")?;
        let vector = field.vector("`[1.0, 0.0, 0.0]`")?;
        if (vector - scenes).abs().max_element() > SAME * unit {
            return Err(other(&field, what));
        }
    }
    Ok(())
}

fn predicted(table: &Table<'_>) -> Result<Vec<Predicted>, Diagnostic> {
    let part = |name: &Field<'_>, text: &str| {
        Part::named(text).ok_or_else(|| {
            name.error(
                "no part of the light is called that",
                format!("the parts are {}", listed(&Part::ALL.map(Part::name))),
            )
        })
    };
    let found = predictions(table, "predicted", "`[\"all\", 0.01, 25.0]`", &part)?;
    let predicted = |(part, rms, area)| Predicted { part, rms, area };
    Ok(found.into_iter().map(predicted).collect())
}

fn predicted_by_tag(table: &Table<'_>) -> Result<Vec<PredictedAt>, Diagnostic> {
    let tag = |name: &Field<'_>, text: &str| {
        let tag = Tag::named(text).filter(|tag| Tag::OF_PLACES.contains(tag));
        tag.ok_or_else(|| {
            name.error(
                "no place has this tag",
                format!("places are {}", listed(&Tag::OF_PLACES.map(Tag::name))),
            )
        })
    };
    let found = predictions(table, "predicted-by-tag", "`[\"lit\", 0.01, 25.0]`", &tag)?;
    let predicted = |(tag, rms, area)| PredictedAt { tag, rms, area };
    Ok(found.into_iter().map(predicted).collect())
}

/// What a text names.
type Named<'a, T> = dyn Fn(&Field<'_>, &str) -> Result<T, Diagnostic> + 'a;

/// A list of [name, error, area]; none where the key is missing.
fn predictions<T>(
    table: &Table<'_>,
    key: &'static str,
    example: &str,
    named: &Named<'_, T>,
) -> Result<Vec<(T, f64, f64)>, Diagnostic> {
    let one = |element: &Field<'_>| {
        let parts = element.elements("[name, error, area]", example)?;
        let [name, rms, area] = parts.as_slice() else {
            return Err(element.error(
                "a prediction is [name, error, area]",
                format!("write it like {example}"),
            ));
        };
        Ok((
            named(name, name.string(example)?)?,
            within(rms, 0.0..=1e6, example)?,
            within(area, 0.0..=1e17, example)?,
        ))
    };
    match table.optional(key) {
        Some(field) => field
            .elements("a list of predictions", example)?
            .iter()
            .map(one)
            .collect(),
        None => Ok(Vec::new()),
    }
}

/// A number in a range.
pub(super) fn within(
    field: &Field<'_>,
    range: std::ops::RangeInclusive<f64>,
    example: &str,
) -> Result<f64, Diagnostic> {
    let number = field.signed_number(example)?;
    match range.contains(&number) {
        true => Ok(number),
        false => Err(field.error(
            format!(
                "this must be between {:?} and {:?}",
                range.start(),
                range.end()
            ),
            format!("write it like {example}"),
        )),
    }
}

/// Two finite numbers.
pub(super) fn pair(field: &Field<'_>, wanted: &str, example: &str) -> Result<[f64; 2], Diagnostic> {
    let elements = field.elements(wanted, example)?;
    match elements.as_slice() {
        [a, b] => Ok([a.signed_number(example)?, b.signed_number(example)?]),
        _ => Err(field.error(
            format!("this must be {wanted}, not {} of them", elements.len()),
            format!("write it like {example}"),
        )),
    }
}

/// A place on a surface: within its bounding rectangle, as far as rounding goes.
pub(super) fn place(u: &Field<'_>, v: &Field<'_>, frame: &Frame) -> Result<[f64; 2], Diagnostic> {
    let slack = 1e-6 * frame.size_u.max(frame.size_v);
    let along = |field: &Field<'_>, name: &str, size: f64| {
        let x = field.signed_number("`0.25`")?;
        match (-slack..=size + slack).contains(&x) {
            true => Ok(x),
            false => Err(field.error(
                format!("this place is not on the surface: its {name} runs from 0 to {size:?} m"),
                "move it back onto the surface",
            )),
        }
    };
    Ok([along(u, "u", frame.size_u)?, along(v, "v", frame.size_v)?])
}

/// A count, or an index that must be below `end`.
pub(super) fn index(field: &Field<'_>, end: usize, of: &str) -> Result<usize, Diagnostic> {
    let remedy = match end {
        0 => format!("there are no {of}"),
        _ => format!("write a whole number from 0 to {}", end - 1),
    };
    let number = field
        .as_integer()
        .and_then(|integer| usize::try_from(integer).ok());
    match number {
        Some(number) if number < end => Ok(number),
        Some(number) => Err(field.error(
            format!("{number} is beyond the {of}, of which there are {end}"),
            remedy,
        )),
        None => Err(field.error(format!("this must be an index into the {of}"), remedy)),
    }
}

/// The elements of a list of indices.
pub(super) fn indices(field: &Field<'_>, end: usize, of: &str) -> Result<Vec<usize>, Diagnostic> {
    let elements = field.elements("a list of whole numbers", "`[0, 1, 2]`")?;
    elements
        .iter()
        .map(|element| index(element, end, of))
        .collect()
}
