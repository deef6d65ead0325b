//! Stability: sums of irradiance over 1e5 shots, and energies from 1e-30 to
//! 1e30 W m⁻² sr⁻¹, in floating point and in integers.

use crate::energy::{patched, room};
use crate::integers;
use isolux::Error;
use isolux::error::What;
use isolux::form_factor::Best;
use isolux::geometry::Receiver;
use isolux::integers::{Format, Q24, Q29};
use isolux::number::SoftRoot;
use isolux::scene::Scene;
use isolux::shoot::{Light, Stop};
use isolux_host::bake;
use isolux_host::scene;

type Floats<'t> = Box<Light<'t, Best, 1024, 256>>;

/// Shots of the long sums.
const SHOTS: u32 = 100_000;

/// A room in which light goes to and fro for long: 24 emitters that reflect.
fn bright_room(radiance: f64) -> crate::energy::Planned {
    let wall = (0.0, 0.999);
    let faces = [wall, (radiance, 0.999), wall, wall, wall, wall];
    patched(&room([4.0, 5.0, 3.0], faces), 2)
}

fn floats(tables: &bake::Tables) -> Floats<'_> {
    let scene = Scene::load(tables.bytes()).expect("sound tables");
    Box::new(Light::new(scene).expect("room"))
}

/// A sample's sum over all shots is its irradiance from all that was shot at
/// once: what differs is rounding, and it has a bound.
#[test]
fn sums_of_1e5_shots_do_not_drift_in_single_precision() {
    let (_, _, tables) = bright_room(10.0);
    let mut light = floats(&tables);
    let solved = light.solve(Stop::Shots(SHOTS));
    assert_eq!(solved.shots, SHOTS);
    let scene = light.scene();
    let mut worst = 0.0_f32;
    for surface in scene.surfaces() {
        let (first, places) = scene.samples_of(surface);
        for (&place, &sum) in places.iter().zip(&light.irradiance()[first..]) {
            let receiver = Receiver::new::<SoftRoot>(surface.place(place).into(), surface.normal);
            let at_once = light.at(&receiver.expect("a receiver"));
            worst = worst.max((sum / at_once - 1.0).abs());
        }
    }
    println!("best: {worst:.1e} of the irradiance");
    // Half a unit in the last place a shot, twice: of the sum, and of what the
    // emitter has shot. Rounding to nearest walks at random: 1e-5 would do.
    let allowed = SHOTS as f32 * f32::EPSILON;
    assert!(worst <= allowed, "{worst:e} > {allowed:e}");
    assert!(worst <= 1e-3, "{worst:e}");
}

fn drift_in_integers<F: Format>() -> (u64, u32) {
    let (scene, plan, _) = bright_room(10.0);
    let tables = bake::integers::bake(&scene, &plan).expect("tables");
    let mut light = integers::light::<F>(&tables);
    let solved = light.solve(Stop::Shots(SHOTS));
    let scene = light.scene();
    let mut worst = 0;
    for surface in scene.surfaces() {
        let (first, places) = scene.samples_of(surface);
        for (&place, &sum) in places.iter().zip(&light.irradiance()[first..]) {
            assert!((0..i32::MAX).contains(&sum), "nothing overflows");
            let normal = surface.normal.map(i64::from);
            let receiver = scene.receiver_at(surface.place(place), normal);
            let at_once = light.at(&receiver.expect("a receiver"));
            worst = worst.max(at_once.abs_diff(u64::from(sum.unsigned_abs())));
        }
    }
    let emitters = scene.emitters().len() as u64;
    assert!(worst <= (u64::from(solved.shots) + emitters) / 2, "{worst}");
    (worst, solved.shots)
}

#[test]
fn sums_of_1e5_shots_keep_their_bound_in_integers() {
    for (name, (units, shots)) in [
        ("q29", drift_in_integers::<Q29>()),
        ("q24", drift_in_integers::<Q24>()),
    ] {
        println!("{name}: {units} units of 2^30 after {shots} shots");
        assert!(shots > SHOTS / 2, "{name} has {shots} shots alone");
    }
}

/// The scene with all radiances times a factor.
fn brighter(scene: &scene::Scene, factor: f64) -> scene::Scene {
    let mut scene = scene.clone();
    for surface in &mut scene.surfaces {
        surface.radiance = surface.radiance.map(|x| x * factor);
    }
    scene
}

#[test]
fn energies_from_1e_minus_30_to_1e30() {
    let (scene, plan, tables) = bright_room(1.0);
    let fixed = bake::integers::bake(&scene, &plan).expect("tables");
    let stop = Stop::Reflections(5);
    let (mut float, mut whole) = (floats(&tables), integers::light::<Q29>(&fixed));
    float.solve(stop);
    whole.solve(stop);
    let unit = |light: &isolux::integers::Light<'_, Q29, 1024, 256>| {
        2.0_f64.powi(light.scene().header().irradiance)
    };
    for exponent in -30..=30 {
        let factor = 10.0_f64.powi(exponent);
        let scene = brighter(&scene, factor);
        let tables = bake::integers::bake(&scene, &plan).expect("tables");
        let mut light = integers::light::<Q29>(&tables);
        light.solve(stop);
        for (one, many) in whole.irradiance().iter().zip(light.irradiance()) {
            let one = f64::from(*one) * unit(&whole) * factor;
            let many = f64::from(*many) * unit(&light);
            // 125 shots of half a unit, in 2^30 or half as many units.
            let off = (many - one).abs() / (unit(&light) * 2.0_f64.powi(30));
            assert!(
                off <= 2.0 * 126.0 / 2.0_f64.powi(30),
                "1e{exponent}: {off:e}"
            );
        }
        let tables = bake::bake(&scene, &plan, None).expect("tables");
        if exponent >= 21 {
            // A stated limit: beyond it powers and sums might not be finite.
            let refused = Scene::load(tables.bytes()).err();
            let what = What::Exitances;
            assert!(
                matches!(refused, Some(Error::Number { what: of, .. }) if of == what),
                "1e{exponent}: {refused:?}"
            );
            continue;
        }
        let mut light = floats(&tables);
        light.solve(stop);
        for (&one, &many) in float.irradiance().iter().zip(light.irradiance()) {
            let one = f64::from(one) * factor;
            let off = (f64::from(many) / one - 1.0).abs();
            // Every one of some 125 roundings may fall otherwise.
            assert!(off <= 125.0 * 6e-8, "1e{exponent}: {off:e}");
        }
    }
}
