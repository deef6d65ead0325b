//! Any bytes as tables, on the type of light that they ask for.
#![forbid(unsafe_code)]

#[path = "../../tables/bytes.rs"]
mod bytes;
#[path = "../../tables/lit.rs"]
mod lit;

use bytes::{Words, lengthened, seal};
use isolux::integers;
use isolux::luminance::{Colour, Constant, Increment, Linear, Luminance, Rgb};
use isolux::number::SoftRoot;
use isolux::resample::Stencils;
use isolux::scene::Scene;
use isolux::shoot::Stop;
use isolux::transfer::{Codes, Matrix, Vectors};
use isolux::visibility::{Unoccluded, VertexRays};
use lit::{Sights, lit, looked};

/// Loads these bytes as they are, and with a length and a checksum that are right, which
/// no mutation finds; what loads is lit and asked.
pub fn tables(data: &[u8]) {
    used(data);
    let mut bytes = data.to_vec();
    lengthened(&mut bytes);
    seal(&mut bytes);
    used(&bytes);
}

fn used(bytes: &[u8]) {
    let words = Words::new(bytes);
    let tables = words.bytes(bytes.len());
    // Which stop rule is taken, and whether luminaires are dimmed.
    let case = bytes
        .iter()
        .fold(0, |sum: u64, &byte| sum + u64::from(byte));
    if let Ok(scene) = Scene::load(tables) {
        match scene.counts().channels {
            1 => by_form::<f32>(scene, case),
            _ => by_form::<Rgb>(scene, case),
        }
    }
    if let Ok(scene) = integers::Scene::load(tables) {
        let _ = in_integers::<integers::Computed>(scene, case)
            || in_integers::<integers::Matrix<8>>(scene, case);
    }
}

/// One type of radiosity takes these tables.
fn by_form<C: Colour>(scene: Scene<'_>, case: u64)
where
    Constant<C>: Luminance<Colour = C>,
    Increment<C>: Luminance<Colour = C>,
    Linear<C>: Luminance<Colour = C>,
{
    let counts = scene.counts();
    match (counts.coefficients, counts.weights) {
        (1, 0) => by_transfer::<Constant<C>>(scene, case),
        (1, _) => by_transfer::<Increment<C>>(scene, case),
        _ => by_transfer::<Linear<C>>(scene, case),
    }
}

/// The types of transfer that take these tables.
fn by_transfer<L: Luminance>(scene: Scene<'_>, case: u64) {
    looked::<L, Unoccluded, Stencils<SoftRoot>>(scene, case);
    looked::<L, VertexRays, Stencils<SoftRoot>>(scene, case);
    looked::<L, Sights, Stencils<SoftRoot>>(scene, case);
    lit::<L, Codes, Stencils<SoftRoot>>(scene, case, |_| ());
    lit::<L, Matrix<8>, Stencils<SoftRoot>>(scene, case, |_| ());
    lit::<L, Matrix<6>, Stencils<SoftRoot>>(scene, case, |_| ());
    lit::<L, Matrix<4>, Stencils<SoftRoot>>(scene, case, |_| ());
    lit::<L, Vectors, Stencils<SoftRoot>>(scene, case, |_| ());
}

/// Lights, dims and resamples tables in integers; whether the type held them.
fn in_integers<T: integers::Transfer>(scene: integers::Scene<'_>, case: u64) -> bool {
    let Ok(light) = integers::Light::<integers::Q29, 80, 64, T>::new(scene) else {
        return false;
    };
    let mut light = Box::new(light);
    let below = Stop::Below {
        fraction: 1e-3,
        shots: 6,
    };
    let stops = [below, Stop::Reflections(1), Stop::Shots(6)];
    let stop = stops[case as usize % stops.len()];
    let solved = light.solve(stop);
    assert!((0.0..=2.0).contains(&solved.unshot), "{solved:?}");
    let _ = light.set_radiance(0, 0.5 * light.radiance(0));
    let solved = light.update(stop);
    assert!((0.0..=2.0).contains(&solved.unshot), "{solved:?}");
    for point in 0..scene.points().len() {
        assert!(light.point(point).is_ok_and(|e| e >= 0), "point {point}");
    }
    let mut row = [0; 6];
    for surface in 0..scene.surfaces().len() {
        let done = light.resample_row(surface, [6, 6], 3, &mut row);
        done.expect("a surface, a row and room");
    }
    true
}
