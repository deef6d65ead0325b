//! The default rung.

use super::{Arithmetic, Outline, residual, snell};
use crate::geometry::{Receiver, Vector};
use crate::number::{Floating, Root, SoftRoot};
use core::marker::PhantomData;

/// The rung `best`: the residual form where the emitter is small, Snell's
/// quotient with exact horizon caps otherwise. No library call but the square
/// root, which `R` supplies.
///
/// |error of F| ≤ 2.5e-7 in `f32`, in every position in front of the emitter:
/// close to its plane, to a vertex, and to an edge as well, where the direction
/// of the edge's plane and the crossing of the horizon are computed with what
/// rounding took from the subtraction of the receiver's position (2.3e-7 at the
/// most in a million positions of all kinds; promised are 2e-7 + 0.03 u L/h 1e-7
/// to 1e-1 from an edge, u = 2⁻²⁴, L the largest distance to a vertex, h the distance
/// to the nearest edge). Relative error ≤ 1.5e-6 for an emitter seen within 22.5° of
/// its first vertex, wholly above the horizon, with both cosines above 0.2, slender
/// or not (7.7e-7 at the most in 80000). In `f64` the fits of the arc tangents limit it to 2e-8
/// absolute. The project's tests hold it to these.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Best<R = SoftRoot>(PhantomData<R>);

impl<N: Floating, R: Root<N> + Copy> Arithmetic<N> for Best<R> {
    type Root = R;

    #[inline]
    fn contour(receiver: &Receiver<N>, facing: Vector<N>, outline: &Outline<'_, N>) -> N {
        if super::is_small(receiver, outline) {
            residual::contour(receiver, outline)
        } else {
            snell::contour::<6, N, R>(receiver, facing, outline)
        }
    }
}
