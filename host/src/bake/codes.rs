//! How each sample gets what it gets from each emitter, in four bits.
//!
//! The light of every luminaire alone, in every channel alone, is followed
//! through the room with exact visibility; any dimming is a sum of these, so
//! that a plan for each holds for all. A pair of sample and patch then has the
//! cheapest [`Code`] whose error is below [`TOLERANCE`] of what the sample
//! receives in all, for every such light; where none is, the most accurate one.
//! Many small errors of one sign would still be a large one: of codes that cost
//! the same the one is taken that leaves the sum of the sample's errors
//! smallest, and where that sum passes [`BALANCE`] a dearer one that brings it
//! back.
//!
//! Direct light does not vary over a luminaire: its visible fraction, in 16 bits,
//! is all there is to say.

use super::room::{Light, Room, Rung, UNIT, fractions, places, received};
use super::{Tables, Written};
use isolux::geometry::Receiver;
use isolux::scene::{Code, Method, Scene};
use rayon::prelude::*;

/// The part of a sample's irradiance that a code may err by.
const TOLERANCE: f64 = 0.002;

/// The part of it below which a term is skipped.
const NEGLIGIBLE: f64 = TOLERANCE / 4.0;

/// The part of it that the errors of all its codes together may come to: beyond,
/// a code is taken that brings them down, whatever it costs.
const BALANCE: f64 = TOLERANCE / 8.0;

/// The codes of a scene of linear patches.
pub(super) fn of(tables: &Tables) -> Written {
    let Ok(scene) = Scene::load(tables.bytes()) else {
        return Written::default();
    };
    let places = places(&scene);
    let room = Room::new(&scene, &places);
    let patches = room.patches().len();
    let codes = room.codes();
    let pairs = patches * codes.len();
    let mut bytes = vec![0; pairs.div_ceil(8) * 4];
    for patch in 0..patches {
        for (receiver, of_receiver) in codes.iter().enumerate() {
            let pair = patch * codes.len() + receiver;
            bytes[pair / 2] |= (of_receiver[patch].bits() << (pair % 2 * 4)) as u8;
        }
    }
    Written {
        codes: pairs,
        bytes,
        fractions: fractions(&scene, &places),
        ..Written::default()
    }
}

impl Room<'_> {
    /// The codes, by sample with reflected light, then by patch.
    fn codes(&self) -> Vec<Vec<Code>> {
        let lights = self.lights();
        let reflected = self.reflected_places();
        (0..reflected.len())
            .into_par_iter()
            .map(|index| match &reflected[index].receiver {
                Some(receiver) => self.codes_of(index, receiver, &lights),
                None => vec![Code::SKIP; self.patches().len()],
            })
            .collect()
    }

    /// The codes of one sample, those of its largest terms first.
    fn codes_of(&self, index: usize, receiver: &Receiver<f32>, lights: &[Light]) -> Vec<Code> {
        let first = self.scene.counts().luminaires as usize;
        let patches = self.patches().len();
        // Everything as a part of what the sample receives of that light.
        let part = |light: &Light, value: f64| match light.irradiance[index] {
            all if all > 0.0 => value / all,
            _ => 0.0,
        };
        let exact = |patch: usize| -> Vec<f64> {
            let of = |light: &Light| {
                let value = received(&self.terms[index][patch], &light.radiosity[patch]);
                part(light, value)
            };
            lights.iter().map(of).collect()
        };
        let mut order: Vec<(usize, Vec<f64>)> = (0..patches).map(|p| (p, exact(p))).collect();
        order.sort_by(|(_, a), (_, b)| largest(b).total_cmp(&largest(a)));

        let mut codes = vec![Code::SKIP; patches];
        let mut sum = vec![0.0; lights.len()];
        for (patch, exact) in order {
            let coded = |method: Method| -> Vec<f64> {
                let whole = Code::whole(method);
                let term = self
                    .scene
                    .coded::<Rung, _>(receiver, first + patch, UNIT, whole);
                let of = |light: &Light| part(light, received(&term.0, &light.radiosity[patch]));
                lights.iter().map(of).collect()
            };
            let (code, errors) = choose(&exact, coded, &sum);
            codes[patch] = code;
            for (sum, error) in sum.iter_mut().zip(errors) {
                *sum += error;
            }
        }
        codes
    }
}

/// The cheapest code that will do, and its errors.
///
/// `exact` is the term of every light, `coded` that of a method with all of the
/// emitter seen, `sum` the errors of the codes that the sample has already.
fn choose(exact: &[f64], coded: impl Fn(Method) -> Vec<f64>, sum: &[f64]) -> (Code, Vec<f64>) {
    let after = |errors: &[f64]| -> f64 {
        let sums: Vec<f64> = errors.iter().zip(sum).map(|(e, s)| e + s).collect();
        largest(&sums)
    };
    // The least error by itself, and the least of the sum among those that will
    // do by themselves.
    let (mut best, mut balanced): (Option<Tried>, Option<Tried>) = (None, None);
    for method in Method::ALL {
        let whole = coded(method);
        for code in Code::all().filter(|code| code.meaning().0 == method) {
            let fraction = f64::from(code.meaning().1);
            let pairs = whole.iter().zip(exact);
            let errors: Vec<f64> = pairs
                .map(|(coded, exact)| coded * fraction - exact)
                .collect();
            let tried = |least: f64| Tried {
                least,
                code,
                errors: errors.clone(),
            };
            let error = largest(&errors);
            if best.as_ref().is_none_or(|best| error < best.least) {
                best = Some(tried(error));
            }
            let allowed = match method {
                Method::Skip => NEGLIGIBLE,
                _ => TOLERANCE,
            };
            let least = after(&errors);
            if error < allowed && balanced.as_ref().is_none_or(|b| least < b.least) {
                balanced = Some(tried(least));
            }
        }
        if balanced
            .as_ref()
            .is_some_and(|balanced| balanced.least < BALANCE)
        {
            break;
        }
    }
    let chosen = balanced.or(best).map(|tried| (tried.code, tried.errors));
    chosen.unwrap_or((Code::SKIP, exact.iter().map(|exact| -exact).collect()))
}

/// A code with its errors.
struct Tried {
    /// What there is the least of.
    least: f64,
    code: Code,
    errors: Vec<f64>,
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}
