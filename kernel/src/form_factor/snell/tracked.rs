//! Vertices of a loop that is summed with care, and where its edges cross the
//! horizon.

use super::{Vertex, WIDE};
use crate::clip::Corner;
use crate::geometry::{Receiver, Vector};
use crate::number::{Floating, Root};

/// What a loop is summed against.
#[derive(Clone, Copy)]
pub(super) struct View<'a, N> {
    pub(super) receiver: &'a Receiver<N>,
    pub(super) facing: Vector<N>,
}

/// A vertex of a loop that is summed with care.
#[derive(Clone, Copy)]
pub(super) struct Tracked<'a, N, R> {
    pub(super) vertex: Vertex<N, R>,
    /// 1; of a crossing, the part of its edge that is above the horizon.
    pub(super) part: N,
    /// The vertex itself, in metres; of a crossing, one end of its edge.
    pub(super) source: &'a [N; 3],
    pub(super) view: &'a View<'a, N>,
}

impl<'a, N: Floating, R: Root<N> + Copy> Tracked<'a, N, R> {
    #[cfg_attr(feature = "small", inline(never))]
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn new(source: &'a [N; 3], view: &'a View<'a, N>) -> Self {
        Self {
            vertex: Vertex::new(source, view.receiver),
            part: N::ONE,
            source,
            view,
        }
    }

    /// A crossing of the horizon.
    #[inline(always)]
    fn crossing(&self, position: Vector<N>, part: N) -> Self {
        Self {
            vertex: Vertex::at(position, N::ZERO),
            part,
            ..*self
        }
    }

    /// a×b, and whether the edge between them is seen under nearly 180°: then
    /// the receiver is close to it, and a×b is a small difference of large
    /// products.
    #[cfg_attr(feature = "small", inline(never))]
    #[cfg_attr(not(feature = "small"), inline(always))]
    pub(super) fn cross(&self, other: &Self) -> (Vector<N>, bool) {
        let (a, b) = (&self.vertex, &other.vertex);
        let c = a.position.cross(b.position);
        let r = a.norm * b.norm;
        let obtuse = a.position.dot(b.position) < N::ZERO;
        (c, obtuse && c.norm_squared() < N::of(WIDE) * (r * r))
    }

    /// a×b also where it is small: the products exact, and what rounding took
    /// from V − P put back to first order.
    #[inline(never)]
    pub(super) fn accurate_cross(&self, other: &Self) -> Vector<N> {
        let (a, b) = (self.vertex.position, other.vertex.position);
        a.accurate_cross(b) + (self.rest().cross(b) + a.cross(other.rest()))
    }

    /// What rounding took from the vertex when it was brought to the receiver.
    #[cfg_attr(feature = "small", inline(never))]
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn rest(&self) -> Vector<N> {
        Vector::from(*self.source).rest_of_difference(self.view.receiver.position())
    }

    /// Where an edge seen under nearly 180° crosses the horizon: along
    /// (a×b)×n, a being the end above it. Along the edge the place is known to
    /// u L only, which may be many times the distance to it.
    ///
    /// `None` where the edge's plane is within 0.06° of the horizon: then that
    /// direction is the worse one, and the cap takes back what either is off by.
    #[cold]
    #[inline(never)]
    fn wide_crossing(&self, other: &Self) -> Option<Self> {
        let (inner, outer) = if self.vertex.height >= N::ZERO {
            (self, other)
        } else {
            (other, self)
        };
        let scale = N::ONE / (inner.vertex.norm * outer.vertex.norm);
        let c = inner.accurate_cross(outer) * scale;
        let along = c.cross(self.view.receiver.normal());
        let steep = along.norm_squared() > N::of(1.0 / 1_048_576.0) * c.norm_squared();
        steep.then(|| self.crossing(along, N::ONE))
    }
}

impl<N: Floating, R: Root<N> + Copy> Corner<N> for Tracked<'_, N, R> {
    #[inline(always)]
    fn height(&self) -> N {
        self.vertex.height
    }

    #[inline(always)]
    fn farness(&self) -> N {
        self.vertex.norm
    }

    #[cfg_attr(feature = "small", inline(never))]
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn toward(&self, other: &Self, t: N) -> Self {
        let (_, wide) = self.cross(other);
        if wide && let Some(crossing) = self.wide_crossing(other) {
            return crossing;
        }
        let (a, b) = (self.vertex.position, other.vertex.position);
        let inside = self.vertex.height >= N::ZERO;
        self.crossing(a + (b - a) * t, if inside { t } else { N::ONE - t })
    }
}
