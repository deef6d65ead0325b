//! A loop summed edge by edge with Snell's quotient and exact horizon caps.
//!
//! For an edge from a to b, with c = a×b, d = a·b, t = 2|a||b| + |d| and
//! x = |d|/t,
//!
//! ```text
//! γ/|c| = s(x)/t              where d ≥ 0
//! γ/|c| = 1/(2|c|) − s(x)/t   where d < 0
//! ```
//!
//! with γ in turns and s of [`turn_over_sine`], so that the edge's term γ n·c/|c| needs one
//! division and, where γ ≤ 90°, no root but those of the vertices' lengths.
//!
//! An edge that the horizon cuts keeps the part f of itself above it, and f c
//! is the cross product of that part: the whole edge's direction, which rounding
//! the crossing would turn.
//!
//! A cap runs along the horizon, where n·c/|c| is ±1 exactly, so its term is
//! its angle: computing it as an ordinary edge would cost up to 5e-3 where the
//! emitter's plane passes close by the receiver. The sign is that of n·c; where
//! the cap is seen under nearly 180° and n·c drowns in rounding, it is that of
//! the cap's direction along the line in which the emitter's plane meets the
//! horizon: for a receiver in front of the emitter, n·(a×b) has the sign of
//! (b − a)·(m×n), m being the emitter's normal (take a as the line's point
//! nearest to the receiver: m·a < 0 and n·(a×(m×n)) = −m·a).

mod tracked;

use super::Outline;
use super::tally::Tally;
use crate::clip::{self, Edges};
use crate::geometry::{Receiver, Vector};
use crate::number::{Floating, Number, Root, turn_over_sine};
use core::marker::PhantomData;
use tracked::{Tracked, View};

/// Squared sine below which an edge past 90° is summed with care: beyond 165°,
/// rounding c would cost more than 2.5e-7.
const WIDE: f64 = 1.0 / 16.0;

/// Half a turn, exactly: π would be rounded.
const HALF: f64 = 0.5;

/// A vertex relative to the receiver.
#[derive(Clone, Copy)]
struct Vertex<N, R> {
    position: Vector<N>,
    height: N,
    norm: N,
    root: PhantomData<R>,
}

impl<N: Floating, R: Root<N> + Copy> Vertex<N, R> {
    #[inline(always)]
    fn new(vertex: &[N; 3], receiver: &Receiver<N>) -> Self {
        let position = Vector::from(*vertex) - receiver.position();
        Self::at(position, receiver.normal().dot(position))
    }

    #[inline(always)]
    fn at(position: Vector<N>, height: N) -> Self {
        Self {
            position,
            height,
            norm: R::sqrt(position.norm_squared()),
            root: PhantomData,
        }
    }

    /// What an edge that begins here takes of it: its place and twice its
    /// distance.
    #[inline(always)]
    fn from(&self) -> (Vector<N>, N) {
        (self.position, self.norm + self.norm)
    }
}

/// How a loop is summed.
struct Snell<const DEGREE: usize>;

/// The angle between two vectors, in turns, over its sine times their lengths; past 90°,
/// that of the supplement. `twice` = 2|a||b|, `d` = |a·b|.
#[cfg_attr(feature = "small", inline(never))]
#[cfg_attr(not(feature = "small"), inline(always))]
fn per_sine<const DEGREE: usize, N: Number>(twice: N, d: N) -> N {
    let inverse = N::ONE / (twice + d);
    turn_over_sine::<DEGREE, N>(d * inverse) * inverse
}

/// γ of two vertices in turns, from |a×b|.
#[cfg_attr(feature = "small", inline(never))]
#[cfg_attr(not(feature = "small"), inline)]
fn angle<const DEGREE: usize, N: Floating, R>(a: &Vertex<N, R>, b: &Vertex<N, R>, sine: N) -> N {
    let (d, r) = (a.position.dot(b.position), a.norm * b.norm);
    if r <= N::ZERO {
        return N::ZERO; // the receiver is one of them
    }
    let acute = per_sine::<DEGREE, N>(r + r, d.abs()) * sine;
    if d < N::ZERO {
        N::of(HALF) - acute
    } else {
        acute
    }
}

/// γ n·c/|c| of an edge above the horizon, or `None` where it is seen under
/// nearly 180°. `twice` = 2|a|.
#[cfg_attr(feature = "small", inline(never))]
#[cfg_attr(not(feature = "small"), inline(always))]
fn plain_term<const DEGREE: usize, N: Floating, R: Root<N>>(
    normal: Vector<N>,
    (a, twice): (Vector<N>, N),
    b: &Vertex<N, R>,
) -> Option<N> {
    let c = a.cross(b.position);
    let d = a.dot(b.position);
    let twice = twice * b.norm;
    let along = normal.dot(c);
    if d >= N::ZERO {
        return Some(per_sine::<DEGREE, N>(twice, d) * along);
    }
    let squared = c.norm_squared();
    if squared < N::of(WIDE / 4.0) * (twice * twice) {
        return None;
    }
    Some((N::of(HALF) / R::sqrt(squared) - per_sine::<DEGREE, N>(twice, -d)) * along)
}

/// γ n·c/|c| of the part from a to b of an edge, c being the whole edge's cross
/// product and `part` c that of the part.
#[inline]
fn term<const DEGREE: usize, N: Floating, R: Root<N>>(
    [a, b]: [&Tracked<'_, N, R>; 2],
    c: Vector<N>,
    part: N,
) -> N {
    let normal = a.view.receiver.normal();
    let (a, b) = (&a.vertex, &b.vertex);
    let (d, r) = (a.position.dot(b.position), a.norm * b.norm);
    if r <= N::ZERO {
        return N::ZERO; // the receiver is one of them
    }
    let acute = per_sine::<DEGREE, N>(r + r, d.abs()) * part;
    let along = normal.dot(c);
    if d >= N::ZERO {
        acute * along
    } else {
        (N::of(HALF) / R::sqrt(c.norm_squared()) - acute) * along
    }
}

/// γ n·c/|c| of an edge that is seen under nearly 180°, or of the part of it
/// from a to b.
#[cold]
#[inline(never)]
fn wide_term<const DEGREE: usize, N: Floating, R: Root<N> + Copy>(
    [a, b]: [&Tracked<'_, N, R>; 2],
    [from, to]: [&Tracked<'_, N, R>; 2],
) -> N {
    let c = from.accurate_cross(to);
    let sine = R::sqrt(c.norm_squared());
    if sine <= N::ZERO {
        return N::ZERO; // the receiver is on the edge
    }
    let along = a.view.receiver.normal().dot(c) / sine;
    let (a, b) = (&a.vertex, &b.vertex);
    // With its sign: a crossing may be rounded to the other side of its end.
    let of_part = a.position.cross(b.position).dot(c) / sine;
    angle::<DEGREE, N, R>(a, b, of_part) * along
}

impl<'a, const DEGREE: usize, N: Floating, R: Root<N> + Copy> Edges<N, Tracked<'a, N, R>>
    for Snell<DEGREE>
{
    type Sum = Tally<DEGREE, N>;

    #[inline(always)]
    fn whole(
        &self,
        sum: Tally<DEGREE, N>,
        from: Tracked<'a, N, R>,
        to: Tracked<'a, N, R>,
    ) -> Tally<DEGREE, N> {
        let normal = from.view.receiver.normal();
        sum.plus(
            match plain_term::<DEGREE, N, R>(normal, from.vertex.from(), &to.vertex) {
                Some(term) => term,
                None => wide_term::<DEGREE, N, R>([&from, &to], [&from, &to]),
            },
        )
    }

    /// γ n·c/|c| with γ of the part and c of the whole edge: close to an edge,
    /// rounding a crossing would turn the plane it spans with the receiver.
    #[cfg_attr(feature = "small", inline(never))]
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn cut(
        &self,
        sum: Tally<DEGREE, N>,
        [a, b]: [Tracked<'a, N, R>; 2],
        [from, to]: [Tracked<'a, N, R>; 2],
    ) -> Tally<DEGREE, N> {
        let (c, wide) = from.cross(&to);
        sum.plus(if wide {
            wide_term::<DEGREE, N, R>([&a, &b], [&from, &to])
        } else {
            // At most one of them is a crossing.
            term::<DEGREE, N, R>([&a, &b], c, a.part * b.part)
        })
    }

    /// ±γ.
    #[inline(never)]
    fn cap(
        &self,
        sum: Tally<DEGREE, N>,
        from: Tracked<'a, N, R>,
        to: Tracked<'a, N, R>,
    ) -> Tally<DEGREE, N> {
        let View { receiver, facing } = *from.view;
        let (normal, a, b) = (receiver.normal(), &from.vertex, &to.vertex);
        let mut sign = normal.dot(a.position.cross(b.position));
        let sine = sign.abs();
        let angle = angle::<DEGREE, N, R>(a, b, sine);
        let obtuse = a.position.dot(b.position) < N::ZERO;
        if obtuse && sine < N::of(1.0 / 256.0) * (a.norm * b.norm) {
            sign = facing.cross(normal).dot(b.position - a.position);
        }
        sum.plus(if sign < N::ZERO { -angle } else { angle })
    }
}

/// The sum over a loop. As long as it is above the horizon and has no edge
/// towards 180°, nothing is called and nothing spills; from the first vertex or
/// edge that is otherwise, the rest is summed with care.
#[inline(always)]
fn sum<const DEGREE: usize, N: Floating, R: Root<N> + Copy>(
    receiver: &Receiver<N>,
    facing: Vector<N>,
    vertices: &[[N; 3]],
) -> N {
    let Some((first, others)) = vertices.split_first() else {
        return N::ZERO;
    };
    let normal = receiver.normal();
    let first = Vertex::<N, R>::new(first, receiver);
    let (mut sum, mut from, mut ahead) = (Tally::<DEGREE, N>::ZERO, first.from(), others.iter());
    let mut left = others.len();
    if first.height >= N::ZERO {
        left = loop {
            let Some(next) = ahead.next() else {
                match plain_term::<DEGREE, N, R>(normal, from, &first) {
                    Some(term) => return sum.total(term),
                    None => break 0,
                }
            };
            let to = Vertex::new(next, receiver);
            let term = if to.height >= N::ZERO {
                plain_term::<DEGREE, N, R>(normal, from, &to)
            } else {
                None
            };
            let Some(term) = term else {
                break ahead.len().wrapping_add(1);
            };
            (sum, from) = (sum.plus(term), to.from());
        };
    }
    rest::<DEGREE, N, R>(receiver, facing, vertices, left, sum)
}

/// The sum of a loop from the vertex on behind which `left` others are to come.
#[cold]
#[inline(never)]
pub(super) fn rest<const DEGREE: usize, N: Floating, R: Root<N> + Copy>(
    receiver: &Receiver<N>,
    facing: Vector<N>,
    vertices: &[[N; 3]],
    left: usize,
    sum: Tally<DEGREE, N>,
) -> N {
    let (done, ahead) = vertices
        .split_at_checked(vertices.len().wrapping_sub(left))
        .unwrap_or_default();
    let (Some(first), Some(from)) = (done.first(), done.last()) else {
        return sum.sum();
    };
    let view = View { receiver, facing };
    let tracked = |vertex| Tracked::<N, R>::new(vertex, &view);
    let (first, from) = (tracked(first), tracked(from));
    clip::walk_on(
        first,
        from,
        ahead.iter().map(tracked),
        &Snell::<DEGREE>,
        sum,
    )
    .sum()
}

/// Σ γ_i n·unit(v_i × v_{i+1}) in turns over the part of the loop above the
/// horizon.
#[inline]
pub(super) fn contour<const DEGREE: usize, N: Floating, R: Root<N> + Copy>(
    receiver: &Receiver<N>,
    facing: Vector<N>,
    outline: &Outline<'_, N>,
) -> N {
    sum::<DEGREE, N, R>(receiver, facing, outline.vertices())
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
    let receiver = Receiver::of_unit(Vector::ZERO, normal);
    let receiver = &receiver;
    let view = View { receiver, facing };
    // Rounding took nothing from places that are relative already.
    let source = [N::ZERO; 3];
    let mut vertices = places.map(|place| Tracked::<N, R> {
        vertex: Vertex::at(place, N::ZERO),
        part: N::ONE,
        source: &source,
        view: &view,
    });
    let Some(first) = vertices.next() else {
        return N::ZERO;
    };
    let snell = Snell::<DEGREE>;
    let add = |sum, index, from, to| {
        if cap == Some(index) {
            snell.cap(sum, from, to)
        } else {
            snell.whole(sum, from, to)
        }
    };
    let (mut sum, mut from, mut index) = (Tally::ZERO, first, 0_usize);
    for to in vertices {
        sum = add(sum, index, from, to);
        from = to;
        index = index.wrapping_add(1);
    }
    add(sum, index, from, first).sum()
}
