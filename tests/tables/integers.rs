//! A scene in integers: the laws of light hold to the bounds its module states,
//! powers of two change nothing but exponents, and tables that somebody changed
//! are refused or lit.

use crate::bytes::{Words, lengthened, seal};
use crate::energy::{patched, room};
use crate::mutation::{Dice, mutated};
use crate::paper;
use isolux::Error;
use isolux::error::What;
use isolux::integers::{Computed, Format, Light, Matrix, Q24, Q29, Scene, Transfer};
use isolux::shoot::Stop;
use isolux_host::bake::{Tables, integers};
use isolux_host::occlusion::Occlusion;
use isolux_host::plan::{self, Plan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{self, file, shipped};
use std::f64::consts::PI;

type Lit<'t, F> = Box<Light<'t, F, 1024, 256>>;

pub(crate) fn light<F: Format>(tables: &Tables) -> Lit<'_, F> {
    let scene = Scene::load(tables.bytes()).expect("sound tables");
    Box::new(Light::new(scene).expect("room"))
}

/// Irradiance in W m⁻².
fn watts<F: Format>(light: &Light<'_, F, 1024, 256>, units: u64) -> f64 {
    units as f64 * 2.0_f64.powi(light.scene().header().irradiance)
}

fn at<F: Format>(light: &Light<'_, F, 1024, 256>, place: [f32; 3], normal: [f32; 3]) -> f64 {
    let receiver = light.scene().receiver(place, normal);
    watts(light, light.at(&receiver.expect("a receiver")))
}

/// Every wall emits L and reflects ρ: then E = π L / (1 − ρ) everywhere.
fn furnace<F: Format>(error: f64) {
    for (radiance, rho, size) in [
        (2.0, 0.5, [3.0; 3]),
        (0.25, 0.8, [2.0, 6.0, 3.0]),
        (1e4, 0.1, [8.0, 1.0, 4.0]),
    ] {
        let (scene, plan, _) = patched(&room(size, [(radiance, rho); 6]), 1);
        let tables = integers::bake(&scene, &plan).expect("tables");
        let mut light = light::<F>(&tables);
        let rest = 1e-6;
        let solved = light.solve(Stop::below(rest));
        assert!(solved.unshot <= rest, "{solved:?}");
        let exact = PI * radiance / (1.0 - rho);
        let unit = watts(&light, 1) / exact;
        // Five form factors with their errors, half a unit a shot; all light is
        // 1/(1 − ρ) of that. What is unshot has not arrived.
        let own = 5.0 * error + f64::from(solved.shots) * unit / 2.0;
        let allowed = (own + f64::from(rest)) / (1.0 - rho);
        let mut worst = 0.0_f64;
        for surface in &scene.surfaces {
            let corner = surface.vertices[0] - surface.center();
            for t in [0.0, 0.3, 0.6, 0.9] {
                let place = (surface.center() + corner * t).as_vec3().to_array();
                let got = at(&light, place, surface.normal.as_vec3().to_array());
                worst = worst.max((got / exact - 1.0).abs());
            }
        }
        println!("furnace {size:?}, rho {rho}: {worst:.1e} of {allowed:.1e}");
        assert!(worst <= allowed, "{size:?}: {worst:e} > {allowed:e}");
    }
}

#[test]
fn a_furnace_is_equally_bright_everywhere_in_integers() {
    furnace::<Q29>(5e-8);
    furnace::<Q24>(5e-6);
}

/// Exponents aside, what a scene's irradiances and grids are.
fn words(tables: &Tables) -> Vec<i32> {
    let mut light = light::<Q29>(tables);
    light.solve(Stop::below(1e-4));
    let mut words = light.irradiance().to_vec();
    let mut row = [0; 16];
    for surface in 0..light.scene().surfaces().len() {
        for number in 0..16 {
            let done = light.resample_row(surface, [16, 16], number, &mut row);
            done.expect("a row");
            words.extend(row);
        }
    }
    words
}

/// The scene with all radiances and all lengths times a power of two each.
fn times(planned: &(scene::Scene, Plan), radiance: f64, length: f64) -> Tables {
    let (mut scene, mut plan) = planned.clone();
    for surface in &mut scene.surfaces {
        surface.radiance = surface.radiance.map(|x| x * radiance);
        surface.area *= length * length;
        for vertex in &mut surface.vertices {
            *vertex *= length;
        }
    }
    for planned in &mut plan.surfaces {
        planned.frame.origin *= length;
        planned.frame.size_u *= length;
        planned.frame.size_v *= length;
        planned.filter_radius *= length;
        for sample in &mut planned.samples {
            sample.place = sample.place.map(|x| x * length);
            sample.vertex = sample.vertex.map(|x| x * length);
        }
        for band in &mut planned.bands {
            band.area *= length * length;
        }
    }
    integers::bake(&scene, &plan).expect("tables")
}

#[test]
fn powers_of_two_change_nothing_but_exponents() {
    let (scene, plan, _) = paper();
    let planned = (scene.clone(), plan.clone());
    let tables = times(&planned, 1.0, 1.0);
    let expected = words(&tables);
    assert!(
        expected.iter().any(|&word| word > 1 << 28),
        "words are filled"
    );
    for (radiance, length) in [(100, 0), (-100, 0), (0, 17), (0, -30), (40, 20)] {
        let scaled = times(&planned, 2.0_f64.powi(radiance), 2.0_f64.powi(length));
        assert_eq!(words(&scaled), expected, "2^{radiance}, 2^{length}");
        let [before, after] = [&tables, &scaled].map(|tables| {
            let scene = Scene::load(tables.bytes()).expect("sound tables");
            (scene.header().irradiance, scene.header().length)
        });
        assert_eq!(after, (before.0 + radiance, before.1 + length));
    }
}

#[test]
fn receivers_of_their_own_are_where_they_are() {
    let (scene, plan, tables) = paper();
    let fixed = integers::bake(scene, plan).expect("tables");
    let mut light = light::<Q29>(&fixed);
    light.solve(Stop::below(1e-3));
    let solution = isolux_host::solve::solve(
        tables,
        isolux_host::solve::Rung::Best,
        isolux_host::solve::Sight::None,
        Stop::below(1e-3),
    )
    .expect("a solution");
    let places: Vec<([f32; 3], [f32; 3])> = (0..200_u8)
        .map(|k| {
            let x = f32::from(k);
            let place = [x * 0.05 - 2.0, (x * 0.7) % 5.0 - 2.5, (x * 0.3) % 2.0];
            (place, [x - 100.0, 30.0, 50.0 - x])
        })
        .collect();
    let floats = solution.at(&places).expect("receivers");
    let brightest = floats.iter().map(|at| f64::from(at.value[0]));
    let brightest = brightest.fold(0.0, f64::max);
    for (&(place, normal), float) in places.iter().zip(floats) {
        let off = at(&light, place, normal) - f64::from(float.value[0]);
        assert!(off.abs() <= 2e-6 * brightest, "{place:?}: {off:e}");
    }
    let scene = light.scene();
    let up = [0.0, 0.0, 1.0];
    for (place, normal) in [
        ([f32::NAN, 0.0, 0.0], up),
        ([0.0, f32::INFINITY, 0.0], up),
        ([0.0; 3], [0.0; 3]),
        ([0.0; 3], [f32::NAN, 0.0, 1.0]),
        ([1e9, 0.0, 0.0], up),
        ([f32::MAX, 0.0, 0.0], up),
    ] {
        let refused = scene.receiver::<Q29>(place, normal);
        assert_eq!(refused.err(), Some(Error::Receiver), "{place:?} {normal:?}");
    }
}

#[test]
fn what_integers_do_not_hold_is_not_baked() {
    let (mut scene, plan, tables) = paper().clone();
    scene.surfaces[0].reflectance = [0.5, 0.4, 0.3];
    let refused = integers::bake(&scene, &plan);
    assert_eq!(refused.err(), Some(integers::Refused::Colour));
    // Neither kind of tables is taken for the other.
    assert_eq!(Scene::load(tables.bytes()).err(), Some(Error::NotTables));
    let (scene, plan, _) = paper();
    let fixed = integers::bake(scene, plan).expect("tables");
    let other = isolux::scene::Scene::load(fixed.bytes());
    assert_eq!(other.err(), Some(Error::NotTables));
    let small = Light::<Q29, 10, 16>::new(Scene::load(fixed.bytes()).expect("sound"));
    assert!(matches!(
        small.err(),
        Some(Error::Capacity {
            what: What::Samples,
            needed: 58,
            have: 10
        })
    ));
}

/// The shadow of a board with terms in place of it, in few patches.
fn shaded() -> Tables {
    let mut sources = shipped::ALL.iter();
    let (name, source) = sources
        .find(|(name, _)| *name == "penumbra.toml")
        .expect("shipped");
    let mut scene = file::parse(name, source).expect("a sound scene");
    scene.budget.samples = Some(40);
    let direct = Reference::new(&scene, Reflections::AtMost(0), &mut |_| {}).expect("a reference");
    let field = |places: &[_]| direct.irradiance_at(places);
    let plan = plan::patches::linear(&scene, &scene.budget, &field).expect("a plan");
    let occlusion = Occlusion::of(&scene).expect("few vertices");
    integers::bake_matrix(&scene, &plan, Some(occlusion), 8).expect("tables")
}

#[test]
fn mutated_integer_tables_are_refused_or_lit() {
    let (scene, plan, _) = paper();
    let computed = integers::bake(scene, plan).expect("tables");
    mutated_are_refused_or_lit::<Computed>(&computed, 30_000, |light, scene| {
        for (place, normal) in [([0.0; 3], [0.0, 0.0, 1.0]), ([1.0, -1.0, 1.0], [1.0; 3])] {
            // Their unit of length may have changed: too far, then.
            if let Ok(receiver) = scene.receiver(place, normal) {
                light.at(&receiver);
            }
        }
    });
    mutated_are_refused_or_lit::<Matrix<8>>(&shaded(), 30_000, |_, _| ());
}

/// What a firmware of such a table would be.
type Small<'t, T> = Light<'t, Q29, 64, 32, T>;

fn mutated_are_refused_or_lit<T: Transfer>(
    sound: &Tables,
    cases: u64,
    ask: impl Fn(&Small<'_, T>, &Scene<'_>),
) {
    let (mut loaded, mut refused) = (0, 0);
    for case in 0..cases {
        let mut dice = Dice::new(11, case);
        let mut bytes = mutated(sound.bytes(), &mut dice);
        if dice.below(2) == 0 {
            lengthened(&mut bytes);
        }
        seal(&mut bytes);
        let words = Words::new(&bytes);
        let Ok(scene) = Scene::load(words.bytes(bytes.len())) else {
            refused += 1;
            continue;
        };
        let Ok(light) = Small::<T>::new(scene) else {
            refused += 1; // of other coefficients or bits
            continue;
        };
        loaded += 1;
        let mut light = Box::new(light);
        let stops = [
            Stop::Below {
                fraction: 1e-3,
                shots: 40,
            },
            Stop::Reflections(2),
            Stop::Shots(12),
        ];
        let stop = stops[case as usize % stops.len()];
        let solved = light.solve(stop);
        assert!((0.0..=2.0).contains(&solved.unshot), "case {case}");
        assert!(solved.shots <= 200, "case {case}");
        let _ = light.set_radiance(0, 0.5 * light.radiance(0));
        let solved = light.update(stop);
        assert!((0.0..=2.0).contains(&solved.unshot), "case {case}");
        assert!(solved.shots <= 200, "case {case}");
        for point in 0..scene.points().len() {
            assert!(light.point(point).is_ok_and(|e| e >= 0), "case {case}");
        }
        let mut row = [0; 6];
        for surface in 0..scene.surfaces().len() {
            for v in 0..6 {
                let done = light.resample_row(surface, [6, 6], v, &mut row);
                done.expect("a surface, a row and room");
            }
        }
        ask(&light, &scene);
    }
    println!("{loaded} loaded, {refused} refused");
    assert!(loaded > 3_000 && refused > 3_000, "{loaded} {refused}");
}

/// As bright as a word can be, reflecting nearly all, and every wall 40 times
/// over: light grows until words are full, and stays there.
#[test]
fn impossible_energy_saturates() {
    let (scene, mut plan, _) = patched(&room([3.0; 3], [(1e20, 0.999); 6]), 1);
    for surface in &mut plan.surfaces {
        let band = surface.bands[0].clone();
        surface.bands = vec![band; 40];
    }
    let tables = integers::bake(&scene, &plan).expect("tables");
    let mut light = light::<Q29>(&tables);
    for stop in [Stop::Reflections(40), Stop::Shots(3_000)] {
        let solved = light.solve(stop);
        assert!((0.0..=2.0).contains(&solved.unshot), "{solved:?}");
        let brightest = light.irradiance().iter().max();
        assert_eq!(brightest, Some(&i32::MAX), "{stop:?}");
    }
}
