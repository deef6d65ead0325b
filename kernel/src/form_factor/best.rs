//! The default rung.

use super::{Arithmetic, Outline, residual, snell};
use crate::geometry::{Receiver, Vector};
use crate::number::{Floating, Root, SoftRoot};
use core::marker::PhantomData;

/// The rung `best`: the residual form where the emitter is small, half-angle
/// tangents with exact horizon caps otherwise. No library call but the square
/// root, which `R` supplies.
///
/// Bounds in `f32`, u = 2⁻²⁴, L the largest distance to a vertex, h the
/// distance to the nearest edge: |error of F| ≤ 2.5e-7 + 0.03 u L/h (the
/// subtraction of the receiver's position from a vertex is rounded, which
/// matters next to an edge only); relative error ≤ 1.5e-6 for an emitter seen
/// within 22.5° of its first vertex, wholly above the horizon, with aspect
/// below 100 and both cosines above 0.1. In `f64` the fits of the arc tangents
/// limit it to 2e-8 absolute. The project's tests hold it to these.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Best<R = SoftRoot>(PhantomData<R>);

impl<N: Floating, R: Root<N> + Copy> Arithmetic<N> for Best<R> {
    type Root = R;

    #[inline]
    fn contour(receiver: &Receiver<N>, facing: Vector<N>, outline: &Outline<'_, N>) -> N {
        if residual::is_small(receiver, outline) {
            residual::contour(receiver, outline)
        } else {
            snell::contour::<6, N, R>(receiver, facing, outline)
        }
    }
}
