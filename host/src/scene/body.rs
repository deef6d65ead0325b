//! Whether named surfaces make a closed convex body.

use core::fmt;

use glam::DVec3;

use super::Surface;
use super::polygon::{PLANARITY, center, diameter};

/// Why surfaces do not make a closed convex body. Faces are indices into the
/// list that was given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyFlaw {
    /// All faces lie in one plane.
    NoVolume,
    /// This face has its front inside the body.
    InsideOut(usize),
    /// The body has parts in front of this face.
    NotConvex(usize),
    /// An edge of this face runs the same way as an edge of another.
    Overlapping(usize),
    /// An edge of this face has no neighbour, and the free edges do not lie in
    /// one plane that could close the body.
    Open(usize),
}

impl BodyFlaw {
    /// The face at which the flaw is best shown.
    pub fn face(&self) -> Option<usize> {
        match *self {
            Self::NoVolume => None,
            Self::InsideOut(face)
            | Self::NotConvex(face)
            | Self::Overlapping(face)
            | Self::Open(face) => Some(face),
        }
    }

    /// What to do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::NoVolume => "leave the body out: its surfaces occlude by themselves",
            Self::InsideOut(_) => {
                "reverse the order of the face's vertices: the fronts of a body look outwards"
            }
            Self::NotConvex(_) => {
                "split it into convex bodies, or leave the body out: its surfaces occlude by themselves"
            }
            Self::Overlapping(_) => {
                "name each face once, with its front outwards, and let faces meet only at their edges"
            }
            Self::Open(_) => {
                "add the missing faces; only faces in one plane, such as the base of a block on a floor, may be left out"
            }
        }
    }
}

impl fmt::Display for BodyFlaw {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::NoVolume => "the body has no volume",
            Self::InsideOut(_) => "the front of this face looks into its body",
            Self::NotConvex(_) => "the body is not convex: parts of it lie in front of this face",
            Self::Overlapping(_) => {
                "this face overlaps another face of its body, or faces the other way"
            }
            Self::Open(_) => "the body is not closed: an edge of this face has no neighbour",
        })
    }
}

/// Checks that `faces` are the boundary of a convex body, but for faces
/// missing in at most one plane.
///
/// `weld` in metres is the distance below which two vertices are one. A face
/// may be split (an edge of one then meets several edges of others).
pub fn check(faces: &[&Surface], weld: f64) -> Result<(), BodyFlaw> {
    let corners = weld_corners(faces, weld);
    let planar = PLANARITY * diameter(&corners);
    check_convex(faces, &corners, weld, planar)?;
    let free = free_edges(faces, &corners, weld)?;
    let Some(first) = free.first() else {
        return Ok(());
    };
    let open = BodyFlaw::Open(first.face);
    // The closing face runs against the free edges; its area vector is the
    // negative sum of theirs.
    let origin = corners[first.from];
    let doubled: DVec3 = free
        .iter()
        .map(|edge| (corners[edge.to] - origin).cross(corners[edge.from] - origin))
        .sum();
    let length = doubled.length();
    if length <= planar * planar {
        return Err(open);
    }
    let normal = doubled / length;
    let height = |corner: DVec3| (corner - origin).dot(normal);
    let flat = free
        .iter()
        .all(|edge| height(corners[edge.from]).abs() <= planar);
    if !flat || corners.iter().any(|&corner| height(corner) > planar) {
        return Err(open);
    }
    Ok(())
}

/// The different places among all vertices.
pub(crate) fn weld_corners(faces: &[&Surface], weld: f64) -> Vec<DVec3> {
    let mut corners: Vec<DVec3> = Vec::new();
    for vertex in faces.iter().flat_map(|face| &face.vertices) {
        if !corners.iter().any(|c| c.distance(*vertex) <= weld) {
            corners.push(*vertex);
        }
    }
    corners
}

/// Every corner must lie behind every face, and some corner well behind.
fn check_convex(
    faces: &[&Surface],
    corners: &[DVec3],
    weld: f64,
    planar: f64,
) -> Result<(), BodyFlaw> {
    for (index, face) in faces.iter().enumerate() {
        let on_face = center(&face.vertices);
        let mut highest = 0.0_f64;
        let mut lowest = 0.0_f64;
        for &corner in corners {
            let height = (corner - on_face).dot(face.normal);
            highest = highest.max(height);
            lowest = lowest.min(height);
        }
        // A thin plate is a body as long as it is thicker than a plane.
        let tolerance = planar.min(0.5 * lowest.abs()).max(weld);
        match (highest > tolerance, lowest < -tolerance) {
            (false, false) => return Err(BodyFlaw::NoVolume),
            (true, false) => return Err(BodyFlaw::InsideOut(index)),
            (true, true) => return Err(BodyFlaw::NotConvex(index)),
            (false, true) => {}
        }
    }
    Ok(())
}

/// A piece of a face's edge between two corners with none in between.
#[derive(Clone, Copy)]
pub(crate) struct Edge {
    pub(crate) from: usize,
    pub(crate) to: usize,
    pub(crate) face: usize,
}

/// All edges of faces, in pieces between two corners with none in between.
pub(crate) fn edges(faces: &[&Surface], corners: &[DVec3], weld: f64) -> Vec<Edge> {
    let mut edges = Vec::new();
    for (face, surface) in faces.iter().enumerate() {
        let count = surface.vertices.len();
        for i in 0..count {
            let ends = (surface.vertices[i], surface.vertices[(i + 1) % count]);
            for pair in corners_along(ends.0, ends.1, corners, weld).windows(2) {
                let (from, to) = (pair[0], pair[1]);
                edges.push(Edge { from, to, face });
            }
        }
    }
    edges
}

/// The pieces of edges that no other face runs along the other way.
pub(crate) fn free_edges(
    faces: &[&Surface],
    corners: &[DVec3],
    weld: f64,
) -> Result<Vec<Edge>, BodyFlaw> {
    let edges = edges(faces, corners, weld);
    for (index, edge) in edges.iter().enumerate() {
        let same = |e: &Edge| e.from == edge.from && e.to == edge.to;
        if edges[..index].iter().any(same) {
            return Err(BodyFlaw::Overlapping(edge.face));
        }
    }
    let paired = |edge: &Edge| edges.iter().any(|e| e.from == edge.to && e.to == edge.from);
    Ok(edges.iter().copied().filter(|e| !paired(e)).collect())
}

/// The corners on the segment from `start` to `end`, in its order.
fn corners_along(start: DVec3, end: DVec3, corners: &[DVec3], weld: f64) -> Vec<usize> {
    let along = end - start;
    let length_squared = along.length_squared();
    let mut found: Vec<(f64, usize)> = corners
        .iter()
        .enumerate()
        .filter_map(|(index, &corner)| {
            let t = (corner - start).dot(along) / length_squared;
            let foot = start + along * t.clamp(0.0, 1.0);
            (corner.distance(foot) <= weld).then_some((t, index))
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, index)| index).collect()
}
