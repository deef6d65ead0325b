//! What every sample receives in the end of every luminaire alone.
//!
//! The kernel itself lights the scene with one luminaire after the other; any dimming
//! is a sum of that. Reflectances are those of the scene.

use super::{Tables, Written};
use crate::solve::{self, Rung, Sight, Solution};
use isolux::scene::Response;
use isolux::shoot::Stop;
use std::f32::consts::FRAC_1_PI;

/// The part of a luminaire's power that its response leaves out.
const STOP: Stop = Stop::Below {
    fraction: 1e-5,
    shots: 1 << 20,
};

/// The responses of a scene whose occluders, if any, are in these tables.
///
/// # Errors
/// Those of the kernel, which does not take tables that are too large for the host.
pub(super) fn of(tables: &Tables) -> Result<Written, isolux::Error> {
    let sight = match tables.counts.occluders {
        0 => Sight::None,
        _ => Sight::Exact,
    };
    let mut solution = solve::solve(tables, Rung::default(), sight, Stop::Reflections(0))?;
    let luminaires = tables.counts.luminaires as usize;
    let channels = tables.counts.channels as usize;
    let mut written = Written::default();
    for luminaire in 0..luminaires {
        let alone = alone(&mut solution, luminaires, luminaire)?;
        for channel in 0..channels {
            let values = alone.iter().map(|value| value[channel].max(0.0));
            let largest = values.clone().fold(0.0, f32::max);
            let scale = largest / Response::of(u16::MAX);
            let code = |value: f32| match scale > 0.0 {
                // The cast saturates.
                true => (value / scale).sqrt().round() as u16,
                false => 0,
            };
            written.responses.extend(values.map(code));
            written.scales.push(scale);
        }
    }
    Ok(written)
}

/// The light of one luminaire of 1 W m⁻² of exitance, from darkness.
fn alone(
    solution: &mut Solution<'_>,
    luminaires: usize,
    on: usize,
) -> Result<Vec<solve::Channels>, isolux::Error> {
    for luminaire in 0..luminaires {
        solution.set_radiance(luminaire, [0.0; 3])?;
    }
    // Nothing emits: it is dark.
    solution.update(STOP);
    solution.set_radiance(on, [FRAC_1_PI; 3])?;
    solution.update(STOP);
    Ok(solution.irradiance())
}
