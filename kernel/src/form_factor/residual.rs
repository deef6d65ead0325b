//! A small loop summed without cancellation.
//!
//! The terms of Eq. 3 are of the size of the loop's angular radius s, their
//! sum is of the size s² or s³: in single precision nothing is left of a form
//! factor below 1e-7. But the cancellation can be done on paper. With
//! D_i = V_i − V_0, e_i = V_{i+1} − V_i and C_i = D_i × D_{i+1} taken from the
//! original vertices, v_0 = V_0 − P and γ_i/|v_i × v_{i+1}| = (1 + η_i)/r_0²,
//! Σ e_i = 0 gives exactly
//!
//! ```text
//! −2π F r_0² = (n × v_0)·Σ η_i e_i + Σ (1 + η_i) n·C_i
//! ```
//!
//! Of the two sums, what is left when both cosines are small cancels: their parts
//! of first order in s are n·M and (n·M) r_0² − (n·v_0)(M·v_0) over r_0², with M = Σ
//! C_i twice the area along the loop's normal. So with X_i/r_0² the first order of
//! η_i and η′_i the rest,
//!
//! ```text
//! −2π F r_0² = (n·v_0)(M·v_0)/r_0² + (n × v_0)·Σ η′_i e_i + Σ η_i n·C_i
//! ```
//!
//! the first term of which is cos cos A/r² and the others smaller by s. Both
//! orders come without a subtraction of nearly equal numbers:
//!
//! ```text
//! δ_i = D_i·(2 v_0 + D_i)                       = r_i² − r_0²
//! X   = −v_0·(D_i + D_{i+1}),   x = X − D_i·D_{i+1},   d = r_0² − x = v_i·v_{i+1}
//! y   = (δ_{i+1} − δ_i − |e|²)/2
//! l   = (r_0² + δ_i)|e|² − y²                   = |v_i × v_{i+1}|²
//! w   = l/d² = tan² γ,   k(w) = (1 − h(w))/w
//! η′  = (X x/r_0² − D_i·D_{i+1} − r_0² w k(w))/d,   η = X/r_0² + η′
//! ```
//!
//! One division an edge and no root. k is fitted for w ≤ 1: every edge must be
//! seen under at most 45°, which holds where every |D_i| ≤ r_0 sin 22.5°
//! ([`is_small`](super::is_small)). The choice is made on the whole loop, before the clip, and
//! clipped corners carry their D along: deciding on the clipped loop would
//! cost 2e-5.

use super::{Outline, TURN};
use crate::clip::{self, Corner, Edges};
use crate::geometry::{Receiver, Vector};
use crate::number::{Number, residual_arctangent};

/// A vertex relative to the loop's first one.
#[derive(Clone, Copy)]
struct Vertex<N> {
    offset: Vector<N>,
    height: N,
    /// 2 v_0·D.
    twice_along: N,
    /// δ = |v|² − |v_0|².
    excess: N,
    twice_first: Vector<N>,
}

impl<N: Number> Vertex<N> {
    #[inline(always)]
    fn new(offset: Vector<N>, height: N, twice_first: Vector<N>) -> Self {
        let twice_along = offset.dot(twice_first);
        Self {
            offset,
            height,
            twice_along,
            excess: twice_along + offset.norm_squared(),
            twice_first,
        }
    }
}

impl<N: Number> Corner<N> for Vertex<N> {
    #[inline(always)]
    fn height(&self) -> N {
        self.height
    }

    #[inline(always)]
    fn farness(&self) -> N {
        self.excess
    }

    #[inline(always)]
    fn toward(&self, other: &Self, t: N) -> Self {
        let offset = self.offset + (other.offset - self.offset) * t;
        Self::new(offset, N::ZERO, self.twice_first)
    }
}

struct Residual<N> {
    normal: Vector<N>,
    distance_squared: N,
    /// 1/r_0².
    inverse_squared: N,
}

#[derive(Clone, Copy)]
struct Sum<N> {
    /// Σ C: twice the area along the loop's normal.
    area: Vector<N>,
    /// Σ η′ e.
    along: Vector<N>,
    /// Σ η n·C.
    across: N,
}

impl<N: Number> Residual<N> {
    #[cfg_attr(feature = "small", inline(never))]
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn add(&self, sum: Sum<N>, a: Vertex<N>, b: Vertex<N>) -> Sum<N> {
        let half = N::of(0.5);
        let e = b.offset - a.offset;
        let length_squared = e.norm_squared();
        let straight = (a.twice_along + b.twice_along) * N::of(-0.5);
        let curved = a.offset.dot(b.offset);
        let x = straight - curved;
        let y = (b.excess - a.excess - length_squared) * half;
        let inverse = N::ONE / (self.distance_squared - x);
        let l = (self.distance_squared + a.excess) * length_squared - y * y;
        let w = l * inverse * inverse;
        let first = straight * self.inverse_squared;
        let bend = curved + self.distance_squared * w * residual_arctangent(w);
        let second = (first * x - bend) * inverse;
        let area = a.offset.cross(b.offset);
        Sum {
            area: sum.area + area,
            along: sum.along + e * second,
            across: sum.across + (first + second) * self.normal.dot(area),
        }
    }
}

impl<N: Number> Edges<N, Vertex<N>> for Residual<N> {
    type Sum = Sum<N>;

    #[inline(always)]
    fn whole(&self, sum: Sum<N>, from: Vertex<N>, to: Vertex<N>) -> Sum<N> {
        self.add(sum, from, to)
    }

    #[inline(never)]
    fn cut(&self, sum: Sum<N>, [from, to]: [Vertex<N>; 2], _: [Vertex<N>; 2]) -> Sum<N> {
        self.add(sum, from, to)
    }

    /// Small loops are far from spanning 180°: a cap is an edge like others.
    #[inline(always)]
    fn cap(&self, sum: Sum<N>, from: Vertex<N>, to: Vertex<N>) -> Sum<N> {
        self.cut(sum, [from, to], [from, to])
    }
}

/// Σ γ_i n·unit(v_i × v_{i+1}) in turns over the part of a small loop above the
/// horizon.
#[inline]
pub(super) fn contour<N: Number>(receiver: &Receiver<N>, outline: &Outline<'_, N>) -> N {
    let Some(&origin) = outline.vertices().first() else {
        return N::ZERO;
    };
    let origin = Vector::from(origin);
    let (place, normal) = (receiver.position(), receiver.normal());
    let first = origin - place;
    let twice_first = first + first;
    let corners = outline.vertices().iter().map(|&vertex| {
        let vertex = Vector::from(vertex);
        Vertex::new(vertex - origin, normal.dot(vertex - place), twice_first)
    });
    walk(normal, first, corners)
}

/// The same of a loop wholly above the horizon, given by its first vertex
/// relative to the receiver and all vertices relative to the first.
#[inline]
pub(super) fn closed<N: Number>(
    normal: Vector<N>,
    first: Vector<N>,
    offsets: impl Iterator<Item = Vector<N>>,
) -> N {
    let twice_first = first + first;
    let corners = offsets.map(|offset| Vertex::new(offset, N::ZERO, twice_first));
    walk(normal, first, corners)
}

#[inline(always)]
fn walk<N: Number>(
    normal: Vector<N>,
    first: Vector<N>,
    corners: impl Iterator<Item = Vertex<N>>,
) -> N {
    let distance_squared = first.norm_squared();
    let edges = Residual {
        normal,
        distance_squared,
        inverse_squared: N::ONE / distance_squared,
    };
    let none = Sum {
        area: Vector::ZERO,
        along: Vector::ZERO,
        across: N::ZERO,
    };
    let sum = clip::walk(corners, &edges, none);
    let inverse_squared = edges.inverse_squared;
    let straight = normal.dot(first) * first.dot(sum.area) * inverse_squared;
    let bent = normal.cross(first).dot(sum.along) + sum.across;
    (straight + bent) * inverse_squared * N::of(TURN)
}
