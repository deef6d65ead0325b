//! How each sample gets what it gets from each patch, as rounded terms.
//!
//! Every term is known exactly ([`Room`]), and rounded to a factor and a place of few
//! bits ([`Term`]). Of its neighbours the one is taken that leaves the sum of the
//! sample's errors smallest, for the light of every luminaire alone, the largest terms
//! first: what rounding does to them the small ones make good.

use super::room::{Light, Room, fractions, places};
use super::{Tables, Written};
use isolux::scene::{Scene, Term};
use rayon::prelude::*;

/// The matrix of a scene of linear patches, of so many bits a factor: 4, 6 or 8.
pub(super) fn of(tables: &Tables, bits: u32) -> Written {
    let Ok(scene) = Scene::load(tables.bytes()) else {
        return Written::default();
    };
    let places = places(&scene);
    let room = Room::new(&scene, &places);
    let lights = room.lights();
    let rows = room.terms.par_iter().enumerate();
    let rows: Vec<(f32, Vec<u32>)> = rows
        .map(|(index, terms)| Rounding::new(bits, terms).row(terms, index, &lights))
        .collect();
    let (patches, receivers) = (room.patches().len(), rows.len());
    let terms = patches * receivers;
    let width = 2 * bits as usize;
    // A word can be read wherever a term begins.
    let mut bytes = vec![0; ((terms * width).div_ceil(8) + 3).next_multiple_of(4)];
    for patch in 0..patches {
        for (receiver, (_, row)) in rows.iter().enumerate() {
            let first = (patch * receivers + receiver) * width;
            let word = row[patch] << (first % 8);
            for (byte, part) in bytes[first / 8..].iter_mut().zip(word.to_le_bytes()) {
                *byte |= part;
            }
        }
    }
    match terms {
        0 => Written {
            fractions: fractions(&scene, &places),
            ..Written::default()
        },
        _ => Written {
            terms,
            bits,
            bytes,
            fractions: fractions(&scene, &places),
            scales: rows.iter().map(|(scale, _)| *scale).collect(),
            ..Written::default()
        },
    }
}

/// How the terms of one receiver are rounded.
struct Rounding {
    bits: u32,
    /// A factor is so many times the square of its code.
    scale: f32,
}

impl Rounding {
    fn new(bits: u32, terms: &[[f32; 3]]) -> Self {
        let largest = terms.iter().map(|term| term[0]).fold(0.0, f32::max);
        let most = ((1_u32 << bits) - 1) as f32;
        Self {
            bits,
            scale: largest / (most * most),
        }
    }

    /// The scale, and the bits of every term.
    fn row(&self, terms: &[[f32; 3]], index: usize, lights: &[Light]) -> (f32, Vec<u32>) {
        // What a term brings of every light, as a part of what the sample receives.
        let parts = |patch: usize, term: [f64; 3]| -> Vec<f64> {
            let part = |light: &Light| {
                let pairs = term.iter().zip(&light.radiosity[patch]);
                let value: f64 = pairs.map(|(t, b)| t * b).sum();
                match light.irradiance[index] {
                    all if all > 0.0 => value / all,
                    _ => 0.0,
                }
            };
            lights.iter().map(part).collect()
        };
        let mut order: Vec<usize> = (0..terms.len()).collect();
        order.sort_by(|&a, &b| terms[b][0].total_cmp(&terms[a][0]));
        let mut words = vec![0; terms.len()];
        let mut sums = vec![0.0; lights.len()];
        for patch in order {
            let exact = parts(patch, terms[patch].map(f64::from));
            let mut best: Option<(f64, u32, Vec<f64>)> = None;
            for word in self.neighbours(terms[patch]) {
                let rounded = parts(patch, self.term(word));
                let errors = rounded.iter().zip(&exact).map(|(r, e)| r - e);
                let after: Vec<f64> = errors.zip(&sums).map(|(e, sum)| e + sum).collect();
                let square: f64 = after.iter().map(|e| e * e).sum();
                if best.as_ref().is_none_or(|(least, ..)| square < *least) {
                    best = Some((square, word, after));
                }
            }
            if let Some((_, word, after)) = best {
                (words[patch], sums) = (word, after);
            }
        }
        (self.scale, words)
    }

    /// What the device makes of these bits.
    fn term(&self, word: u32) -> [f64; 3] {
        let Term { factor, place } = Term::of(self.bits, word);
        let factor = f64::from(factor * self.scale);
        [
            factor,
            factor * f64::from(place[0]),
            factor * f64::from(place[1]),
        ]
    }

    /// The words on both sides of a term, in the factor and along both axes.
    fn neighbours(&self, [factor, along_a, along_b]: [f32; 3]) -> Vec<u32> {
        if factor <= 0.0 || self.scale <= 0.0 {
            return vec![0];
        }
        let both = |exact: f32, most: u32| {
            let below = exact.floor().clamp(0.0, most as f32) as u32;
            [below, (below + 1).min(most)]
        };
        let half = self.bits / 2;
        let middle = (1_u32 << half) as f32 / 2.0;
        let place = |moment: f32| both(moment / factor * middle + middle, (1 << half) - 1);
        let factors = both((factor / self.scale).sqrt(), (1 << self.bits) - 1);
        let mut words = Vec::new();
        for c in factors {
            for i in place(along_a) {
                for j in place(along_b) {
                    words.push(c | i << self.bits | j << (self.bits + half));
                }
            }
        }
        words
    }
}
