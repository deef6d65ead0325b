//! Straight lines in an emitter's plane: planes through the receiver, cut by
//! that plane.

use crate::form_factor::SeenPlane;
use crate::geometry::Vector;
use crate::number::Floating;

/// The half-plane c_0 + c_1 a + c_2 b ≥ 0 in coordinates of a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line<N> {
    constant: N,
    slopes: [N; 2],
}

/// Unit roundoff of the number, 2⁻ᵖ.
#[inline(always)]
pub(super) fn unit_roundoff<N: Floating>() -> N {
    let half = N::SPLITTER - N::ONE;
    N::ONE / (half * half)
}

impl<N: Floating> Line<N> {
    /// Where the half-space h·v ≥ 0, v relative to the receiver, meets the
    /// plane.
    #[cfg_attr(feature = "small", inline(never))]
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn of_half_space(h: Vector<N>, seen: &SeenPlane<N>) -> Self {
        Self {
            constant: h.dot(seen.origin),
            slopes: seen.axes.map(|axis| h.dot(axis)),
        }
    }

    /// c_0 + c_1 a + c_2 b.
    #[inline(always)]
    pub(super) fn height(&self, [a, b]: [N; 2]) -> N {
        let [along_a, along_b] = self.slopes;
        self.constant + (along_a * a + along_b * b)
    }

    /// The height within which a corner counts as on the line, 8 u Σ|c|.
    ///
    /// Rounding moves a height by at most 4 u Σ|c|; what two occluders share
    /// then counts as on both of their lines, and no light leaks between.
    #[inline(always)]
    pub(super) fn tolerance(&self) -> N {
        let [along_a, along_b] = self.slopes;
        let size = self.constant.abs() + along_a.abs() + along_b.abs();
        N::of(8.0) * unit_roundoff::<N>() * size
    }
}

/// The normal of the plane through the receiver and the edge from a to b, both
/// relative to the receiver: base × (B − A), where base is the nearer end and
/// `along` is B − A from the tables.
///
/// The same edge in the other direction gives the negative, bit for bit:
/// adjacent faces share one plane, and nothing leaks between them. a×b would be
/// antisymmetric too, but loses small emitters (7e-3 of F against 4e-5).
#[cfg_attr(feature = "small", inline(never))]
#[cfg_attr(not(feature = "small"), inline(always))]
pub(super) fn plane_through<N: Floating>(
    a: Vector<N>,
    b: Vector<N>,
    along: Vector<N>,
) -> Vector<N> {
    let (near_a, near_b) = (a.norm_squared(), b.norm_squared());
    let first = near_a < near_b || (near_a == near_b && precedes(a, b));
    if first {
        a.cross(along)
    } else {
        b.cross(along)
    }
}

fn precedes<N: Floating>(a: Vector<N>, b: Vector<N>) -> bool {
    [a.x, a.y, a.z] < [b.x, b.y, b.z]
}
