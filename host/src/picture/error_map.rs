//! Where and by how much an approximation is wrong.

use super::axes::Page;
use super::canvas::{Canvas, Frame, GREY, Rgb, WHITE};
use super::false_colour::{BACKGROUND, has_luminaires, view_page};
use super::scale::{self, SignedErrors};
use super::{CameraView, Picture, PictureError, SurfaceField, colour_bar};
use crate::compare::{self, Errors, Statistics};
use crate::report::percent;

/// Where the reference is too dark for a relative error.
const NOT_COUNTED: Rgb = [150, 150, 150];

/// Draws the signed relative error of a surface, (a - r) / r in percent: purple
/// where the approximation is too dark, orange where it is too bright, on a
/// symmetric scale that 98 % of the cells keep; cells beyond it are hatched.
/// Both metrics stand in the caption.
///
/// # Errors
/// [`PictureError::Inconsistent`] where a field's parts, or the two fields, do not
/// fit each other.
pub fn error_map(
    approximate: &SurfaceField,
    reference: &SurfaceField,
) -> Result<Picture, PictureError> {
    approximate.check()?;
    reference.check()?;
    let same = approximate.columns == reference.columns
        && approximate.rows == reference.rows
        && approximate.inside == reference.inside;
    if !same {
        return Err(PictureError::Inconsistent(format!(
            "the approximation of {} and its reference are not on the same grid",
            reference.name
        )));
    }
    let full_scale = reference
        .lit()
        .filter(|value| value.is_finite())
        .fold(0.0, f64::max);
    let signed: Vec<Option<f64>> = approximate
        .values
        .iter()
        .zip(&reference.values)
        .map(|(a, r)| compare::relative_error(*a, *r, full_scale))
        .collect();
    let errors = compare::errors(approximate.lit().zip(reference.lit()), full_scale);
    let counted = || {
        signed
            .iter()
            .zip(&reference.inside)
            .filter(|(_, inside)| **inside)
            .map(|(error, _)| *error)
    };
    let signed_errors = SignedErrors::fit(counted().flatten());
    let title = format!("{}: relative error against the reference", reference.name);
    let captions = describe(&errors, counted().flatten().next().is_some());
    let mut page = Page::new(&title, &captions, reference.low, reference.size)?;
    let sources = page.sources(reference);
    page.field(reference, &sources, |cell, column, row| {
        colour(signed[cell], &signed_errors, column, row)
    });
    page.outline(&reference.outline);
    page.axes();
    let marks = Marks {
        exceeded: signed_errors.exceeded,
        not_counted: counted().any(|error| error.is_none()),
        luminaires: false,
    };
    legend(&mut page.canvas, page.legend, &signed_errors, marks);
    Ok(Picture {
        canvas: page.canvas,
    })
}

/// Draws the signed relative error of everything a camera sees. `full_scale`
/// holds the largest reference value of each surface of the scene; luminaires
/// are white and not counted.
///
/// # Errors
/// [`PictureError::Inconsistent`] where the views differ in size or in what they
/// show, or a pixel shows a surface that `full_scale` lacks.
pub fn camera_error_map(
    approximate: &CameraView,
    reference: &CameraView,
    full_scale: &[f64],
    title: &str,
) -> Result<Picture, PictureError> {
    let triples = pixel_triples(approximate, reference, full_scale)?;
    let errors = compare::errors_by_scale(triples.iter().flatten().copied());
    let signed = |triple: &Compared| compare::relative_error(triple.0, triple.1, triple.2);
    let signed_errors = SignedErrors::fit(triples.iter().flatten().filter_map(signed));
    let captions = describe(
        &errors,
        triples
            .iter()
            .flatten()
            .any(|triple| signed(triple).is_some()),
    );
    let (mut canvas, placed, room) = view_page(reference, title, &captions)?;
    placed.draw(&mut canvas, BACKGROUND, |pixel, column, row| {
        if pixel.luminaire {
            return WHITE;
        }
        // The same source pixel as `pixel`, found by its place in the view.
        let index = placed.index(column, row);
        let error = triples[index].as_ref().and_then(signed);
        colour(error, &signed_errors, column, row)
    });
    canvas.border(placed.frame, GREY);
    let marks = Marks {
        exceeded: signed_errors.exceeded,
        not_counted: triples
            .iter()
            .flatten()
            .any(|triple| signed(triple).is_none()),
        luminaires: has_luminaires(reference),
    };
    legend(&mut canvas, room, &signed_errors, marks);
    Ok(Picture { canvas })
}

/// Approximation, reference and full scale of a pixel.
type Compared = (f64, f64, f64);

/// What is compared in each pixel; `None` where nothing is.
fn pixel_triples(
    approximate: &CameraView,
    reference: &CameraView,
    full_scale: &[f64],
) -> Result<Vec<Option<Compared>>, PictureError> {
    approximate.check()?;
    reference.check()?;
    if (approximate.width, approximate.height) != (reference.width, reference.height) {
        return Err(PictureError::Inconsistent(format!(
            "the approximation's view is {} x {} pixels, the reference's {} x {}",
            approximate.width, approximate.height, reference.width, reference.height
        )));
    }
    approximate
        .pixels
        .iter()
        .zip(&reference.pixels)
        .map(|(a, r)| match (a, r) {
            (Some(a), Some(r)) if a.surface == r.surface => {
                let Some(scale) = full_scale.get(r.surface) else {
                    return Err(PictureError::Inconsistent(format!(
                        "the view shows surface {} but there are {} full scales",
                        r.surface,
                        full_scale.len()
                    )));
                };
                Ok((!r.luminaire).then_some((a.irradiance, r.irradiance, *scale)))
            }
            (None, None) => Ok(None),
            _ => Err(PictureError::Inconsistent(
                "the approximation's view and the reference's show different surfaces".to_owned(),
            )),
        })
        .collect()
}

/// The captions; of no counted error at all they say so, for its zeros would boast.
fn describe(errors: &Errors, counted: bool) -> Vec<String> {
    let line = |name: &str, statistics: &Statistics| {
        format!(
            "{name} max {} %, rms {} %, 95th percentile {} %",
            percent(statistics.max),
            percent(statistics.rms),
            percent(statistics.p95)
        )
    };
    let relative = if counted {
        line("relative error:     ", &errors.relative)
    } else {
        "relative error: none counted".to_owned()
    };
    vec![relative, line("error of full scale:", &errors.full_scale)]
}

fn colour(error: Option<f64>, scale: &SignedErrors, column: usize, row: usize) -> Rgb {
    match error {
        None => NOT_COUNTED,
        Some(error) if error.abs() > scale.limit && hatched(column, row) => WHITE,
        Some(error) => scale.colour(error),
    }
}

/// Diagonal stripes, three pixels in nine.
fn hatched(column: usize, row: usize) -> bool {
    (column + row) % 9 < 3
}

/// What the map holds beside the scale's colours.
struct Marks {
    exceeded: bool,
    not_counted: bool,
    luminaires: bool,
}

fn legend(canvas: &mut Canvas, room: Frame, scale: &SignedErrors, marks: Marks) {
    let limit = scale::label(scale.limit);
    let beneath = 58.0 * f32::from(u8::from(marks.exceeded))
        + 74.0 * f32::from(u8::from(marks.not_counted))
        + 32.0 * f32::from(u8::from(marks.luminaires));
    let mut bar = room;
    if beneath > 0.0 {
        bar.height -= beneath + 16.0;
    }
    colour_bar::signed_errors(canvas, bar, &["relative error", "% of reference"], scale);
    let mut top = bar.bottom() + 18.0;
    if marks.exceeded {
        for (sign, end) in [("+", scale.limit), ("-", -scale.limit)] {
            let meaning = format!("beyond {sign}{limit} %");
            let fill = |column, row| colour(Some(end * 1.01), scale, column, row);
            top = colour_bar::swatch(canvas, room, top, &meaning, fill);
        }
    }
    if marks.not_counted {
        let meaning = "not counted: reference below 0.1 % of full scale";
        top = colour_bar::swatch(canvas, room, top, meaning, |_, _| NOT_COUNTED);
    }
    if marks.luminaires {
        colour_bar::swatch(canvas, room, top, "luminaire", |_, _| WHITE);
    }
}
