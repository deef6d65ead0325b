//! Weights that give the light there is.
//!
//! Weights of samples are fitted to whatever patches may send. At the foot of something
//! few samples see what a place there sees, and what the plan's patches send is itself
//! least right; so when a plan has been solved, the weights of every node of reflected light
//! are scaled until they give what the judge says is there. For another light the factor is
//! as right as it is for this one.

use crate::plan::Plan;
use crate::plan::room::{Known, Room};
use crate::solve::Solution;

/// No node is scaled by more than this factor, or less than its inverse.
const MOST: f64 = 2.0;

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
        let samples = surface.samples.len();
        let reflected = surface
            .fields
            .iter_mut()
            .filter(|field| field.tensor.is_none());
        for mesh in reflected.filter_map(|field| field.mesh.as_mut()) {
            let places = room.looked_at(index);
            let wanted = (known.settled)(&places[..mesh.nodes.len().min(places.len())]);
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
