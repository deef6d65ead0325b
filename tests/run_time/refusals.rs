//! What may not be set, and that it then is not.

use crate::scenes;
use isolux::Error;
use isolux::error::What;
use isolux::form_factor::Best;
use isolux::luminance::{Constant, Rgb};
use isolux::scene::Scene;
use isolux::shoot::{Light, Stop};
use isolux::visibility::Unoccluded;
use proptest::prelude::*;

type Grey<'t, const SURFACES: usize> =
    Light<'t, Best, 1024, 256, Constant<f32>, Unoccluded, SURFACES>;
type Coloured<'t> = Light<'t, Best, 1024, 256, Constant<Rgb>, Unoccluded, 4>;

/// The brightest π L that tables may hold, and a little less of L.
const BRIGHTEST: f32 = 1e21 / std::f32::consts::PI * 0.999_999;

#[test]
fn bad_radiances_are_refused() {
    let tables = scenes::bands(false).baked();
    let scene = Scene::load(tables.bytes()).expect("sound tables");
    let mut light = Box::new(Grey::<0>::new(scene).expect("room"));
    let kept = light.radiance(1);
    for bad in [f32::NAN, -1.0, -1e-30, f32::INFINITY, 1e21, f32::MIN] {
        let refused = Error::Number {
            what: What::Luminaires,
            record: 1,
        };
        assert_eq!(light.set_radiance(1, bad), Err(refused), "{bad}");
        assert_eq!(light.radiance(1), kept);
    }
    for good in [0.0, -0.0, f32::MIN_POSITIVE, 1.0, BRIGHTEST] {
        assert_eq!(light.set_radiance(1, good), Ok(()), "{good}");
        light.update(Stop::below(0.001));
        assert!(light.irradiance().iter().all(|e| e.is_finite()), "{good}");
    }
    for none in [2, 3, usize::MAX] {
        let refused = Error::Unknown {
            what: What::Luminaires,
            asked: none as u32,
            have: 2,
        };
        assert_eq!(light.set_radiance(none, 1.0), Err(refused));
        assert_eq!(light.radiance(none), 0.0);
    }
}

#[test]
fn bad_channels_are_refused() {
    let tables = scenes::bands(true).baked();
    let scene = Scene::load(tables.bytes()).expect("sound tables");
    let mut light = Box::new(Coloured::new(scene).expect("room"));
    for channel in 0..3 {
        let mut radiance = [1.0, 2.0, 3.0];
        radiance[channel] = f32::NAN;
        assert!(light.set_radiance(0, Rgb(radiance)).is_err());
        let mut reflectance = [0.1, 0.2, 0.3];
        reflectance[channel] = 1.0;
        assert!(light.set_reflectance(0, Rgb(reflectance)).is_err());
    }
}

#[test]
fn bad_reflectances_are_refused() {
    let tables = scenes::bands(false).baked();
    let scene = Scene::load(tables.bytes()).expect("sound tables");
    let mut light = Box::new(Grey::<4>::new(scene).expect("room"));
    let kept = light.reflectance(0);
    for bad in [f32::NAN, -0.1, 1.0, f32::INFINITY] {
        let refused = Error::Number {
            what: What::Reflectances,
            record: 0,
        };
        assert_eq!(light.set_reflectance(0, bad), Err(refused), "{bad}");
        assert_eq!(light.reflectance(0), kept);
    }
    let what = What::Surfaces;
    let refused = Error::Unknown {
        what,
        asked: 4,
        have: 4,
    };
    assert_eq!(light.set_reflectance(4, 0.5), Err(refused));
    let mut fixed = Box::new(Grey::<0>::new(scene).expect("room"));
    let refused = |needed, have| Error::Capacity { what, needed, have };
    assert_eq!(fixed.set_reflectance(0, 0.5), Err(refused(4, 0)));
    let few = Grey::<3>::new(scene).map(|_| ());
    assert_eq!(few, Err(refused(4, 3)));
}

proptest! {
    /// Any sequence of any numbers: all that leaves is finite.
    #[test]
    fn any_sequence_of_settings_gives_numbers(
        settings in prop::collection::vec((0_usize..3, any::<f32>(), any::<f32>()), 1..12)
    ) {
        static TABLES: std::sync::OnceLock<isolux_host::bake::Tables> = std::sync::OnceLock::new();
        let tables = TABLES.get_or_init(|| scenes::bands(false).baked());
        let scene = Scene::load(tables.bytes()).expect("sound tables");
        let mut light = Box::new(Grey::<4>::new(scene).expect("room"));
        let stop = Stop::Below { fraction: 0.001, shots: 200 };
        for (index, radiance, reflectance) in settings {
            let _ = light.set_radiance(index, radiance);
            let _ = light.set_reflectance(index, reflectance);
            let solved = light.update(stop);
            prop_assert!(solved.unshot.is_finite() && solved.unshot >= 0.0, "{solved:?}");
            prop_assert!(light.irradiance().iter().all(|e| e.is_finite()));
        }
    }
}
