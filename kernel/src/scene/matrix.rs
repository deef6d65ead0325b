//! What a receiver gets, as numbers that a host computed and rounded.
//!
//! Of a secondary emitter that is a term of a matrix: of the form factor F and the
//! place (a, b) where the emitter has its centre of gravity as it is seen,
//!
//! ```text
//! E = F B(a, b),      F = s c²,      a = (i − h) / h,      b = (j − h) / h,
//! ```
//!
//! with a scale s for every receiver and c, i, j small numbers: a factor of n bits
//! and two places of n/2 bits, h = 2^(n/2 − 1). A square spreads the steps as the
//! terms are spread, most of them far smaller than a receiver's largest. An emitter
//! of constant radiosity has no use for the place.
//!
//! Of a luminaire it is a response: what a sample receives in the end of a
//! luminaire's light, direct and reflected, for 1 W m⁻² of exitance,
//! E = M s c² with c of 16 bits and a scale for every luminaire and channel. It
//! holds for the reflectances that it was computed for.

use super::Scene;
use super::records::Counts;
use crate::luminance::{Colour, Luminance};

/// What a receiver gets from a secondary emitter of 1 W m⁻².
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Term {
    /// The form factor of what is seen.
    pub factor: f32,
    /// Where that has its centre of gravity, in the emitter's own coordinates.
    pub place: [f32; 2],
}

impl Term {
    /// The term that these bits stand for, of so many bits a factor: the factor in
    /// the lowest, then a, then b. The factor is not yet scaled: c².
    #[inline(always)]
    pub fn of(bits: u32, word: u32) -> Self {
        let [code, a, b] = codes(bits, word);
        let middle = middle(bits);
        // A power of two: the division is exact.
        let step = 1.0 / middle as f32;
        let place = |code: u32| code.wrapping_sub(middle) as i32 as f32 * step;
        Self {
            factor: code.wrapping_mul(code) as f32,
            place: [place(a), place(b)],
        }
    }
}

/// The numbers that the bits of a term are: c, i and j.
#[inline(always)]
pub(crate) fn codes(bits: u32, word: u32) -> [u32; 3] {
    let half = bits >> 1;
    let part = |from: u32, bits: u32| word >> (from & 31) & (1_u32 << (bits & 31)).wrapping_sub(1);
    [
        part(0, bits),
        part(bits, half),
        part(bits.wrapping_add(half), half),
    ]
}

/// h, which stands for the middle of an emitter.
#[inline(always)]
pub(crate) fn middle(bits: u32) -> u32 {
    (1_u32 << ((bits >> 1) & 31)) >> 1
}

/// The square of a response's 16 bits, to be scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Response;

impl Response {
    /// c² of 16 bits, rounded to single precision.
    #[inline(always)]
    pub fn of(code: u16) -> f32 {
        u32::from(code).wrapping_mul(u32::from(code)) as f32
    }
}

/// How many scales tables with these counts have.
pub(crate) const fn scales(counts: &Counts) -> u32 {
    if counts.responses > 0 {
        return counts.luminaires.saturating_mul(counts.channels);
    }
    match counts.terms.checked_div(secondary(counts)) {
        Some(receivers) => receivers,
        None => 0,
    }
}

/// Bytes of the terms of tables with these counts: whole words, so that a word can
/// be read wherever a term begins.
pub(crate) const fn bytes(counts: &Counts) -> u64 {
    if counts.terms == 0 {
        return 0;
    }
    // Counts that nobody has checked yet: past what any tables have it saturates.
    let terms = counts.terms as u64 * 2;
    let bits = terms.saturating_mul(counts.bits as u64);
    (bits.div_ceil(8) + 3).next_multiple_of(4)
}

const fn secondary(counts: &Counts) -> u32 {
    counts.emitters.saturating_sub(counts.luminaires)
}

/// Gives each item with the bits of its term: terms of so many bits a factor, of which
/// the first item has this one.
#[inline(always)]
pub(crate) fn with_words<T>(
    terms: &[u8],
    bits: u32,
    first: u32,
    items: impl Iterator<Item = T>,
    mut take: impl FnMut(T, u32),
) {
    let begin = u64::from(first).wrapping_mul(u64::from(bits) << 1);
    let bytes = terms.get((begin >> 3) as usize..).unwrap_or(&[]);
    // Where terms are whole bytes they are read as such.
    match bits {
        4 => {
            for (item, &byte) in items.zip(bytes) {
                take(item, byte.into());
            }
        }
        8 => {
            let (words, _) = bytes.as_chunks::<2>();
            for (item, word) in items.zip(words) {
                take(item, u16::from_le_bytes(*word).into());
            }
        }
        _ => {
            let begin = (begin & 7) as u32;
            let words = (0_u32..).map_while(|k| {
                let at = k.wrapping_mul(bits << 1).wrapping_add(begin);
                let word = bytes.get((at >> 3) as usize..)?.first_chunk()?;
                Some(u32::from_le_bytes(*word) >> (at & 7))
            });
            for (item, word) in items.zip(words) {
                take(item, word);
            }
        }
    }
}

impl Scene<'_> {
    /// Adds what receivers that follow each other, the first of them this one among
    /// all samples that receive reflected light, get from an emitter; `bits` is that of
    /// the tables. Nothing where there are no terms.
    ///
    /// Cost on a Cortex-M4F: about 30 instructions a receiver, 10 where its term is 0.
    #[inline(always)]
    pub fn add_terms<L: Luminance>(
        &self,
        bits: u32,
        emitter: usize,
        first: u32,
        radiosity: L,
        values: &mut [L::Colour],
    ) {
        let nth = (emitter as u32).wrapping_sub(self.header.counts.luminaires);
        let index = nth
            .wrapping_mul(self.scales.len() as u32)
            .wrapping_add(first);
        let scales = self.scales.get(first as usize..).unwrap_or(&[]);
        let receivers = values.iter_mut().zip(scales);
        with_words(
            self.codes,
            bits,
            index,
            receivers,
            |(value, &scale), word| {
                let Term { factor, place } = Term::of(bits, word);
                if factor > 0.0 {
                    *value = value.plus(radiosity.received(factor * scale, || place));
                }
            },
        );
    }

    /// What a sample receives in the end of a luminaire's light, for 1 W m⁻² of its
    /// exitance, in every channel. Nothing where there is no such response.
    #[inline(always)]
    pub fn response<C: Colour>(&self, luminaire: usize, sample: u32) -> C {
        let counts = &self.header.counts;
        let first = (luminaire as u32).wrapping_mul(C::CHANNELS as u32);
        let channel = |channel: u32| {
            let row = first.wrapping_add(channel);
            let index = row.wrapping_mul(counts.samples).wrapping_add(sample);
            let code = self.fractions.get(index as usize).copied();
            let scale = self.scales.get(row as usize).copied();
            Response::of(code.unwrap_or(0)) * scale.unwrap_or(0.0)
        };
        match C::CHANNELS {
            1 => C::read(&[channel(0)]),
            _ => C::read(&[channel(0), channel(1), channel(2)]),
        }
    }
}
