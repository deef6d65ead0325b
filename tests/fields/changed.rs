//! Tables with fields that somebody changed: whatever loads can be put together, and
//! gives numbers.
//!
//! `ISOLUX_CASES=1000000 cargo test --release --test fields changed` for more,
//! `ISOLUX_SEED` for others.

use crate::{open, room, shipped_scene};
use isolux::form_factor::{Arithmetic, Best};
use isolux::luminance::{Constant, Linear, Luminance};
use isolux::number::SoftRoot;
use isolux::resample::Stencils;
use isolux::scene::Scene;
use isolux::scene::records::{Header, checksum};
use isolux::shoot::{Light, Stop};
use isolux::transfer::Transfer;
use isolux::visibility::{Exact, Unoccluded};
use isolux_host::bake::Tables;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::mem::{offset_of, size_of};
use zerocopy::IntoBytes;

fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().expect(name))
}

/// Puts every surface together and asks for rows and places.
fn use_it<L, V>(scene: Scene<'_>, sight: V) -> Option<()>
where
    L: Luminance<Colour = f32>,
    V: Transfer,
    Best: Arithmetic<f32>,
{
    let light = Light::<Best, 128, 64, L, V>::with_sight(scene, sight).ok()?;
    let mut light = Box::new(light);
    light.solve(Stop::Reflections(1));
    let is_number = |x: f32| assert!(x.is_finite() && x >= 0.0, "{x}");
    for index in 0..scene.surfaces().len() {
        let surface = scene.surface(index).expect("a surface");
        let mut room = vec![0.0; scene.fields().room(surface)];
        let Ok(made) = light.reconstruct::<Stencils<SoftRoot>>(index, &mut room) else {
            continue;
        };
        let mut row = [0.0; 9];
        for number in 0..4 {
            made.row([9, 4], number, &mut row).expect("a row");
            row.into_iter().for_each(is_number);
        }
        for place in [
            [0.0, 0.0],
            [1.0, 2.0],
            [-1e30, 1e30],
            [f32::NAN, f32::INFINITY],
        ] {
            is_number(made.at(place));
        }
    }
    Some(())
}

/// Numbers that a check may have forgotten.
const WORDS: [u32; 14] = [
    0,
    1,
    2,
    7,
    0xffff,
    0x1_0000,
    0x7fff_8000,
    u32::MAX,
    0x7f80_0000, // infinity
    0x7fc0_0000, // not a number
    0x0080_0000, // the smallest normal number
    0x5a0e_1bca, // 1e16
    0xda0e_1bca,
    0x3f80_0000, // 1
];

fn changed(tables: &Tables, lit: impl Fn(Scene<'_>) -> Option<()>) {
    let sound = tables.bytes();
    let cases = setting("ISOLUX_CASES", 20_000);
    let seed = setting("ISOLUX_SEED", 1);
    let mut bytes = [0_u8; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    let random = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    let mut runner = TestRunner::new_with_rng(Config::default(), random);
    // The counts of the head, and the fields at the end, are changed more often.
    let words = sound.len() / 4;
    let head = size_of::<Header>() / 4;
    let place = prop_oneof![0..head, words - words / 4..words, 0..words];
    let value = prop_oneof![prop::sample::select(&WORDS[..]), any::<u32>()];
    let change = prop::collection::vec((place, value), 1..4);
    let (mut used, mut refused) = (0_u64, 0_u64);
    for _ in 0..cases {
        let change = change.new_tree(&mut runner).expect("a change").current();
        let mut mutated: Vec<u32> = sound
            .chunks_exact(4)
            .map(|word| u32::from_le_bytes(word.try_into().expect("four bytes")))
            .collect();
        for (place, value) in change {
            mutated[place] = value;
        }
        let field = offset_of!(Header, checksum);
        let sum = checksum(&mutated.as_bytes()[field + 4..]);
        mutated[field / 4] = sum;
        match Scene::load(mutated.as_bytes()).ok().and_then(&lit) {
            Some(()) => used += 1,
            None => refused += 1,
        }
    }
    println!("{used} used, {refused} refused");
    // Enough of both that either way is looked at.
    assert!(
        used * 20 > cases && refused * 20 > cases,
        "{used} {refused}"
    );
}

#[test]
fn changed_grids_are_refused_or_give_numbers() {
    let (_, tables) = open(&shipped_scene("paper.toml"));
    changed(&tables, |scene| {
        use_it::<Constant<f32>, _>(scene, Unoccluded)
    });
}

#[test]
fn changed_meshes_are_refused_or_give_numbers() {
    let mut scene = shipped_scene("penumbra.toml");
    scene.budget.samples = Some(30);
    let (_, tables) = room(&scene);
    type Seeing = Exact<16, 8, 64, 8>;
    changed(&tables, |scene| {
        use_it::<Linear<f32>, _>(scene, Seeing::new())
    });
}
