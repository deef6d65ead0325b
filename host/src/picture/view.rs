//! A camera's view at the size of a picture.

use super::canvas::{Canvas, Frame, INK, Rgb};
use super::{CameraView, Pixel};

/// The size at which a view is drawn into `room` pixels of width: enlarged by
/// a whole number, so that its pixels stay even, or reduced to fit.
pub(super) fn drawn_size(view: &CameraView, room: usize) -> (usize, usize) {
    if view.width <= room {
        let factor = (room / view.width.max(1)).max(1);
        (view.width * factor, view.height * factor)
    } else {
        let height = (view.height as f64 * room as f64 / view.width as f64).round();
        (room, (height as usize).max(1))
    }
}

/// A view in its place on the page.
pub(super) struct Placed<'view> {
    pub(super) view: &'view CameraView,
    pub(super) frame: Frame,
}

impl Placed<'_> {
    /// Which of the view's pixels the frame's pixel shows.
    pub(super) fn index(&self, column: usize, row: usize) -> usize {
        let x = (column as f64 + 0.5) / f64::from(self.frame.width) * self.view.width as f64;
        let y = (row as f64 + 0.5) / f64::from(self.frame.height) * self.view.height as f64;
        let x = (x as usize).min(self.view.width - 1);
        let y = (y as usize).min(self.view.height - 1);
        y * self.view.width + x
    }

    /// What the frame's pixel shows.
    pub(super) fn at(&self, column: usize, row: usize) -> Option<&Pixel> {
        self.view.pixels[self.index(column, row)].as_ref()
    }

    /// The page's pixel of a place in the view's pixels.
    pub(super) fn pixel(&self, place: [f64; 2]) -> [f32; 2] {
        [
            self.frame.x + place[0] as f32 / self.view.width as f32 * self.frame.width,
            self.frame.y + place[1] as f32 / self.view.height as f32 * self.frame.height,
        ]
    }

    /// What the page's pixel shows.
    pub(super) fn on_page(&self, at: [f32; 2]) -> Option<&Pixel> {
        let column = at[0] - self.frame.x;
        let row = at[1] - self.frame.y;
        let inside =
            column >= 0.0 && row >= 0.0 && column < self.frame.width && row < self.frame.height;
        inside
            .then(|| self.at(column as usize, row as usize))
            .flatten()
    }

    /// Draws every pixel with `colour(pixel, column, row)`, the background with
    /// `background`, and a line where one surface meets another.
    pub(super) fn draw(
        &self,
        canvas: &mut Canvas,
        background: Rgb,
        colour: impl Fn(&Pixel, usize, usize) -> Rgb,
    ) {
        let surface = |column, row| self.at(column, row).map(|pixel| pixel.surface);
        canvas.image(self.frame, |column, row| {
            let here = surface(column, row);
            let edge = (column > 0 && surface(column - 1, row) != here)
                || (row > 0 && surface(column, row - 1) != here);
            if edge {
                return Some(INK);
            }
            Some(
                self.at(column, row)
                    .map_or(background, |pixel| colour(pixel, column, row)),
            )
        });
    }
}
