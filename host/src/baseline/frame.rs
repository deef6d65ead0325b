//! Quadrilaterals and triangles as the baseline divides them.

use glam::DVec3;

use super::{Error, Sample};
use crate::scene::Surface;

/// A planar convex quadrilateral, or a triangle whose last two corners are
/// one, under the bilinear map
///
/// `place(u, v) = corner + u e + v f + u v g`.
///
/// Its Jacobian is linear in u and v, so that the area of a cell is exactly
/// what it is at the cell's middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    corner: DVec3,
    along_u: DVec3,
    along_v: DVec3,
    twist: DVec3,
    /// Unit normal of the front.
    pub(super) normal: DVec3,
}

impl Frame {
    /// The frame of a surface: u from the first vertex to the second, v from
    /// the first to the last.
    pub(super) fn of(surface: &Surface) -> Result<Self, Error> {
        let corners = match surface.vertices[..] {
            [a, b, c] => Some([a, b, c, c]),
            [a, b, c, d] if is_convex([a, b, c, d], surface.normal) => Some([a, b, c, d]),
            _ => None,
        };
        let [a, b, c, d] = corners.ok_or_else(|| Error::Shape {
            surface: surface.name.clone(),
        })?;
        Ok(Self {
            corner: a,
            along_u: b - a,
            along_v: d - a,
            twist: (a - b) + (c - d),
            normal: surface.normal,
        })
    }

    /// Height above a plane that rounding of this surface's coordinates may feign.
    pub(super) fn rounding(&self) -> f64 {
        let sum = self.corner.abs() + self.along_u.abs() + self.along_v.abs();
        1e-12 * sum.max_element()
    }

    /// The place of (`u`, `v`), each 0 to 1.
    pub(super) fn place(&self, u: f64, v: f64) -> DVec3 {
        self.corner + self.along_u * u + self.along_v * v + self.twist * (u * v)
    }

    /// The Jacobian (m²) as its value at the first corner and what it grows
    /// by along u and along v.
    pub(super) fn jacobian(&self) -> [f64; 3] {
        [
            (self.along_u, self.along_v),
            (self.along_u, self.twist),
            (self.twist, self.along_v),
        ]
        .map(|(a, b)| a.cross(b).dot(self.normal))
    }

    /// The middles of `count` cells in each direction of a part of the
    /// surface, with the areas they stand for.
    pub(super) fn samples(
        &self,
        start: [f64; 2],
        size: [f64; 2],
        count: [usize; 2],
    ) -> Vec<Sample> {
        let [constant, by_u, by_v] = self.jacobian();
        let share = [size[0] / count[0] as f64, size[1] / count[1] as f64];
        let middle = |axis: usize, index: usize| start[axis] + (index as f64 + 0.5) * share[axis];
        let sample = |k: usize| {
            let (u, v) = (middle(0, k % count[0]), middle(1, k / count[0]));
            Sample {
                place: self.place(u, v),
                area: (constant + by_u * u + by_v * v) * (share[0] * share[1]),
            }
        };
        (0..count[0] * count[1]).map(sample).collect()
    }

    /// The corners of a part of the surface.
    pub(super) fn corners(&self, [u, v]: [f64; 2], [width, height]: [f64; 2]) -> [DVec3; 4] {
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
            .map(|(i, j)| self.place(u + i * width, v + j * height))
    }

    /// The (u, v) of a point in the plane: the bilinear map's inverse.
    pub(super) fn locate(&self, position: DVec3) -> (f64, f64) {
        let offset = position - self.corner;
        let cross = |a: DVec3, b: DVec3| a.cross(b).dot(self.normal);
        // (e + v g) × (q − v f) = 0, the root that is −c/b without a twist.
        let a = cross(self.along_v, self.twist);
        let b = cross(self.twist, offset) - cross(self.along_u, self.along_v);
        let c = cross(self.along_u, offset);
        let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
        let v = 2.0 * c / (root - b);
        let along = self.along_u + self.twist * v;
        let length = along.length_squared();
        let u = (offset - self.along_v * v).dot(along) / length;
        // At a triangle's apex every u is the same place.
        (if u.is_finite() { u } else { 0.0 }, v)
    }
}

/// Whether all corners turn left, seen against the normal.
fn is_convex(corners: [DVec3; 4], normal: DVec3) -> bool {
    (0..4).all(|k| {
        let [before, here, after] = [0, 1, 2].map(|i| corners[(k + i) % 4]);
        (here - before).cross(after - here).dot(normal) > 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn surface(vertices: Vec<DVec3>) -> Surface {
        let measured = crate::scene::polygon::measure(&vertices).expect("a sound polygon");
        Surface {
            name: "quad".to_owned(),
            normal: measured.normal,
            area: measured.area,
            vertices,
            reflectance: [0.5; 3],
            radiance: [0.0; 3],
        }
    }

    /// A convex quadrilateral or triangle in a plane of its own.
    fn shape(radii: [f64; 4], corners: usize) -> Surface {
        let (x, y) = (DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.0, 0.0, 1.0));
        let at = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / corners as f64;
            DVec3::new(1.0, -2.0, 3.0) + (x * angle.cos() + y * angle.sin()) * radii[k]
        };
        surface((0..corners).map(at).collect())
    }

    proptest! {
        #[test]
        fn the_map_is_inverted_and_its_cells_have_the_area(
            radii in [1.0..1.9_f64, 1.0..1.9_f64, 1.0..1.9_f64, 1.0..1.9_f64],
            corners in 3..=4_usize,
            u in 0.0..1.0_f64,
            v in 0.0..0.999_f64,
        ) {
            let surface = shape(radii, corners);
            let frame = Frame::of(&surface).expect("a convex shape");
            let (found_u, found_v) = frame.locate(frame.place(u, v));
            prop_assert!((found_u - u).abs() < 1e-8, "{found_u} for {u}");
            prop_assert!((found_v - v).abs() < 1e-8, "{found_v} for {v}");
            let samples = frame.samples([0.0; 2], [1.0; 2], [3, 5]);
            let area: f64 = samples.iter().map(|sample| sample.area).sum();
            prop_assert!((area / surface.area - 1.0).abs() < 1e-12);
            let part = frame.samples([0.0; 2], [0.25, 1.0], [2, 2]);
            let rest = frame.samples([0.25, 0.0], [0.75, 1.0], [1, 7]);
            let both: f64 = part.iter().chain(&rest).map(|sample| sample.area).sum();
            prop_assert!((both / surface.area - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_apex_of_a_triangle_is_found() {
        let surface = shape([1.0; 4], 3);
        let frame = Frame::of(&surface).expect("a triangle");
        let (u, v) = frame.locate(surface.vertices[2]);
        assert!(u.is_finite() && (v - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_dart_is_refused() {
        let mut dart = shape([1.0; 4], 4);
        dart.vertices[2] = dart.vertices[0] + 0.2 * (dart.vertices[2] - dart.vertices[0]);
        assert!(Frame::of(&dart).is_err());
    }
}
