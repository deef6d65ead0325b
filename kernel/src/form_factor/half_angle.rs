//! A loop summed edge by edge with half-angle tangents and exact horizon caps.
//!
//! For an edge from a to b, with d = a·b, r = |a||b| and t = r + |d|,
//!
//! ```text
//! q = (r − |d|)/t = tan²(γ/2)  where d ≥ 0,  γ/|a×b| = 2 h(q)/t
//! q = |a×b|²/t²                where d < 0,  γ/|a×b| = π/|a×b| − 2 h(q)/t
//! ```
//!
//! with h(q) = atan(√q)/√q, so that the edge's term γ n·(a×b)/|a×b| needs one
//! division and, where γ ≤ 90°, no root but those of the vertices' lengths. The
//! first form of q loses its digits where γ is small, where h is 1 − q/3 and
//! does not care; past 90° the sine itself is needed, and the second form has
//! all of its digits.
//!
//! A cap runs along the horizon, where n·c/|c| is ±1 exactly, so its term is
//! its angle: computing it as an ordinary edge would cost up to 5e-3 where the
//! emitter's plane passes close by the receiver. The sign is that of n·c; where
//! the cap is seen under nearly 180° and n·c drowns in rounding, it is that of
//! the cap's direction along the line in which the emitter's plane meets the
//! horizon: for a receiver in front of the emitter, n·(a×b) has the sign of
//! (b − a)·(m×n), m being the emitter's normal (take a as the line's point
//! nearest to the receiver: m·a < 0 and n·(a×(m×n)) = −m·a).

use super::Outline;
use crate::clip::{self, Corner, Edges};
use crate::geometry::{Receiver, Vector};
use crate::number::{Number, Root, scaled_arctangent};
use core::marker::PhantomData;

/// A vertex relative to the receiver.
#[derive(Clone, Copy)]
struct Vertex<N, R> {
    position: Vector<N>,
    height: N,
    norm: N,
    root: PhantomData<R>,
}

impl<N: Number, R: Root<N>> Vertex<N, R> {
    #[inline(always)]
    fn new(position: Vector<N>, height: N) -> Self {
        let norm = R::sqrt(position.norm_squared());
        Self {
            position,
            height,
            norm,
            root: PhantomData,
        }
    }
}

impl<N: Number, R: Root<N> + Copy> Corner<N> for Vertex<N, R> {
    #[inline(always)]
    fn height(&self) -> N {
        self.height
    }

    #[inline(always)]
    fn farness(&self) -> N {
        self.norm
    }

    #[inline(always)]
    fn toward(&self, other: &Self, t: N) -> Self {
        Self::new(
            self.position + (other.position - self.position) * t,
            N::ZERO,
        )
    }
}

struct HalfAngle<const DEGREE: usize, N, R> {
    normal: Vector<N>,
    facing: Vector<N>,
    root: PhantomData<R>,
}

impl<const DEGREE: usize, N: Number, R: Root<N>> HalfAngle<DEGREE, N, R> {
    /// γ n·c/|c|.
    #[inline(always)]
    fn edge(&self, a: Vertex<N, R>, b: Vertex<N, R>) -> N {
        let c = a.position.cross(b.position);
        let d = a.position.dot(b.position);
        let r = a.norm * b.norm;
        let per_sine = if d >= N::ZERO {
            let t = r + d;
            if t <= N::ZERO {
                return N::ZERO; // the receiver is a vertex: the edge has no direction
            }
            let inverse = N::ONE / t;
            let q = (r - d) * inverse;
            N::of(2.0) * scaled_arctangent::<DEGREE, N>(q) * inverse
        } else {
            let squared = c.norm_squared();
            let sine = R::sqrt(squared);
            if sine <= N::ZERO {
                return N::ZERO; // the receiver is on the edge
            }
            let inverse = N::ONE / (r - d);
            let q = squared * inverse * inverse;
            N::PI / sine - N::of(2.0) * scaled_arctangent::<DEGREE, N>(q) * inverse
        };
        per_sine * self.normal.dot(c)
    }
}

impl<const DEGREE: usize, N: Number, R: Root<N>> Edges<N, Vertex<N, R>>
    for HalfAngle<DEGREE, N, R>
{
    type Sum = N;

    #[inline(always)]
    fn whole(&self, sum: N, from: Vertex<N, R>, to: Vertex<N, R>) -> N {
        sum + self.edge(from, to)
    }

    #[inline(never)]
    fn cut(&self, sum: N, from: Vertex<N, R>, to: Vertex<N, R>) -> N {
        sum + self.edge(from, to)
    }

    /// ±γ.
    #[inline(never)]
    fn cap(&self, sum: N, from: Vertex<N, R>, to: Vertex<N, R>) -> N {
        let d = from.position.dot(to.position);
        let signed_sine = self.normal.dot(from.position.cross(to.position));
        let sine = signed_sine.abs();
        let t = from.norm * to.norm + d.abs();
        if t <= N::ZERO {
            return sum;
        }
        let tangent = sine / t;
        let half = scaled_arctangent::<DEGREE, N>(tangent * tangent) * tangent;
        let mut angle = half + half;
        let mut sign = signed_sine;
        if d < N::ZERO {
            angle = N::PI - angle;
            if tangent < N::of(1.0 / 512.0) {
                let along = self.facing.cross(self.normal);
                sign = along.dot(to.position - from.position);
            }
        }
        if sign < N::ZERO {
            sum - angle
        } else {
            sum + angle
        }
    }
}

/// Σ γ_i n·unit(v_i × v_{i+1}) over the part of the loop above the horizon.
#[inline]
pub(super) fn contour<const DEGREE: usize, N: Number, R: Root<N> + Copy>(
    receiver: &Receiver<N>,
    facing: Vector<N>,
    outline: &Outline<'_, N>,
) -> N {
    let (place, normal) = (receiver.position(), receiver.normal());
    let corners = outline.vertices().iter().map(|&vertex| {
        let position = Vector::from(vertex) - place;
        Vertex::<N, R>::new(position, normal.dot(position))
    });
    let edges = HalfAngle::<DEGREE, N, R> {
        normal,
        facing,
        root: PhantomData,
    };
    clip::walk(corners, &edges, N::ZERO)
}
