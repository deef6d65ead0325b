//! What the patches shoot, had from the samples that are there for display.
//!
//! A draft's patch has its radiosity from places of its own. Here the same mean and
//! gradients are made of the samples around it, by the weights that are right for
//! every luminaire alone and for whatever the patches may send
//! ([`super::super::fields::shares`]).

use super::super::fields::shares;
use super::super::patches::Patch;
use super::super::{Plan, Receives, SurfacePlan};
use super::{Known, Places};
use glam::{DVec2, DVec3};
use isolux::scene::records::HEAVIEST;
use rayon::prelude::*;

/// Samples that a patch is told by are chosen from so many nearest ones.
const NEAREST: usize = 24;

/// Gives a plan the patches of the draft.
pub(super) fn shoot_from_samples(plan: &mut Plan, known: &Known<'_>) {
    let drafts = &known.draft.surfaces;
    plan.surfaces
        .par_iter_mut()
        .zip(drafts)
        .for_each(|(planned, draft)| planned.patches = patches(planned, draft, known));
}

/// What places receive of a kind of light, a row each.
type Rows<'a> = dyn Fn(&Places, Receives) -> Vec<Vec<f64>> + 'a;

/// One kind of light: at the draft's places and at the samples.
struct Kind {
    /// The draft's samples of this kind, and what they may receive.
    draft: Vec<Option<Vec<f64>>>,
    /// The plan's.
    samples: Vec<(usize, [f64; 2], Vec<f64>)>,
}

fn patches(planned: &SurfacePlan, draft: &SurfacePlan, known: &Known<'_>) -> Vec<Patch> {
    let frame = &planned.frame;
    let world = |[u, v]: [f64; 2]| (frame.to_world(u, v), frame.normal);
    let kind = |receives: &[Receives], rows: &Rows<'_>| {
        let of = |surface: &SurfacePlan, kind: Receives| -> Vec<(usize, [f64; 2], Vec<f64>)> {
            let samples = surface.samples.iter().enumerate();
            let chosen: Vec<(usize, [f64; 2])> = samples
                .filter(|(_, sample)| sample.tag.receives() == kind)
                .map(|(k, sample)| (k, sample.place))
                .collect();
            let places: Vec<(DVec3, DVec3)> =
                chosen.iter().map(|&(_, place)| world(place)).collect();
            let rows = rows(&places, kind);
            chosen
                .into_iter()
                .zip(rows)
                .map(|((k, place), row)| (k, place, row))
                .collect()
        };
        let mut of_draft = vec![None; draft.samples.len()];
        let mut samples = Vec::new();
        for &kind in receives {
            for (k, _, row) in of(draft, kind) {
                of_draft[k] = Some(row);
            }
            samples.extend(of(planned, kind));
        }
        Kind {
            draft: of_draft,
            samples,
        }
    };
    let wide = |terms: Vec<Vec<f32>>| -> Vec<Vec<f64>> {
        let row = |terms: Vec<f32>| terms.into_iter().map(f64::from).collect();
        terms.into_iter().map(row).collect()
    };
    let direct = kind(
        &[Receives::Unshadowed, Receives::Direct],
        &|places, kind| {
            wide(match kind {
                Receives::Unshadowed => (known.unshadowed)(places),
                _ => (known.direct)(places),
            })
        },
    );
    let of_surfaces = known.patches();
    let reflected = kind(&[Receives::Reflected], &|places, _| {
        let rows = wide((known.reflected)(places));
        rows.iter()
            .map(|parts| shares::row(parts, &of_surfaces))
            .collect()
    });
    let with_members = |patch: &Patch| {
        let mut members = direct.members(patch, known.shares);
        members.extend(reflected.members(patch, known.shares));
        Patch {
            members,
            ..patch.clone()
        }
    };
    draft.patches.iter().map(with_members).collect()
}

impl Kind {
    /// The samples, no more than `most` for each, and weights that tell a patch its mean and
    /// gradients.
    fn members(&self, patch: &Patch, most: usize) -> Vec<(usize, [f64; 3])> {
        let center = DVec2::from(patch.center);
        let mut near: Vec<&(usize, [f64; 2], Vec<f64>)> = self.samples.iter().collect();
        let distance =
            |sample: &(usize, [f64; 2], Vec<f64>)| DVec2::from(sample.1).distance_squared(center);
        near.sort_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.0.cmp(&b.0)));
        near.truncate(NEAREST);
        let offered: Vec<(usize, &[f64])> = near.iter().map(|s| (s.0, s.2.as_slice())).collect();
        let mut members: Vec<(usize, [f64; 3])> = Vec::new();
        for coefficient in 0..3 {
            let mut target: Vec<f64> = Vec::new();
            for (place, weights) in &patch.members {
                if let Some(row) = &self.draft[*place] {
                    target.resize(row.len(), 0.0);
                    for (sum, x) in target.iter_mut().zip(row) {
                        *sum += weights[coefficient] * x;
                    }
                }
            }
            let fitted = shares::fit(&target, &offered, most);
            // Where all samples of a surface are next to dark and a patch of it is not, they
            // tell of its light by weights that no table holds: of a part of it, then.
            let heaviest = fitted
                .iter()
                .fold(0.0, |most, (_, w)| f64::max(most, w.abs()));
            let part = f64::min(1.0, f64::from(HEAVIEST) / heaviest);
            for (sample, weight) in fitted {
                let weight = part * weight;
                match members.iter_mut().find(|(k, _)| *k == sample) {
                    Some((_, weights)) => weights[coefficient] = weight,
                    None => {
                        let mut weights = [0.0; 3];
                        weights[coefficient] = weight;
                        members.push((sample, weights));
                    }
                }
            }
        }
        members
    }
}
