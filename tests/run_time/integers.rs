//! Integers: what was written down gives the light of floating point to the rung's error,
//! what is lit on agrees with what is lit anew, and changed tables are refused or lit.

use crate::scenes::{self, Planned};
use isolux::Error;
use isolux::error::What;
use isolux::integers::{Computed, Format, Header, Light, Matrix, Q24, Q29, Scene, Transfer};
use isolux::scene::records::{Counts, checksum};
use isolux::shoot::Stop;
use isolux_host::bake::{Tables, integers};
use isolux_host::solve::{self, FormFactorRung, Rung, Sight};
use proptest::prelude::*;
use std::mem::offset_of;
use std::sync::OnceLock;
use zerocopy::IntoBytes;

/// As in floating point: of the power, what two solves may leave unshot.
const UNSHOT: f32 = 5e-7;

const STOP: Stop = Stop::Below {
    fraction: UNSHOT,
    shots: 20_000,
};

/// What may differ, of the largest irradiance there ever was: what both stops leave, and
/// half a unit of 2⁻³⁰ for each of some thousand additions.
const TOLERANCE: f64 = 1e-5;

type Room<'t, F, T> = Light<'t, F, 1024, 256, T>;

fn dark<F: Format, T: Transfer>(tables: &Tables) -> Box<Room<'_, F, T>> {
    let scene = Scene::load(tables.bytes()).expect("sound tables");
    Box::new(Light::new(scene).expect("room"))
}

fn bands(planned: &Planned) -> Tables {
    integers::bake(&planned.scene, &planned.plan).expect("tables")
}

fn matrix(planned: &Planned) -> Tables {
    planned.matrix_in_integers(8)
}

/// Irradiances in W m⁻².
fn watts<F: Format, T: Transfer>(light: &Room<'_, F, T>) -> Vec<f64> {
    let unit = 2.0_f64.powi(light.scene().header().irradiance);
    let values = light.irradiance().iter();
    values.map(|&e| f64::from(e) * unit).collect()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, e| most.max(e.abs()))
}

/// The largest difference as a part of `scale`.
fn apart(a: &[f64], b: &[f64], scale: f64) -> f64 {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) / scale
}

/// Dims every luminaire, one after the other or all at once, and sets it back.
fn follows<F: Format, T: Transfer>(
    planned: &Planned,
    bake: fn(&Planned) -> Tables,
    times: &[f64],
    at_once: bool,
) {
    let dimmed = planned.dimmed(times);
    let (tables, anew) = (bake(planned), bake(&dimmed));
    let mut light = dark::<F, T>(&tables);
    light.solve(STOP);
    let before = watts(&light);
    let mut scale = largest(&before);
    let mut set = |light: &mut Room<'_, F, T>, radiances: &[[f32; 3]]| {
        for (index, [radiance, ..]) in radiances.iter().enumerate() {
            light.set_radiance(index, *radiance).expect("a radiance");
            let kept = light.radiance(index);
            assert!((kept / radiance - 1.0).abs() < 1e-6, "{kept} {radiance}");
            if !at_once {
                light.update(STOP);
                scale = scale.max(largest(&watts(light)));
            }
        }
        let solved = light.update(STOP);
        assert!(solved.unshot <= UNSHOT, "{solved:?}");
        scale = scale.max(largest(&watts(light)));
    };
    set(&mut light, &dimmed.radiances());
    let after = watts(&light);
    set(&mut light, &planned.radiances());
    let mut fresh = dark::<F, T>(&anew);
    fresh.solve(STOP);
    let off = apart(&after, &watts(&fresh), scale);
    assert!(off <= TOLERANCE, "{off:e} from a fresh bake, {times:?}");
    let back = apart(&before, &watts(&light), scale);
    assert!(back <= TOLERANCE, "{back:e} from what it was, {times:?}");
}

/// Where light is steep on a patch that reflects little of it, words hold what it receives
/// as well as what it reflects.
#[test]
fn steep_light_is_not_cut_off() {
    let times = [0.01, 1.9914915331223468, 0.01, 1.8135591933403035];
    for at_once in [false, true] {
        follows::<Q29, Matrix<8>>(scenes::office(), matrix, &times, at_once);
    }
}

/// Up to twice as bright, which tables have room for.
fn any_dimming(luminaires: usize) -> impl Strategy<Value = (Vec<f64>, bool)> {
    (prop::collection::vec(0.01..2.0, luminaires), any::<bool>())
}

fn two_lights() -> &'static Planned {
    static PLANNED: OnceLock<Planned> = OnceLock::new();
    PLANNED.get_or_init(|| scenes::bands(false))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bands_in_integers_follow_a_dimming((times, at_once) in any_dimming(2)) {
        follows::<Q29, Computed>(two_lights(), bands, &times, at_once);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn terms_in_integers_follow_a_dimming((times, at_once) in any_dimming(4)) {
        follows::<Q29, Matrix<8>>(scenes::office(), matrix, &times, at_once);
        follows::<Q24, Matrix<8>>(scenes::office(), matrix, &times, at_once);
    }

    /// Any sequence of any numbers: refused, or within what a word holds.
    #[test]
    fn any_sequence_of_settings_stays_in_words(
        settings in prop::collection::vec((0_usize..3, any::<f32>(), 0.0_f32..2.0), 1..12)
    ) {
        static TABLES: OnceLock<Tables> = OnceLock::new();
        let tables = TABLES.get_or_init(|| bands(two_lights()));
        let mut light = dark::<Q29, Computed>(tables);
        let baked = [light.radiance(0), light.radiance(1)];
        let stop = Stop::Below { fraction: 0.001, shots: 200 };
        for (index, any, times) in settings {
            let _ = light.set_radiance(index, any);
            let _ = light.set_radiance(index, times * baked.get(index).unwrap_or(&0.0));
            let solved = light.update(stop);
            prop_assert!((0.0..=2.0).contains(&solved.unshot), "{solved:?}");
            let mut values = light.irradiance().iter();
            prop_assert!(values.all(|e| (-2000..i32::MAX).contains(e)));
        }
    }
}

/// As in floating point: darkness is exact, and what was set is lit from darkness too.
#[test]
fn nothing_emits_in_integers_and_nothing_is_lit() {
    let tables = bands(two_lights());
    let mut light = dark::<Q29, Computed>(&tables);
    light.solve(STOP);
    let before = watts(&light);
    let solved = light.update(STOP);
    assert_eq!((solved.shots, solved.form_factors), (0, 0));
    let radiances = [light.radiance(0), light.radiance(1)];
    light.set_radiance(0, 0.0).expect("darkness");
    light.update(STOP);
    assert!(largest(&watts(&light)) > 0.1 * largest(&before));
    light.set_radiance(1, -0.0).expect("darkness");
    assert_eq!(light.unshot_fraction(), 1.0);
    let solved = light.update(STOP);
    assert_eq!((solved.shots, solved.unshot), (0, 0.0));
    assert!(light.irradiance().iter().all(|&e| e == 0));
    light.solve(STOP);
    assert!(light.irradiance().iter().all(|&e| e == 0));
    for (index, radiance) in radiances.into_iter().enumerate() {
        light.set_radiance(index, radiance).expect("a radiance");
    }
    light.update(STOP);
    let back = apart(&before, &watts(&light), largest(&before));
    assert!(back <= TOLERANCE, "{back:e}");
}

#[test]
fn bad_radiances_are_refused_in_integers() {
    let tables = bands(two_lights());
    let mut light = dark::<Q29, Computed>(&tables);
    let kept = light.radiance(1);
    let all = [
        f32::NAN,
        -1.0,
        -1e-30,
        f32::INFINITY,
        1e21,
        f32::MIN,
        2.01 * kept,
    ];
    for bad in all {
        let refused = Error::Number {
            what: What::Luminaires,
            record: 1,
        };
        assert_eq!(light.set_radiance(1, bad), Err(refused), "{bad}");
        assert_eq!(light.radiance(1), kept);
    }
    for good in [0.0, -0.0, f32::MIN_POSITIVE, kept, 2.0 * kept] {
        assert_eq!(light.set_radiance(1, good), Ok(()), "{good}");
    }
    let refused = Error::Unknown {
        what: What::Luminaires,
        asked: 2,
        have: 2,
    };
    assert_eq!(light.set_radiance(2, 1.0), Err(refused));
    assert_eq!(light.radiance(2), 0.0);
}

/// What the samples and the named points have on a rung, and after how many shots: the
/// same of all rungs, so that what is left unshot is no difference.
fn lit(tables: &Tables, rung: FormFactorRung) -> (Vec<f64>, Vec<f64>, u32) {
    let stop = Stop::Reflections(3);
    let solution = solve::solve(tables, rung, Sight::Exact, stop).expect("a solution");
    let first = |values: Vec<[f32; 3]>| values.iter().map(|e| e[0].into()).collect();
    let values = first(solution.irradiance());
    (values, first(solution.points()), solution.solved.shots)
}

/// Errors relative to each value, in percent: rms and largest.
fn relative(got: &[f64], exact: &[f64], scale: f64) -> (f64, f64) {
    let pairs = got.iter().zip(exact).filter(|(_, e)| **e > 1e-3 * scale);
    let off: Vec<f64> = pairs.map(|(got, e)| (got / e - 1.0).abs()).collect();
    let squares: f64 = off.iter().map(|off| off * off).sum();
    let rms = 100.0 * (squares / off.len() as f64).sqrt();
    (rms, 100.0 * largest(&off))
}

/// Of the same terms integers make the light of floating point but for their form factors'
/// errors, and for what single precision rounds: every shot a sample by half a unit, 2⁻²⁴
/// of it, which walks at random. Of the scene past its occluders they err by what the
/// terms do.
#[test]
fn terms_in_integers_are_those_of_floating_point() {
    let planned = scenes::finer();
    for (bits, most, most_points) in [(4, 2.0, 3.0), (6, 0.5, 0.6), (8, 0.3, 0.06)] {
        let (floats, whole) = (planned.matrix(bits), planned.matrix_in_integers(bits));
        let (best, best_points, shots) = lit(&floats, Rung::Best.into());
        let (exact, exact_points, _) = lit(floats.computed(), Rung::Best.into());
        let scale = largest(&best);
        let rounded = f64::from(shots).sqrt() * 2.0_f64.powi(-23);
        for (rung, own) in [(FormFactorRung::Q29, 1e-6), (FormFactorRung::Q24, 1e-5)] {
            let (got, points, _) = lit(&whole, rung);
            let off = apart(&got, &best, scale);
            let off_points = apart(&points, &best_points, scale);
            let (rms, _) = relative(&got, &exact, scale);
            let (_, of_points) = relative(&points, &exact_points, scale);
            println!(
                "office, {bits} bits, {}: {} bytes for {}; {off:.1e} and {off_points:.1e} of the brightest from f32 in {shots} shots; rms {rms:.3} %, points {of_points:.3} % from exact transfer",
                rung.name(),
                whole.bytes().len(),
                floats.bytes().len(),
            );
            assert!(off <= own + rounded, "{bits}: {off:e}");
            assert!(off_points <= own + rounded, "{bits}: {off_points:e}");
            assert!(
                rms < most && of_points < most_points,
                "{bits}: {rms} {of_points}"
            );
        }
    }
}

/// A place that nobody planned for is asked past the occluders, as with terms in floating
/// point.
#[test]
fn places_of_their_own_see_past_occluders() {
    let planned = scenes::office();
    let (floats, whole) = (planned.matrix(8), planned.matrix_in_integers(8));
    let places: Vec<([f32; 3], [f32; 3])> = (0..40_u8)
        .map(|k| {
            let x = f32::from(k);
            let place = [0.1 + x * 0.09, 5.9 - x * 0.13, 0.1 + (x * 0.37) % 2.0];
            (place, [x - 20.0, 7.0, 12.0 - x])
        })
        .collect();
    let at = |tables: &Tables, rung: FormFactorRung| -> Vec<f64> {
        let stop = Stop::Reflections(3);
        let solution = solve::solve(tables, rung, Sight::Exact, stop).expect("a solution");
        let answers = solution.at(&places).expect("receivers");
        answers.iter().map(|at| at.value[0].into()).collect()
    };
    let best = at(&floats, Rung::Best.into());
    let got = at(&whole, FormFactorRung::Q29);
    let off = apart(&got, &best, largest(&best));
    assert!(off <= 1e-6, "{off:e}");
}

/// A copy of tables in which something is changed, with a checksum that is right.
fn changed(tables: &Tables, change: impl FnOnce(&mut [u8])) -> Vec<u32> {
    let mut words = vec![0_u32; tables.bytes().len() / 4];
    words.as_mut_bytes().copy_from_slice(tables.bytes());
    change(words.as_mut_bytes());
    let field = offset_of!(Header, checksum);
    words[field / 4] = checksum(&words.as_bytes()[field + 4..]);
    words
}

fn refused(tables: &Tables, at: usize, change: impl FnOnce(u32) -> u32) -> Option<Error> {
    let words = changed(tables, |bytes| {
        let word = &mut bytes[at..at + 4];
        let now = u32::from_le_bytes(word.try_into().expect("four bytes"));
        word.copy_from_slice(&change(now).to_le_bytes());
    });
    Scene::load(words.as_bytes()).err()
}

/// Where the sections of what is written down begin, from the end of the tables.
fn sections(tables: &Tables) -> [usize; 3] {
    let counts = &tables.counts;
    let terms = ((counts.terms * 2 * counts.bits).div_ceil(8) as usize + 3).next_multiple_of(4);
    let terms = tables.bytes().len() - terms;
    let fractions = terms - (2 * counts.fractions as usize).next_multiple_of(4);
    let receivers = (counts.terms / (counts.emitters - counts.luminaires)) as usize;
    [fractions - 4 * receivers, fractions, terms]
}

#[test]
fn terms_that_do_not_fit_are_refused() {
    let tables = matrix(scenes::office());
    let count = |field: usize| offset_of!(Header, counts) + field;
    for by in [-1, 1] {
        for field in [
            offset_of!(Counts, terms),
            offset_of!(Counts, fractions),
            offset_of!(Counts, bits),
            offset_of!(Counts, weights),
            offset_of!(Counts, points),
            offset_of!(Counts, coefficients),
        ] {
            let found = refused(&tables, count(field), |n| n.wrapping_add_signed(by));
            assert!(found.is_some(), "field {field} by {by}");
        }
    }
    let [scales, ..] = sections(&tables);
    let number = |what| Some(Error::Number { what, record: 0 });
    assert_eq!(refused(&tables, scales, |_| u32::MAX), number(What::Scales));
    // A factor of 1 is one too many; just below it is none.
    let most = ((1_u64 << 47) / (255 * 255)) as u32;
    assert_eq!(refused(&tables, scales, |_| most), None);
    assert_eq!(refused(&tables, scales, |_| most + 1), number(What::Scales));
    // The first weight is before the members, which are before the scales.
    let members = (2 * tables.counts.members as usize).next_multiple_of(4);
    let weights = scales - members - 4 * tables.counts.weights as usize;
    let found = refused(&tables, weights, |_| i32::MIN.cast_unsigned());
    assert!(
        matches!(
            found,
            Some(Error::Number {
                what: What::Weights,
                ..
            })
        ),
        "{found:?}"
    );
    let scene = Scene::load(tables.bytes()).expect("sound tables");
    let of_other_bits = Room::<Q29, Matrix<6>>::new(scene).err();
    let wrong = |what, needed, have| Some(Error::Capacity { what, needed, have });
    assert_eq!(of_other_bits, wrong(What::Bits, 8, 6));
    let constant = Room::<Q29, Computed>::new(scene).err();
    assert_eq!(constant, wrong(What::Coefficients, 3, 1));
}

/// Any bits may stand where weights, scales, fractions and terms are: refused, or lit
/// within words, to an end.
#[test]
fn any_terms_in_integers_are_refused_or_lit() {
    fn tried<F: Format, T: Transfer>(planned: &Planned, bits: u32, from_terms: bool) -> u32 {
        let tables = planned.matrix_in_integers(bits);
        let [scales, _, terms] = sections(&tables);
        let mut lit = 0;
        for seed in 1..=12_u32 {
            let mut state = seed;
            let words = changed(&tables, |bytes| {
                let first = if from_terms { terms } else { scales };
                for byte in &mut bytes[first..] {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    *byte = (state >> 24) as u8;
                }
                if !from_terms {
                    // Scales that no check refuses, and any fractions.
                    for scale in bytes[scales..scales + 4 * 900].chunks_exact_mut(4) {
                        scale[3] &= 0x7f;
                    }
                }
            });
            let Ok(scene) = Scene::load(words.as_bytes()) else {
                continue;
            };
            lit += 1;
            let mut light = Box::new(Room::<F, T>::new(scene).expect("room"));
            let stop = Stop::Below {
                fraction: 1e-3,
                shots: 2000,
            };
            let solved = light.solve(stop);
            assert!(
                (0.0..=2.0).contains(&solved.unshot) && solved.shots <= 2000,
                "{solved:?}"
            );
            for _ in 0..20 {
                light.reflect();
            }
            light.set_radiance(0, 0.0).expect("darkness");
            light.update(stop);
            let mut row = [0; 4];
            for surface in 0..scene.surfaces().len() {
                light
                    .resample_row(surface, [4, 4], 1, &mut row)
                    .expect("a row");
            }
        }
        lit
    }
    let planned = scenes::office();
    assert_eq!(tried::<Q29, Matrix<4>>(planned, 4, true), 12);
    assert_eq!(tried::<Q24, Matrix<6>>(planned, 6, true), 12);
    assert_eq!(tried::<Q29, Matrix<8>>(planned, 8, true), 12);
    tried::<Q29, Matrix<8>>(planned, 8, false);
}

#[test]
fn what_integers_do_not_hold_is_not_written() {
    let planned = scenes::office();
    let bake = |planned: &Planned| {
        integers::bake_matrix(&planned.scene, &planned.plan, None, 8).map(|tables| tables.counts)
    };
    assert_eq!(bake(scenes::coloured()), Err(integers::Refused::Colour));
    assert_eq!(bake(two_lights()), Err(integers::Refused::Constant));
    let linear = integers::bake(&planned.scene, &planned.plan).map(|tables| tables.counts);
    assert_eq!(linear, Err(integers::Refused::Linear));
    let again = || planned.matrix_in_integers(8);
    assert_eq!(again().bytes(), again().bytes());
}
