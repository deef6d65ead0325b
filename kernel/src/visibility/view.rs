//! An emitter and what may hide it, from where a receiver is.
//!
//! What cannot hide anything is left out as early as possible, without a root
//! or a division; what may becomes lines in the emitter's plane.

use super::line::{Line, plane_through};
use super::records::{Blocker, Face, Occluder, Occluders, Target};
use crate::form_factor::SeenPlane;
use crate::geometry::{Receiver, Vector};
use crate::number::Floating;

/// An emitter as a receiver sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct View<N> {
    pub(super) seen: SeenPlane<N>,
    place: Vector<N>,
    flat: N,
    /// Centre of the emitter's sphere relative to the receiver.
    axis: Vector<N>,
    radius: N,
    axis_squared: N,
    /// |axis|² − radius²: positive where the receiver is outside the sphere.
    outside: N,
}

/// What an occluder hides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shadow {
    /// Nothing.
    None,
    /// What is inside of all lines that were handed over.
    Lines,
    /// Everything: the receiver is inside of it.
    All,
}

/// A number of the tables.
#[inline(always)]
pub(super) fn number<N: Floating>(x: f32) -> N {
    N::of(f64::from(x))
}

/// A vector of the tables.
#[inline(always)]
fn vector<N: Floating>(v: [f32; 3]) -> Vector<N> {
    Vector::from(v.map(number))
}

impl<N: Floating> View<N> {
    /// `None` where the receiver is on or behind the emitter's plane.
    pub(super) fn new(receiver: &Receiver<N>, target: &Target<'_>, flat: f32) -> Option<Self> {
        let axis = vector(target.origin) - receiver.position();
        let facing: Vector<N> = vector(target.normal);
        let in_front = facing.dot(axis) < N::ZERO;
        if !in_front {
            return None;
        }
        let radius = number(target.radius);
        let axis_squared = axis.norm_squared();
        Some(Self {
            seen: SeenPlane {
                origin: axis,
                axes: target.axes.map(vector),
                facing,
                normal: receiver.normal(),
            },
            place: receiver.position(),
            flat: number(flat),
            axis,
            radius,
            axis_squared,
            outside: axis_squared - radius * radius,
        })
    }

    /// The receiver's horizon.
    pub(super) fn horizon(&self) -> Line<N> {
        Line::of_half_space(self.seen.normal, &self.seen)
    }

    /// Whether an occluder's sphere is below the horizon, or outside of the
    /// cone from the receiver round the emitter's sphere.
    ///
    /// With C, r the occluder's sphere and a, R the emitter's, it is outside
    /// where the distance from the axis times cos α exceeds r plus the distance
    /// along it times sin α, sin α = R/|a|; all of it times |a|², squared.
    /// Lengths below 1e6 m: the products are of degree 6.
    #[cfg_attr(feature = "small", inline(never))]
    #[cfg_attr(not(feature = "small"), inline)]
    fn misses(&self, occluder: &Occluder) -> bool {
        let centre: Vector<N> = vector::<N>(occluder.centre) - self.place;
        let radius: N = number(occluder.radius);
        if self.seen.normal.dot(centre) + radius < N::ZERO {
            return true;
        }
        if self.outside <= N::ZERO {
            return false;
        }
        let along = centre.dot(self.axis);
        let reach = radius * self.axis_squared + along * self.radius;
        let off = centre.norm_squared() * self.axis_squared - along * along;
        reach < N::ZERO || off * self.outside > reach * reach * N::of(1.0001)
    }

    /// The signed distance of the receiver from a face's plane.
    #[inline(always)]
    fn height_over(&self, face: &Face) -> N {
        vector::<N>(face.normal).dot(self.place) - number(face.offset)
    }

    /// Hands over the lines inside of which a blocker hides the emitter, until
    /// `each` says that enough is known.
    #[inline]
    pub(super) fn shadow(
        &self,
        occluders: &Occluders<'_>,
        blocker: &Blocker,
        each: impl FnMut(&Line<N>) -> bool,
    ) -> Shadow {
        let Some(occluder) = occluders.occluders.get(blocker.occluder as usize) else {
            return Shadow::None;
        };
        match occluders.faces_of(occluder) {
            [] => Shadow::None,
            [face] => self.of_polygon(occluders, occluder, face, blocker.clear, each),
            faces => self.of_body(occluders, occluder, faces, blocker.clear, each),
        }
    }

    #[inline]
    fn of_polygon(
        &self,
        occluders: &Occluders<'_>,
        occluder: &Occluder,
        face: &Face,
        clear: u32,
        mut each: impl FnMut(&Line<N>) -> bool,
    ) -> Shadow {
        let height = self.height_over(face);
        let in_front = height > N::ZERO;
        // A polygon hides nothing from a place on its own plane; the first
        // form of the test also turns NaN away.
        let off_plane = height.abs() > self.flat;
        let side = if in_front {
            Blocker::FRONT
        } else {
            Blocker::BACK
        };
        if !off_plane || clear & side != 0 || self.misses(occluder) {
            return Shadow::None;
        }
        for edge in occluders.edges_of(occluder) {
            let Some(ends) = occluders.ends(edge) else {
                return Shadow::None;
            };
            if !each(&self.line_of_edge(ends, in_front)) {
                return Shadow::Lines;
            }
        }
        Shadow::Lines
    }

    /// A body's outline is made of the edges between a face that is turned to
    /// the receiver and one that is not. Where none is, the receiver is on the
    /// body, which hides what is behind the faces it is on, or inside of it.
    #[inline]
    fn of_body(
        &self,
        occluders: &Occluders<'_>,
        occluder: &Occluder,
        faces: &[Face],
        clear: u32,
        mut each: impl FnMut(&Line<N>) -> bool,
    ) -> Shadow {
        if self.misses(occluder) {
            return Shadow::None;
        }
        let (mut front, mut on) = (0_u32, 0_u32);
        let mut bit = 1_u32;
        for face in faces {
            let height = self.height_over(face);
            if height > self.flat {
                if clear & bit != 0 {
                    return Shadow::None;
                }
                front |= bit;
            } else if height >= -self.flat {
                on |= bit;
            }
            bit = bit.wrapping_shl(1);
        }
        if front == 0 {
            return self.behind_faces(faces, on, each);
        }
        for edge in occluders.edges_of(occluder) {
            let turned = |face: u16| front.wrapping_shr(u32::from(face)) & 1 != 0;
            let left = turned(edge.left);
            if left == turned(edge.right) {
                continue;
            }
            let Some(ends) = occluders.ends(edge) else {
                return Shadow::None;
            };
            if !each(&self.line_of_edge(ends, left)) {
                return Shadow::Lines;
            }
        }
        Shadow::Lines
    }

    /// What a body hides from a receiver on some of its faces.
    fn behind_faces(
        &self,
        faces: &[Face],
        on: u32,
        mut each: impl FnMut(&Line<N>) -> bool,
    ) -> Shadow {
        if on == 0 {
            return Shadow::All;
        }
        let mut rest = on;
        for face in faces {
            if rest & 1 != 0 {
                let inwards = Vector::ZERO - vector(face.normal);
                if !each(&Line::of_half_space(inwards, &self.seen)) {
                    break;
                }
            }
            rest = rest.wrapping_shr(1);
        }
        Shadow::Lines
    }

    /// The line of the plane through the receiver and an edge that runs
    /// counter-clockwise or clockwise round what hides, seen from the receiver.
    #[cfg_attr(feature = "small", inline(never))]
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn line_of_edge(&self, (a, b): ([f32; 3], [f32; 3]), counter_clockwise: bool) -> Line<N> {
        let (a, b): (Vector<N>, Vector<N>) = (vector(a), vector(b));
        let h = plane_through(a - self.place, b - self.place, b - a);
        let inwards = if counter_clockwise {
            Vector::ZERO - h
        } else {
            h
        };
        Line::of_half_space(inwards, &self.seen)
    }
}
