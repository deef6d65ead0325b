//! What a scene costs, known before it runs.

use crate::scene::Scene;

/// Bytes of RAM that [`Light`](crate::shoot::Light) takes on a 32-bit part:
/// 4 a sample, 8 an emitter, and 64 for the borrowed tables and the counts.
///
/// Exact on thumb targets: the firmware does not compile where `size_of` differs.
pub const fn light_bytes(samples: usize, emitters: usize) -> usize {
    4 * samples + 8 * emitters + 64
}

/// Form factors that direct light costs: one per luminaire and sample, less
/// the samples on a luminaire's own surface.
pub fn direct_form_factors(scene: &Scene<'_>) -> u64 {
    shots(scene, |emitter| emitter.exitance > 0.0)
}

/// Form factors that one reflection costs at the most: one per emitter and
/// sample, less the samples on an emitter's own surface.
pub fn reflection_form_factors(scene: &Scene<'_>) -> u64 {
    shots(scene, |emitter| emitter.members > 0)
}

fn shots(scene: &Scene<'_>, counts: impl Fn(&crate::scene::records::Emitter) -> bool) -> u64 {
    let all = scene.samples().len() as u64;
    scene
        .emitters()
        .iter()
        .filter(|emitter| counts(emitter))
        .map(|emitter| {
            let own = scene
                .surface(emitter.surface as usize)
                .map_or(0, |s| u64::from(s.samples));
            all.saturating_sub(own)
        })
        .fold(0, u64::saturating_add)
}
