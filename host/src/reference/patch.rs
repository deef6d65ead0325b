//! A quadrilateral part of a surface, its quadrature nodes, and what a
//! receiver gets from it.

use glam::DVec3;

use super::rule::Rule;

/// A differential area that receives light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Receiver {
    /// Position in metres.
    pub(super) position: DVec3,
    /// Unit normal.
    pub(super) normal: DVec3,
}

/// How much of a patch lies above a receiver's horizon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Exposure {
    /// Nothing.
    Below,
    /// All of it.
    Above,
    /// The horizon crosses it.
    Crossed,
}

/// A planar convex quadrilateral under the bilinear map of the unit square,
/// with the nodes of a product Gauss rule.
pub(super) struct Patch {
    /// Corners in the order (0,0), (1,0), (1,1), (0,1) of the unit square.
    pub(super) corners: [DVec3; 4],
    /// Mean of the corners.
    pub(super) centre: DVec3,
    /// Largest distance of a corner from the centre.
    pub(super) radius: f64,
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    /// Area that each node stands for, in m².
    pub(super) area: Vec<f64>,
}

impl Patch {
    /// The patch with these corners, counter-clockwise about unit `normal`.
    pub(super) fn new(corners: [DVec3; 4], normal: DVec3, rule: &Rule) -> Self {
        let centre = corners.iter().sum::<DVec3>() * 0.25;
        let count = rule.order() * rule.order();
        let mut patch = Self {
            corners,
            centre,
            radius: corners
                .iter()
                .map(|corner| corner.distance(centre))
                .fold(0.0, f64::max),
            x: Vec::with_capacity(count),
            y: Vec::with_capacity(count),
            z: Vec::with_capacity(count),
            area: Vec::with_capacity(count),
        };
        for (v, v_weight) in rule.nodes.iter().zip(&rule.weights) {
            for (u, u_weight) in rule.nodes.iter().zip(&rule.weights) {
                let place = patch.place(*u, *v);
                patch.x.push(place.x);
                patch.y.push(place.y);
                patch.z.push(place.z);
                let stretch = patch.stretch(*u, *v, normal);
                patch.area.push(u_weight * v_weight * stretch);
            }
        }
        patch
    }

    /// The point at (`u`, `v`) of the unit square.
    pub(super) fn place(&self, u: f64, v: f64) -> DVec3 {
        let [a, b, c, d] = self.corners;
        (a * (1.0 - u) + b * u) * (1.0 - v) + (d * (1.0 - u) + c * u) * v
    }

    /// Area of the surface per area of the unit square.
    fn stretch(&self, u: f64, v: f64, normal: DVec3) -> f64 {
        let [a, b, c, d] = self.corners;
        let along_u = (b - a) * (1.0 - v) + (c - d) * v;
        let along_v = (d - a) * (1.0 - u) + (c - b) * u;
        along_u.cross(along_v).dot(normal)
    }

    /// The nodes, u fastest.
    pub(super) fn nodes(&self) -> impl Iterator<Item = DVec3> + '_ {
        let pairs = self.x.iter().zip(&self.y).zip(&self.z);
        pairs.map(|((x, y), z)| DVec3::new(*x, *y, *z))
    }

    /// The quarter at (`half_u`, `half_v`).
    pub(super) fn quarter(
        &self,
        (half_u, half_v): (usize, usize),
        normal: DVec3,
        rule: &Rule,
    ) -> Self {
        let (u, v) = (0.5 * half_u as f64, 0.5 * half_v as f64);
        let corners = [
            self.place(u, v),
            self.place(u + 0.5, v),
            self.place(u + 0.5, v + 0.5),
            self.place(u, v + 0.5),
        ];
        Self::new(corners, normal, rule)
    }

    /// What of the patch the receiver's horizon leaves.
    pub(super) fn exposure(&self, receiver: &Receiver) -> Exposure {
        let heights = self.heights(receiver);
        if heights.iter().all(|height| *height <= 0.0) {
            Exposure::Below
        } else if heights.iter().all(|height| *height >= 0.0) {
            Exposure::Above
        } else {
            Exposure::Crossed
        }
    }

    fn heights(&self, receiver: &Receiver) -> [f64; 4] {
        self.corners
            .map(|corner| receiver.normal.dot(corner - receiver.position))
    }

    /// `Σ wᵢ cos cos / r²` over the nodes, for a receiver at `height` over the
    /// patch's plane and a patch wholly above its horizon. With w = L dA this
    /// is irradiance.
    pub(super) fn receive(&self, receiver: &Receiver, height: f64, weighted: &[f64]) -> f64 {
        let (p, n) = (receiver.position, receiver.normal);
        let places = self.x.iter().zip(&self.y).zip(&self.z);
        let mut sum = 0.0;
        for (((x, y), z), weight) in places.zip(weighted) {
            let (dx, dy, dz) = (x - p.x, y - p.y, z - p.z);
            let square = dx * dx + dy * dy + dz * dz;
            sum += weight * (n.x * dx + n.y * dy + n.z * dz) / (square * square);
        }
        sum * height
    }

    /// Adds to `weights` what the receiver gets for unit radiance at each node
    /// where its horizon crosses the patch: the part above it is integrated by strips of constant v, each from the horizon on,
    /// with the radiance interpolated through the nodes. Strips are grouped
    /// between the places where the horizon passes a side of the patch, so
    /// that every integrand is smooth.
    pub(super) fn weigh_crossed(
        &self,
        receiver: &Receiver,
        height: f64,
        (normal, rule): (DVec3, &Rule),
        weights: &mut [f64],
    ) {
        let [a, b, c, d] = self.heights(receiver);
        let mut breaks = vec![0.0, 1.0];
        for (start, end) in [(a, d), (b, c)] {
            if (start < 0.0) != (end < 0.0) {
                breaks.push((start / (start - end)).clamp(0.0, 1.0));
            }
        }
        breaks.sort_by(f64::total_cmp);
        for span in breaks.windows(2) {
            let depth = span[1] - span[0];
            for (node, v_weight) in rule.nodes.iter().zip(&rule.weights) {
                let v = span[0] + depth * node;
                let (left, right) = (a + (d - a) * v, b + (c - b) * v);
                let Some((from, to)) = above(left, right) else {
                    continue;
                };
                let mut row = vec![0.0; rule.order()];
                for (node, u_weight) in rule.nodes.iter().zip(&rule.weights) {
                    let u = from + (to - from) * node;
                    let towards = self.place(u, v) - receiver.position;
                    let square = towards.length_squared();
                    let kernel = height * receiver.normal.dot(towards) / (square * square);
                    let measure = u_weight * (to - from) * self.stretch(u, v, normal);
                    for (value, share) in row.iter_mut().zip(rule.basis(u)) {
                        *value += share * kernel * measure;
                    }
                }
                let basis = rule.basis(v);
                for (out, share) in weights.chunks_exact_mut(rule.order()).zip(basis) {
                    for (weight, value) in out.iter_mut().zip(&row) {
                        *weight += share * value * v_weight * depth;
                    }
                }
            }
        }
    }
}

/// Where the line from `left` at 0 to `right` at 1 is not negative.
fn above(left: f64, right: f64) -> Option<(f64, f64)> {
    match (left >= 0.0, right >= 0.0) {
        (true, true) => Some((0.0, 1.0)),
        (true, false) => Some((0.0, left / (left - right))),
        (false, true) => Some((left / (left - right), 1.0)),
        (false, false) => None,
    }
}
