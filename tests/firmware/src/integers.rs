//! The kernel in integers, as the firmware's steps call it.

use isolux::Error;

use crate::job::baked::{self, ROOM};

pub(crate) use baked::{Light, Value};

/// Nothing.
pub(crate) const DARK: Value = 0;

/// Words of a value.
pub(crate) const WORDS: usize = 1;

/// Rows have nothing in common.
#[inline(always)]
pub(crate) fn reconstruct(_: &Light, _: usize, _: &mut [Value; ROOM]) -> Result<(), Error> {
    Ok(())
}

/// One row of a surface's grid.
#[inline(always)]
pub(crate) fn resample_row(
    light: &Light,
    surface: usize,
    _: &[Value; ROOM],
    grid: [u32; 2],
    row: u32,
    out: &mut [Value],
) -> Result<(), Error> {
    light.resample_row(surface, grid, row, out).map(drop)
}

/// A value with one bit wrong.
pub(crate) fn wrong(value: Value) -> Value {
    value ^ 1
}
