//! What the points of a surface light, and how wrong they light it.

use super::super::Field;
use super::super::fields::tensor::{Nodes, Tensor};
use super::at;
use crate::scene::Scene;
use crate::scene::frame::Frame;
use glam::DVec3;
use std::f64::consts::PI;

/// Places along each side of a surface at which another one's points are judged, and
/// nodes along each side that say what they should give.
const PROBED: usize = 6;
const DENSE: usize = 24;

/// What a surface's points light.
pub(super) struct Lit {
    /// Places with their normals on other surfaces that reflect, what they receive
    /// in all, of this surface, and the power of theirs.
    probes: Vec<Probe>,
}

struct Probe {
    position: DVec3,
    normal: DVec3,
    total: f64,
    exact: f64,
    power: f64,
}

impl Lit {
    /// By a surface, which reflects what reaches it.
    pub(super) fn by(scene: &Scene, index: usize, frame: &Frame, total: &Field<'_>) -> Self {
        let dense = Tensor::over(frame, Nodes::Gauss, [DENSE; 2], None);
        let values = at(frame, &dense.places(), total);
        let mut probes = Vec::new();
        for (other, surface) in scene.surfaces.iter().enumerate() {
            if other == index || !surface.reflects() {
                continue;
            }
            let its = Frame::new(surface);
            let cells = (0..PROBED * PROBED)
                .map(|k| its.cell_center(k % PROBED, k / PROBED, PROBED, PROBED))
                .filter(|&(u, v)| its.contains(u, v));
            let places: Vec<[f64; 2]> = cells.map(|(u, v)| [u, v]).collect();
            let totals = at(&its, &places, total);
            let mean = totals.iter().sum::<f64>() / totals.len().max(1) as f64;
            probes.extend(places.iter().zip(totals).map(|(&[u, v], total)| {
                let (position, normal) = (its.to_world(u, v), its.normal);
                Probe {
                    position,
                    normal,
                    total,
                    exact: sent(frame, &dense, &values, position, normal),
                    power: mean * surface.area,
                }
            }));
        }
        // Beside what arrives in all, it gives that much times its reflectance.
        let rho = scene.surfaces[index].reflectance[0];
        for probe in &mut probes {
            probe.total /= rho;
        }
        Self { probes }
    }

    /// The largest relative error that points with these values cause anywhere.
    pub(super) fn relative(&self, frame: &Frame, tensor: &Tensor, values: &[f64]) -> f64 {
        let errors = self.probes.iter().map(|probe| {
            let sent = sent(frame, tensor, values, probe.position, probe.normal);
            (sent - probe.exact).abs() / probe.total.max(f64::MIN_POSITIVE)
        });
        errors.fold(0.0, f64::max)
    }

    /// The largest relative error that points with these values cause, times the
    /// power it is an error of, in W.
    pub(super) fn error(&self, frame: &Frame, tensor: &Tensor, values: &[f64]) -> f64 {
        let errors = self.probes.iter().map(|probe| {
            let sent = sent(frame, tensor, values, probe.position, probe.normal);
            let error = (sent - probe.exact).abs() / probe.total.max(f64::MIN_POSITIVE);
            error * probe.power
        });
        errors.fold(0.0, f64::max)
    }
}

/// What the nodes of a tensor grid give to a place, as points of these radiosities.
fn sent(frame: &Frame, tensor: &Tensor, values: &[f64], place: DVec3, normal: DVec3) -> f64 {
    let nodes = tensor.places().into_iter().zip(tensor.areas()).zip(values);
    nodes
        .map(|(([u, v], area), value)| {
            let to = frame.to_world(u, v) - place;
            let cosines = to.dot(normal).max(0.0) * (-to.dot(frame.normal)).max(0.0);
            value * area * cosines / (PI * to.length_squared().powi(2))
        })
        .sum()
}
