//! What people look at: the camera's picture, false colour with isolux
//! contours, the samples and emitters of a plan, and error maps.
//!
//! Everything here takes plain numbers and returns a [`Picture`]; nothing knows
//! how they were computed. The maps are readable by colour-blind people: viridis
//! for amounts and purple-orange for signed errors (both through `colorous`),
//! marks that differ in shape as well as in colour. The fonts are embedded, so
//! the same numbers give the same bytes on every machine.

mod axes;
mod canvas;
mod colour_bar;
mod error_map;
mod false_colour;
mod isolines;
mod region;
mod samples;
mod scale;
mod text;
mod tone;
mod trade_off;
mod view;

use std::fmt;
use std::path::Path;

use crate::report::{WriteError, write_file};
use crate::scene::Quantity;

pub use error_map::{camera_error_map, error_map};
pub use false_colour::{camera_false_colour, false_colour};
pub use samples::samples;
pub use tone::{camera_picture, side_by_side};
pub use trade_off::{TradeLine, TradeMark, TradePanel, trade_off};

/// What a camera sees, pixel by pixel.
#[derive(Clone, Debug)]
pub struct CameraView {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Rows from the top, each from the left; `None` is the background.
    pub pixels: Vec<Option<Pixel>>,
}

/// What one pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Index of the surface in the scene.
    pub surface: usize,
    /// Whether the surface is a luminaire: it is drawn bright and left out of
    /// false colour and errors.
    pub luminaire: bool,
    /// Irradiance in W m⁻² or lx; the mean of the channels in a coloured scene.
    pub irradiance: f64,
    /// Radiance towards the camera of each channel, emitted and reflected, in
    /// W m⁻² sr⁻¹ or cd m⁻²; three equal numbers in a grey scene.
    pub radiance: [f64; 3],
}

/// A grid of values over the bounding rectangle of a surface.
#[derive(Clone, Debug)]
pub struct SurfaceField {
    /// The surface's name.
    pub name: String,
    /// What the values are in: W m⁻² or lx.
    pub quantity: Quantity,
    /// Lower left corner of the bounding rectangle in the surface's own
    /// coordinates (u to the right, v upwards), in metres.
    pub low: [f64; 2],
    /// Size of the bounding rectangle in metres, both positive.
    pub size: [f64; 2],
    /// Cells along u.
    pub columns: usize,
    /// Cells along v.
    pub rows: usize,
    /// The value in the middle of each cell: the row of lowest v first, each
    /// from lowest u.
    pub values: Vec<f64>,
    /// Which of the cells belong to the visible surface, in the same order.
    pub inside: Vec<bool>,
    /// The surface's polygon, drawn as a line; may be empty.
    pub outline: Vec<[f64; 2]>,
}

/// Where a surface is sampled and from where it shoots.
#[derive(Clone, Debug)]
pub struct SamplePlan {
    /// The surface's name.
    pub name: String,
    /// What radiosities are in: W m⁻² or lx.
    pub quantity: Quantity,
    /// Lower left corner of the bounding rectangle, in metres.
    pub low: [f64; 2],
    /// Size of the bounding rectangle in metres, both positive.
    pub size: [f64; 2],
    /// The surface's polygon; the bounding rectangle where empty.
    pub outline: Vec<[f64; 2]>,
    /// The samples.
    pub samples: Vec<SampleMark>,
    /// The emitter polygons.
    pub emitters: Vec<EmitterShape>,
    /// The irradiance beneath, drawn in faint grey where no emitter covers it.
    pub field: Option<SurfaceField>,
}

/// One sample of a [`SamplePlan`].
#[derive(Clone, Debug)]
pub struct SampleMark {
    /// Place on the surface in metres.
    pub position: [f64; 2],
    /// What it is for, such as "light transfer" or "display"; each tag has its
    /// own mark, in the order in which they first appear.
    pub tag: String,
}

/// One emitter of a [`SamplePlan`].
#[derive(Clone, Debug)]
pub struct EmitterShape {
    /// Closed loops in metres, the first vertex not repeated: the outer one
    /// and, where it has holes, inner ones. A place inside an odd number of
    /// loops belongs to the emitter.
    pub loops: Vec<Vec<[f64; 2]>>,
    /// Mean radiosity in W m⁻² (lm m⁻² in a photometric scene).
    pub radiosity: f64,
}

/// A finished picture: 8 bits a channel, sRGB.
pub struct Picture {
    canvas: canvas::Canvas,
}

impl Picture {
    /// Width in pixels.
    #[must_use]
    pub fn width(&self) -> usize {
        self.canvas.width()
    }

    /// Height in pixels.
    #[must_use]
    pub fn height(&self) -> usize {
        self.canvas.height()
    }

    /// Red, green and blue of the pixel `x` from the left and `y` from the top;
    /// `None` outside of the picture.
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> Option<[u8; 3]> {
        self.canvas.pixel(x, y)
    }

    /// The picture as a PNG file's bytes.
    ///
    /// # Errors
    /// [`PictureError::Encoding`] where the encoder refuses.
    pub fn png(&self) -> Result<Vec<u8>, PictureError> {
        self.canvas.png()
    }

    /// Writes the picture as a PNG file, whole or not at all.
    ///
    /// # Errors
    /// As [`Picture::png`] and [`write_file`].
    pub fn write(&self, path: &Path) -> Result<(), PictureError> {
        write_file(path, &self.png()?).map_err(PictureError::Write)
    }
}

impl fmt::Debug for Picture {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Picture({} x {})", self.width(), self.height())
    }
}

/// Why there is no picture.
#[derive(Debug)]
pub enum PictureError {
    /// The numbers do not fit each other; says which and how.
    Inconsistent(String),
    /// There is nothing to draw, or it would not fit into memory.
    Size {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
    },
    /// The PNG encoder refused.
    Encoding(String),
    /// The file could not be written.
    Write(WriteError),
}

impl fmt::Display for PictureError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Inconsistent(what) => write!(formatter, "cannot draw: {what}"),
            Self::Size { width, height } => write!(
                formatter,
                "cannot draw a picture of {width} x {height} pixels; each side must be 1 to {}",
                canvas::MAX_SIDE
            ),
            Self::Encoding(what) => write!(formatter, "cannot encode the picture: {what}"),
            Self::Write(error) => error.fmt(formatter),
        }
    }
}

impl std::error::Error for PictureError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Write(error) => Some(error),
            _ => None,
        }
    }
}

impl CameraView {
    fn check(&self) -> Result<(), PictureError> {
        let count = self.width.checked_mul(self.height);
        if count == Some(self.pixels.len()) && !self.pixels.is_empty() {
            return Ok(());
        }
        Err(PictureError::Inconsistent(format!(
            "a view of {} x {} pixels has {} of them",
            self.width,
            self.height,
            self.pixels.len()
        )))
    }

    /// The pixels that show something other than a luminaire.
    fn lit(&self) -> impl Iterator<Item = &Pixel> {
        self.pixels
            .iter()
            .flatten()
            .filter(|pixel| !pixel.luminaire)
    }
}

impl SurfaceField {
    fn check(&self) -> Result<(), PictureError> {
        let count = self.columns.checked_mul(self.rows);
        let whole = count == Some(self.values.len()) && count == Some(self.inside.len());
        if !whole || self.values.is_empty() {
            return Err(PictureError::Inconsistent(format!(
                "the field of {} is {} x {} cells but has {} values and {} marks of what is inside",
                self.name,
                self.columns,
                self.rows,
                self.values.len(),
                self.inside.len()
            )));
        }
        check_rectangle(&self.name, self.low, self.size)
    }

    /// The middle of a cell, in metres.
    fn middle(&self, cell: usize) -> [f64; 2] {
        let share = [
            ((cell % self.columns) as f64 + 0.5) / self.columns as f64,
            ((cell / self.columns) as f64 + 0.5) / self.rows as f64,
        ];
        std::array::from_fn(|axis| self.low[axis] + share[axis] * self.size[axis])
    }

    /// The values inside.
    fn lit(&self) -> impl Iterator<Item = f64> {
        self.values
            .iter()
            .zip(&self.inside)
            .filter(|(_, inside)| **inside)
            .map(|(value, _)| *value)
    }
}

/// Refuses what has no place on a map.
fn check_rectangle(name: &str, low: [f64; 2], size: [f64; 2]) -> Result<(), PictureError> {
    let sound = low.iter().all(|side| side.is_finite())
        && size.iter().all(|side| side.is_finite() && *side > 0.0);
    if sound {
        return Ok(());
    }
    Err(PictureError::Inconsistent(format!(
        "the bounding rectangle of {name} starts at {low:?} m and measures {size:?} m"
    )))
}
