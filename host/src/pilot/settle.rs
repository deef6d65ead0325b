//! Weights that give the light there is.
//!
//! Weights of samples are fitted to whatever patches may send. At the foot of something
//! few samples see what a place there sees, and what the plan's patches send is itself
//! least right; so when a plan has been solved, the weights of every node of reflected light
//! are scaled until the mesh gives what the judge says is there: not at the nodes alone, but
//! all over its triangles, as nearly as linear values can. For another light the factor is as
//! right as it is for this one.

use crate::plan::Plan;
use crate::plan::fields::Mesh;
use crate::plan::room::{Known, Room};
use crate::scene::frame::Frame;
use crate::solve::Solution;
use glam::{DVec2, DVec3};
use nalgebra::{DMatrix, DVector};

/// No node is scaled by more than this factor, or less than its inverse.
const MOST: f64 = 2.0;

/// Light below this part of a surface's brightest place counts as that much.
const DARK: f64 = 1e-3;

/// What the judge says at a node itself counts beside all places around it.
const AT_NODE: f64 = 0.01;

/// Places in a triangle, by the shares of its corners, and their parts of its area: right for
/// polynomials of degree 4 (Dunavant 1985).
const RULE: [([f64; 3], f64); 6] = {
    const A: f64 = 0.445_948_490_915_965;
    const B: f64 = 0.091_576_213_509_771;
    const OF_A: f64 = 0.223_381_589_678_011;
    const OF_B: f64 = 0.109_951_743_655_322;
    [
        ([1.0 - 2.0 * A, A, A], OF_A),
        ([A, 1.0 - 2.0 * A, A], OF_A),
        ([A, A, 1.0 - 2.0 * A], OF_A),
        ([1.0 - 2.0 * B, B, B], OF_B),
        ([B, 1.0 - 2.0 * B, B], OF_B),
        ([B, B, 1.0 - 2.0 * B], OF_B),
    ]
};

/// Scales the weights of a plan's reflected light to what is known of it, given the plan's
/// own solution.
pub(super) fn scale(plan: &mut Plan, room: &Room<'_>, light: &Solution<'_>, known: &Known<'_>) {
    let irradiance = light.irradiance();
    let value = |sample: usize| {
        let channels = irradiance.get(sample).copied().unwrap_or_default();
        channels.into_iter().map(f64::from).sum::<f64>() / 3.0
    };
    let mut first = 0;
    for (index, surface) in plan.surfaces.iter_mut().enumerate() {
        let (samples, frame) = (surface.samples.len(), &surface.frame);
        let reflected = surface
            .fields
            .iter_mut()
            .filter(|field| field.tensor.is_none());
        for mesh in reflected.filter_map(|field| field.mesh.as_mut()) {
            let places = room.looked_at(index);
            let at_nodes = (known.settled)(&places[..mesh.nodes.len().min(places.len())]);
            let wanted = fitted(frame, mesh, &at_nodes, known);
            let from = first + mesh.first;
            for (node, wanted) in mesh.nodes.iter_mut().zip(wanted) {
                let shares = node.shares.iter();
                let found: f64 = shares.map(|&(k, weight)| weight * value(from + k)).sum();
                if found > 0.0 && wanted > 0.0 {
                    let factor = (wanted / found).clamp(1.0 / MOST, MOST);
                    node.shares
                        .iter_mut()
                        .for_each(|(_, weight)| *weight *= factor);
                }
            }
        }
        first += samples;
    }
}

/// The places of the [`RULE`] in all triangles of a mesh with the normal, and the area in m²
/// that each stands for.
fn within(frame: &Frame, mesh: &Mesh) -> (Vec<(DVec3, DVec3)>, Vec<f64>) {
    let of_triangle = |triangle: &[usize; 3]| {
        let corners = triangle.map(|k| DVec2::from(mesh.nodes[k].place));
        let area = 0.5
            * (corners[1] - corners[0])
                .perp_dot(corners[2] - corners[0])
                .abs();
        RULE.map(|(shares, part)| {
            let place: DVec2 = corners.iter().zip(shares).map(|(&c, s)| c * s).sum();
            let place = frame.to_world(place.x, place.y);
            ((place, frame.normal), area * part)
        })
    };
    mesh.triangles.iter().flat_map(of_triangle).unzip()
}

/// What nodes have to have so that linear values between them miss least of what is known of
/// reflected light: least squares of the part of all light that is missed, over the triangles,
/// each place as far as it counts.
fn fitted(frame: &Frame, mesh: &Mesh, at_nodes: &[f64], known: &Known<'_>) -> Vec<f64> {
    let (places, areas) = within(frame, mesh);
    let reflected = (known.settled)(&places);
    let direct = (known.direct)(&places).into_iter();
    let all: Vec<f64> = (reflected.iter().zip(direct))
        .map(|(reflected, direct)| reflected + direct.iter().map(|&x| f64::from(x)).sum::<f64>())
        .collect();
    let brightest = all.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let count = at_nodes.len();
    let mut normal = DMatrix::<f64>::zeros(count, count);
    let mut right = DVector::<f64>::zeros(count);
    for (k, &(place, facing)) in places.iter().enumerate() {
        let corners = mesh.triangles[k / RULE.len()];
        let (shares, _) = RULE[k % RULE.len()];
        let scale = all[k].max(DARK * brightest);
        let weight = areas[k] * (known.importance)(place, facing) / (scale * scale);
        for (&i, x) in corners.iter().zip(shares) {
            right[i] += weight * x * reflected[k];
            for (&j, y) in corners.iter().zip(shares) {
                normal[(i, j)] += weight * x * y;
            }
        }
    }
    for k in 0..count {
        // A node of no triangle keeps what it has.
        let own = match normal[(k, k)] {
            around if around > 0.0 => AT_NODE * around,
            _ => 1.0,
        };
        normal[(k, k)] += own;
        right[k] += own * at_nodes[k];
    }
    match normal.cholesky() {
        Some(factors) => factors.solve(&right).iter().copied().collect(),
        None => at_nodes.to_vec(),
    }
}
