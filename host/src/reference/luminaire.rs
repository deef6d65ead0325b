//! Luminaires and the direct light of what a receiver sees of them.

use std::f64::consts::PI;

use glam::DVec3;

use super::Error;
use super::convex::Loop;
use super::form_factor::form_factor_signed;
use super::partition;
use super::surface::Outline;
use super::visible::Sight;
use crate::scene::Scene;

/// A polygon of constant radiance.
pub(super) struct Luminaire {
    /// Where it is.
    pub(super) outline: Outline,
    /// Radiance of each channel.
    pub(super) radiance: [f64; 3],
    /// Area in m².
    pub(super) area: f64,
    /// Its convex parts.
    parts: Vec<Vec<DVec3>>,
}

/// The surfaces that emit in any channel.
pub(super) fn luminaires(scene: &Scene) -> Result<Vec<Luminaire>, Error> {
    let emitting = scene.surfaces.iter().filter(|surface| surface.emits());
    emitting
        .map(|surface| {
            let parts = partition::convex_pieces(&surface.vertices, surface.normal);
            Ok(Luminaire {
                outline: Outline::new(scene, surface),
                radiance: surface.radiance,
                area: surface.area,
                parts: parts.ok_or_else(|| Error::Outline {
                    surface: surface.name.clone(),
                })?,
            })
        })
        .collect()
}

/// Irradiance by all luminaires: `E = Σ π L F`, F of the visible part.
pub(super) fn direct(luminaires: &[Luminaire], sight: &Sight) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let everything = sight.everything();
    for luminaire in luminaires {
        let factor = luminaire.visible_factor(sight, &everything);
        let channels = sum.iter_mut().zip(luminaire.radiance);
        channels.for_each(|(sum, radiance)| *sum += PI * radiance * factor);
    }
    sum
}

impl Luminaire {
    /// Form factor to the part that nothing hides.
    fn visible_factor(&self, sight: &Sight, everything: &[u32]) -> f64 {
        let receiver = &sight.receiver;
        if self.outline.height(receiver).is_none() {
            return 0.0;
        }
        let mut free = true;
        let mut sum = 0.0;
        for part in &self.parts {
            let polygon = sight.relative(part);
            let Some(blockers) = sight.blockers(everything, &polygon, self.outline.normal) else {
                free = false;
                continue;
            };
            free &= blockers.is_empty();
            let fragments = sight.fragments(polygon, &blockers);
            let factor =
                |fragment: &Loop| form_factor_signed(DVec3::ZERO, receiver.normal, fragment);
            sum += fragments.iter().map(factor).sum::<f64>();
        }
        // Nothing in between: the polygon as it is, in its own coordinates.
        if free {
            self.outline.form_factor(receiver)
        } else {
            sum.clamp(0.0, 1.0)
        }
    }
}
