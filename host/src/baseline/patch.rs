//! Patches: what shoots reflected light, and its mean of the elements.

use super::frame::Frame;
use super::occluders::{Occluders, Span};
use super::{Elements, Sample};

/// A part of a surface that shoots.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    /// Index of its surface.
    pub(super) surface: usize,
    pub(super) area: f64,
    pub(super) samples: Vec<Sample>,
    pub(super) span: Span,
    /// Element vertices with their weights in the mean over the patch.
    weights: Vec<(usize, f64)>,
    /// Radiosity that it has shot, W m⁻².
    pub(super) shot: f64,
}

impl Patch {
    /// The patches of a surface, u fastest.
    pub(super) fn of(
        surface: usize,
        elements: &Elements,
        samples_a_side: usize,
        occluders: &Occluders,
    ) -> Vec<Self> {
        let count = elements.resolution.patches;
        let size = count.map(|count| 1.0 / count as f64);
        let patch = |k: usize| {
            let start = [
                (k % count[0]) as f64 * size[0],
                (k / count[0]) as f64 * size[1],
            ];
            let samples = elements.frame.samples(start, size, [samples_a_side; 2]);
            Self {
                surface,
                area: samples.iter().map(|sample| sample.area).sum(),
                samples,
                span: occluders.span(&elements.frame.corners(start, size)),
                weights: weights(&elements.frame, elements.resolution.vertices, start, size),
                shot: 0.0,
            }
        };
        (0..count[0] * count[1]).map(patch).collect()
    }

    /// Mean irradiance over the patch, bilinear between the vertices.
    pub(super) fn mean(&self, vertices: &[f64]) -> f64 {
        let weighted = self.weights.iter().map(|&(index, w)| w * vertices[index]);
        weighted.sum()
    }
}

/// The weights of element vertices in the mean over a part of the surface:
/// `∫∫ h_i h_j J du dv / ∫∫ J du dv` with the Jacobian of the bilinear map.
fn weights(
    frame: &Frame,
    vertices: [usize; 2],
    start: [f64; 2],
    size: [f64; 2],
) -> Vec<(usize, f64)> {
    let [constant, by_u, by_v] = frame.jacobian();
    let [along_u, along_v] =
        [0, 1].map(|axis| hat_moments(start[axis], size[axis], vertices[axis]));
    let mut weights = Vec::new();
    for (j, [v, of_v]) in along_v.iter().enumerate() {
        for (i, [u, of_u]) in along_u.iter().enumerate() {
            let weight = constant * u * v + by_u * of_u * v + by_v * u * of_v;
            if weight > 0.0 {
                weights.push((j * vertices[0] + i, weight));
            }
        }
    }
    let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
    for (_, weight) in &mut weights {
        *weight /= sum;
    }
    weights
}

/// `∫ h dt` and `∫ t h dt` over `[start, start + width]`, divided by the width,
/// of the `count` hat functions h on equally spaced vertices of `[0, 1]`.
fn hat_moments(start: f64, width: f64, count: usize) -> Vec<[f64; 2]> {
    let spans = (count - 1) as f64;
    // Integrals of a hat of half width 1, and of its place times it, from its
    // foot to `t`.
    let integrals = |t: f64| match t.clamp(-1.0, 1.0) {
        t if t <= 0.0 => [
            0.5 * (t + 1.0) * (t + 1.0),
            t * t * (0.5 + t / 3.0) - 1.0 / 6.0,
        ],
        t => [
            1.0 - 0.5 * (1.0 - t) * (1.0 - t),
            t * t * (0.5 - t / 3.0) - 1.0 / 6.0,
        ],
    };
    let moments = |index: usize| {
        let at = |place: f64| integrals(place * spans - index as f64);
        let (from, to) = (at(start), at(start + width));
        let [all, off] = [0, 1].map(|k| (to[k] - from[k]) / (width * spans));
        [all, (all * index as f64 + off) / spans]
    };
    (0..count).map(moments).collect()
}

#[cfg(test)]
mod tests {
    use super::hat_moments;

    #[test]
    fn moments_of_hats_are_those_of_lines() {
        for (start, width, count) in [
            (0.0, 0.5, 10),
            (0.5, 0.5, 8),
            (0.25, 0.25, 2),
            (0.0, 1.0, 3),
        ] {
            let moments = hat_moments(start, width, count);
            let vertices = || moments.iter().enumerate();
            let place = |i: usize| i as f64 / (count - 1) as f64;
            // A line equals its interpolant: so do its integral and its moment.
            let line = |t: f64| 3.0 * t - 0.7;
            let middle = start + 0.5 * width;
            let mean: f64 = vertices().map(|(i, [w, _])| w * line(place(i))).sum();
            assert!((mean - line(middle)).abs() < 1e-14);
            let first: f64 = vertices().map(|(i, [_, w])| w * line(place(i))).sum();
            let square = middle * middle + width * width / 12.0;
            assert!((first - (3.0 * square - 0.7 * middle)).abs() < 1e-14);
        }
    }
}
