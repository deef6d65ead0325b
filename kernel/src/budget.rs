//! What a scene costs, known before it runs.

use crate::scene::Scene;
use crate::scene::records::{Counts, Sight};

/// Bytes of RAM that [`Light`](crate::shoot::Light) takes on a 32-bit part: for
/// every channel 4 a sample and 8 an emitter's coefficient, and 228 for the
/// borrowed tables and the counts.
///
/// Exact on thumb targets: the firmware does not compile where `size_of` differs.
pub const fn light_bytes(counts: &Counts) -> usize {
    let coefficients = counts.emitters as usize * counts.coefficients as usize;
    counts.channels as usize * (4 * counts.samples as usize + 8 * coefficients) + 228
}

/// Bytes of RAM that [`Light`](crate::shoot::Light) takes besides where reflectances may
/// change: 4 a surface and channel.
pub const fn reflectance_bytes(counts: &Counts) -> usize {
    4 * counts.channels as usize * counts.surfaces as usize
}

/// Bytes of RAM that the workspace of [`Exact`](crate::visibility::Exact) takes
/// on a 32-bit part; 0 where nothing occludes.
///
/// Exact on thumb targets: the firmware does not compile where `size_of` differs.
pub const fn sight_bytes(sight: &Sight) -> usize {
    if sight.vertices == 0 {
        return 0;
    }
    let polygon = 8 * sight.vertices as usize + 8;
    let ends = (2 * sight.blockers as usize).next_multiple_of(4);
    let waiting = sight.pieces as usize * (polygon + 8);
    76 + 4 * polygon + 12 * sight.lines as usize + ends + waiting
}

/// Bytes of RAM that the room takes in which surfaces are reconstructed, one after the
/// other: 4 a value and channel; 0 where the cone filter does it.
pub const fn room_bytes(counts: &Counts) -> usize {
    4 * counts.channels as usize * counts.room as usize
}

/// Form factors that direct light costs: one per luminaire and sample, less
/// the samples on a luminaire's own surface.
pub fn direct_form_factors(scene: &Scene<'_>) -> u64 {
    shots(scene, true)
}

/// Form factors that one reflection costs at the most: one per emitter and
/// sample, less the samples on an emitter's own surface.
pub fn reflection_form_factors(scene: &Scene<'_>) -> u64 {
    shots(scene, false)
}

fn shots(scene: &Scene<'_>, of_luminaires: bool) -> u64 {
    let receivers = |surface| {
        let samples = scene.receivers(surface, of_luminaires);
        samples.len() as u64
    };
    let all: u64 = scene.receiving().iter().map(receivers).sum();
    scene
        .emitters()
        .iter()
        .enumerate()
        .filter(|&(index, _)| scene.is_luminaire(index) == of_luminaires)
        .map(|(_, emitter)| {
            let own = scene.surface(emitter.surface as usize);
            all.saturating_sub(own.map_or(0, receivers))
        })
        .fold(0, u64::saturating_add)
}
