//! Tables of every kind that somebody changed: tensor grids whose nodes shoot, meshes
//! with visible fractions and exact visibility, layers, codes, colour. Whatever loads
//! can be lit, reconstructed and asked, without a panic, a NaN or an end that does not
//! come.
//!
//! 100 000 tables over all kinds by default; `ISOLUX_CASES=10000000 cargo test
//! --release --test tables fuzz` for more, `ISOLUX_SEED` for others. `tests/fuzz/run`
//! looks for tables that reach what none has reached.

use crate::bytes::{Words, lengthened, seal};
use crate::lit::{Sights, lit, looked};
use crate::mutation::{Dice, mutated, setting};
use isolux::luminance::{Constant, Increment, Linear, Rgb};
use isolux::number::SoftRoot;
use isolux::resample::{Stencils, Tensors};
use isolux::scene::Scene;
use isolux::transfer::{Codes, Matrix, Vectors};
use isolux::visibility::{Unoccluded, VertexRays};
use isolux_host::bake::{self, Tables, TooLarge};
use isolux_host::occlusion::Occlusion;
use isolux_host::pilot;
use isolux_host::plan::{self, Plan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{Scene as SceneFile, file, shipped};
use isolux_host::solve::Sight;
use rayon::prelude::*;
use std::path::Path;

/// A kind of table, and what is done with one that loads.
pub(crate) struct Kind {
    pub(crate) name: &'static str,
    pub(crate) sound: Vec<u8>,
    uses: fn(Scene<'_>, u64) -> bool,
}

/// A shipped scene with few samples, smaller than it ships.
fn scene(name: &str, samples: u64, colour: bool) -> SceneFile {
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

/// How tables are baked from a plan that is sound.
type Baking = fn(&SceneFile, &Plan, Option<Occlusion>) -> Result<Tables, TooLarge>;

/// The shadow of a board, by its own way: tensor grids times meshes.
fn shaded(colour: bool, baking: Baking) -> Tables {
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
    baking(&scene, &plan, Some(occlusion)).expect("tables")
}

/// The paper's scene: tensor grids with points, or nested outlines.
pub(crate) fn open(layers: bool) -> Tables {
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

/// Terms whose factors have 6 bits.
fn matrix(
    scene: &SceneFile,
    plan: &Plan,
    occlusion: Option<Occlusion>,
) -> Result<Tables, TooLarge> {
    bake::bake_matrix(scene, plan, occlusion, 6)
}

pub(crate) fn kinds() -> Vec<Kind> {
    let kind = |name, tables: Tables, uses| Kind {
        name,
        sound: tables.bytes().to_vec(),
        uses,
    };
    let shadows = shaded(false, bake::bake);
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
        kind("colour", shaded(true, bake::bake), |scene, case| {
            looked::<Linear<Rgb>, Sights, Stencils<SoftRoot>>(scene, case)
        }),
        kind("codes", shaded(false, bake::bake_coded), |scene, case| {
            lit::<Linear<f32>, Codes, Stencils<SoftRoot>>(scene, case, |_| ())
        }),
        kind("matrix", shaded(false, matrix), |scene, case| {
            lit::<Linear<f32>, Matrix<6>, Stencils<SoftRoot>>(scene, case, |_| ())
        }),
        kind(
            "vectors",
            shaded(true, bake::bake_vectors),
            |scene, case| lit::<Constant<Rgb>, Vectors, Stencils<SoftRoot>>(scene, case, |_| ()),
        ),
    ]
}

/// One changed table: whether it was loaded, and whether the type held it.
fn tried(kind: &Kind, seed: u64, case: u64) -> (bool, bool) {
    let mut dice = Dice::new(seed, case);
    let mut bytes = mutated(&kind.sound, &mut dice);
    // One in eight keeps its old checksum.
    if dice.below(8) > 0 {
        if dice.below(2) == 0 {
            lengthened(&mut bytes);
        }
        seal(&mut bytes);
    }
    let words = Words::new(&bytes);
    match Scene::load(words.bytes(bytes.len())) {
        Ok(scene) => (true, (kind.uses)(scene, case)),
        Err(_) => (false, false),
    }
}

/// Writes sound tables of every kind for `tests/fuzz` to begin with.
fn write_to(corpus: &Path, kinds: &[Kind]) {
    std::fs::create_dir_all(corpus).expect("a directory");
    for kind in kinds {
        std::fs::write(corpus.join(kind.name), &kind.sound).expect("a file");
    }
}

#[test]
fn fuzz_tables_of_every_kind() {
    let kinds = kinds();
    if let Some(corpus) = std::env::var_os("ISOLUX_CORPUS") {
        write_to(Path::new(&corpus), &kinds);
    }
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
