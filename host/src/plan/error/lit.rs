//! What the points of a surface light, and how wrong they light it.

use super::super::Field;
use super::super::fields::tensor::{Nodes, Tensor};
use super::at;
use super::few::Row;
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
    /// The surface it is on; that of the points themselves where it is on none.
    surface: usize,
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
                    surface: other,
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

    /// With the named points of the scene.
    pub(super) fn and_points(
        mut self,
        scene: &Scene,
        index: usize,
        frame: &Frame,
        total: &Field<'_>,
    ) -> Self {
        let dense = Tensor::over(frame, Nodes::Gauss, [DENSE; 2], None);
        let values = at(frame, &dense.places(), total);
        let rho = scene.surfaces[index].reflectance[0];
        self.probes.extend(scene.points.iter().map(|point| {
            let (position, normal) = (point.position, point.normal);
            let total = total(&[(position, normal)]).first().copied();
            Probe {
                surface: index,
                position,
                normal,
                total: total.unwrap_or(0.0) / rho,
                exact: sent(frame, &dense, &values, position, normal),
                power: 0.0,
            }
        }));
        self
    }

    /// What every place receives of samples with these values, for a unit of area each,
    /// and of the surface in truth, both over the error that the place may have: the
    /// relative one of its surface by `allowed`. Places that are dark are none.
    pub(super) fn rows(
        &self,
        frame: &Frame,
        tensor: &Tensor,
        values: &[f64],
        allowed: &dyn Fn(usize) -> f64,
    ) -> Vec<Row> {
        let places = tensor.places();
        let lit = self.probes.iter().filter(|probe| probe.total > 0.0);
        lit.map(|probe| {
            let scale = 1.0 / (probe.total * allowed(probe.surface));
            let of_sample = |(&place, value): (&[f64; 2], &f64)| {
                scale * value * kernel(frame, place, probe.position, probe.normal)
            };
            Row {
                of_samples: places.iter().zip(values).map(of_sample).collect(),
                wanted: scale * probe.exact,
            }
        })
        .collect()
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
        .map(|((node, area), value)| value * area * kernel(frame, node, place, normal))
        .sum()
}

/// What a place receives of a square metre at a place (u, v) of a surface, for a radiosity
/// of 1: cos θ cos θ' / (π r²).
fn kernel(frame: &Frame, [u, v]: [f64; 2], place: DVec3, normal: DVec3) -> f64 {
    let to = frame.to_world(u, v) - place;
    let cosines = to.dot(normal).max(0.0) * (-to.dot(frame.normal)).max(0.0);
    cosines / (PI * to.length_squared().powi(2))
}
