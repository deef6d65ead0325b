//! The kernel in floating point, as the firmware's steps call it.

use isolux::Error;
use isolux::luminance::Colour as _;

use crate::job::baked::{self, ROOM};
use crate::root::Chosen;

pub(crate) use baked::{Light, Value};

/// Nothing.
pub(crate) const DARK: Value = Value::DARK;

/// Words of a value.
pub(crate) const WORDS: usize = Value::CHANNELS;

/// Whether surfaces are put together from fields.
const FIELDS: bool = ROOM > 0;

/// Makes what the rows of a surface need, where it has fields.
#[inline(always)]
pub(crate) fn reconstruct(
    light: &Light,
    surface: usize,
    room: &mut [Value; ROOM],
) -> Result<(), Error> {
    match FIELDS {
        false => Ok(()),
        true => light
            .reconstruct::<baked::Reconstruction>(surface, room)
            .map(drop),
    }
}

/// One row of a surface's grid.
#[inline(always)]
pub(crate) fn resample_row(
    light: &Light,
    surface: usize,
    room: &[Value; ROOM],
    grid: [u32; 2],
    row: u32,
    out: &mut [Value],
) -> Result<(), Error> {
    match FIELDS {
        false => light
            .resample_row::<Chosen>(surface, grid, row, out)
            .map(drop),
        true => light
            .reconstructed::<baked::Reconstruction>(surface, room)?
            .row(grid, row, out),
    }
}

/// A value with one bit wrong.
pub(crate) fn wrong(value: Value) -> Value {
    value.map(|value| f32::from_bits(value.to_bits() ^ 1))
}
