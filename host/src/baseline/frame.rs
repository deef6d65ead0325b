//! Parallelograms as the baseline divides them.

use glam::DVec3;

use super::{Error, Samples};
use crate::scene::Surface;

/// Misfit of the fourth corner, as a share of the diagonal, that is still a
/// parallelogram (the scene format's own measure of planarity).
const MISFIT: f64 = 1e-4;

/// A corner and the two sides that leave it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    corner: DVec3,
    along_u: DVec3,
    along_v: DVec3,
    /// Unit normal of the front.
    pub(super) normal: DVec3,
}

impl Frame {
    /// The frame of a surface: u from the first vertex to the second, v from
    /// the first to the last.
    pub(super) fn of(surface: &Surface) -> Result<Self, Error> {
        if let [a, b, c, d] = surface.vertices[..]
            && (a + c - b - d).length() <= MISFIT * a.distance(c)
        {
            return Ok(Self {
                corner: a,
                along_u: b - a,
                along_v: d - a,
                normal: surface.normal,
            });
        }
        Err(Error::Shape {
            surface: surface.name.clone(),
        })
    }

    fn area(&self) -> f64 {
        self.along_u.cross(self.along_v).length()
    }

    /// Height above a plane that rounding of this surface's coordinates may feign.
    pub(super) fn rounding(&self) -> f64 {
        let sum = self.corner.abs() + self.along_u.abs() + self.along_v.abs();
        1e-12 * sum.max_element()
    }

    fn place(&self, u: f64, v: f64) -> DVec3 {
        self.corner + self.along_u * u + self.along_v * v
    }

    /// An element vertex of `side` in each direction.
    pub(super) fn vertex(&self, (i, j): (usize, usize), side: usize) -> DVec3 {
        let spans = (side - 1) as f64;
        self.place(i as f64 / spans, j as f64 / spans)
    }

    /// One of `side` × `side` equal parts.
    pub(super) fn part(&self, (column, row): (usize, usize), side: usize) -> Self {
        let share = 1.0 / side as f64;
        Self {
            corner: self.place(column as f64 * share, row as f64 * share),
            along_u: self.along_u * share,
            along_v: self.along_v * share,
            normal: self.normal,
        }
    }

    /// The centres of `side` × `side` equal parts.
    pub(super) fn samples(&self, side: usize) -> Samples {
        let share = 1.0 / side as f64;
        let centre = |index: usize| (index as f64 + 0.5) * share;
        let places = (0..side * side).map(|k| self.place(centre(k % side), centre(k / side)));
        Samples {
            places: places.collect(),
            normal: self.normal,
            area: self.area() * share * share,
        }
    }

    /// The (u, v) of a point in the plane.
    pub(super) fn locate(&self, position: DVec3) -> (f64, f64) {
        let offset = position - self.corner;
        let area = self.along_u.cross(self.along_v);
        let square = area.length_squared();
        (
            offset.cross(self.along_v).dot(area) / square,
            self.along_u.cross(offset).dot(area) / square,
        )
    }
}
