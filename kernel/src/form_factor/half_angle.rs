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
use crate::number::{Floating, Number, Root, scaled_arctangent};
use core::marker::PhantomData;

/// Squared sine below which an edge past 90° is summed with care: beyond 165°,
/// rounding c would cost more than 2.5e-7.
const WIDE: f64 = 1.0 / 16.0;

/// A vertex relative to the receiver.
#[derive(Clone, Copy)]
struct Vertex<'a, N, R> {
    position: Vector<N>,
    height: N,
    norm: N,
    /// The vertex itself, in metres; of a crossing, one end of its edge.
    source: &'a [N; 3],
    root: PhantomData<R>,
}

impl<'a, N: Number, R: Root<N>> Vertex<'a, N, R> {
    #[inline(always)]
    fn new(position: Vector<N>, height: N, source: &'a [N; 3]) -> Self {
        let norm = R::sqrt(position.norm_squared());
        Self {
            position,
            height,
            norm,
            source,
            root: PhantomData,
        }
    }
}

impl<N: Number, R: Root<N> + Copy> Corner<N> for Vertex<'_, N, R> {
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
            self.source,
        )
    }
}

struct HalfAngle<const DEGREE: usize, N, R> {
    place: Vector<N>,
    normal: Vector<N>,
    facing: Vector<N>,
    root: PhantomData<R>,
}

impl<const DEGREE: usize, N: Floating, R: Root<N>> HalfAngle<DEGREE, N, R> {
    /// γ n·c/|c|, or `None` towards 180°, where the receiver is close to the
    /// edge, c is a small difference of large products, and its direction is
    /// what counts.
    #[inline(always)]
    fn edge(&self, a: &Vertex<'_, N, R>, b: &Vertex<'_, N, R>) -> Option<N> {
        let c = a.position.cross(b.position);
        let d = a.position.dot(b.position);
        let r = a.norm * b.norm;
        let t = r + d.abs();
        let per_sine = if d >= N::ZERO {
            if t <= N::ZERO {
                return Some(N::ZERO); // the receiver is a vertex: no direction
            }
            let inverse = N::ONE / t;
            let q = (r - d) * inverse;
            let half = scaled_arctangent::<DEGREE, N>(q) * inverse;
            half + half
        } else {
            let squared = c.norm_squared();
            if squared < N::of(WIDE) * (r * r) {
                return None;
            }
            let inverse = N::ONE / t;
            let q = squared * inverse * inverse;
            let half = scaled_arctangent::<DEGREE, N>(q) * inverse;
            N::PI / R::sqrt(squared) - (half + half)
        };
        Some(per_sine * self.normal.dot(c))
    }

    /// γ n·c/|c| of an edge towards 180°.
    #[cold]
    #[inline(never)]
    fn wide_edge(&self, a: &Vertex<'_, N, R>, b: &Vertex<'_, N, R>) -> N {
        let c = self.accurate_cross(a, b);
        let sine = R::sqrt(c.norm_squared());
        if sine <= N::ZERO {
            return N::ZERO; // the receiver is on the edge
        }
        self.angle(a, b, sine) * (self.normal.dot(c) / sine)
    }

    /// a×b of two vertices, also where they are nearly parallel: the products
    /// exact, and what rounding took from V − P put back to first order. Only
    /// the direction of an edge close to the receiver needs it.
    #[inline]
    fn accurate_cross(&self, a: &Vertex<'_, N, R>, b: &Vertex<'_, N, R>) -> Vector<N> {
        let rest =
            |vertex: &Vertex<'_, N, R>| Vector::from(*vertex.source).rest_of_difference(self.place);
        a.position.accurate_cross(b.position)
            + (rest(a).cross(b.position) + a.position.cross(rest(b)))
    }

    /// γ, from |a×b|.
    #[inline]
    fn angle(&self, a: &Vertex<'_, N, R>, b: &Vertex<'_, N, R>, sine: N) -> N {
        let d = a.position.dot(b.position);
        let t = a.norm * b.norm + d.abs();
        if t <= N::ZERO {
            return N::ZERO; // the receiver is one of them
        }
        let tangent = sine / t;
        let half = scaled_arctangent::<DEGREE, N>(tangent * tangent) * tangent;
        let angle = half + half;
        if d < N::ZERO { N::PI - angle } else { angle }
    }
}

impl<'a, const DEGREE: usize, N: Floating, R: Root<N>> Edges<N, Vertex<'a, N, R>>
    for HalfAngle<DEGREE, N, R>
{
    type Sum = N;

    #[inline(always)]
    fn whole(&self, sum: N, from: Vertex<'a, N, R>, to: Vertex<'a, N, R>) -> N {
        let term = match self.edge(&from, &to) {
            Some(term) => term,
            None => self.wide_edge(&from, &to),
        };
        sum + term
    }

    /// γ n·c/|c| with γ of the part and c of the whole edge: close to an edge,
    /// rounding a crossing would turn the plane it spans with the receiver.
    #[inline(never)]
    fn cut(&self, sum: N, [a, b]: [Vertex<'a, N, R>; 2], [from, to]: [Vertex<'a, N, R>; 2]) -> N {
        let mut c = from.position.cross(to.position);
        let r = from.norm * to.norm;
        if c.norm_squared() < N::of(WIDE) * (r * r) {
            c = self.accurate_cross(&from, &to);
        }
        let sine = R::sqrt(c.norm_squared());
        if sine <= N::ZERO {
            return sum; // the receiver is on the edge's line
        }
        let part = R::sqrt(a.position.cross(b.position).norm_squared());
        sum + self.angle(&a, &b, part) * (self.normal.dot(c) / sine)
    }

    /// ±γ.
    #[inline(never)]
    fn cap(&self, sum: N, from: Vertex<'a, N, R>, to: Vertex<'a, N, R>) -> N {
        let signed_sine = self.normal.dot(from.position.cross(to.position));
        let sine = signed_sine.abs();
        let angle = self.angle(&from, &to, sine);
        let near_180 = from.position.dot(to.position) < N::ZERO
            && sine < N::of(1.0 / 256.0) * from.norm * to.norm;
        let sign = if near_180 {
            let along = self.facing.cross(self.normal);
            along.dot(to.position - from.position)
        } else {
            signed_sine
        };
        if sign < N::ZERO {
            sum - angle
        } else {
            sum + angle
        }
    }
}

impl<const DEGREE: usize, N: Floating, R: Root<N> + Copy> HalfAngle<DEGREE, N, R> {
    #[inline(always)]
    fn vertex<'a>(&self, vertex: &'a [N; 3]) -> Vertex<'a, N, R> {
        let position = Vector::from(*vertex) - self.place;
        Vertex::new(position, self.normal.dot(position), vertex)
    }

    /// The sum over a loop that is wholly above the horizon and has no edge
    /// towards 180°; `None` otherwise. Nothing is called and nothing spills.
    #[inline(always)]
    fn plain(&self, vertices: &[[N; 3]]) -> Option<N> {
        let above = |vertex| {
            let vertex = self.vertex(vertex);
            (vertex.height >= N::ZERO).then_some(vertex)
        };
        let mut vertices = vertices.iter();
        let Some(first) = vertices.next() else {
            return Some(N::ZERO);
        };
        let first = above(first)?;
        let (mut sum, mut from) = (N::ZERO, first);
        for vertex in vertices {
            let to = above(vertex)?;
            sum = sum + self.edge(&from, &to)?;
            from = to;
        }
        Some(sum + self.edge(&from, &first)?)
    }

    /// The sum over any loop.
    #[inline(never)]
    fn careful(&self, vertices: &[[N; 3]]) -> N {
        let corners = vertices.iter().map(|vertex| self.vertex(vertex));
        clip::walk(corners, self, N::ZERO)
    }
}

/// Σ γ_i n·unit(v_i × v_{i+1}) over the part of the loop above the horizon.
#[inline]
pub(super) fn contour<const DEGREE: usize, N: Floating, R: Root<N> + Copy>(
    receiver: &Receiver<N>,
    facing: Vector<N>,
    outline: &Outline<'_, N>,
) -> N {
    let half_angle = HalfAngle::<DEGREE, N, R> {
        place: receiver.position(),
        normal: receiver.normal(),
        facing,
        root: PhantomData,
    };
    match half_angle.plain(outline.vertices()) {
        Some(sum) => sum,
        None => half_angle.careful(outline.vertices()),
    }
}

/// The same over a loop that has been clipped already: its vertices relative
/// to the receiver; the edge from vertex number `cap` runs along the horizon.
#[inline]
pub(super) fn closed<const DEGREE: usize, N: Floating, R: Root<N> + Copy>(
    normal: Vector<N>,
    facing: Vector<N>,
    places: impl Iterator<Item = Vector<N>>,
    cap: Option<usize>,
) -> N {
    let half_angle = HalfAngle::<DEGREE, N, R> {
        place: Vector::ZERO,
        normal,
        facing,
        root: PhantomData,
    };
    // Rounding took nothing from places that are relative already.
    let source = [N::ZERO; 3];
    let mut vertices = places.map(|place| Vertex::new(place, N::ZERO, &source));
    let Some(first) = vertices.next() else {
        return N::ZERO;
    };
    let add = |sum, index, from, to| {
        if cap == Some(index) {
            half_angle.cap(sum, from, to)
        } else {
            half_angle.whole(sum, from, to)
        }
    };
    let (mut sum, mut from, mut index) = (N::ZERO, first, 0_usize);
    for to in vertices {
        sum = add(sum, index, from, to);
        from = to;
        index = index.wrapping_add(1);
    }
    add(sum, index, from, first)
}
