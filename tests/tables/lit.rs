//! What a firmware does with tables that loaded: it lights the scene, dims it,
//! reconstructs its surfaces and asks for light, and nothing of it may be a panic, a
//! NaN or an end that does not come.

use isolux::form_factor::Best;
use isolux::geometry::Receiver;
use isolux::luminance::{Colour, Luminance};
use isolux::number::SoftRoot;
use isolux::resample::Reconstruction;
use isolux::scene::Scene;
use isolux::shoot::{Light, Stop};
use isolux::transfer::Transfer;
use isolux::visibility::{Exact, Visibility};

/// What a firmware of such a table would be.
type Lit<'t, L, V> = Light<'t, Best, 80, 64, L, V>;

/// The most values that a firmware has room to reconstruct in.
const ROOM: usize = 2000;

/// What it looks with.
pub(crate) type Sights = Exact<8, 6, 24, 6>;

fn is_number<C: Colour>(value: C, case: u64, of: &str) {
    value.map(|x| {
        assert!(!x.is_nan(), "case {case}: {of} {x}");
        x
    });
}

/// Places to ask for light at.
const PLACES: [([f32; 3], [f32; 3]); 3] = [
    ([0.1, 0.2, 0.0], [0.0, 0.0, 1.0]),
    ([1.0, -1.0, 1.0], [1.0, 1.0, 1.0]),
    ([1e8, -1e8, 1e-8], [-1.0, 1.0, 0.0]),
];

/// Lights a scene and asks for everything; whether the type held it.
pub(crate) fn lit<L: Luminance, V: Transfer + Default, Q: Reconstruction>(
    scene: Scene<'_>,
    case: u64,
    ask: impl FnOnce(&Lit<'_, L, V>),
) -> bool {
    let Ok(light) = Lit::<L, V>::new(scene) else {
        return false;
    };
    let mut light = Box::new(light);
    let below = Stop::Below {
        fraction: 1e-3,
        shots: 6,
    };
    let stops = [below, Stop::Reflections(1), Stop::Shots(6)];
    let stop = stops[case as usize % stops.len()];
    let solved = light.solve(stop);
    is_number(solved.unshot, case, "unshot");
    assert!(solved.shots <= 134, "case {case}: {} shots", solved.shots);
    if case.is_multiple_of(4) {
        // Dimmed, or brighter than anything is: refused then.
        let to = if case.is_multiple_of(8) { 0.5 } else { 1e30 };
        let _ = light.set_radiance(0, L::Colour::DARK.map(|_| to));
        let solved = light.update(stop);
        is_number(solved.unshot, case, "unshot");
    }
    for &value in light.irradiance() {
        is_number(value, case, "irradiance");
    }
    let mut row = [L::Colour::DARK; 4];
    let mut room = vec![L::Colour::DARK; ROOM];
    for (index, surface) in scene.surfaces().iter().enumerate() {
        if scene.fields().room(surface) <= ROOM
            && let Ok(reconstructed) = light.reconstruct::<Q>(index, &mut room)
        {
            for v in 0..4 {
                reconstructed.row([4, 4], v, &mut row).expect("a row");
                row.iter()
                    .for_each(|&value| is_number(value, case, "reconstructed"));
            }
        }
        light
            .resample_row::<SoftRoot>(index, [4, 4], 1, &mut row)
            .expect("a surface, a row and room");
        row.iter()
            .for_each(|&value| is_number(value, case, "filtered"));
    }
    ask(&light);
    true
}

/// As [`lit`], and asks for the light at places nobody planned for.
pub(crate) fn looked<L: Luminance, V: Visibility + Default, Q: Reconstruction>(
    scene: Scene<'_>,
    case: u64,
) -> bool {
    lit::<L, V, Q>(scene, case, |light| {
        for (p, n) in PLACES {
            let receiver = Receiver::new::<SoftRoot>(p, n).expect("a receiver");
            let bracket = light.at_with(&receiver, &mut V::default());
            is_number(bracket.low, case, "low");
            is_number(bracket.high, case, "high");
        }
    })
}
