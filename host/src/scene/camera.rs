//! The pinhole camera: which surface each pixel sees, and where.

use glam::{DVec2, DVec3};

use super::{Camera, Scene, Surface};

/// What a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index in [`Scene::surfaces`].
    pub surface: usize,
    /// The place in metres.
    pub position: DVec3,
    /// Whether the ray comes from the surface's front, the side that is lit.
    pub front: bool,
}

/// A camera with a picture size: the map between pixels and space.
///
/// Pixel coordinates run right and down from the upper left corner of the
/// picture; pixel (i, j) covers i..i + 1, j..j + 1. Pixels are square.
#[derive(Clone, Copy, Debug)]
pub struct View {
    eye: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    /// Half a pixel's height at unit depth, times two: metres per pixel.
    step: f64,
    width: u32,
    height: u32,
}

impl View {
    /// The view of `camera` in a picture of `width` x `height` pixels.
    ///
    /// The camera must be as [`file::parse`](super::file::parse) leaves it:
    /// eye and target differ, up is not parallel to the view, the field of
    /// view is between 0 and 180 degrees.
    pub fn new(camera: &Camera, width: u32, height: u32) -> Self {
        let forward = super::unit(camera.target - camera.eye).unwrap_or(DVec3::NEG_Z);
        let right = super::unit(forward.cross(camera.up))
            .unwrap_or_else(|| forward.any_orthonormal_vector());
        Self {
            eye: camera.eye,
            forward,
            right,
            up: right.cross(forward),
            step: 2.0 * (0.5 * camera.fov.to_radians()).tan() / f64::from(height.max(1)),
            width,
            height,
        }
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Where all rays begin, in metres.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The unit direction of the ray through pixel coordinates (x, y).
    pub fn direction(&self, x: f64, y: f64) -> DVec3 {
        let right = (x - 0.5 * f64::from(self.width)) * self.step;
        let up = (0.5 * f64::from(self.height) - y) * self.step;
        let direction = self.forward + self.right * right + self.up * up;
        direction / direction.length()
    }

    /// The pixel coordinates of a place, also outside of the picture; `None`
    /// at or behind the plane of the eye.
    pub fn project(&self, place: DVec3) -> Option<(f64, f64)> {
        let offset = place - self.eye;
        let depth = offset.dot(self.forward);
        if depth <= 0.0 {
            return None;
        }
        let scale = 1.0 / (depth * self.step);
        let x = 0.5 * f64::from(self.width) + offset.dot(self.right) * scale;
        let y = 0.5 * f64::from(self.height) - offset.dot(self.up) * scale;
        (x.is_finite() && y.is_finite()).then_some((x, y))
    }

    /// What each pixel's centre sees, row by row from the top.
    ///
    /// Costs, for each pixel, a test of every surface's bounding sphere and of
    /// the edges of those it meets.
    pub fn hits(&self, scene: &Scene) -> Vec<Option<Hit>> {
        let caster = Caster::new(scene);
        let mut hits = Vec::with_capacity(self.width as usize * self.height as usize);
        for row in 0..self.height {
            for column in 0..self.width {
                let direction = self.direction(f64::from(column) + 0.5, f64::from(row) + 0.5);
                hits.push(caster.nearest(self.eye, direction));
            }
        }
        hits
    }
}

/// Casts rays into a scene.
#[derive(Clone, Debug)]
pub struct Caster<'s> {
    surfaces: &'s [Surface],
    /// Center and squared radius of each surface's bounding sphere, about a
    /// place on its plane.
    spheres: Vec<(DVec3, f64)>,
    tolerance: f64,
}

impl<'s> Caster<'s> {
    /// Prepares the surfaces of `scene`.
    pub fn new(scene: &'s Scene) -> Self {
        let tolerance = scene.plane_tolerance();
        let sphere = |surface: &Surface| {
            let center = surface.center();
            let reach = surface
                .vertices
                .iter()
                .fold(0.0_f64, |reach, v| reach.max(v.distance(center)));
            (center, (reach + tolerance).powi(2))
        };
        Self {
            surfaces: &scene.surfaces,
            spheres: scene.surfaces.iter().map(sphere).collect(),
            tolerance,
        }
    }

    /// The first surface that the ray from `origin` along the unit vector
    /// `direction` meets at a distance above the scene's plane tolerance.
    ///
    /// Concave polygons are exact, and no ray slips between polygons that
    /// share an edge with the same vertices. Of surfaces at the same distance
    /// one that shows its front comes first, then the first in the file.
    pub fn nearest(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let axes = direction.any_orthonormal_pair();
        let mut best: Option<(f64, Hit)> = None;
        for (index, surface) in self.surfaces.iter().enumerate() {
            let Some((distance, front)) = self.meet(index, surface, origin, direction, axes) else {
                continue;
            };
            let nearer = match &best {
                None => true,
                Some((nearest, _)) if distance < nearest - self.tolerance => true,
                Some((nearest, hit)) => distance <= nearest + self.tolerance && front && !hit.front,
            };
            if nearer {
                let position = origin + direction * distance;
                let hit = Hit {
                    surface: index,
                    position,
                    front,
                };
                best = Some((distance, hit));
            }
        }
        best.map(|(_, hit)| hit)
    }

    /// Distance and side of a surface on the ray.
    fn meet(
        &self,
        index: usize,
        surface: &Surface,
        origin: DVec3,
        direction: DVec3,
        (right, up): (DVec3, DVec3),
    ) -> Option<(f64, bool)> {
        let (center, reach_squared) = self.spheres[index];
        let to_center = center - origin;
        let along = to_center.dot(direction);
        if to_center.length_squared() - along * along > reach_squared {
            return None;
        }
        let slope = surface.normal.dot(direction);
        if slope == 0.0 {
            return None;
        }
        let distance = surface.normal.dot(to_center) / slope;
        // Grazing rays may overflow; a distance beyond the scene is no hit.
        if !(distance > self.tolerance && distance.is_finite()) {
            return None;
        }
        // Seen along the ray, the polygon is planar and the ray is its origin.
        let seen = |vertex: &DVec3| {
            let offset = *vertex - origin;
            DVec2::new(offset.dot(right), offset.dot(up))
        };
        let around = encloses_origin(surface.vertices.iter().map(seen));
        around.then_some((distance, slope < 0.0))
    }
}

/// Whether a polygon encloses the origin, by counting the edges that cross the
/// positive x axis. An edge gives the same answer in both directions, so the
/// origin is never between two polygons that share an edge.
fn encloses_origin(vertices: impl Iterator<Item = DVec2> + Clone) -> bool {
    let Some(last) = vertices.clone().last() else {
        return false;
    };
    let mut inside = false;
    let mut from = last;
    for to in vertices {
        if (from.y > 0.0) != (to.y > 0.0) {
            let (low, high) = if from.y > 0.0 { (to, from) } else { (from, to) };
            if low.perp_dot(high) > 0.0 {
                inside = !inside;
            }
        }
        from = to;
    }
    inside
}
