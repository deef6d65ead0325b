//! Whether points stand for surfaces.

use super::super::fields::tensor::Tensor;
use super::super::{Plan, SurfacePlan};
use crate::scene::Scene;
use glam::DVec3;

/// Distance of a place that nobody planned for from points that shoot, in distances
/// between them, from which on the same can be said.
const FAR: f64 = 1.2;

/// The surfaces with the grids that they are reconstructed from.
fn grids(plan: &Plan) -> impl Iterator<Item = (usize, &SurfacePlan, &Tensor)> {
    let surfaces = plan.surfaces.iter().enumerate();
    surfaces.filter_map(|(index, planned)| {
        let tensor = planned.fields.first()?.tensor.as_ref()?;
        Some((index, planned, tensor))
    })
}

/// Whether surfaces are what their grids cover.
pub(super) fn grids_are_surfaces(scene: &Scene, plan: &Plan) -> bool {
    grids(plan).all(|(index, planned, _)| {
        let rectangle = planned.frame.size_u * planned.frame.size_v;
        (scene.surfaces[index].area - rectangle).abs() <= 1e-6 * rectangle
    })
}

/// Whether the points are farther from all places asked for than [`FAR`] times their
/// distance from each other.
pub(super) fn points_are_far(scene: &Scene, plan: &Plan, places: &[DVec3]) -> bool {
    grids(plan).all(|(_, planned, tensor)| {
        let gap = |axis: usize| {
            let nodes = tensor.nodes[axis].windows(2);
            nodes.map(|pair| pair[1] - pair[0]).fold(0.0, f64::max) * tensor.half[axis]
        };
        let near = FAR * gap(0).max(gap(1));
        let points: Vec<DVec3> = tensor
            .places()
            .iter()
            .map(|&[u, v]| planned.frame.to_world(u, v))
            .collect();
        let normal = planned.frame.normal;
        let flat = scene.plane_tolerance();
        let far = |place: &DVec3| {
            let above = (*place - planned.frame.origin).dot(normal) > flat;
            !above || points.iter().all(|point| point.distance(*place) >= near)
        };
        places.iter().all(far)
    })
}
