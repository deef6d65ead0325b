//! Tables with codes against the same scene computed past its occluders.

use crate::bytes::{Words, seal};
use crate::put;
use isolux::Error;
use isolux::error::What;
use isolux::form_factor::Best;
use isolux::luminance::Linear;
use isolux::scene::records::{Counts, Header};
use isolux::scene::{Code, Method, Scene};
use isolux::shoot::{Light, Stop};
use isolux::transfer::Codes;
use isolux::visibility::{Exact, Unoccluded};
use isolux_host::bake::{self, Tables};
use isolux_host::occlusion::Occlusion;
use isolux_host::plan;
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{file, shipped};
use isolux_host::solve::{self, Rung, Sight};
use std::mem::offset_of;
use std::sync::OnceLock;

const STOP: Stop = Stop::below(0.001);

/// What a term may err by: a part of what its sample receives in all.
const TOLERANCE: f64 = 0.002;

/// The Cornell box in few patches, with codes.
fn cornell() -> &'static Tables {
    static CORNELL: OnceLock<Tables> = OnceLock::new();
    CORNELL.get_or_init(baked)
}

fn baked() -> Tables {
    let mut sources = shipped::ALL.iter();
    let (name, source) = sources
        .find(|(name, _)| *name == "cornell.toml")
        .expect("shipped");
    let mut scene = file::parse(name, source).expect("a sound scene");
    scene.budget.samples = Some(320);
    let reference = Reference::new(&scene, Reflections::AtMost(0), &mut |_| {});
    let direct = reference.expect("a reference");
    let field = |places: &[_]| direct.irradiance_at(places);
    let plan = plan::patches::linear(&scene, &scene.budget, &field).expect("a plan");
    let places = scene
        .surfaces
        .iter()
        .flat_map(|surface| surface.vertices.clone());
    let occlusion = Occlusion::for_receivers_within(&scene, places).expect("occluders");
    bake::bake_coded(&scene, &plan, Some(occlusion)).expect("tables")
}

/// Irradiance of every sample and mean radiosity of every emitter.
fn solved(tables: &Tables) -> (Vec<f64>, Vec<f64>) {
    let solution = solve::solve(tables, Rung::Best, Sight::Exact, STOP).expect("a solution");
    let irradiance = solution
        .irradiance()
        .iter()
        .map(|e| f64::from(e[0]))
        .collect();
    let emitters = 0..tables.counts.emitters as usize;
    let radiosity = emitters
        .map(|k| f64::from(solution.radiosity(k)[0]))
        .collect();
    (irradiance, radiosity)
}

/// Whether samples receive direct light, in the order of the tables.
fn is_direct(tables: &Tables) -> Vec<bool> {
    let scene = Scene::load(tables.bytes()).expect("sound tables");
    let kinds = scene
        .surfaces()
        .iter()
        .flat_map(|surface| (0..surface.samples).map(|k| k < surface.samples - surface.indirect));
    kinds.collect()
}

#[test]
fn codes_err_by_what_the_planner_allowed() {
    let tables = cornell();
    let ((coded, _), (exact, _)) = (solved(tables), solved(tables.computed()));
    let direct = is_direct(tables);
    let largest = |wanted: bool| {
        let own = exact
            .iter()
            .zip(&direct)
            .filter(|(_, direct)| **direct == wanted);
        own.map(|(e, _)| *e).fold(0.0, f64::max)
    };
    let (brightest, full) = (largest(true), largest(false));
    let (mut count, mut squares) = (0.0, 0.0);
    for ((coded, exact), direct) in coded.iter().zip(&exact).zip(&direct) {
        let error = (coded - exact).abs();
        if *direct {
            // Half a step of the fraction, and the rung's own rounding.
            assert!(error <= 1e-5 * brightest, "direct {coded} for {exact}");
        } else {
            assert!(
                error <= 10.0 * TOLERANCE * full,
                "{coded} for {exact} of {full}"
            );
            squares += (error / full).powi(2);
            count += 1.0;
        }
    }
    let rms = f64::sqrt(squares / count);
    println!(
        "rms of reflected light: {:.3} % of its largest",
        100.0 * rms
    );
    assert!(rms < TOLERANCE, "{rms}");
}

#[test]
fn codes_keep_the_energy() {
    let tables = cornell();
    let scene = Scene::load(tables.bytes()).expect("sound tables");
    let power = |radiosity: &[f64]| -> f64 {
        let secondary = scene.counts().luminaires as usize..;
        let emitters = scene.emitters()[secondary.clone()].iter();
        let pairs = emitters.zip(&radiosity[secondary]);
        pairs.map(|(emitter, b)| f64::from(emitter.area) * b).sum()
    };
    let ((_, coded), (_, exact)) = (solved(tables), solved(tables.computed()));
    let (coded, exact) = (power(&coded), power(&exact));
    println!("reflected power: {coded} coded, {exact} exact");
    assert!(
        (coded - exact).abs() <= TOLERANCE * exact,
        "{coded} {exact}"
    );
}

#[test]
fn coded_tables_need_no_occluder() {
    let (coded, exact) = (cornell(), cornell().computed());
    assert_eq!(coded.counts.occluders + coded.counts.blockers, 0);
    assert!(exact.counts.occluders > 0 && exact.counts.codes == 0);
    assert!(coded.counts.codes > 0 && coded.counts.fractions > 0);
    // Some of everything: else a method is not tested.
    let scene = Scene::load(coded.bytes()).expect("sound tables");
    let luminaires = scene.counts().luminaires as usize;
    let receivers = scene.counts().codes / (scene.emitters().len() - luminaires) as u32;
    for method in Method::ALL {
        let mut emitters = luminaires..scene.emitters().len();
        assert!(
            emitters.any(|e| (0..receivers).any(|r| scene.code(e, r).meaning().0 == method)),
            "{method:?}"
        );
    }
    assert_eq!(Code::whole(Method::Skip), Code::SKIP);
    assert!(Code::all().all(|code| (0.0..=1.0).contains(&code.meaning().1)));
}

#[test]
fn coding_twice_gives_the_same_bytes() {
    assert_eq!(cornell().bytes(), baked().bytes());
}

#[test]
fn a_rung_reads_its_own_tables_alone() {
    type With<'t, V> = Light<'t, Best, 1024, 128, Linear<f32>, V>;
    let scene = Scene::load(cornell().bytes()).expect("sound tables");
    let exact = Scene::load(cornell().computed().bytes()).expect("sound tables");
    assert!(With::<Codes>::new(scene).is_ok());
    assert!(With::<Exact<16, 16, 64, 16>>::new(exact).is_ok());
    let refused = Error::Capacity {
        what: What::Codes,
        needed: scene.counts().codes,
        have: 0,
    };
    assert_eq!(With::<Unoccluded>::new(scene).map(|_| ()), Err(refused));
    assert_eq!(
        With::<Exact<16, 16, 64, 16>>::new(scene).map(|_| ()),
        Err(refused)
    );
    let refused = With::<Codes>::new(exact).map(|_| ());
    assert!(matches!(
        refused,
        Err(Error::Unknown {
            what: What::Codes,
            have: 0,
            ..
        })
    ));
}

/// A count of codes or fractions that fits the length, but not the samples.
#[test]
fn codes_for_other_pairs_are_refused() {
    let sound = cornell();
    let of = |field: usize, count: u32, what| {
        let mut bytes = sound.bytes().to_vec();
        put(&mut bytes, offset_of!(Header, counts) + field, count);
        seal(&mut bytes);
        let words = Words::new(&bytes);
        let refused = Scene::load(words.bytes(bytes.len())).map(|_| ());
        assert_eq!(refused, Err(Error::Range { what, record: 0 }), "{count}");
    };
    // The same number of words or half-words.
    let codes = sound.counts.codes;
    let other = if codes.is_multiple_of(8) {
        codes - 1
    } else {
        codes.next_multiple_of(8)
    };
    of(offset_of!(Counts, codes), other, What::Codes);
    let fractions = sound.counts.fractions;
    let other = if fractions.is_multiple_of(2) {
        fractions - 1
    } else {
        fractions + 1
    };
    of(offset_of!(Counts, fractions), other, What::Fractions);
}

/// Every code may stand anywhere: no bits of theirs break anything.
#[test]
fn any_codes_give_numbers() {
    let sound = cornell().bytes();
    let first = sound.len() - cornell().counts.codes.div_ceil(8) as usize * 4;
    for seed in 1..=16_u32 {
        let mut bytes = sound.to_vec();
        let mut state = seed;
        for byte in &mut bytes[first..] {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *byte = (state >> 24) as u8;
        }
        seal(&mut bytes);
        let words = Words::new(&bytes);
        let scene = Scene::load(words.bytes(bytes.len())).expect("any codes are codes");
        let light = Light::<Best, 1024, 128, Linear<f32>, Codes>::new(scene);
        let mut light = Box::new(light.expect("room"));
        let stop = Stop::Below {
            fraction: 1e-3,
            shots: 300,
        };
        assert!(light.solve(stop).unshot.is_finite(), "{seed}");
        assert!(light.irradiance().iter().all(|e| e.is_finite()), "{seed}");
    }
}
