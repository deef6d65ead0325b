//! The kernel in integers, as the firmware's steps call it.

use core::mem::size_of;

use isolux::Error;
use isolux::integers;
pub(crate) use isolux::integers::Scene;

use crate::job::{self, COUNTS};

/// Room for samples and for emitters.
const SAMPLES: usize = COUNTS.samples as usize;
const EMITTERS: usize = COUNTS.emitters as usize;

/// The kernel's state for this scene.
pub(crate) type Light = integers::Light<'static, job::Arithmetic, SAMPLES, EMITTERS>;

/// What a sample receives.
pub(crate) type Value = u32;

/// Nothing.
pub(crate) const DARK: Value = 0;

/// Words of a value.
pub(crate) const WORDS: usize = 1;

// What the budget sheet promises is what the state takes.
const _: () = assert!(
    size_of::<Light>() == integers::light_bytes(&COUNTS),
    "integers::light_bytes is not the size of Light on this target"
);

/// The state of no scene.
pub(crate) const EMPTY: Light = Light::empty();

/// Integers spread samples by the cone filter, which needs no room.
pub(crate) const ROOM: usize = 0;

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
