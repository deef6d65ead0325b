//! False colour of irradiance with isolux contours.

use super::axes::{self, Page};
use super::canvas::{Canvas, Frame, GREY, Rgb, WHITE};
use super::isolines::{DrawnIsoline, draw_labels, draw_lines, isolines};
use super::scale::Amounts;
use super::view::{Placed, drawn_size};
use super::{CameraView, Picture, PictureError, SurfaceField, colour_bar};
use crate::report::quantity;
use crate::scene::Quantity;

/// Behind the scene.
pub(super) const BACKGROUND: Rgb = [212, 217, 222];

/// Draws the irradiance of a surface in viridis with labelled isolux contours, a
/// colour bar and axes in metres.
///
/// The scale is logarithmic where the field spans more than 1 : 8; levels are
/// round numbers. Values that are not finite are drawn as darkness.
///
/// # Errors
/// [`PictureError::Inconsistent`] where the field's parts do not fit each other.
pub fn false_colour(field: &SurfaceField) -> Result<Picture, PictureError> {
    field.check()?;
    let amounts = Amounts::fit(field.lit());
    let title = format!("{}: {}", field.name, field.quantity.irradiance_name());
    let captions = [describe(field.lit(), &amounts, field.quantity)];
    let mut page = Page::new(&title, &captions, field.low, field.size)?;
    let sources = page.sources(field);
    page.field(field, &sources, |cell, _, _| {
        amounts.colour(field.values[cell])
    });
    let shown: Vec<f64> = sources
        .iter()
        .map(|source| source.map_or(0.0, |cell| field.values[cell]))
        .collect();
    let covered: Vec<bool> = sources.iter().map(Option::is_some).collect();
    let lines = isolines(&shown, &covered, field.columns, field.rows, &amounts.levels)?;
    let place = |at: [f64; 2]| {
        page.pixel([
            field.low[0] + at[0] / field.columns as f64 * field.size[0],
            field.low[1] + at[1] / field.rows as f64 * field.size[1],
        ])
    };
    let lines: Vec<_> = lines.iter().map(|isoline| isoline.drawn(place)).collect();
    draw_lines(&mut page.canvas, &lines);
    page.outline(&field.outline);
    let map = page.map;
    let free = |at: [f32; 2]| {
        let column = ((at[0] - map.x) / map.width * field.columns as f32) as usize;
        let row = ((map.bottom() - at[1]) / map.height * field.rows as f32) as usize;
        column < field.columns && row < field.rows && field.inside[row * field.columns + column]
    };
    draw_labels(&mut page.canvas, &lines, map, free, &mut Vec::new());
    page.axes();
    let heading = [
        field.quantity.irradiance_name(),
        field.quantity.irradiance_unit(),
    ];
    colour_bar::amounts(&mut page.canvas, page.legend, &heading, &amounts);
    Ok(Picture {
        canvas: page.canvas,
    })
}

/// Draws the irradiance of everything a camera sees in one scale, with isolux
/// contours on each surface; luminaires are white.
///
/// # Errors
/// [`PictureError::Inconsistent`] where the view has not as many pixels as it says.
pub fn camera_false_colour(
    view: &CameraView,
    title: &str,
    quantity_shown: Quantity,
) -> Result<Picture, PictureError> {
    view.check()?;
    let lit = || view.lit().map(|pixel| pixel.irradiance);
    let amounts = Amounts::fit(lit());
    let captions = [describe(lit(), &amounts, quantity_shown)];
    let (mut canvas, placed, legend) = view_page(view, title, &captions)?;
    placed.draw(&mut canvas, BACKGROUND, |pixel, _, _| {
        if pixel.luminaire {
            WHITE
        } else {
            amounts.colour(pixel.irradiance)
        }
    });
    let mut surfaces: Vec<usize> = view.lit().map(|pixel| pixel.surface).collect();
    surfaces.sort_unstable();
    surfaces.dedup();
    let mut drawn = Vec::new();
    for surface in surfaces {
        let lines = surface_lines(&placed, surface, &amounts.levels)?;
        draw_lines(&mut canvas, &lines);
        drawn.push((surface, lines));
    }
    let mut taken = Vec::new();
    for (surface, lines) in &drawn {
        let free = |at| {
            placed
                .on_page(at)
                .is_some_and(|pixel| pixel.surface == *surface && !pixel.luminaire)
        };
        draw_labels(&mut canvas, lines, placed.frame, free, &mut taken);
    }
    canvas.border(placed.frame, GREY);
    let heading = [
        quantity_shown.irradiance_name(),
        quantity_shown.irradiance_unit(),
    ];
    let mut bar = legend;
    if has_luminaires(view) {
        bar.height -= 44.0;
        colour_bar::swatch(
            &mut canvas,
            legend,
            bar.bottom() + 14.0,
            "luminaire",
            |_, _| WHITE,
        );
    }
    colour_bar::amounts(&mut canvas, bar, &heading, &amounts);
    Ok(Picture { canvas })
}

/// Whether the view shows a luminaire, which legends then explain.
pub(super) fn has_luminaires(view: &CameraView) -> bool {
    view.pixels.iter().flatten().any(|pixel| pixel.luminaire)
}

/// A page with a view on it: heading written, and room for a legend.
pub(super) fn view_page<'view>(
    view: &'view CameraView,
    title: &str,
    captions: &[String],
) -> Result<(Canvas, Placed<'view>, Frame), PictureError> {
    let (width, height) = drawn_size(view, 1040);
    let top = axes::heading_height(captions.len());
    // A small view still needs a page on which captions and legend fit.
    let (body, tall) = (width.max(420) as f32, (height as f32).max(380.0));
    let legend = Frame::new(24.0 + body + 28.0, top, 224.0, tall);
    let page = (legend.right() as usize + 12, (top + tall) as usize + 28);
    let mut canvas = Canvas::new(page.0, page.1)?;
    axes::heading(&mut canvas, title, captions);
    let frame = Frame::new(24.0, top, width as f32, height as f32);
    Ok((canvas, Placed { view, frame }, legend))
}

/// The isolines of one surface, in pixels of the page.
fn surface_lines(
    placed: &Placed<'_>,
    surface: usize,
    levels: &[f64],
) -> Result<Vec<DrawnIsoline>, PictureError> {
    let view = placed.view;
    let shows = |x: usize, y: usize| {
        view.pixels[y * view.width + x]
            .as_ref()
            .filter(|pixel| pixel.surface == surface && !pixel.luminaire)
    };
    // Only the rectangle that the surface covers.
    let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
    for y in 0..view.height {
        for x in (0..view.width).filter(|x| shows(*x, y).is_some()) {
            low = [low[0].min(x), low[1].min(y)];
            high = [high[0].max(x + 1), high[1].max(y + 1)];
        }
    }
    if low[0] >= high[0] {
        return Ok(Vec::new());
    }
    let (columns, rows) = (high[0] - low[0], high[1] - low[1]);
    let cells: Vec<_> = (0..columns * rows)
        .map(|cell| shows(low[0] + cell % columns, low[1] + cell / columns))
        .collect();
    let values: Vec<f64> = cells
        .iter()
        .map(|pixel| pixel.map_or(0.0, |pixel| pixel.irradiance))
        .collect();
    let inside: Vec<bool> = cells.iter().map(Option::is_some).collect();
    let place = |at: [f64; 2]| placed.pixel([low[0] as f64 + at[0], low[1] as f64 + at[1]]);
    Ok(isolines(&values, &inside, columns, rows, levels)?
        .iter()
        .map(|isoline| isoline.drawn(place))
        .collect())
}

/// The caption: the range, what the lines are, and what the scale does not show.
fn describe(
    values: impl Iterator<Item = f64>,
    amounts: &Amounts,
    quantity_shown: Quantity,
) -> String {
    let unit = quantity_shown.irradiance_unit();
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values.filter(|value| value.is_finite()) {
        low = low.min(value);
        high = high.max(value);
    }
    if low > high {
        return "no values".to_owned();
    }
    let mut caption = format!("{} to {} {unit}", quantity(low), quantity(high));
    if amounts.logarithmic {
        caption.push_str(", logarithmic scale");
    }
    if amounts.cut {
        caption.push_str(&format!(" from {} up", quantity(amounts.low)));
    }
    if !amounts.levels.is_empty() {
        caption.push_str(&format!("; isolux contours in {unit}"));
    }
    caption
}
