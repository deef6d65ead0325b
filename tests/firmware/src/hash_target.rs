//! The evaluations themselves.

use isolux::form_factor::fixed_point::{self, Format, Q24, Q29, Scale};
use isolux::form_factor::{Arithmetic, Best, Libm, Micromath, Poly3, Poly5, Poly8, form_factor};
use isolux::geometry::Receiver;
use semihosting::process;

use crate::hash_cases::{Case, Cases, Hash};
use crate::root::Chosen;

include!(concat!(env!("OUT_DIR"), "/evaluations.rs"));

/// Hashes every case on one rung; a receiver that is none counts as 0.
#[inline(never)]
fn hash<A: Arithmetic<f32>>() -> u64 {
    let (mut cases, mut hash) = (Cases::new(), Hash::new());
    for _ in 0..EVALUATIONS {
        let case = cases.following();
        hash.add(match Receiver::new::<Chosen>(case.position, case.normal) {
            Ok(receiver) => form_factor::<A, f32>(&receiver, case.vertices()).to_bits(),
            Err(_) => 0,
        });
    }
    hash.0
}

/// Hashes every case on an integer rung.
#[inline(never)]
fn fixed_hash<F: Format>() -> u64 {
    let (mut cases, mut hash) = (Cases::new(), Hash::new());
    for _ in 0..EVALUATIONS {
        let answer = fixed_form_factor::<F>(&cases.following());
        hash.add(answer.map_or(0, |answer| answer.to_bits() as u32));
    }
    hash.0
}

/// A case in integers: its places in one scale, its normal in another.
fn fixed_form_factor<F: Format>(case: &Case) -> Option<F> {
    let vertices = case.vertices();
    let scale = Scale::of(vertices.iter().flatten().chain(&case.position).copied())?;
    let normal = Scale::of(case.normal)?.place(case.normal);
    let receiver = fixed_point::Receiver::<F>::new(scale.place(case.position), normal).ok()?;
    let mut places = [[0_i64; 3]; Case::MOST];
    for (place, &vertex) in places.iter_mut().zip(vertices) {
        *place = scale.place(vertex);
    }
    let places = places.get(..vertices.len())?;
    Some(fixed_point::form_factor(&receiver, places))
}

/// Hashes the answers of one rung.
type Hashes = fn() -> u64;

/// The rungs in floating point.
const FLOATS: &[(&str, Hashes)] = &[
    ("libm", hash::<Libm<Chosen>>),
    ("micromath", hash::<Micromath>),
    ("poly3", hash::<Poly3<Chosen>>),
    ("poly5", hash::<Poly5<Chosen>>),
    ("poly8", hash::<Poly8<Chosen>>),
    ("best", hash::<Best<Chosen>>),
];

/// The rungs in integers.
const INTEGERS: &[(&str, Hashes)] = &[("q24", fixed_hash::<Q24>), ("q29", fixed_hash::<Q29>)];

#[cortex_m_rt::entry]
fn main() -> ! {
    let floats = if cfg!(feature = "integers-alone") {
        &[]
    } else {
        FLOATS
    };
    for (rung, hash) in floats.iter().chain(INTEGERS) {
        defmt::info!("hash {=str} {=u64:016x}", *rung, hash());
    }
    defmt::info!("end hashes {=usize}", floats.len() + INTEGERS.len());
    process::exit(0)
}
