//! How what a sample receives from an emitter is had, in integers: what
//! [`transfer`](crate::transfer) is to floating point.
//!
//! Either every form factor is computed, and nothing hides anything ([`Computed`]); or
//! the host wrote down what is received of what reflects, and which part is seen of
//! luminaires ([`Matrix`]). The terms come first of all that a host can write, because
//! a core without FPU has the most of them: no division and no root, a few
//! multiplications of words a pair, where codes would still have form factors computed.

use super::radiosity::Radiosity;
use super::scene::Scene;
use crate::Error;
use crate::error::What;
use crate::form_factor::fixed_point::Format;
use crate::scene::matrix::{codes, middle, with_words};

/// A rung of the transfer ladder.
pub trait Transfer {
    /// How radiosity varies over an emitter.
    type Radiosity: Radiosity;

    /// Whether looking for the brightest emitter costs more than a shot, so that all
    /// shoot in turn.
    const SWEEPS: bool;

    /// Whether tables are what this rung reads.
    ///
    /// # Errors
    /// [`Error::Capacity`] where their terms have other bits.
    fn fits(scene: &Scene<'_>) -> Result<(), Error>;

    /// The parts of a luminaire's form factor that samples see which follow each other, in
    /// 65 535ths, none where all of them see all. `first` is counted among the samples that
    /// receive direct light.
    fn fractions<'t>(scene: &Scene<'t>, luminaire: usize, first: u32) -> &'t [u16];

    /// Adds what samples that follow each other receive from an emitter that reflects,
    /// where that is read; whether it is. `first` is counted among the samples that
    /// receive reflected light.
    fn add(
        scene: &Scene<'_>,
        emitter: usize,
        first: u32,
        radiosity: Self::Radiosity,
        values: &mut [i32],
    ) -> bool;
}

/// Every form factor is computed: constant radiosities, and nothing hides anything.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Computed;

impl Transfer for Computed {
    type Radiosity = [i32; 1];
    const SWEEPS: bool = false;

    fn fits(_: &Scene<'_>) -> Result<(), Error> {
        Ok(())
    }

    #[inline(always)]
    fn fractions<'t>(_: &Scene<'t>, _: usize, _: u32) -> &'t [u16] {
        &[]
    }

    #[inline(always)]
    fn add(_: &Scene<'_>, _: usize, _: u32, _: [i32; 1], _: &mut [i32]) -> bool {
        false
    }
}

/// A term for each sample and emitter that reflects, with a factor of `BITS` bits, 4, 6
/// or 8, as [`Term`](crate::scene::Term) says; a visible fraction for each sample and
/// luminaire. Radiosities are linear.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Matrix<const BITS: u32>;

impl<const BITS: u32> Transfer for Matrix<BITS> {
    type Radiosity = [i32; 3];
    const SWEEPS: bool = true;

    fn fits(scene: &Scene<'_>) -> Result<(), Error> {
        let counts = scene.counts();
        match counts.terms == 0 || counts.bits == BITS {
            true => Ok(()),
            false => Err(Error::Capacity {
                what: What::Bits,
                needed: counts.bits,
                have: BITS,
            }),
        }
    }

    #[inline(always)]
    fn fractions<'t>(scene: &Scene<'t>, luminaire: usize, first: u32) -> &'t [u16] {
        scene.fractions(luminaire, first)
    }

    #[inline(always)]
    fn add(
        scene: &Scene<'_>,
        emitter: usize,
        first: u32,
        radiosity: [i32; 3],
        values: &mut [i32],
    ) -> bool {
        let (index, terms) = scene.terms(emitter, first);
        let places = Places::new(BITS, radiosity);
        let scales = scene.scales().get(first as usize..).unwrap_or(&[]);
        let receivers = values.iter_mut().zip(scales);
        with_words(terms, BITS, index, receivers, |(value, &scale), word| {
            let [code, a, b] = codes(BITS, word);
            if code > 0 {
                let more = received(places.at([a, b]), factor(BITS, scale, code));
                *value = saturated(i64::from(*value).wrapping_add(more));
            }
        });
        true
    }
}

/// A radiosity as it is at the places that terms name.
struct Places {
    /// Where both codes are 0 ...
    corner: i32,
    /// ... and what a step along each coordinate adds.
    steps: [i32; 2],
}

impl Places {
    /// At places of so many bits both together, B = m + (i − h) a/h + (j − h) b/h.
    ///
    /// In tables of an impossible scene that may leave a word: it is then the mean
    /// everywhere.
    #[inline(always)]
    fn new(bits: u32, [mean, a, b]: [i32; 3]) -> Self {
        let middle = middle(bits) as i32;
        let shift = middle.trailing_zeros() & 31;
        let step = |along: i32| along.saturating_add(middle >> 1) >> shift;
        let steps = [step(a), step(b)];
        let corner = steps.iter().fold(i64::from(mean), |sum, &step| {
            sum.wrapping_sub(i64::from(step).wrapping_mul(middle.into()))
        });
        let reach = steps
            .iter()
            .fold(u64::from(mean.unsigned_abs()), |sum, step| {
                sum.wrapping_add(u64::from(step.unsigned_abs()).wrapping_mul(middle as u64))
            });
        match reach <= i32::MAX as u64 {
            true => Self {
                corner: corner as i32,
                steps,
            },
            false => Self {
                corner: mean,
                steps: [0; 2],
            },
        }
    }

    #[inline(always)]
    fn at(&self, [i, j]: [u32; 2]) -> i32 {
        let [a, b] = self.steps;
        self.corner
            .wrapping_add(a.wrapping_mul(i as i32))
            .wrapping_add(b.wrapping_mul(j as i32))
    }
}

/// The form factor s c² in units of 2⁻³¹, rounded down: below 1, as is checked on load.
#[inline(always)]
fn factor(bits: u32, scale: u32, code: u32) -> i32 {
    let square = code.wrapping_mul(code);
    let product = u64::from(scale).wrapping_mul(square.into());
    (product >> (bits.wrapping_mul(2) & 63)) as i32
}

/// Radiosity times form factor, rounded to nearest.
#[inline(always)]
fn received(radiosity: i32, factor: i32) -> i64 {
    let product = i64::from(radiosity).wrapping_mul(factor.into());
    product.wrapping_add(1 << 30) >> 31
}

/// A word, as near as one comes.
#[inline(always)]
pub(super) fn saturated(value: i64) -> i32 {
    value.clamp(i32::MIN.into(), i32::MAX.into()) as i32
}

/// A form factor of which so many 65 535ths are seen, rounded to nearest: 1/65 535 is
/// 65 537 units of 2⁻³² but for 2⁻³² of itself.
#[inline(always)]
pub(super) fn part<F: Format>(factor: F, seen: u16) -> F {
    if seen == u16::MAX {
        return factor;
    }
    // 30 and 16 bits, and 17 more.
    let product = (factor.to_bits() as u64).wrapping_mul(seen.into());
    let scaled = product.wrapping_mul(65_537).wrapping_add(1 << 31);
    F::from_bits((scaled >> 32) as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::fixed_point::Q29;

    #[test]
    fn places_are_those_of_the_terms() {
        for (bits, middle) in [(4, 2_i64), (6, 4), (8, 8)] {
            for radiosity in [
                [1 << 28, -(1 << 27), 12_345_678],
                [1000, 999, -77],
                [-5, 8, 0],
            ] {
                let places = Places::new(bits, radiosity);
                let [mean, a, b] = radiosity.map(i64::from);
                for i in 0..2 * middle {
                    for j in 0..2 * middle {
                        let got = i64::from(places.at([i as u32, j as u32]));
                        let exact = mean * middle + (i - middle) * a + (j - middle) * b;
                        // A step is rounded by half a unit at the most.
                        assert!((got * middle - exact).abs() <= middle * middle, "{got}");
                    }
                }
            }
            let steep = Places::new(bits, [i32::MAX, i32::MIN, i32::MAX]);
            assert_eq!(steep.at([3, 1]), i32::MAX);
        }
    }

    #[test]
    fn parts_are_rounded_to_nearest() {
        for factor in [1, 12_345, 1 << 20, 123_456_789, 1 << 29] {
            for seen in [0, 1, 2, 32_767, 40_000, 65_534, u16::MAX] {
                let got = part(Q29::from_bits(factor), seen).to_bits();
                let exact = f64::from(factor) * f64::from(seen) / 65_535.0;
                assert!((f64::from(got) - exact).abs() <= 0.51, "{factor} {seen}");
            }
        }
    }

    #[test]
    fn terms_are_products() {
        let scale = (0.3 / (255.0 * 255.0) * 2.0_f64.powi(47)) as u32;
        for code in [1, 2, 17, 128, 255] {
            let exact = 0.3 * f64::from(code * code) / (255.0 * 255.0);
            let got = f64::from(factor(8, scale, code)) / 2_147_483_648.0;
            // The scale is rounded down, and the factor.
            assert!((got - exact).abs() < 9.3e-10, "{code}: {got} {exact}");
            for radiosity in [1 << 30, -(1 << 30), 7, -1] {
                let more = received(radiosity, factor(8, scale, code)) as f64;
                // That of 2³⁰, and half a unit.
                assert!((more - exact * f64::from(radiosity)).abs() <= 1.51);
            }
        }
    }
}
