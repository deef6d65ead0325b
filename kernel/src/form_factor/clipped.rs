//! A convex loop that has been clipped already, in coordinates of its plane.
//!
//! What visibility leaves of an emitter are convex pieces given in coordinates
//! of the emitter's plane. They are summed as whole emitters are, the small
//! ones as residuals, the others by half angles, and an edge that the horizon
//! cut keeps its exact term through every later cut.

use super::{residual, snell};
use crate::geometry::Vector;
use crate::number::{Floating, Root};

/// The plane of an emitter as a receiver sees it: places are
/// v = origin + a axes\[0\] + b axes\[1\] relative to the receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenPlane<N> {
    /// Place (0, 0) relative to the receiver, in metres.
    pub origin: Vector<N>,
    /// The plane's axes, in metres; first × second runs along `facing`.
    pub axes: [Vector<N>; 2],
    /// Normal of the emitting side, of any length.
    pub facing: Vector<N>,
    /// Unit normal of the receiver.
    pub normal: Vector<N>,
}

impl<N: Floating> SeenPlane<N> {
    /// a axes\[0\] + b axes\[1\]: a difference of two places.
    #[inline(always)]
    pub fn offset(&self, [a, b]: [N; 2]) -> Vector<N> {
        let [first, second] = self.axes;
        first * a + second * b
    }

    /// A place relative to the receiver, in metres.
    #[inline(always)]
    pub fn place(&self, coordinates: [N; 2]) -> Vector<N> {
        self.origin + self.offset(coordinates)
    }
}

/// The form factor of a convex loop above the receiver's horizon, F ≥ 0.
///
/// `corners` in coordinates of the plane, counter-clockwise seen from its
/// emitting side; the edge that begins at corner number `cap`, if any, runs
/// along the horizon. Error and cost as of the rung [`Best`](super::Best).
/// Never panics; NaN becomes 0.
#[inline]
pub fn of_clipped<N: Floating, R: Root<N> + Copy>(
    seen: &SeenPlane<N>,
    corners: &[[N; 2]],
    cap: Option<usize>,
) -> N {
    let Some(&anchor) = corners.first() else {
        return N::ZERO;
    };
    let from_anchor = |corner: [N; 2]| {
        let ([a, b], [a0, b0]) = (corner, anchor);
        seen.offset([a - a0, b - b0])
    };
    let first = seen.place(anchor);
    let mut reach_squared = N::ZERO;
    for &corner in corners {
        let squared = from_anchor(corner).norm_squared();
        if squared > reach_squared {
            reach_squared = squared;
        }
    }
    let sum = if super::is_within_reach(reach_squared, first.norm_squared()) {
        let offsets = corners.iter().map(|&corner| from_anchor(corner));
        residual::closed(seen.normal, first, offsets)
    } else {
        let places = corners.iter().map(|&corner| seen.place(corner));
        snell::closed::<6, N, R>(seen.normal, seen.facing, places, cap)
    };
    super::fraction(-sum)
}
