//! Tables of every kind that somebody changed: tensor grids whose nodes shoot, meshes
//! with visible fractions and exact visibility, layers, codes, colour. Whatever loads
//! can be lit, reconstructed and asked, without a panic, a NaN or an end that does not
//! come.
//!
//! 100 000 tables over all kinds by default; `ISOLUX_CASES=10000000 cargo test
//! --release --test tables fuzz` for more, `ISOLUX_SEED` for others.

use crate::mutation::{Dice, mutated, setting};
use crate::{Words, seal};
use isolux::form_factor::Best;
use isolux::geometry::Receiver;
use isolux::luminance::{Colour, Constant, Increment, Linear, Luminance, Rgb};
use isolux::number::SoftRoot;
use isolux::resample::{Reconstruction, Stencils, Tensors};
use isolux::scene::Scene;
use isolux::scene::records::Header;
use isolux::shoot::{Light, Stop};
use isolux::transfer::{Codes, Transfer};
use isolux::visibility::{Exact, Unoccluded, VertexRays, Visibility};
use isolux_host::bake::{self, Tables};
use isolux_host::occlusion::Occlusion;
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{file, shipped};
use isolux_host::solve::Sight;
use isolux_host::{pilot, plan};
use rayon::prelude::*;
use std::mem::size_of;

/// What a firmware of such a table would be.
type Lit<'t, L, V> = Light<'t, Best, 80, 64, L, V>;

/// The most values that a firmware has room to reconstruct in.
const ROOM: usize = 2000;

/// A kind of table, and what is done with one that loads.
struct Kind {
    name: &'static str,
    sound: Vec<u8>,
    uses: fn(Scene<'_>, u64) -> bool,
}

/// A shipped scene with few samples, smaller than it ships.
fn scene(name: &str, samples: u64, colour: bool) -> isolux_host::scene::Scene {
    let (name, source) = { shipped::ALL.iter() }
        .find(|(file, _)| *file == name)
        .expect("shipped");
    let mut scene = file::parse(name, source).expect("a sound scene");
    scene.budget.samples = Some(samples);
    if colour {
        for surface in &mut scene.surfaces {
            surface.reflectance[1] *= 0.5;
            surface.radiance[2] *= 0.5;
        }
    }
    scene
}

/// The shadow of a board, by its own way: tensor grids times meshes.
fn shaded(colour: bool, coded: bool) -> Tables {
    let scene = scene("penumbra.toml", 30, colour);
    let light = Reference::new(&scene, Reflections::AtMost(0), &mut |_| {}).expect("a reference");
    let field = |places: &[_]| light.irradiance_at(places);
    let places = scene.surfaces.iter().flat_map(|s| s.vertices.clone());
    let occlusion = Occlusion::for_receivers_within(&scene, places).expect("occluders");
    let looking = (Some(&occlusion), Sight::Exact);
    let plan = pilot::room(
        &scene,
        &scene.budget,
        looking,
        pilot::Manner::default(),
        &field,
    )
    .expect("a plan");
    match coded {
        false => bake::bake(&scene, &plan, Some(occlusion)),
        true => bake::bake_coded(&scene, &plan, Some(occlusion)),
    }
    .expect("tables")
}

/// The paper's scene: tensor grids with points, or nested outlines.
fn open(layers: bool) -> Tables {
    let scene = scene("paper.toml", 58, false);
    let once = Reference::new(&scene, Reflections::AtMost(1), &mut |_| {}).expect("a reference");
    let field = |places: &[_]| once.irradiance_at(places);
    let plan = match layers {
        true => plan::layer_cake(&scene, &scene.budget, &field).expect("a plan"),
        false => plan::error_driven(&scene, &scene.budget, &field, &[])
            .expect("a plan")
            .expect("points stand for the surfaces"),
    };
    bake::bake(&scene, &plan, None).expect("tables")
}

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
fn lit<L: Luminance, V: Transfer + Default, Q: Reconstruction>(
    scene: Scene<'_>,
    case: u64,
    ask: impl FnOnce(&Lit<'_, L, V>),
) -> bool {
    let Ok(light) = Lit::<L, V>::new(scene) else {
        return false;
    };
    let mut light = Box::new(light);
    let stops = [Stop::Shots(3), Stop::Reflections(1), Stop::Shots(6)];
    let solved = light.solve(stops[case as usize % stops.len()]);
    is_number(solved.unshot, case, "unshot");
    assert!(solved.shots <= 80, "case {case}: {} shots", solved.shots);
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
fn looked<L: Luminance, V: Visibility + Default, Q: Reconstruction>(
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

type Sights = Exact<8, 6, 24, 6>;

fn kinds() -> Vec<Kind> {
    let kind = |name, tables: Tables, uses| Kind {
        name,
        sound: tables.bytes().to_vec(),
        uses,
    };
    let shadows = shaded(false, false);
    vec![
        kind("points", open(false), |scene, case| {
            looked::<Constant<f32>, Unoccluded, Tensors<SoftRoot>>(scene, case)
        }),
        kind("layers", open(true), |scene, case| {
            looked::<Increment<f32>, Unoccluded, Tensors<SoftRoot>>(scene, case)
        }),
        kind("rays", shadows.clone(), |scene, case| {
            looked::<Linear<f32>, VertexRays, Stencils<SoftRoot>>(scene, case)
        }),
        kind("shadows", shadows, |scene, case| {
            looked::<Linear<f32>, Sights, Stencils<SoftRoot>>(scene, case)
        }),
        kind("colour", shaded(true, false), |scene, case| {
            looked::<Linear<Rgb>, Sights, Stencils<SoftRoot>>(scene, case)
        }),
        kind("codes", shaded(false, true), |scene, case| {
            lit::<Linear<f32>, Codes, Stencils<SoftRoot>>(scene, case, |_| ())
        }),
    ]
}

/// One changed table: whether it was loaded, and whether the type held it.
fn tried(kind: &Kind, seed: u64, case: u64) -> (bool, bool) {
    let mut dice = Dice::new(seed, case);
    let mut bytes = mutated(&kind.sound, &mut dice);
    // One in eight keeps its old checksum.
    if dice.below(8) > 0 {
        if dice.below(2) == 0 && bytes.len() >= size_of::<Header>() {
            let length = (bytes.len() as u32).to_le_bytes();
            bytes[12..16].copy_from_slice(&length);
        }
        seal(&mut bytes);
    }
    let words = Words::new(&bytes);
    match Scene::load(words.bytes(bytes.len())) {
        Ok(scene) => (true, (kind.uses)(scene, case)),
        Err(_) => (false, false),
    }
}

#[test]
fn fuzz_tables_of_every_kind() {
    let kinds = kinds();
    for (kind, place) in kinds.iter().zip(1..) {
        let words = Words::new(&kind.sound);
        let scene = Scene::load(words.bytes(kind.sound.len())).expect(kind.name);
        assert!(
            (kind.uses)(scene, place),
            "{}: {:?}",
            kind.name,
            scene.counts()
        );
    }
    let (seed, cases) = (setting("ISOLUX_SEED", 1), setting("ISOLUX_CASES", 100_000));
    let each = cases.div_ceil(kinds.len() as u64);
    for (number, kind) in (0_u64..).zip(&kinds) {
        let seed = seed.wrapping_add(number << 40);
        let count =
            |(loaded, held): (u64, u64), (l, h)| (loaded + u64::from(l), held + u64::from(h));
        let (loaded, held) = (0..each)
            .into_par_iter()
            .map(|case| tried(kind, seed, case))
            .fold(|| (0, 0), count)
            .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        println!("{}: {each} tables, {loaded} loaded, {held} lit", kind.name);
        // Both must be met, or nothing was tested.
        let refused = each - loaded;
        assert!(
            held * 10 > each && refused * 10 > each,
            "{}: {loaded} loaded, {held} lit of {each}",
            kind.name
        );
    }
}
