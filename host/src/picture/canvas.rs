//! A white page to draw on: rectangles, lines, polygons, text, images.

use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Rect, Stroke, Transform,
};

use super::{PictureError, text};

/// No side of a picture is longer: 8192 x 8192 pixels take 256 MiB.
pub(super) const MAX_SIDE: usize = 8192;

/// Red, green, blue.
pub(super) type Rgb = [u8; 3];

/// Text and axes.
pub(super) const INK: Rgb = [26, 26, 26];
/// Lines that must not shout.
pub(super) const GREY: Rgb = [120, 120, 120];
pub(super) const WHITE: Rgb = [255, 255, 255];

/// Size of headings in pixels.
pub(super) const TITLE: f32 = 24.0;
/// Size of captions and legends in pixels.
pub(super) const BODY: f32 = 17.0;
/// Size of tick labels in pixels.
pub(super) const SMALL: f32 = 15.0;

/// Where a text's given point lies in it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Left,
    Middle,
    Right,
}

/// A rectangle of pixels: left, top, width, height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) width: f32,
    pub(super) height: f32,
}

impl Frame {
    pub(super) fn new(x: f32, y: f32, width: f32, height: f32) -> Self {
        Self {
            x,
            y,
            width,
            height,
        }
    }

    pub(super) fn right(&self) -> f32 {
        self.x + self.width
    }

    pub(super) fn bottom(&self) -> f32 {
        self.y + self.height
    }

    /// Whether `inner` lies inside with `margin` to spare.
    pub(super) fn holds(&self, inner: &Self, margin: f32) -> bool {
        inner.x >= self.x + margin
            && inner.y >= self.y + margin
            && inner.right() <= self.right() - margin
            && inner.bottom() <= self.bottom() - margin
    }

    /// Whether both come closer than `margin`.
    pub(super) fn meets(&self, other: &Self, margin: f32) -> bool {
        self.x < other.right() + margin
            && other.x < self.right() + margin
            && self.y < other.bottom() + margin
            && other.y < self.bottom() + margin
    }
}

/// The page.
#[derive(Clone)]
pub(super) struct Canvas {
    pixmap: Pixmap,
}

impl Canvas {
    /// A white page.
    pub(super) fn new(width: usize, height: usize) -> Result<Self, PictureError> {
        let refused = PictureError::Size { width, height };
        if width > MAX_SIDE || height > MAX_SIDE {
            return Err(refused);
        }
        let mut pixmap = Pixmap::new(width as u32, height as u32).ok_or(refused)?;
        pixmap.fill(Color::WHITE);
        Ok(Self { pixmap })
    }

    pub(super) fn width(&self) -> usize {
        self.pixmap.width() as usize
    }

    pub(super) fn height(&self) -> usize {
        self.pixmap.height() as usize
    }

    pub(super) fn pixel(&self, x: usize, y: usize) -> Option<Rgb> {
        let pixel = self
            .pixmap
            .pixel(u32::try_from(x).ok()?, u32::try_from(y).ok()?)?;
        Some([pixel.red(), pixel.green(), pixel.blue()])
    }

    pub(super) fn png(&self) -> Result<Vec<u8>, PictureError> {
        self.pixmap
            .encode_png()
            .map_err(|error| PictureError::Encoding(error.to_string()))
    }

    /// Fills `frame`.
    pub(super) fn fill(&mut self, frame: Frame, colour: Rgb, opacity: f32) {
        if let Some(rect) = Rect::from_xywh(frame.x, frame.y, frame.width, frame.height) {
            self.pixmap
                .fill_rect(rect, &paint(colour, opacity), Transform::identity(), None);
        }
    }

    /// Draws the border of `frame`, one pixel wide and on the pixels' grid.
    pub(super) fn border(&mut self, frame: Frame, colour: Rgb) {
        let (right, bottom) = (frame.right(), frame.bottom());
        for side in [
            Frame::new(frame.x - 1.0, frame.y - 1.0, frame.width + 2.0, 1.0),
            Frame::new(frame.x - 1.0, bottom, frame.width + 2.0, 1.0),
            Frame::new(frame.x - 1.0, frame.y, 1.0, frame.height),
            Frame::new(right, frame.y, 1.0, frame.height),
        ] {
            self.fill(side, colour, 1.0);
        }
    }

    /// Draws a line through `points`; nothing of fewer than two.
    pub(super) fn stroke(&mut self, points: &[[f32; 2]], closed: bool, pen: Pen) {
        let mut builder = PathBuilder::new();
        append(&mut builder, points, closed);
        if let Some(path) = builder.finish() {
            let stroke = Stroke {
                width: pen.width,
                line_cap: LineCap::Butt,
                line_join: LineJoin::Round,
                ..Stroke::default()
            };
            self.pixmap.stroke_path(
                &path,
                &paint(pen.colour, pen.opacity),
                &stroke,
                Transform::identity(),
                None,
            );
        }
    }

    /// Fills what lies inside an odd number of `loops`.
    pub(super) fn fill_loops(&mut self, loops: &[Vec<[f32; 2]>], colour: Rgb, opacity: f32) {
        let mut builder = PathBuilder::new();
        for points in loops {
            append(&mut builder, points, true);
        }
        if let Some(path) = builder.finish() {
            self.pixmap.fill_path(
                &path,
                &paint(colour, opacity),
                FillRule::EvenOdd,
                Transform::identity(),
                None,
            );
        }
    }

    /// Sets the pixels of `frame` (its corners on the pixels' grid) to what
    /// `colour` says of the pixel in column and row of the frame; `None` leaves
    /// the page as it is.
    pub(super) fn image(&mut self, frame: Frame, colour: impl Fn(usize, usize) -> Option<Rgb>) {
        let (left, top) = (frame.x as usize, frame.y as usize);
        for row in 0..frame.height as usize {
            for column in 0..frame.width as usize {
                if let Some(colour) = colour(column, row) {
                    self.blend(left + column, top + row, colour, 1.0);
                }
            }
        }
    }

    /// Writes `text` with capitals centred on the height `at[1]`.
    pub(super) fn text(&mut self, text: &str, at: [f32; 2], size: f32, anchor: Anchor) {
        let width = text::width(text, size);
        let left = match anchor {
            Anchor::Left => at[0],
            Anchor::Middle => at[0] - width / 2.0,
            Anchor::Right => at[0] - width,
        };
        let (x0, y0) = (
            left.round() as i32,
            (at[1] + text::cap_height(size) / 2.0).round() as i32,
        );
        text::draw(text, size, |x, y, coverage| {
            self.blend_signed(x0 + x, y0 + y, INK, coverage);
        });
    }

    /// Writes `text` upwards, centred on `at`.
    pub(super) fn text_upwards(&mut self, text: &str, at: [f32; 2], size: f32) {
        let bottom = (at[1] + text::width(text, size) / 2.0).round() as i32;
        let baseline = (at[0] + text::cap_height(size) / 2.0).round() as i32;
        text::draw(text, size, |x, y, coverage| {
            self.blend_signed(baseline + y, bottom - x, INK, coverage);
        });
    }

    fn blend_signed(&mut self, x: i32, y: i32, colour: Rgb, opacity: f32) {
        if let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) {
            self.blend(x, y, colour, opacity);
        }
    }

    fn blend(&mut self, x: usize, y: usize, colour: Rgb, opacity: f32) {
        let (width, height) = (self.width(), self.height());
        if x >= width || y >= height {
            return;
        }
        let start = 4 * (y * width + x);
        let data = &mut self.pixmap.data_mut()[start..start + 3];
        for (old, new) in data.iter_mut().zip(colour) {
            *old = (f32::from(*old) + (f32::from(new) - f32::from(*old)) * opacity).round() as u8;
        }
    }
}

/// How a line is drawn.
#[derive(Clone, Copy)]
pub(super) struct Pen {
    pub(super) colour: Rgb,
    pub(super) width: f32,
    pub(super) opacity: f32,
}

impl Pen {
    pub(super) fn new(colour: Rgb, width: f32, opacity: f32) -> Self {
        Self {
            colour,
            width,
            opacity,
        }
    }
}

fn paint(colour: Rgb, opacity: f32) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(
        colour[0],
        colour[1],
        colour[2],
        (opacity.clamp(0.0, 1.0) * 255.0).round() as u8,
    );
    paint.anti_alias = true;
    paint
}

fn append(builder: &mut PathBuilder, points: &[[f32; 2]], closed: bool) {
    if points.len() < 2 {
        return;
    }
    for (index, point) in points.iter().enumerate() {
        if index == 0 {
            builder.move_to(point[0], point[1]);
        } else {
            builder.line_to(point[0], point[1]);
        }
    }
    if closed {
        builder.close();
    }
}

/// `share` of `top` over the rest of `bottom`.
pub(super) fn mix(top: Rgb, bottom: Rgb, share: f64) -> Rgb {
    std::array::from_fn(|channel| {
        (f64::from(top[channel]) * share + f64::from(bottom[channel]) * (1.0 - share)).round() as u8
    })
}
