//! Emitters that are points: every way to light a scene lights it with them, or refuses
//! the scene, and none leaves them dark.

use crate::bytes::Words;
use crate::fuzz::open;
use isolux::Error;
use isolux::error::What;
use isolux::form_factor::Best;
use isolux::luminance::{Constant, Increment};
use isolux::number::SoftRoot;
use isolux::scene::Scene;
use isolux::shoot::{Light, Stop};
use isolux::visibility::{Polygons, Unoccluded};
use isolux_host::bake::Tables;
use isolux_host::solve::{self, Rung, Sight};

const STOP: Stop = Stop::below(1e-3);

type Soft = Best<SoftRoot>;
type WithPoints<'t> = Light<'t, Soft, 256, 64>;
type WithoutPoints<'t> = Light<'t, Soft, 256, 64, Constant<f32>, Polygons>;
type Layers<'t, V> = Light<'t, Soft, 256, 64, Increment<f32>, V>;

fn with<T>(tables: &Tables, use_of: impl FnOnce(Scene<'_>) -> T) -> T {
    let words = Words::new(tables.bytes());
    use_of(Scene::load(words.bytes(tables.bytes().len())).expect("sound tables"))
}

#[test]
fn points_light_on_the_host_what_they_light_on_the_device() {
    let tables = open(false);
    let alone = with(&tables, |scene| {
        assert!(scene.counts().shapes > 0, "the scene has points");
        let mut light = WithPoints::new(scene).expect("room");
        light.solve(STOP);
        light.irradiance().to_vec()
    });
    assert!(alone.iter().all(|&value| value > 0.0), "{alone:?}");
    // Grey, told as every channel.
    let in_channels: Vec<f32> = alone.iter().flat_map(|&value| [value; 3]).collect();
    for sight in [Sight::None, Sight::VertexRays, Sight::Exact] {
        let light = solve::solve(&tables, Rung::default(), sight, STOP);
        let samples = light.expect("light").irradiance();
        let samples: Vec<f32> = samples.into_iter().flatten().collect();
        assert_eq!(samples, in_channels, "{sight:?}");
    }
}

#[test]
fn what_knows_no_points_refuses_them() {
    with(&open(false), |scene| {
        let refused = WithoutPoints::new(scene).expect_err("there are points");
        let Error::Capacity { what, needed, have } = refused else {
            panic!("{refused}");
        };
        assert_eq!(
            (what, needed, have),
            (What::Shapes, scene.counts().shapes, 0)
        );
    });
}

#[test]
fn what_knows_no_points_gives_the_same_bits_without_any() {
    fn lit<V: isolux::visibility::Visibility + Default>(scene: Scene<'_>) -> Vec<f32> {
        let mut light = Layers::<V>::new(scene).expect("room");
        light.solve(STOP);
        light.irradiance().to_vec()
    }
    with(&open(true), |scene| {
        assert_eq!(scene.counts().shapes, 0);
        assert_eq!(lit::<Polygons>(scene), lit::<Unoccluded>(scene));
    });
}
