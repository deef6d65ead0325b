//! The records of occlusion, as they lie in tables.
//!
//! Every record is made of 4-byte words or pairs of 2-byte ones, without
//! padding. Indices that point nowhere are read as "nothing there": they hide
//! no light and cause no panic; whoever loads tables checks them once.

use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// A convex polygon, or a closed convex body, that hides what is behind it.
///
/// With one face it is a polygon, which blocks from both sides; with more it is
/// a body.
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Occluder {
    /// Centre of a sphere that holds it, in metres.
    pub centre: [f32; 3],
    /// Radius of that sphere in metres, rounded up.
    pub radius: f32,
    /// Where its faces begin.
    pub first_face: u32,
    /// How many faces it has: 1, or 4 to [`FACES`].
    pub faces: u32,
    /// Where its edges begin.
    pub first_edge: u32,
    /// How many edges it has.
    pub edges: u32,
}

/// The most faces of a body: one bit each in [`Blocker::clear`].
pub const FACES: usize = 32;

/// The plane of a face: normal·x = offset, its front (the outside of a body)
/// where normal·x is larger.
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Face {
    /// Unit normal.
    pub normal: [f32; 3],
    /// normal·x of the plane, in metres.
    pub offset: f32,
}

/// An edge: from `a` to `b`, with the face `left` on its left seen from
/// outside, so that the edges of a polygon run counter-clockwise seen from its
/// front.
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Edge {
    /// Where it begins: an index in [`Occluders::vertices`]. Vertices that two
    /// occluders share must have the same bits, else light leaks between them.
    pub a: u16,
    /// Where it ends.
    pub b: u16,
    /// The face on the left, counted from the first of its body.
    pub left: u16,
    /// The face on the right; of a polygon's edge, `left` again.
    pub right: u16,
}

/// An occluder that can come between an emitter and something: an entry of
/// the emitter's list.
///
/// The lists hold **no** occluder that reaches behind the emitter's plane:
/// whoever writes them cuts a polygon there and enters a body as its faces.
/// Their order is part of the answer (to 5e-7 of F): from the emitter outwards
/// is fastest.
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Blocker {
    /// An index in [`Occluders::occluders`].
    pub occluder: u32,
    /// From where it cannot block. Body: bit f is set where the emitter lies
    /// wholly in front of face f or on its plane, so that a receiver in front
    /// of it sees past the body. Polygon: [`Self::FRONT`], [`Self::BACK`].
    pub clear: u32,
}

impl Blocker {
    /// Bit of [`clear`](Self::clear) of a polygon with the emitter wholly in
    /// front of it or on its plane.
    pub const FRONT: u32 = 1;
    /// Bit of [`clear`](Self::clear) of a polygon with the emitter wholly
    /// behind it or on its plane.
    pub const BACK: u32 = 2;
}

/// All occluders of a scene, borrowed from its tables.
#[derive(Clone, Copy, Debug, Default)]
pub struct Occluders<'t> {
    /// The occluders.
    pub occluders: &'t [Occluder],
    /// Their faces.
    pub faces: &'t [Face],
    /// Their edges.
    pub edges: &'t [Edge],
    /// Their vertices, in metres.
    pub vertices: &'t [[f32; 3]],
    /// The distance in metres within which a place is on a plane: 1e-6 of the
    /// largest absolute coordinate of the scene.
    pub flat: f32,
}

impl<'t> Occluders<'t> {
    pub(super) fn faces_of(&self, occluder: &Occluder) -> &'t [Face] {
        range(self.faces, occluder.first_face, occluder.faces)
    }

    pub(super) fn edges_of(&self, occluder: &Occluder) -> &'t [Edge] {
        range(self.edges, occluder.first_edge, occluder.edges)
    }

    /// Both ends of an edge.
    #[inline(always)]
    pub(super) fn ends(&self, edge: &Edge) -> Option<([f32; 3], [f32; 3])> {
        let a = self.vertices.get(usize::from(edge.a))?;
        let b = self.vertices.get(usize::from(edge.b))?;
        Some((*a, *b))
    }
}

#[inline(always)]
fn range<T>(all: &[T], first: u32, count: u32) -> &[T] {
    all.get(first as usize..)
        .and_then(|rest| rest.get(..count as usize))
        .unwrap_or(&[])
}

/// The convex polygon of an emitter in a frame of its own.
#[derive(Clone, Copy, Debug)]
pub struct Target<'t> {
    /// Origin of the frame, in the middle of the polygon, in metres.
    pub origin: [f32; 3],
    /// Half extents along two perpendicular axes of the plane, in metres; the
    /// first × the second runs along `normal`.
    pub axes: [[f32; 3]; 2],
    /// Unit normal of the emitting side.
    pub normal: [f32; 3],
    /// Radius in metres, rounded up, of a sphere about `origin` that holds the
    /// polygon.
    pub radius: f32,
    /// Coordinates (a, b) of its corners, |a|, |b| ≤ 1, counter-clockwise seen
    /// from the emitting side: origin + a axes\[0\] + b axes\[1\].
    pub corners: &'t [[f32; 2]],
}
