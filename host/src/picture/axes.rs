//! The page of a surface: title, captions, a map with axes in metres, and
//! room for a legend to its right.

use super::canvas::{Anchor, BODY, Canvas, Frame, GREY, INK, Pen, Rgb, SMALL, TITLE, WHITE};
use super::{PictureError, SurfaceField, region, scale, text};

/// Pixels for the heights' labels, and for the legend.
const LEFT: f32 = 92.0;
const LEGEND: f32 = 236.0;
/// The largest a map gets, in pixels.
const MAP: [f64; 2] = [760.0, 760.0];
/// A legend needs this height whatever the map's.
const LEAST_HEIGHT: f32 = 380.0;
/// Below the map: labels and the axis' name.
const BOTTOM: f32 = 70.0;

/// A page whose map is ready to be drawn into.
pub(super) struct Page {
    pub(super) canvas: Canvas,
    /// Where the map is, on the pixels' grid.
    pub(super) map: Frame,
    /// Where the legend is.
    pub(super) legend: Frame,
    low: [f64; 2],
    size: [f64; 2],
}

impl Page {
    /// A page with its title and captions written, for a rectangle in metres.
    pub(super) fn new(
        title: &str,
        captions: &[String],
        low: [f64; 2],
        size: [f64; 2],
    ) -> Result<Self, PictureError> {
        let scale = (MAP[0] / size[0]).min(MAP[1] / size[1]);
        // A strip too thin to be seen is drawn thicker than it is.
        let [width, height] = size.map(|side| (side * scale).round().max(24.0) as f32);
        let top = heading_height(captions.len());
        // Narrow maps still need a page that is wide enough for its captions.
        let body = width.max(420.0);
        let page_width = LEFT + body + 28.0 + LEGEND;
        let page_height = top + height.max(LEAST_HEIGHT) + BOTTOM;
        let mut canvas = Canvas::new(page_width as usize, page_height as usize)?;
        heading(&mut canvas, title, captions);
        let map = Frame::new(LEFT, top, width, height);
        let legend = Frame::new(
            map.right() + 28.0,
            top,
            page_width - map.right() - 28.0 - 12.0,
            height.max(LEAST_HEIGHT),
        );
        Ok(Self {
            canvas,
            map,
            legend,
            low,
            size,
        })
    }

    /// The pixel of a place in metres.
    pub(super) fn pixel(&self, place: [f64; 2]) -> [f32; 2] {
        let share = |axis: usize| ((place[axis] - self.low[axis]) / self.size[axis]) as f32;
        [
            self.map.x + share(0) * self.map.width,
            self.map.bottom() - share(1) * self.map.height,
        ]
    }

    /// The pixels of a loop in metres.
    pub(super) fn pixels(&self, places: &[[f64; 2]]) -> Vec<[f32; 2]> {
        places.iter().map(|place| self.pixel(*place)).collect()
    }

    /// Which cell of the field each cell shows: itself where it is inside, a
    /// neighbour that is where only the polygon's edge keeps it out. So the
    /// field reaches beyond its polygon, to be cut off along it by
    /// [`Page::outline`], while holes of other causes stay as they are.
    pub(super) fn sources(&self, field: &SurfaceField) -> Vec<Option<usize>> {
        let outline = [self.pixels(&field.outline)];
        let (columns, rows) = (field.columns, field.rows);
        let neighbour = |cell: usize| {
            let (column, row) = (cell % columns, cell / columns);
            let near =
                |middle: usize, count: usize| middle.saturating_sub(1)..(middle + 2).min(count);
            near(row, rows)
                .flat_map(|y| near(column, columns).map(move |x| y * columns + x))
                .find(|cell| field.inside[*cell])
        };
        (0..field.inside.len())
            .map(|cell| {
                if field.inside[cell] {
                    Some(cell)
                } else if field.outline.is_empty()
                    || region::inside(&outline, self.pixel(field.middle(cell)))
                {
                    None
                } else {
                    neighbour(cell)
                }
            })
            .collect()
    }

    /// Draws the cells that have a source with `colour(source, column, row)`, the
    /// latter two in pixels of the map.
    pub(super) fn field(
        &mut self,
        field: &SurfaceField,
        sources: &[Option<usize>],
        colour: impl Fn(usize, usize, usize) -> Rgb,
    ) {
        let map = self.map;
        self.canvas.image(map, |column, row| {
            let across = ((column as f32 + 0.5) / map.width * field.columns as f32) as usize;
            let up = ((map.height - row as f32 - 0.5) / map.height * field.rows as f32) as usize;
            let cell = up.min(field.rows - 1) * field.columns + across.min(field.columns - 1);
            sources[cell].map(|source| colour(source, column, row))
        });
    }

    /// Draws the polygon of the surface and clears what lies beyond it; the
    /// whole rectangle is surface where it is empty.
    pub(super) fn outline(&mut self, outline: &[[f64; 2]]) {
        let points = self.pixels(outline);
        if points.len() < 3 {
            return;
        }
        let map = self.map;
        let rectangle = vec![
            [map.x, map.y],
            [map.right(), map.y],
            [map.right(), map.bottom()],
            [map.x, map.bottom()],
        ];
        self.canvas
            .fill_loops(&[rectangle, points.clone()], WHITE, 1.0);
        self.canvas.stroke(&points, true, Pen::new(INK, 1.6, 1.0));
    }

    /// Draws the frame, the ticks and the names of the axes.
    pub(super) fn axes(&mut self) {
        let map = self.map;
        self.canvas.border(map, GREY);
        for axis in 0..2 {
            let span = [map.width, map.height][axis];
            let low = self.low[axis];
            let high = low + self.size[axis];
            // The margin lets ticks stand on the corners themselves.
            let ease = 1e-3 * (high - low);
            let count = (span / 110.0).clamp(1.0, 8.0) as usize;
            // Labels of a narrow map that would touch the last one are left out.
            let mut free_from = f32::NEG_INFINITY;
            for tick in scale::linear_levels(low - ease, high + ease, count) {
                let label = scale::label(tick);
                if axis == 0 {
                    let x = self.pixel([tick, self.low[1]])[0];
                    let mark = Frame::new(x.round() - 0.5, map.bottom() + 1.0, 1.0, 6.0);
                    self.canvas.fill(mark, GREY, 1.0);
                    let half = text::width(&label, SMALL) / 2.0;
                    if x - half > free_from {
                        let at = [x, map.bottom() + 19.0];
                        self.canvas.text(&label, at, SMALL, Anchor::Middle);
                        free_from = x + half + 8.0;
                    }
                } else {
                    let y = self.pixel([self.low[0], tick])[1];
                    let mark = Frame::new(map.x - 7.0, y.round() - 0.5, 6.0, 1.0);
                    self.canvas.fill(mark, GREY, 1.0);
                    self.canvas
                        .text(&label, [map.x - 12.0, y], SMALL, Anchor::Right);
                }
            }
        }
        let below = [map.x + map.width / 2.0, map.bottom() + 46.0];
        self.canvas.text("u (m)", below, BODY, Anchor::Middle);
        self.canvas
            .text_upwards("v (m)", [22.0, map.y + map.height / 2.0], BODY);
    }
}

/// The height that a title and its captions take.
pub(super) fn heading_height(captions: usize) -> f32 {
    58.0 + 25.0 * captions as f32 + 8.0
}

/// Writes title and captions at the top left of the page, smaller where they
/// would not fit.
pub(super) fn heading(canvas: &mut Canvas, title: &str, captions: &[String]) {
    let room = canvas.width() as f32 - 48.0;
    canvas.text(
        title,
        [24.0, 34.0],
        fitted(title, room, TITLE),
        Anchor::Left,
    );
    for (line, caption) in captions.iter().enumerate() {
        let at = [24.0, 66.0 + 25.0 * line as f32];
        canvas.text(caption, at, fitted(caption, room, BODY), Anchor::Left);
    }
}

/// The size up to `size` at which `text` fits into `room`.
pub(super) fn fitted(text: &str, room: f32, size: f32) -> f32 {
    let width = text::width(text, size);
    if width > room {
        size * room / width
    } else {
        size
    }
}
