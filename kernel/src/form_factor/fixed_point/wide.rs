//! What is left of a loop from the first vertex below the horizon, or the first
//! edge seen under nearly 180°, on.
//!
//! Such an edge passes close by the receiver. The cross product of its unit vectors
//! is then a small difference of large products: within 2 units in the last place
//! over sin γ of the edge's direction, which at 1e-7 of the distance is nothing.
//! But the differences of the integers are exact and so is their cross product, of
//! up to 120 bits; it gives the plane that the edge spans with the receiver, and
//! where that plane meets the horizon.

use super::contour::{Snell, Vertex, cross, half_angle, narrow, words};
use super::direction::{difference, dot, exact, unit};
use super::{Coordinate, Format, Receiver};
use crate::clip::{self, Corner, Edges};
use crate::geometry::Vector;

/// A vertex of a loop that is summed with care.
#[derive(Clone, Copy)]
pub(super) struct Tracked<'a, F, C> {
    vertex: Vertex<F>,
    /// The vertex itself; of a crossing, one end of its edge.
    source: &'a [C; 3],
    receiver: &'a Receiver<F>,
}

impl<F: Format, C: Coordinate> Tracked<'_, F, C> {
    /// The vertex less the receiver's place, exactly.
    fn place(&self) -> [i64; 3] {
        difference(self.source.map(Into::into), self.receiver.position)
    }

    /// The unit vector along the cross product with another vertex of an edge that
    /// is seen under nearly 180°; `None` of other edges. 0 where the receiver is
    /// on the edge.
    fn axis(&self, other: &Self) -> Option<Vector<F>> {
        let (a, b) = (words(self.vertex.direction), words(other.vertex.direction));
        if dot(a, b) >= 0 || !is_wide::<F>(cross(a, b)) {
            return None;
        }
        let c = exact::coarse(exact::cross(self.place(), other.place()));
        Some(unit(c.map(i64::from)))
    }

    /// Where an edge seen under nearly 180° crosses the horizon: along axis × n,
    /// with the axis of the edge from its end above it.
    ///
    /// `None` where the edge's plane is within 0.06° of the horizon: then that
    /// direction is the worse one.
    fn wide_crossing(&self, other: &Self) -> Option<Self> {
        let (inner, outer) = if self.vertex.height >= F::ZERO {
            (self, other)
        } else {
            (other, self)
        };
        let axis = inner.axis(outer)?;
        let along = cross(words(axis), words(self.receiver.normal));
        let least = 1_u64 << (2 * F::FRACTION - 10);
        let steep = along.iter().any(|along| along.unsigned_abs() > least);
        steep.then(|| Self {
            vertex: Vertex::on_horizon(unit(along)),
            ..*self
        })
    }
}

/// Whether a cross product of two unit vectors more than 90° apart says that they
/// are nearly 180° apart: none of its coordinates is 1/4.
#[inline(always)]
pub(super) fn is_wide<F: Format>(c: [i64; 3]) -> bool {
    let least = 1_u64 << (2 * F::FRACTION - 2);
    c.iter().all(|along| along.unsigned_abs() < least)
}

impl<F: Format, C: Coordinate> Corner<F> for Tracked<'_, F, C> {
    fn height(&self) -> F {
        self.vertex.height
    }

    fn farness(&self) -> F {
        self.vertex.farness()
    }

    #[cfg_attr(feature = "small", inline(never))]
    fn toward(&self, other: &Self, t: F) -> Self {
        match self.wide_crossing(other) {
            Some(crossing) => crossing,
            None => Self {
                vertex: self.vertex.toward(&other.vertex, t),
                ..*self
            },
        }
    }
}

impl<'a, F: Format, C: Coordinate> Edges<F, Tracked<'a, F, C>> for Snell<'_, F> {
    type Sum = i64;

    fn whole(&self, sum: i64, from: Tracked<'a, F, C>, to: Tracked<'a, F, C>) -> i64 {
        self.cut(sum, [from, to], [from, to])
    }

    #[inline(never)]
    fn cut(
        &self,
        sum: i64,
        [a, b]: [Tracked<'a, F, C>; 2],
        [from, to]: [Tracked<'a, F, C>; 2],
    ) -> i64 {
        let Some(axis) = from.axis(&to) else {
            return sum.wrapping_add(self.any_edge(a.vertex, b.vertex));
        };
        let (axis, normal) = (words(axis), words(self.normal));
        let (a, b) = (words(a.vertex.direction), words(b.vertex.direction));
        let sine = dot(axis, cross(a, b).map(narrow::<F>)).unsigned_abs();
        let half = half_angle::<F>((sine >> (2 * F::FRACTION - 30)) as u32, dot(a, b));
        let along = narrow::<F>(dot(normal, axis));
        sum.wrapping_add(i64::from(along).wrapping_mul(i64::from(half)))
    }

    fn cap(&self, sum: i64, from: Tracked<'a, F, C>, to: Tracked<'a, F, C>) -> i64 {
        self.along_horizon(sum, from.vertex, to.vertex)
    }
}

/// Half the sum of a loop that began at `first` and has come to `from`, behind which
/// `left` others are to come, in units of 2^(−2 `F::FRACTION`).
#[cold]
#[inline(never)]
pub(super) fn rest<F: Format, C: Coordinate>(
    receiver: &Receiver<F>,
    edges: &Snell<'_, F>,
    outline: &[[C; 3]],
    [first, from]: [Vertex<F>; 2],
    left: usize,
    sum: i64,
) -> i64 {
    let (done, ahead) = outline
        .split_at_checked(outline.len().wrapping_sub(left))
        .unwrap_or_default();
    let (Some(source), Some(last)) = (done.first(), done.last()) else {
        return sum;
    };
    let tracked = |vertex, source| Tracked {
        vertex,
        source,
        receiver,
    };
    let ahead = ahead
        .iter()
        .map(|source| tracked(Vertex::new(receiver, source), source));
    clip::walk_on(
        tracked(first, source),
        tracked(from, last),
        ahead,
        edges,
        sum,
    )
}
