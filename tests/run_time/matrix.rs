//! Rounded terms and responses against the same scene computed past its occluders.

use crate::scenes::{self, Planned};
use isolux::shoot::Stop;
use isolux_host::bake::Tables;
use isolux_host::solve::{self, Channels, Rung, Sight};

/// What is unshot comes to several times as much in a room: far below what terms err by.
const STOP: Stop = Stop::Below {
    fraction: 1e-5,
    shots: 20_000,
};

/// Errors of reflected light at samples, in percent of each value, and of all light
/// at the named points.
struct Errors {
    rms: f64,
    largest: f64,
    points: f64,
}

/// What every sample has with the luminaires that are on, at these times their
/// radiances.
fn lit(tables: &Tables, radiances: &[[f32; 3]]) -> (Vec<Channels>, Vec<Channels>) {
    let mut solution = solve::solve(tables, Rung::Best, Sight::Exact, STOP).expect("a solution");
    for (luminaire, radiance) in radiances.iter().enumerate() {
        solution.set_radiance(luminaire, *radiance).expect("sound");
    }
    solution.update(STOP);
    (solution.irradiance(), solution.points())
}

/// The largest errors of any luminaire alone, and of all together.
fn errors(planned: &Planned, tables: &Tables) -> Errors {
    let nominal = planned.radiances();
    let alone = (0..nominal.len()).map(|on| {
        let only = |k| if k == on { nominal[k] } else { [0.0; 3] };
        (0..nominal.len()).map(only).collect()
    });
    let states: Vec<Vec<[f32; 3]>> = alone.chain([nominal.clone()]).collect();
    let mut errors = Errors {
        rms: 0.0,
        largest: 0.0,
        points: 0.0,
    };
    for radiances in &states {
        let (exact, exact_points) = lit(tables.computed(), radiances);
        let (got, points) = lit(tables, radiances);
        let scale = exact.iter().map(|e| e[0]).fold(0.0, f32::max);
        let pairs = got.iter().zip(&exact).filter(|(_, e)| e[0] > 1e-3 * scale);
        let off: Vec<f64> = pairs
            .map(|(got, exact)| f64::from(got[0] / exact[0] - 1.0).abs())
            .collect();
        let squares: f64 = off.iter().map(|off| off * off).sum();
        let rms = 100.0 * (squares / off.len() as f64).sqrt();
        let largest = 100.0 * off.iter().copied().fold(0.0, f64::max);
        let pairs = points.iter().zip(&exact_points);
        let of_points = pairs.map(|(got, exact)| f64::from(got[0] / exact[0] - 1.0).abs());
        errors.rms = errors.rms.max(rms);
        errors.largest = errors.largest.max(largest);
        errors.points = errors.points.max(100.0 * of_points.fold(0.0, f64::max));
    }
    errors
}

#[test]
fn terms_err_by_what_their_bits_allow() {
    for (name, planned) in [("office", scenes::finer()), ("box", scenes::coloured())] {
        let show = |how: &str, tables: &Tables| {
            let found = errors(planned, tables);
            println!(
                "{name}, {how}: {} bytes for {}; rms {:.4} %, largest {:.3} %, points {:.4} %",
                tables.bytes().len(),
                tables.computed().bytes().len(),
                found.rms,
                found.largest,
                found.points
            );
            found
        };
        show("codes", &planned.coded());
        // Rms at samples and largest at named points, in percent, for any luminaire
        // alone and all together.
        for (bits, rms, points) in [(4, 2.0, 3.0), (6, 0.5, 0.6), (8, 0.3, 0.06)] {
            let found = show(&format!("{bits} bits"), &planned.matrix(bits));
            assert!(found.rms < rms && found.points < points, "{name}, {bits}");
        }
        let found = show("vectors", &planned.vectors());
        assert!(found.rms < 0.05 && found.points < 0.05, "{name}, vectors");
    }
}
