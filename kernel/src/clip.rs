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

/// What is done with the edges of the part inside.
pub trait Edges<N, C> {
    /// An edge of the polygon that lies wholly inside.
    fn whole(&mut self, from: &C, to: &C);

    /// The inner part of an edge that crosses the boundary.
    fn cut(&mut self, from: &C, to: &C);

    /// An edge along the boundary, from where the loop left to where it comes
    /// back.
    fn cap(&mut self, from: &C, to: &C);
}

/// Walks round a loop and hands over the edges of its part with height ≥ 0.
///
/// The loop may be any polygon, convex or not: the part inside may then be
/// several pieces, which come connected by caps that run to and fro along the
/// boundary and cancel (Sutherland & Hodgman 1974). No edge comes out of a
/// loop with fewer than two corners. One pass, no buffer. Never panics.
#[inline(always)]
pub fn walk<N: Number, C: Corner<N>>(
    corners: impl Iterator<Item = C>,
    edges: &mut impl Edges<N, C>,
) {
    let mut corners = corners;
    let Some(first) = corners.next() else { return };
    let mut from = first;
    let mut left: Option<C> = None;
    let mut entered_first: Option<C> = None;
    let mut closing = false;
    while !closing {
        let to = match corners.next() {
            Some(corner) => corner,
            None => {
                closing = true;
                first
            }
        };
        match (from.height() >= N::ZERO, to.height() >= N::ZERO) {
            (true, true) => edges.whole(&from, &to),
            (true, false) => {
                let exit = crossing(&from, &to);
                edges.cut(&from, &exit);
                left = Some(exit);
            }
            (false, true) => {
                let entry = crossing(&to, &from);
                match left.take() {
                    Some(exit) => edges.cap(&exit, &entry),
                    None => entered_first = Some(entry),
                }
                edges.cut(&entry, &to);
            }
            (false, false) => {}
        }
        from = to;
    }
    if let (Some(exit), Some(entry)) = (left, entered_first) {
        edges.cap(&exit, &entry);
    }
}

/// Where the edge from an inner to an outer corner crosses the boundary.
#[inline]
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

struct Collector<'a, N, const CAPACITY: usize> {
    corners: &'a mut Corners<N, CAPACITY>,
    dropped: u32,
}

impl<N: Number, const CAPACITY: usize> Collector<'_, N, CAPACITY> {
    fn start(&mut self, corner: &Place<N>) {
        if self.corners.push(*corner).is_err() {
            self.dropped = self.dropped.saturating_add(1);
        }
    }
}

impl<N: Number, const CAPACITY: usize> Edges<N, Place<N>> for Collector<'_, N, CAPACITY> {
    fn whole(&mut self, from: &Place<N>, _: &Place<N>) {
        self.start(from);
    }

    fn cut(&mut self, from: &Place<N>, _: &Place<N>) {
        self.start(from);
    }

    fn cap(&mut self, from: &Place<N>, _: &Place<N>) {
        self.start(from);
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
    let mut collector = Collector {
        corners: clipped,
        dropped: 0,
    };
    walk(corners, &mut collector);
    match collector.dropped {
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
