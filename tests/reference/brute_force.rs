//! Direct light by brute force: shares no idea and no code with the kernel or
//! the reference, so that it can judge both.
//!
//! Emitters are cut into triangles and these into quarters. A triangle whose
//! corners, midpoints and centre all see the receiver, or all do not, is taken
//! as wholly visible or hidden once it is small beside its distance, where the
//! rule of integration holds; the others are cut again. What
//! is hidden is found by asking of each ray whether it meets a polygon. The
//! error falls with the depth like the width of the triangles that shadow
//! borders cross, and misses occluders (or gaps) smaller than the first cut.

use glam::{DVec2, DVec3};

/// A polygon that occludes, and emits on its front where `radiance` > 0.
pub(crate) struct Polygon {
    pub(crate) vertices: Vec<DVec3>,
    pub(crate) radiance: f64,
}

/// How finely emitters are cut: every triangle at least `least` times, those on
/// shadow borders up to `most` times.
#[derive(Clone, Copy)]
pub(crate) struct Depth {
    pub(crate) least: u32,
    pub(crate) most: u32,
}

struct Place<'a> {
    position: DVec3,
    normal: DVec3,
    occluders: Vec<&'a Polygon>,
    /// Closer than this is on a plane.
    tolerance: f64,
    depth: Depth,
}

/// Direct irradiance at `position` facing `normal`. Polygons occlude from both
/// sides, but never a point on their own plane (within 1e-6 of the largest
/// coordinate), nor light from it.
pub(crate) fn direct(polygons: &[Polygon], position: DVec3, normal: DVec3, depth: Depth) -> f64 {
    let coordinates = polygons.iter().flat_map(|polygon| &polygon.vertices);
    let largest = coordinates.fold(0.0_f64, |l, v| l.max(v.abs().max_element()));
    let tolerance = 1e-6 * largest;
    let mut sum = 0.0;
    for (index, emitter) in polygons.iter().enumerate() {
        let facing = newell(&emitter.vertices);
        if emitter.radiance <= 0.0 || (position - emitter.vertices[0]).dot(facing) <= tolerance {
            continue;
        }
        let between = |&(other, polygon): &(usize, &Polygon)| {
            let upright = newell(&polygon.vertices);
            let off = |place: &DVec3| (*place - polygon.vertices[0]).dot(upright).abs() > tolerance;
            other != index && off(&position) && emitter.vertices.iter().any(off)
        };
        let place = Place {
            position,
            normal: normal.normalize(),
            occluders: polygons
                .iter()
                .enumerate()
                .filter(between)
                .map(|(_, p)| p)
                .collect(),
            tolerance,
            depth,
        };
        let anchor = emitter.vertices[0];
        // Signed, so that the fan of a concave polygon covers it once.
        for pair in emitter.vertices[1..].windows(2) {
            let turn = (pair[0] - anchor)
                .cross(pair[1] - anchor)
                .dot(facing)
                .signum();
            sum += emitter.radiance * turn * place.triangle([anchor, pair[0], pair[1]], facing, 0);
        }
    }
    sum
}

fn newell(vertices: &[DVec3]) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for (index, a) in vertices.iter().enumerate() {
        sum += a.cross(vertices[(index + 1) % vertices.len()]);
    }
    sum.normalize()
}

impl Place<'_> {
    fn triangle(&self, [a, b, c]: [DVec3; 3], facing: DVec3, depth: u32) -> f64 {
        let (d, e, f) = (a.midpoint(b), b.midpoint(c), c.midpoint(a));
        let centre = (a + b + c) / 3.0;
        if depth >= self.depth.least {
            let probes = [a, b, c, d, e, f, centre];
            // Off the rim, which neighbouring polygons may share.
            let seen = probes.map(|probe| self.sees(probe.lerp(centre, 1e-7)));
            let count = seen.iter().filter(|seen| **seen).count();
            if count == 0 {
                return 0.0;
            }
            let longest = [b - a, c - b, a - c]
                .map(DVec3::length)
                .into_iter()
                .fold(0.0, f64::max);
            let small = longest < 0.5 * centre.distance(self.position);
            if count == seen.len() && small || depth >= self.depth.most {
                let area = 0.5 * (b - a).cross(c - a).length();
                // Exact for polynomials of third degree.
                let rim = [a, b, c].map(|corner| self.kernel(corner, facing));
                let middles = [d, e, f].map(|middle| self.kernel(middle, facing));
                let mean = (3.0 * rim.iter().sum::<f64>()
                    + 8.0 * middles.iter().sum::<f64>()
                    + 27.0 * self.kernel(centre, facing))
                    / 60.0;
                return area * mean * count as f64 / seen.len() as f64;
            }
        }
        [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
            .map(|quarter| self.triangle(quarter, facing, depth + 1))
            .iter()
            .sum()
    }

    fn kernel(&self, place: DVec3, facing: DVec3) -> f64 {
        let ray = place - self.position;
        let cosines = self.normal.dot(ray).max(0.0) * -facing.dot(ray).min(0.0);
        cosines / ray.length_squared().powi(2)
    }

    /// Whether `place` is above the horizon and nothing is in between.
    fn sees(&self, place: DVec3) -> bool {
        let above = self.normal.dot(place - self.position) > 0.0;
        above
            && !self
                .occluders
                .iter()
                .any(|polygon| self.meets(polygon, place))
    }

    fn meets(&self, polygon: &Polygon, place: DVec3) -> bool {
        let upright = newell(&polygon.vertices);
        let start = (self.position - polygon.vertices[0]).dot(upright);
        let end = (place - polygon.vertices[0]).dot(upright);
        if start * end >= 0.0 || end.abs() <= self.tolerance {
            return false;
        }
        let hit = self.position.lerp(place, start / (start - end));
        // Seen along the axis that the polygon faces most.
        let drop = upright.abs();
        let flat = |v: DVec3| {
            if drop.x >= drop.y && drop.x >= drop.z {
                DVec2::new(v.y, v.z)
            } else if drop.y >= drop.z {
                DVec2::new(v.z, v.x)
            } else {
                DVec2::new(v.x, v.y)
            }
        };
        let point = flat(hit);
        let mut inside = false;
        for (index, a) in polygon.vertices.iter().enumerate() {
            let (a, b) = (
                flat(*a),
                flat(polygon.vertices[(index + 1) % polygon.vertices.len()]),
            );
            if (a.y > point.y) != (b.y > point.y) {
                let crossing = a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y);
                inside ^= crossing > point.x;
            }
        }
        inside
    }
}
