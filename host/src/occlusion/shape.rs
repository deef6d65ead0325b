//! Convex occluders in double precision: polygons and closed bodies.

use glam::DVec3;
use isolux::visibility::records::FACES;

use crate::scene::Surface;
use crate::scene::body::{free_edges, weld_corners};

/// A plane: normal·x = offset.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    pub(super) normal: DVec3,
    pub(super) offset: f64,
}

impl Plane {
    /// The plane of a polygon: its offset is the mean of its vertices'.
    pub(super) fn of(normal: DVec3, vertices: &[DVec3]) -> Self {
        let sum: f64 = vertices.iter().map(|vertex| normal.dot(*vertex)).sum();
        Self {
            normal,
            offset: sum / vertices.len() as f64,
        }
    }

    pub(super) fn height(&self, place: DVec3) -> f64 {
        self.normal.dot(place) - self.offset
    }

    /// The least and the largest height of places.
    pub(super) fn range<'a>(&self, places: impl IntoIterator<Item = &'a DVec3>) -> (f64, f64) {
        places
            .into_iter()
            .map(|&place| self.height(place))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), height| {
                (low.min(height), high.max(height))
            })
    }
}

/// An edge between two faces, with `left` on its left seen from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Edge {
    pub(crate) ends: [usize; 2],
    pub(super) left: usize,
    pub(super) right: usize,
}

/// A convex polygon (one face) or a closed convex body.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pub(crate) vertices: Vec<DVec3>,
    pub(super) faces: Vec<Plane>,
    pub(crate) edges: Vec<Edge>,
}

impl Shape {
    /// A convex polygon, counter-clockwise seen from the side of `normal`.
    pub(super) fn polygon(normal: DVec3, vertices: Vec<DVec3>) -> Self {
        let count = vertices.len();
        Self {
            faces: vec![Plane::of(normal, &vertices)],
            edges: (0..count)
                .map(|i| Edge {
                    ends: [i, (i + 1) % count],
                    left: 0,
                    right: 0,
                })
                .collect(),
            vertices,
        }
    }

    /// A closed convex body made of surfaces, with a missing base closed.
    /// Faces in one plane become one. `None` where it has more faces than the
    /// tables hold, or fewer than a body.
    ///
    /// The surfaces must have passed [`check`](crate::scene::body::check) with
    /// the same distance `flat`, within which places are one place.
    pub(super) fn body(surfaces: &[&Surface], flat: f64) -> Option<Self> {
        let vertices = weld_corners(surfaces, flat);
        let mut faces: Vec<Plane> = Vec::new();
        let mut face_of = Vec::new();
        for surface in surfaces {
            let found = faces.iter().position(|plane| {
                let (low, high) = plane.range(&surface.vertices);
                low >= -flat && high <= flat && plane.normal.dot(surface.normal) > 0.0
            });
            face_of.push(found.unwrap_or_else(|| {
                faces.push(Plane::of(surface.normal, &surface.vertices));
                faces.len() - 1
            }));
        }
        let all = crate::scene::body::edges(surfaces, &vertices, flat);
        let free = free_edges(surfaces, &vertices, flat).ok()?;
        if let Some(first) = free.first() {
            let origin = vertices[first.from];
            let doubled: DVec3 = free
                .iter()
                .map(|edge| (vertices[edge.to] - origin).cross(vertices[edge.from] - origin))
                .sum();
            let corners: Vec<DVec3> = free.iter().map(|edge| vertices[edge.from]).collect();
            faces.push(Plane::of(doubled / doubled.length(), &corners));
        }
        let base = faces.len() - 1;
        let mut edges = Vec::new();
        for edge in &all {
            let back = all.iter().find(|e| e.from == edge.to && e.to == edge.from);
            let (left, right) = (face_of[edge.face], back.map_or(base, |e| face_of[e.face]));
            if left != right && (back.is_none() || edge.from < edge.to) {
                edges.push(Edge {
                    ends: [edge.from, edge.to],
                    left,
                    right,
                });
            }
        }
        (4..=FACES).contains(&faces.len()).then_some(Self {
            vertices,
            faces,
            edges,
        })
    }

    pub(crate) fn is_polygon(&self) -> bool {
        self.faces.len() == 1
    }

    /// A sphere about the middle of its bounding box that holds it.
    pub(super) fn sphere(&self) -> (DVec3, f64) {
        sphere(&self.vertices)
    }

    /// The part of a polygon in front of a plane; `None` where there is none.
    ///
    /// Crossings are computed from the end in front, so that polygons that
    /// share an edge share the crossing.
    pub(super) fn in_front_of(&self, plane: &Plane, flat: f64) -> Option<Self> {
        let heights: Vec<f64> = self.vertices.iter().map(|&v| plane.height(v)).collect();
        let count = self.vertices.len();
        let mut vertices = Vec::with_capacity(count + 1);
        for i in 0..count {
            let j = (i + 1) % count;
            let (from, to) = (heights[i], heights[j]);
            if from >= -flat {
                vertices.push(self.vertices[i]);
            }
            let (front, behind) = if from > to { (i, j) } else { (j, i) };
            if heights[front] > flat && heights[behind] < -flat {
                let t = heights[front] / (heights[front] - heights[behind]);
                let along = self.vertices[behind] - self.vertices[front];
                vertices.push(self.vertices[front] + along * t);
            }
        }
        let (_, highest) = plane.range(&vertices);
        (vertices.len() >= 3 && highest > flat).then(|| Self {
            faces: self.faces.clone(),
            ..Self::polygon(self.faces[0].normal, vertices)
        })
    }
}

/// A sphere about the middle of the bounding box of places that holds them.
pub(super) fn sphere(places: &[DVec3]) -> (DVec3, f64) {
    let low = places.iter().copied().reduce(DVec3::min);
    let high = places.iter().copied().reduce(DVec3::max);
    let centre = (low.unwrap_or_default() + high.unwrap_or_default()) / 2.0;
    let radius = places
        .iter()
        .fold(0.0_f64, |radius, place| radius.max(place.distance(centre)));
    (centre, radius)
}
