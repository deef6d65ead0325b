//! The kernel in floating point, as the firmware's steps call it.

use core::mem::size_of;

use isolux::luminance::{Colour as _, Luminance};
pub(crate) use isolux::scene::Scene;
use isolux::{Error, budget};

use crate::job::{self, COUNTS};
use crate::root::Chosen;

/// Room for samples and for emitters.
const SAMPLES: usize = COUNTS.samples as usize;
const EMITTERS: usize = COUNTS.emitters as usize;

/// The kernel's state for this scene.
pub(crate) type Light = isolux::shoot::Light<
    'static,
    job::Arithmetic,
    SAMPLES,
    EMITTERS,
    job::Luminance,
    job::Transfer,
>;

/// What a sample receives, in every channel.
pub(crate) type Value = <job::Luminance as Luminance>::Colour;

/// Nothing.
pub(crate) const DARK: Value = Value::DARK;

/// Words of a value.
pub(crate) const WORDS: usize = Value::CHANNELS;

// What the budget sheet promises is what the state takes.
const _: () = assert!(
    size_of::<Light>() == budget::light_bytes(&COUNTS) + size_of::<job::Transfer>(),
    "budget::light_bytes is not the size of Light on this target"
);
const _: () = assert!(
    size_of::<job::Transfer>() == 0
        || size_of::<job::Transfer>() == budget::sight_bytes(&job::SIGHT),
    "budget::sight_bytes is not the size of the workspace on this target"
);

/// The state of no scene.
pub(crate) const EMPTY: Light = Light::empty(job::LOOKING);

/// Values that the reconstruction of a surface needs room for.
pub(crate) const ROOM: usize = COUNTS.room as usize;

/// Makes what the rows of a surface need, where it has fields.
#[inline(always)]
pub(crate) fn reconstruct(
    light: &Light,
    surface: usize,
    room: &mut [Value; ROOM],
) -> Result<(), Error> {
    match COUNTS.fields {
        0 => Ok(()),
        _ => light
            .reconstruct::<job::Reconstruction>(surface, room)
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
    match COUNTS.fields {
        0 => light
            .resample_row::<Chosen>(surface, grid, row, out)
            .map(drop),
        _ => light
            .reconstructed::<job::Reconstruction>(surface, room)?
            .row(grid, row, out),
    }
}

/// A value with one bit wrong.
pub(crate) fn wrong(value: Value) -> Value {
    value.map(|value| f32::from_bits(value.to_bits() ^ 1))
}
