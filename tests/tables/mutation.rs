//! Tables that somebody changed: whatever loads can be lit, resampled and
//! asked, without a panic, a NaN or an end that does not come.
//!
//! 100 000 tables by default; `ISOLUX_CASES=1000000 cargo test --release --test
//! tables mutated` for more, `ISOLUX_SEED` for others.

use crate::bytes::{Words, lengthened, seal};
use crate::energy::{patched, room};
use crate::paper;
use isolux::form_factor::{Arithmetic, Best, Libm};
use isolux::geometry::Receiver;
use isolux::number::SoftRoot;
use isolux::scene::Scene;
use isolux::shoot::{Light, Stop};
use isolux_host::bake;

/// Marsaglia's xorshift, so that a case is its number alone.
pub(crate) struct Dice(u64);

impl Dice {
    pub(crate) fn new(seed: u64, case: u64) -> Self {
        let mut dice = Self((seed ^ case.wrapping_mul(0x9e37_79b9_7f4a_7c15)) | 1);
        for _ in 0..8 {
            dice.next();
        }
        dice
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    pub(crate) fn below(&mut self, end: usize) -> usize {
        ((u128::from(self.next()) * end as u128) >> 64) as usize
    }
}

/// Numbers that a check may have forgotten.
const NUMBERS: [f32; 20] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    0.999_999_9,
    1e-45,
    1e-38,
    -1e-30,
    1e-8,
    1e8,
    -1e8,
    1.1e8,
    1e20,
    1e32,
    1.1e32,
    f32::MAX,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

pub(crate) fn mutated(sound: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = sound.to_vec();
    for _ in 0..=dice.below(4) {
        if bytes.is_empty() {
            break;
        }
        // Half of the changes hit the head and the records' heads.
        let reach = if dice.below(2) == 0 {
            bytes.len()
        } else {
            bytes.len().min(600)
        };
        let at = dice.below(reach);
        let word = at / 4 * 4;
        let room = bytes.len().saturating_sub(word) >= 4;
        match dice.below(8) {
            0 => bytes[at] ^= 1 << dice.below(8),
            1 => bytes[at] = dice.next() as u8,
            2 if room => bytes[word..word + 4].copy_from_slice(&(dice.next() as u32).to_le_bytes()),
            3 if room => {
                let small = dice.below(70) as u32;
                bytes[word..word + 4].copy_from_slice(&small.to_le_bytes());
            }
            4 | 5 if room => {
                let number = NUMBERS[dice.below(NUMBERS.len())];
                bytes[word..word + 4].copy_from_slice(&number.to_le_bytes());
            }
            6 => {
                // One place's word at another place.
                let from = dice.below(bytes.len()) / 4 * 4;
                let copy: Vec<u8> = bytes[from..].iter().take(4).copied().collect();
                let end = (word + copy.len()).min(bytes.len());
                bytes[word..end].copy_from_slice(&copy[..end - word]);
            }
            _ if dice.below(16) == 0 => bytes.truncate(at),
            _ if dice.below(16) == 0 => {
                bytes.extend(std::iter::repeat_n(dice.next() as u8, at % 64))
            }
            _ => {}
        }
    }
    bytes
}

/// Lights a scene and asks for everything; the answers must be numbers.
fn use_it<A: Arithmetic<f32>>(scene: Scene<'_>, case: u64) {
    let mut light = Box::new(Light::<A, 64, 16>::new(scene).expect("the paper's counts at most"));
    let stop = Stop::Below {
        fraction: 1e-3,
        shots: 40,
    };
    let stops = [stop, Stop::Reflections(2), Stop::Shots(12)];
    let solved = light.solve(stops[case as usize % stops.len()]);
    let is_number = |x: f32, of: &str| assert!(!x.is_nan() && x >= 0.0, "case {case}: {of} {x}");
    is_number(solved.unshot, "unshot");
    assert!(solved.shots <= 200, "case {case}: {} shots", solved.shots);
    for &value in light.irradiance() {
        is_number(value, "irradiance");
    }
    for emitter in 0..scene.emitters().len() {
        is_number(light.radiosity(emitter).0, "radiosity");
    }
    let mut row = [0.0; 6];
    for surface in 0..scene.surfaces().len() {
        for v in 0..6 {
            light
                .resample_row::<SoftRoot>(surface, [6, 6], v, &mut row)
                .expect("a surface, a row and room");
            for value in row {
                is_number(value, "resampled");
            }
        }
    }
    for (p, n) in [
        ([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ([5.0, 0.5, 2.2], [0.0, 0.0, -1.0]),
        ([1.0, -1.0, 1.0], [1.0, 1.0, 1.0]),
        ([1e8, -1e8, 1e-8], [-1.0, 1.0, 0.0]),
    ] {
        let receiver = Receiver::new::<SoftRoot>(p, n).expect("a receiver");
        is_number(light.at(&receiver), "at");
    }
}

/// A number from the environment.
pub(crate) fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().expect(name))
}

#[test]
fn mutated_tables_are_refused_or_give_numbers() {
    let sound = paper().2.bytes();
    let (seed, cases) = (setting("ISOLUX_SEED", 1), setting("ISOLUX_CASES", 100_000));
    let (mut loaded, mut refused) = (0_u64, 0_u64);
    for case in 0..cases {
        let mut dice = Dice::new(seed, case);
        let mut bytes = mutated(sound, &mut dice);
        // One in eight keeps its old checksum.
        if dice.below(8) > 0 {
            if dice.below(2) == 0 {
                lengthened(&mut bytes);
            }
            seal(&mut bytes);
        }
        let words = Words::new(&bytes);
        match Scene::load(words.bytes(bytes.len())) {
            Ok(scene) => {
                loaded += 1;
                if case % 4 == 0 {
                    use_it::<Libm>(scene, case);
                } else {
                    use_it::<Best>(scene, case);
                }
            }
            Err(_) => refused += 1,
        }
    }
    println!("{loaded} loaded, {refused} refused");
    // Both must be met, or nothing was tested.
    assert!(
        loaded * 10 > cases && refused * 10 > cases,
        "{loaded} {refused}"
    );
}

/// Tables that are sound as bytes and impossible as a scene: as bright and as
/// large as the format allows, reflecting nearly all, and every wall 40 times
/// over, so that each shot brings more than it took. Light grows, but not into
/// infinity less infinity.
#[test]
fn impossible_energy_gives_no_nan() {
    let (scene, plan, _) = patched(&room([3.0; 3], [(1e20, 0.999); 6]), 1);
    let mut plan = plan.clone();
    for surface in &mut plan.surfaces {
        let mut band = surface.bands[0].clone();
        band.area = 5e16;
        surface.bands = vec![band; 40];
    }
    let tables = bake::bake(&scene, &plan, None).expect("tables");
    let scene = Scene::load(tables.bytes()).expect("what the format allows");
    let mut light = Box::new(Light::<Best, 64, 256>::new(scene).expect("room"));
    for stop in [
        Stop::Reflections(100),
        Stop::Shots(30_000),
        Stop::below(1e-3),
    ] {
        let solved = light.solve(stop);
        assert!(solved.unshot.is_finite(), "{solved:?} after {stop:?}");
        assert!(light.irradiance().iter().all(|e| e.is_finite()), "{stop:?}");
        let all = 0..scene.emitters().len();
        assert!(
            all.clone().all(|k| light.radiosity(k).0.is_finite()),
            "{stop:?}"
        );
        let middle = Receiver::new::<SoftRoot>([1.5; 3], [0.0, 0.0, 1.0]).expect("a receiver");
        assert!(light.at(&middle).is_finite(), "{stop:?}");
    }
}
