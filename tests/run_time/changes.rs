//! What is lit on agrees with what is lit anew.

use crate::scenes::{self, Planned};
use isolux::form_factor::Best;
use isolux::luminance::{Colour, Constant, Increment, Linear, Luminance, Rgb};
use isolux::scene::Scene;
use isolux::shoot::{Light, Stop};
use isolux::transfer::{Codes, Transfer};
use isolux::visibility::{Exact, Unoccluded};
use isolux_host::bake::Tables;
use isolux_host::compare;
use isolux_host::solve::{self, HostRoot, Rung, Sight};
use proptest::prelude::*;
use std::f32::consts::PI;
use std::sync::OnceLock;

/// Of the power, what a solve may leave unshot: little enough not to matter beside rounding
/// even where the room multiplies it, by 1 / (1 − ρ), and two solves leave it with either
/// sign.
const UNSHOT: f32 = 5e-7;

const STOP: Stop = Stop::Below {
    fraction: UNSHOT,
    shots: 20_000,
};

/// What may differ, of the largest irradiance there ever was: what both stops leave,
/// and 2⁻²⁴ for each of a hundred or so additions.
const TOLERANCE: f32 = 1e-5;

type Room<'t, L, V, const SURFACES: usize> = Light<'t, Best<HostRoot>, 1024, 256, L, V, SURFACES>;
type Looking = Exact<32, 64, 256, 64>;

/// A light in tables, dark.
fn dark<L: Luminance, V: Transfer + Default, const SURFACES: usize>(
    tables: &Tables,
) -> Box<Room<'_, L, V, SURFACES>> {
    let scene = Scene::load(tables.bytes()).expect("sound tables");
    Box::new(Light::new(scene).expect("room"))
}

fn largest<C: Colour>(values: &[C]) -> f32 {
    let each = values.iter().map(|value| largest_channel(*value));
    each.fold(0.0, f32::max)
}

fn largest_channel<C: Colour>(value: C) -> f32 {
    let most = std::cell::Cell::new(0.0_f32);
    value.map(|x| {
        most.set(most.get().max(x.abs()));
        x
    });
    most.get()
}

/// The largest difference as a part of `scale`.
fn apart<C: Colour>(a: &[C], b: &[C], scale: f32) -> f32 {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().zip(b);
    let each = pairs.map(|(a, b)| largest_channel(a.zip(*b, |a, b| a - b)));
    each.fold(0.0, f32::max) / scale
}

/// Dims every luminaire, one after the other or all at once, and sets it back.
fn follows<L: Luminance, V: Transfer + Default>(
    planned: &Planned,
    bake: fn(&Planned) -> Tables,
    times: &[f64],
    at_once: bool,
) {
    let (nominal, dimmed) = (planned, planned.dimmed(times));
    let (tables, anew) = (bake(nominal), bake(&dimmed));
    let mut light = dark::<L, V, 0>(&tables);
    light.solve(STOP);
    let before = light.irradiance().to_vec();
    let mut scale = largest(&before);
    let mut set = |light: &mut Room<'_, L, V, 0>, radiances: &[[f32; 3]]| {
        for (index, radiance) in radiances.iter().enumerate() {
            let radiance = L::Colour::read(radiance);
            light.set_radiance(index, radiance).expect("a radiance");
            if !at_once {
                light.update(STOP);
                scale = scale.max(largest(light.irradiance()));
            }
        }
        let solved = light.update(STOP);
        assert!(solved.unshot <= UNSHOT, "{solved:?}");
        scale = scale.max(largest(light.irradiance()));
    };
    set(&mut light, &dimmed.radiances());
    let after = light.irradiance().to_vec();
    let emitters: Vec<L> = (0..anew.counts.emitters as usize)
        .map(|emitter| light.radiosity(emitter))
        .collect();
    set(&mut light, &nominal.radiances());

    let mut fresh = dark::<L, V, 0>(&anew);
    fresh.solve(STOP);
    let off = apart(&after, fresh.irradiance(), scale);
    assert!(off <= TOLERANCE, "{off:e} from a fresh bake, {times:?}");
    let back = apart(&before, light.irradiance(), scale);
    assert!(back <= TOLERANCE, "{back:e} from what it was, {times:?}");
    // A small emitter may differ by more, but not in power.
    let scene = Scene::load(anew.bytes()).expect("sound tables");
    let power = |emitter: usize, radiosity: L::Colour| {
        scene.emitters()[emitter].area * largest_channel(radiosity)
    };
    let mut emitted = 0.0;
    let mut off = 0.0;
    for (emitter, radiosity) in emitters.into_iter().enumerate() {
        let fresh = fresh.radiosity(emitter).mean();
        if scene.is_luminaire(emitter) {
            let nominal = L::Colour::read(&nominal.radiances()[emitter]).times(PI);
            emitted += power(emitter, fresh).max(power(emitter, nominal));
        }
        off += power(emitter, radiosity.mean().zip(fresh, |a, b| a - b));
    }
    let off = off / emitted;
    assert!(off <= TOLERANCE, "{off:e} of the power, {times:?}");
}

fn any_dimming(luminaires: usize) -> impl Strategy<Value = (Vec<f64>, bool)> {
    (prop::collection::vec(0.01..3.0, luminaires), any::<bool>())
}

fn config() -> ProptestConfig {
    ProptestConfig {
        cases: 12,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Planned once.
macro_rules! once {
    ($plan:expr) => {{
        static PLANNED: OnceLock<Planned> = OnceLock::new();
        PLANNED.get_or_init(|| $plan)
    }};
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn bands_follow_a_dimming((times, at_once) in any_dimming(2)) {
        let planned = once!(scenes::bands(false));
        follows::<Constant<f32>, Unoccluded>(planned, Planned::baked, &times, at_once);
    }

    #[test]
    fn bands_in_colour_follow_a_dimming((times, at_once) in any_dimming(2)) {
        let planned = once!(scenes::bands(true));
        follows::<Constant<Rgb>, Unoccluded>(planned, Planned::baked, &times, at_once);
    }

    #[test]
    fn layers_follow_a_dimming((times, at_once) in any_dimming(2)) {
        let planned = once!(scenes::layers());
        follows::<Increment<f32>, Unoccluded>(planned, Planned::baked, &times, at_once);
    }

    #[test]
    fn points_follow_a_dimming((times, at_once) in any_dimming(2)) {
        let planned = once!(scenes::points());
        follows::<Constant<f32>, Unoccluded>(planned, Planned::baked, &times, at_once);
    }
}

/// What is left of some patches then is no light on the whole, but light here and as much
/// too little there: it counts as unshot.
#[test]
fn gradients_alone_are_light() {
    let times = [0.01, 1.8438630771611892, 0.8204250873322237, 0.01];
    for at_once in [false, true] {
        follows::<Linear<f32>, Looking>(scenes::office(), Planned::baked, &times, at_once);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4, ..config() })]

    #[test]
    fn patches_follow_a_dimming((times, at_once) in any_dimming(4)) {
        follows::<Linear<f32>, Looking>(scenes::office(), Planned::baked, &times, at_once);
    }

    #[test]
    fn codes_follow_a_dimming((times, at_once) in any_dimming(4)) {
        follows::<Linear<f32>, Codes>(scenes::office(), Planned::coded, &times, at_once);
    }

    #[test]
    fn patches_in_colour_follow_a_dimming((times, at_once) in any_dimming(1)) {
        follows::<Linear<Rgb>, Looking>(scenes::coloured(), Planned::baked, &times, at_once);
    }
}

/// Reflectances of every surface, changed and changed back.
#[test]
fn reflectances_follow() {
    let planned = scenes::office();
    let painted = planned.painted(0.6);
    let (tables, anew) = (planned.baked(), painted.baked());
    let mut light = dark::<Linear<f32>, Looking, 64>(&tables);
    light.solve(STOP);
    let before = light.irradiance().to_vec();
    let scale = largest(&before);
    let set = |light: &mut Room<'_, Linear<f32>, Looking, 64>, of: &Planned| {
        for (index, surface) in of.scene.surfaces.iter().enumerate() {
            let reflectance = surface.reflectance[0] as f32;
            light.set_reflectance(index, reflectance).expect("sound");
            assert_eq!(light.reflectance(index), reflectance);
        }
        light.update(STOP);
    };
    set(&mut light, &painted);
    let mut fresh = dark::<Linear<f32>, Looking, 0>(&anew);
    fresh.solve(STOP);
    let changed = apart(&before, fresh.irradiance(), scale);
    assert!(changed > 0.01, "{changed}");
    let off = apart(light.irradiance(), fresh.irradiance(), scale);
    assert!(off <= TOLERANCE, "{off:e}");
    // From darkness with what was set, too.
    light.solve(STOP);
    let off = apart(light.irradiance(), fresh.irradiance(), scale);
    assert!(off <= TOLERANCE, "{off:e}");
    // Its grids are those of any other light.
    let row = |light: &Room<'_, Linear<f32>, Looking, 64>| {
        let mut row = [0.0; 8];
        let resampled = light.resample_row::<HostRoot>(0, [8, 8], 3, &mut row);
        resampled.map(|_| row).expect("a row of the first surface")
    };
    assert!(row(&light).iter().all(|&value| value > 0.0));
    set(&mut light, planned);
    let back = apart(&before, light.irradiance(), scale);
    assert!(back <= TOLERANCE, "{back:e}");
}

/// What was switched off is dark, to the last bit where nothing is left on; and
/// what was set is what is lit from darkness too.
#[test]
fn nothing_emits_and_nothing_is_lit() {
    let planned = scenes::bands(false);
    let tables = planned.baked();
    let mut light = dark::<Constant<f32>, Unoccluded, 0>(&tables);
    light.solve(STOP);
    let before = light.irradiance().to_vec();
    let radiances = [light.radiance(0), light.radiance(1)];
    light.set_radiance(0, 0.0).expect("darkness");
    light.update(STOP);
    assert!(largest(light.irradiance()) > 0.1 * largest(&before));
    light.set_radiance(1, 0.0).expect("darkness");
    assert_eq!(light.unshot_fraction(), 1.0);
    let solved = light.update(STOP);
    assert_eq!((solved.shots, solved.unshot), (0, 0.0));
    assert!(light.irradiance().iter().all(|&e| e == 0.0));
    light.solve(STOP);
    assert!(light.irradiance().iter().all(|&e| e == 0.0));
    for (index, radiance) in radiances.into_iter().enumerate() {
        light.set_radiance(index, radiance).expect("a radiance");
    }
    light.update(STOP);
    let back = apart(&before, light.irradiance(), largest(&before));
    assert!(back <= TOLERANCE, "{back:e}");
}

/// Nothing set, nothing shot.
#[test]
fn an_update_without_a_change_does_nothing() {
    let tables = scenes::office().baked();
    let mut light = dark::<Linear<f32>, Looking, 0>(&tables);
    light.solve(Stop::below(0.001));
    let before = light.irradiance().to_vec();
    let solved = light.update(Stop::below(0.001));
    assert_eq!((solved.shots, solved.form_factors), (0, 0));
    assert_eq!(before, light.irradiance());
}

/// A dimming is cheaper than a solution, and stops by the same rule.
#[test]
fn an_update_takes_fewer_shots() {
    let tables = scenes::office().baked();
    let mut light = dark::<Linear<f32>, Looking, 0>(&tables);
    let stop = Stop::below(0.001);
    let solved = light.solve(stop);
    let radiance = light.radiance(2);
    light.set_radiance(2, 0.7 * radiance).expect("a radiance");
    let updated = light.update(stop);
    println!("{solved:?}, then {updated:?}");
    assert!(updated.unshot <= 0.001);
    assert!(
        3 * updated.shots < 2 * solved.shots,
        "{updated:?} {solved:?}"
    );
}

/// The balance of the light after a dimming is that of the dimmed scene.
#[test]
fn an_update_keeps_the_energy() {
    let planned = scenes::office();
    let dimmed = planned.dimmed(&[0.2, 1.7, 0.6, 1.1]);
    let (tables, anew) = (planned.baked(), dimmed.baked());
    let stop = Stop::below(1e-4);
    let solve = |tables| solve::solve(tables, Rung::Best, Sight::Exact, stop).expect("a solution");
    let (mut lit_on, fresh) = (solve(&tables), solve(&anew));
    for (index, radiance) in dimmed.radiances().into_iter().enumerate() {
        lit_on.set_radiance(index, radiance).expect("a radiance");
    }
    lit_on.update(stop);
    let balance = |solution| compare::balance(&dimmed.scene, &planned.plan, solution);
    let (lit_on, fresh) = (balance(&lit_on), balance(&fresh));
    let pairs = [
        (lit_on.shot, fresh.shot),
        (lit_on.received, fresh.received),
        (lit_on.absorbed, fresh.absorbed),
        (lit_on.missing, fresh.missing),
    ];
    for (lit_on, fresh) in pairs {
        let off = (lit_on - fresh).abs() / dimmed_power(&dimmed);
        assert!(off < 3e-4, "{off:e}: {lit_on} {fresh}");
    }
}

fn dimmed_power(planned: &Planned) -> f64 {
    let surfaces = planned.scene.surfaces.iter();
    let power = surfaces.map(|surface| surface.radiance[0] * surface.area);
    std::f64::consts::PI * power.sum::<f64>()
}
