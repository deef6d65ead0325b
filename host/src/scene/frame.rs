//! The local frame of a surface: its bounding rectangle and the map to it.

use glam::{DVec2, DVec3};

use super::Surface;
use super::polygon::{diameter, point_to_segment};

/// Two rectangles count as equally large within this part of their area, so
/// that rounding does not choose between them.
const SAME_AREA: f64 = 1e-9;

/// A place within this part of the polygon's diameter of an edge is on it.
const BOUNDARY: f64 = 1e-9;

/// Coordinates (u, v) in metres on a surface's plane.
///
/// They belong to the polygon's bounding rectangle: of the rectangles with a
/// side along an edge the one of least area, the first edge's among equals.
/// The rectangle runs from (0, 0) to (`size_u`, `size_v`), with u along that
/// edge; a rectangle's frame is the rectangle, from its first vertex.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The place of (0, 0) in metres.
    pub origin: DVec3,
    /// Unit vector of u.
    pub u: DVec3,
    /// Unit vector of v: u x v is the normal.
    pub v: DVec3,
    /// Unit normal of the surface's front.
    pub normal: DVec3,
    /// Extent along u in metres.
    pub size_u: f64,
    /// Extent along v in metres.
    pub size_v: f64,
    /// The polygon, counter-clockwise.
    pub vertices: Vec<(f64, f64)>,
    tolerance: f64,
}

impl Frame {
    /// The frame of a validated surface. Costs the square of its vertices.
    pub fn new(surface: &Surface) -> Self {
        let center = surface.center();
        let count = surface.vertices.len();
        let mut best: Option<(f64, Self)> = None;
        for i in 0..count {
            let edge = surface.vertices[(i + 1) % count] - surface.vertices[i];
            // Vertices may lie off the plane a little: u must not.
            let in_plane = edge - surface.normal * edge.dot(surface.normal);
            let Some(u) = super::unit(in_plane) else {
                continue;
            };
            let frame = Self::along(surface, center, u);
            let area = frame.size_u * frame.size_v;
            if best
                .as_ref()
                .is_none_or(|(least, _)| area < least * (1.0 - SAME_AREA))
            {
                best = Some((area, frame));
            }
        }
        match best {
            Some((_, frame)) => frame,
            // No edge has a length: only a surface that was not validated.
            None => Self::along(surface, center, surface.normal.any_orthonormal_vector()),
        }
    }

    /// The frame with the given direction of u.
    fn along(surface: &Surface, center: DVec3, u: DVec3) -> Self {
        let v = surface.normal.cross(u);
        let place =
            |vertex: &DVec3| DVec2::new((*vertex - center).dot(u), (*vertex - center).dot(v));
        let places = || surface.vertices.iter().map(place);
        let low = places().fold(DVec2::INFINITY, DVec2::min);
        let high = places().fold(DVec2::NEG_INFINITY, DVec2::max);
        Self {
            origin: center + u * low.x + v * low.y,
            u,
            v,
            normal: surface.normal,
            size_u: high.x - low.x,
            size_v: high.y - low.y,
            vertices: places().map(|p| (p.x - low.x, p.y - low.y)).collect(),
            tolerance: BOUNDARY * diameter(&surface.vertices),
        }
    }

    /// The coordinates of a place, seen along the normal.
    pub fn to_local(&self, place: DVec3) -> (f64, f64) {
        let offset = place - self.origin;
        (offset.dot(self.u), offset.dot(self.v))
    }

    /// The place of coordinates, in metres.
    pub fn to_world(&self, u: f64, v: f64) -> DVec3 {
        self.origin + self.u * u + self.v * v
    }

    /// Whether the polygon contains the place; its boundary belongs to it.
    pub fn contains(&self, u: f64, v: f64) -> bool {
        let place = DVec2::new(u, v);
        let mut inside = false;
        let Some(&last) = self.vertices.last() else {
            return false;
        };
        let mut from = DVec2::from(last);
        for &to in &self.vertices {
            let to = DVec2::from(to);
            if point_to_segment(place, from, to) <= self.tolerance {
                return true;
            }
            if (from.y > v) != (to.y > v) {
                let (low, high) = if from.y > v { (to, from) } else { (from, to) };
                if (low - place).perp_dot(high - place) > 0.0 {
                    inside = !inside;
                }
            }
            from = to;
        }
        inside
    }

    /// The centre of cell (`column`, `row`) of a grid of `columns` x `rows`
    /// equal cells on the bounding rectangle.
    pub fn cell_center(
        &self,
        column: usize,
        row: usize,
        columns: usize,
        rows: usize,
    ) -> (f64, f64) {
        let along = |size: f64, index: usize, count: usize| {
            size * (index as f64 + 0.5) / count.max(1) as f64
        };
        (
            along(self.size_u, column, columns),
            along(self.size_v, row, rows),
        )
    }
}
