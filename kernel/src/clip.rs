//! A polygon against a half-space.
//!
//! Every clip is one walk round the loop ([`walk`]): it hands over the edges of
//! the part inside, in order, as it finds them, so that a contour integral
//! needs no buffer at all. Where a polygon is wanted, [`polygon`] collects the
//! same walk into a buffer whose capacity is in its type.
//!
//! Where an edge crosses the boundary, the crossing is computed from the
//! endpoint nearer to the origin of the corners' coordinates. From the farther
//! one the crossing would carry that endpoint's rounding: form factors near a
//! vertex lose up to 2e-2 by it, against 1e-7 here.

use crate::Error;
use crate::error::What;
use crate::number::Number;
use core::marker::PhantomData;

/// A vertex on its way through a clip, with whatever its consumer wants to
/// carry along.
pub trait Corner<N: Number>: Copy {
    /// Signed distance from the boundary, in any unit: inside where ≥ 0.
    fn height(&self) -> N;

    /// Any increasing function of the distance from the origin of the
    /// coordinates, for choosing the endpoint a crossing is computed from.
    fn farness(&self) -> N;

    /// The corner at `self + t (other − self)`, 0 ≤ t ≤ 1, which lies on the
    /// boundary.
    fn toward(&self, other: &Self, t: N) -> Self;
}

/// What is done with the edges of the part inside: a fold over them.
///
/// Corners and sums go by value, so that those of the common case, a loop that
/// is wholly inside, stay in registers.
pub trait Edges<N, C> {
    /// What the edges add up to.
    type Sum;

    /// An edge of the polygon that lies wholly inside.
    fn whole(&self, sum: Self::Sum, from: C, to: C) -> Self::Sum;

    /// The inner part of an edge that crosses the boundary, and the whole edge:
    /// a crossing is rounded, so the edge's direction is better had from the
    /// whole.
    fn cut(&self, sum: Self::Sum, part: [C; 2], whole: [C; 2]) -> Self::Sum;

    /// An edge along the boundary, from where the loop left to where it comes
    /// back.
    fn cap(&self, sum: Self::Sum, from: C, to: C) -> Self::Sum;
}

/// Walks round a loop and folds the edges of its part with height ≥ 0.
///
/// The loop may be any polygon, convex or not: the part inside may then be
/// several pieces, which come connected by caps that run to and fro along the
/// boundary and cancel (Sutherland & Hodgman 1974). No edge comes out of a
/// loop with fewer than two corners. One pass, no buffer. Never panics.
#[inline(always)]
pub fn walk<N: Number, C: Corner<N>, E: Edges<N, C>>(
    corners: impl Iterator<Item = C>,
    edges: &E,
    sum: E::Sum,
) -> E::Sum {
    let mut corners = corners;
    match corners.next() {
        Some(first) => walk_on(first, first, corners, edges, sum),
        None => sum,
    }
}

/// The rest of a [`walk`] that began at `first` and has come to `from` without
/// leaving the part inside; `corners` are those behind `from`.
#[inline(always)]
pub(crate) fn walk_on<N: Number, C: Corner<N>, E: Edges<N, C>>(
    first: C,
    from: C,
    corners: impl Iterator<Item = C>,
    edges: &E,
    sum: E::Sum,
) -> E::Sum {
    let (mut corners, mut sum) = (corners, sum);
    let mut gap = Gap::default();
    let mut from = from;
    loop {
        let next = corners.next();
        let to = next.unwrap_or(first);
        let (from_inside, to_inside) = (from.height() >= N::ZERO, to.height() >= N::ZERO);
        if from_inside && to_inside {
            sum = edges.whole(sum, from, to);
        } else if from_inside || to_inside {
            sum = gap.cross(edges, sum, from, to);
        }
        if next.is_none() {
            return gap.close(edges, sum);
        }
        from = to;
    }
}

/// Where a loop has been outside.
struct Gap<C> {
    /// Where it left and has not come back yet.
    left: Option<C>,
    /// Where it came in without having left: it began outside.
    entered: Option<C>,
}

impl<C> Default for Gap<C> {
    fn default() -> Self {
        Self {
            left: None,
            entered: None,
        }
    }
}

impl<C> Gap<C> {
    /// An edge that crosses the boundary.
    #[cold]
    #[inline(never)]
    fn cross<N: Number, E: Edges<N, C>>(&mut self, edges: &E, sum: E::Sum, from: C, to: C) -> E::Sum
    where
        C: Corner<N>,
    {
        if from.height() >= N::ZERO {
            let exit = crossing(&from, &to);
            self.left = Some(exit);
            edges.cut(sum, [from, exit], [from, to])
        } else {
            let entry = crossing(&to, &from);
            let sum = match self.left.take() {
                Some(exit) => edges.cap(sum, exit, entry),
                None => {
                    self.entered = Some(entry);
                    sum
                }
            };
            edges.cut(sum, [entry, to], [from, to])
        }
    }

    /// The cap of a loop that began outside.
    #[inline]
    fn close<N, E: Edges<N, C>>(self, edges: &E, sum: E::Sum) -> E::Sum {
        match (self.left, self.entered) {
            (Some(exit), Some(entry)) => edges.cap(sum, exit, entry),
            _ => sum,
        }
    }
}

/// Where the edge from an inner to an outer corner crosses the boundary.
#[cfg_attr(feature = "small", inline(never))]
#[cfg_attr(not(feature = "small"), inline)]
fn crossing<N: Number, C: Corner<N>>(inner: &C, outer: &C) -> C {
    let (inner_height, outer_height) = (inner.height(), outer.height());
    let drop = inner_height - outer_height;
    if inner.farness() <= outer.farness() {
        inner.toward(outer, inner_height / drop)
    } else {
        outer.toward(inner, -outer_height / drop)
    }
}

/// Corners that a convex polygon of `n` corners can have after one clip.
pub const fn convex_capacity(n: usize) -> usize {
    n + 1
}

/// Corners that any simple polygon of `n` corners can have after one clip:
/// a zigzag crosses the boundary with every edge and keeps every other corner,
/// so n/2 corners stay and n crossings join them.
pub const fn simple_capacity(n: usize) -> usize {
    n + n / 2
}

/// A corner with nothing but its place and its height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place<N> {
    /// Coordinates in metres, relative to the place the clip is seen from.
    pub position: crate::geometry::Vector<N>,
    /// Signed distance from the boundary.
    pub height: N,
}

impl<N: Number> Corner<N> for Place<N> {
    #[inline]
    fn height(&self) -> N {
        self.height
    }

    #[inline]
    fn farness(&self) -> N {
        self.position.norm_squared()
    }

    #[inline]
    fn toward(&self, other: &Self, t: N) -> Self {
        Self {
            position: self.position + (other.position - self.position) * t,
            height: N::ZERO,
        }
    }
}

/// Corners of a clipped polygon, at most `CAPACITY`.
pub type Corners<N, const CAPACITY: usize> = heapless::Vec<Place<N>, CAPACITY>;

/// Collects the first corner of every edge into a buffer and counts those that
/// do not fit.
struct Collector<'a, const CAPACITY: usize>(PhantomData<&'a ()>);

/// The buffer, and how many corners did not fit.
type Collected<'a, N, const CAPACITY: usize> = (&'a mut Corners<N, CAPACITY>, u32);

fn collect<N: Number, const CAPACITY: usize>(
    (corners, dropped): Collected<'_, N, CAPACITY>,
    corner: Place<N>,
) -> Collected<'_, N, CAPACITY> {
    let dropped = match corners.push(corner) {
        Ok(()) => dropped,
        Err(_) => dropped.saturating_add(1),
    };
    (corners, dropped)
}

impl<'a, N: Number + 'a, const CAPACITY: usize> Edges<N, Place<N>> for Collector<'a, CAPACITY> {
    type Sum = Collected<'a, N, CAPACITY>;

    fn whole(&self, sum: Self::Sum, from: Place<N>, _: Place<N>) -> Self::Sum {
        collect(sum, from)
    }

    fn cut(&self, sum: Self::Sum, [from, _]: [Place<N>; 2], _: [Place<N>; 2]) -> Self::Sum {
        collect(sum, from)
    }

    fn cap(&self, sum: Self::Sum, from: Place<N>, _: Place<N>) -> Self::Sum {
        collect(sum, from)
    }
}

/// The part of a polygon with height ≥ 0, written to `clipped` in order.
///
/// `corners` are the polygon's corners with their heights; `clipped` is
/// emptied first, never zero-filled. An empty result means that nothing is
/// inside. At most [`convex_capacity`] corners for a convex polygon,
/// [`simple_capacity`] for any simple one. Never panics.
///
/// # Errors
/// [`Error::Capacity`] where the part has more than `CAPACITY` corners; what
/// `clipped` then holds is no polygon.
pub fn polygon<N: Number, const CAPACITY: usize>(
    corners: impl Iterator<Item = Place<N>>,
    clipped: &mut Corners<N, CAPACITY>,
) -> Result<(), Error> {
    clipped.clear();
    let (_, dropped) = walk(corners, &Collector(PhantomData), (clipped, 0));
    match dropped {
        0 => Ok(()),
        dropped => Err(Error::Capacity {
            what: What::Corners,
            needed: dropped.saturating_add(CAPACITY as u32),
            have: CAPACITY as u32,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector;

    /// Corners in the plane z = 0, inside where y ≥ 0.
    fn corners(points: &[[f64; 2]]) -> impl Iterator<Item = Place<f64>> + '_ {
        points.iter().map(|&[x, y]| Place {
            position: Vector { x, y, z: 0.0 },
            height: y,
        })
    }

    fn area<const CAPACITY: usize>(corners: &Corners<f64, CAPACITY>) -> f64 {
        let mut twice = 0.0;
        for (index, a) in corners.iter().enumerate() {
            let b = corners.get(index + 1).unwrap_or(&corners[0]);
            twice += a.position.x * b.position.y - a.position.y * b.position.x;
        }
        twice / 2.0
    }

    #[test]
    fn a_square_keeps_its_upper_half() {
        let mut clipped = Corners::<f64, { convex_capacity(4) }>::new();
        let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        assert_eq!(polygon(corners(&square), &mut clipped), Ok(()));
        assert_eq!(clipped.len(), 4);
        assert_eq!(area(&clipped), 2.0);
    }

    #[test]
    fn a_cut_corner_makes_one_corner_more() {
        let mut clipped = Corners::<f64, { convex_capacity(3) }>::new();
        let triangle = [[0.0, -1.0], [2.0, 1.0], [-2.0, 1.0]];
        assert_eq!(polygon(corners(&triangle), &mut clipped), Ok(()));
        assert_eq!(clipped.len(), 4);
        assert_eq!(area(&clipped), 3.0);
    }

    #[test]
    fn a_zigzag_needs_three_halves_and_says_so() {
        // Teeth up and down: every edge crosses y = 0.
        let zigzag = [
            [0.0, -1.0],
            [1.0, 1.0],
            [2.0, -1.0],
            [3.0, 1.0],
            [4.0, -1.0],
            [2.0, 3.0],
        ];
        let mut clipped = Corners::<f64, { simple_capacity(6) }>::new();
        assert_eq!(polygon(corners(&zigzag), &mut clipped), Ok(()));
        assert_eq!(clipped.len(), 9);
        let mut short = Corners::<f64, 7>::new();
        assert_eq!(
            polygon(corners(&zigzag), &mut short),
            Err(Error::Capacity {
                what: What::Corners,
                needed: 9,
                have: 7
            })
        );
    }

    #[test]
    fn what_lies_outside_leaves_nothing() {
        let mut clipped = Corners::<f64, 8>::new();
        assert_eq!(
            polygon(
                corners(&[[0.0, -1.0], [1.0, -1.0], [0.0, -2.0]]),
                &mut clipped
            ),
            Ok(())
        );
        assert!(clipped.is_empty());
        assert_eq!(polygon(corners(&[]), &mut clipped), Ok(()));
        assert!(clipped.is_empty());
    }
}
