//! Places at which the answers of two meshes are compared.

use super::patch::Receiver;
use super::tree::Tree;

/// Points at which two meshes are compared.
const PROBES: usize = 200;

/// A place darker than this share of the brightest is compared with that share.
const DARK: f64 = 1e-2;

/// A place, and the area in m² that it stands for.
pub(super) struct Probe {
    pub(super) receiver: Receiver,
    area: f64,
}

/// Places spread over the reflecting surfaces, none at a node.
pub(super) fn spread(tree: &Tree) -> Vec<Probe> {
    let base = &tree.base;
    let stride = base.len().div_ceil(PROBES).max(1);
    let rounds = (PROBES / base.len().max(1)).max(1);
    let mut probes = Vec::new();
    for (number, &index) in base.iter().enumerate().step_by(stride) {
        let cell = &tree.cells[index];
        for round in 0..rounds {
            // A place between a corner and the middle, by the golden ratio.
            let spin = (number * rounds + round) as f64;
            let share = (0.618_033_988_749_895 * spin).fract();
            let corner = cell.outline[(number + round) % cell.outline.len()];
            let next = cell.outline[(number + round + 1) % cell.outline.len()];
            let rim = corner.lerp(next, (0.754_877_666_246_693 * spin).fract());
            let place = cell.centre.lerp(rim, 0.95 * share.sqrt());
            probes.push(Probe {
                receiver: tree.reflectors[cell.reflector].receiver(place),
                area: cell.area,
            });
        }
    }
    probes
}

/// How much two answers at the probes differ, relative to the second: root of
/// the mean square over the area, in the worst channel.
pub(super) fn disagreement(probes: &[Probe], before: &[[f64; 3]], after: &[[f64; 3]]) -> f64 {
    let whole: f64 = probes.iter().map(|probe| probe.area).sum();
    let mut worst = 0.0_f64;
    for channel in 0..3 {
        let brightest = after.iter().map(|value| value[channel]).fold(0.0, f64::max);
        if brightest <= 0.0 {
            continue;
        }
        let pairs = before.iter().zip(after).zip(probes);
        let squares: f64 = pairs
            .map(|((a, b), probe)| {
                let full = b[channel].max(DARK * brightest);
                probe.area * ((a[channel] - b[channel]) / full).powi(2)
            })
            .sum();
        worst = worst.max((squares / whole).sqrt());
    }
    worst
}
