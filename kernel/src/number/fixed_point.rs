//! Numbers of 32 bits with a fixed binary point, and the functions of them that
//! a form factor needs, in integers alone: not one floating-point instruction,
//! the same bits on every core.
//!
//! [`Q29`] and [`Q24`] are the `fixed` crate's numbers with every operation
//! saturating: they have no NaN, no infinity and no way to panic, also where
//! overflow checks are compiled in. The functions are written in unsigned
//! words with the point at the top, so that a product is one multiplication of
//! 32 by 32 bits of which the upper word is kept.

use super::Number;
use core::ops::{Add, Div, Mul, Neg, Sub};
use fixed::types::{I3F29, I8F24};

/// A 32-bit fixed-point number format that form factors can be computed in.
pub trait Format: Number + Eq {
    /// Bits after the binary point.
    const FRACTION: u32;
    /// Degree of the arc tangent's polynomial that suits them: 5 or 8.
    const DEGREE: usize;

    /// The number whose two's complement word is `bits`.
    fn from_bits(bits: i32) -> Self;

    /// The number's two's complement word: its value times 2^`FRACTION`.
    fn to_bits(self) -> i32;
}

/// The word of the number nearest to a constant, ties away from 0, saturated;
/// 0 for NaN. In integers: a constant may reach it at run time on a core that
/// has no floating point.
const fn word(constant: f64, fraction: u32) -> i32 {
    let bits = constant.to_bits();
    let biased = (bits >> 52) as i32 & 0x7ff;
    let mantissa = bits & ((1 << 52) - 1);
    if biased == 0x7ff && mantissa != 0 {
        return 0;
    }
    // The value is (2^52 + mantissa) 2^(biased − 1075).
    let drop = 1075_i32.wrapping_sub(biased).wrapping_sub(fraction as i32);
    let magnitude = if drop < 22 {
        i32::MAX as u64 + 1
    } else if drop > 62 {
        0
    } else {
        let whole = (1 << 52) | mantissa;
        (whole.wrapping_shr(drop as u32 - 1).wrapping_add(1)) >> 1
    };
    if bits >> 63 == 1 {
        if magnitude > i32::MAX as u64 {
            i32::MIN
        } else {
            (magnitude as i32).wrapping_neg()
        }
    } else if magnitude > i32::MAX as u64 {
        i32::MAX
    } else {
        magnitude as i32
    }
}

macro_rules! saturating {
    ($(#[$attribute:meta])* $name:ident, $inner:ident, $fraction:literal, $degree:literal) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
        pub struct $name($inner);

        impl Format for $name {
            const FRACTION: u32 = $fraction;
            const DEGREE: usize = $degree;

            #[inline(always)]
            fn from_bits(bits: i32) -> Self {
                Self($inner::from_bits(bits))
            }

            #[inline(always)]
            fn to_bits(self) -> i32 {
                self.0.to_bits()
            }
        }

        impl Number for $name {
            const ZERO: Self = Self($inner::ZERO);
            const ONE: Self = Self($inner::ONE);
            const PI: Self = Self($inner::PI);

            #[inline]
            fn of(constant: f64) -> Self {
                Self($inner::from_bits(word(constant, $fraction)))
            }

            #[inline]
            fn is_finite(self) -> bool {
                true
            }
        }

        impl Add for $name {
            type Output = Self;

            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self(self.0.saturating_add(other.0))
            }
        }

        impl Sub for $name {
            type Output = Self;

            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self(self.0.saturating_sub(other.0))
            }
        }

        impl Mul for $name {
            type Output = Self;

            /// Rounds down.
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                Self(self.0.saturating_mul(other.0))
            }
        }

        impl Div for $name {
            type Output = Self;

            /// Rounds towards 0. By 0: the largest number of the dividend's
            /// sign; 0/0 is 0.
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                let (dividend, divisor) = (self.to_bits(), other.to_bits());
                let quotient = (i64::from(dividend) << $fraction).checked_div(i64::from(divisor));
                let quotient = quotient.unwrap_or(i64::from(dividend) << 32);
                Self::from_bits(quotient.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32)
            }
        }

        impl Neg for $name {
            type Output = Self;

            #[inline(always)]
            fn neg(self) -> Self {
                Self(self.0.saturating_neg())
            }
        }

        impl From<$name> for $inner {
            fn from(number: $name) -> Self {
                number.0
            }
        }

        impl From<$inner> for $name {
            fn from(number: $inner) -> Self {
                Self(number)
            }
        }

        /// Exact. Floating point: not for the path that has to do without.
        impl From<$name> for f64 {
            fn from(number: $name) -> Self {
                f64::from(number.to_bits()) / f64::from(1_u32 << $fraction)
            }
        }

        #[cfg(feature = "defmt")]
        impl defmt::Format for $name {
            fn format(&self, out: defmt::Formatter<'_>) {
                defmt::write!(out, "{=i32}/2^{=u32}", self.to_bits(), Self::FRACTION);
            }
        }
    };
}

saturating! {
    /// −4 ≤ x < 4 in steps of 2^−29 = 1.9e-9; saturates.
    Q29, I3F29, 29, 8
}

saturating! {
    /// −128 ≤ x < 128 in steps of 2^−24 = 6.0e-8; saturates.
    Q24, I8F24, 24, 5
}

/// The upper word of a product: the product of two fractions of 32 bits.
#[inline(always)]
pub(crate) fn upper(a: u32, b: u32) -> u32 {
    (u64::from(a).wrapping_mul(u64::from(b)) >> 32) as u32
}

/// 2^32 |c| of every coefficient, rounded to nearest, at compile time.
const fn fractions<const COUNT: usize>(coefficients: &[f64; COUNT]) -> [u32; COUNT] {
    let mut words = [0; COUNT];
    let mut index = 0;
    while index < COUNT {
        let c = coefficients[index];
        let magnitude = if c < 0.0 { -c } else { c };
        words[index] = (magnitude * 4_294_967_296.0 + 0.5) as u32;
        index += 1;
    }
    words
}

/// h(q) on 0 ≤ q ≤ 0.1716 = tan² 22.5°, relative error 5.6e-7.
const ARCTANGENT_NARROW_3: [u32; 4] =
    fractions(&[0.9999994444, -0.3332274635, 0.1968107107, -0.1111333486]);
/// h(q) on 0 ≤ q ≤ 0.1716, relative error 6.1e-10.
const ARCTANGENT_NARROW_5: [u32; 6] = fractions(&[
    0.9999999994,
    -0.3333330762,
    0.1999821667,
    -0.1424007789,
    0.1057344161,
    -0.06034691619,
]);
/// 0.1715 in units of 2^−32: below it the narrow fits hold.
const NARROW: u32 = 736_586_891;

/// h(q) on 0 ≤ q ≤ 1, relative error 4.4e-6.
const ARCTANGENT_5: [u32; 6] = fractions(&[
    0.9999956297,
    -0.3329946013,
    0.1956359517,
    -0.1212391229,
    0.05747735311,
    -0.01348047933,
]);
/// h(q) on 0 ≤ q ≤ 1, relative error 1.5e-8.
const ARCTANGENT_8: [u32; 9] = fractions(&[
    0.9999999848,
    -0.3333307335,
    0.1999261945,
    -0.1420364493,
    0.1064093576,
    -0.07504298228,
    0.04269156382,
    -0.01606865739,
    0.002849897048,
]);

/// h(q) = atan(√q)/√q for 0 ≤ q < 1, both in units of 2^−32, by minimax fits
/// of degree 5 or 8; other degrees do not compile.
///
/// With q = tan²(γ/2) it turns the half-angle tangent of an edge into its
/// angle, γ = 2 √q h(q), for γ ≤ 90°. The variable of
/// [`super::angle_over_sine`] needs fewer powers over the whole domain, but here
/// most edges are in the narrow part, where this one needs fewer still.
///
/// The coefficients alternate in sign and fall, so Horner's partial sums do
/// too: each is a coefficient less a fraction of the one before and never
/// negative, which needs neither a sign nor a shift. Relative error 4.4e-6 and
/// 1.5e-8 (fit) plus 1e-9. Below q = 0.1715 fits of degree 3 and 5 for that
/// range, 5.6e-7 and 6e-10. At most `DEGREE` multiplications and subtractions. Never
/// panics.
#[inline(always)]
pub fn scaled_arctangent_word<const DEGREE: usize>(q: u32) -> u32 {
    const {
        assert!(
            matches!(DEGREE, 5 | 8),
            "there are fits of degree 5 and 8 in words"
        );
    }
    match (DEGREE, q < NARROW) {
        (5, true) => alternating(&ARCTANGENT_NARROW_3, q),
        (5, false) => alternating(&ARCTANGENT_5, q),
        (_, true) => alternating(&ARCTANGENT_NARROW_5, q),
        (_, false) => alternating(&ARCTANGENT_8, q),
    }
}

#[inline(always)]
fn alternating<const COUNT: usize>(ascending: &[u32; COUNT], q: u32) -> u32 {
    let mut sum = 0;
    for &coefficient in ascending.iter().rev() {
        sum = coefficient.wrapping_sub(upper(sum, q));
    }
    sum
}

/// 1/t for 2^30 ≤ t ≤ 2^31 standing for 1 ≤ t ≤ 2, in units of 2^−31.
///
/// A quotient of 16 bits and one step of Newton's: relative error at most
/// 5.3e-10 of the step, always too small, and 4.7e-10 of rounding. One division of 32 by 32 bits,
/// two multiplications. Outside of its domain the value is meaningless. Never
/// panics.
#[inline(always)]
pub fn reciprocal(t: u32) -> u32 {
    let rounded = t.wrapping_add(1 << 13) >> 14;
    let quotient = u32::MAX.checked_div(rounded).unwrap_or(0);
    // The middle of what the quotient stands for, in units of 2^−17.
    let seed = quotient.wrapping_mul(2) | 1;
    let product = u64::from(t).wrapping_mul(u64::from(seed));
    let missing = ((1_u64 << 47).wrapping_sub(product) as i64 >> 1) as i32;
    let correction = i64::from(missing).wrapping_mul(i64::from(seed as i32));
    let correction = correction.wrapping_add(1 << 31) >> 32;
    (seed << 14).wrapping_add_signed(correction as i32)
}

/// 1/√x for 2^30 ≤ x < 2^32 standing for 1/4 ≤ x < 1, in units of 2^−30,
/// saturated below 2.
///
/// A cubic (minimax, relative error 7.0e-3) and two steps of Newton's. A step
/// turns an error e into −3e²/2, always too small; a constant added to each
/// step centres what is left, so that the errors are 3.7e-5 and then 1.0e-9
/// with either sign; rounding down adds 9.3e-10. 8 multiplications, no loop, no division. Outside of its
/// domain the value is meaningless. Never panics.
#[inline(always)]
pub fn reciprocal_root(x: u32) -> i32 {
    /// The cubic's coefficients in units of 2^−29, signs alternating.
    const SEED: [u32; 4] = [
        1_670_943_178, // 3.1123742049
        3_173_392_633, // 5.9109043950
        3_344_674_923, // 6.2299425207
        1_309_134_479, // 2.4384529877
    ];
    /// 3 + 3/2 (7.04e-3)² in units of 2^−26.
    const THREE: u32 = 201_331_582;
    /// 3/2 (3.72e-5)² in units of 2^−61, the excess of the second step.
    const EXCESS: i64 = 4_780_752_922;

    let y = alternating(&SEED, x); // 2^−29
    let product = upper(upper(x, y), y); // x y², 2^−26
    let y = upper(y, THREE.wrapping_sub(product)) << 6; // 2^−30
    let y = if y > i32::MAX as u32 {
        i32::MAX
    } else {
        y as i32
    };
    // What is missing to x y² = 1 is small: keep its digits.
    let root = upper(x, (y as u32) << 1); // 2^−31
    let product = u64::from(root).wrapping_mul(u64::from(y as u32)); // 2^−61
    let missing = (1_i64 << 61).wrapping_sub(product as i64);
    let missing = (missing.wrapping_add(EXCESS) >> 17) as i32; // 2^−44
    let correction = i64::from(missing).wrapping_mul(i64::from(y)) >> 45;
    y.saturating_add(correction as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORD: f64 = 4_294_967_296.0;

    #[test]
    fn constants_are_rounded_to_nearest_and_saturate() {
        for constant in [
            0.0,
            1.0,
            -1.0,
            0.3,
            -0.3,
            1e-9,
            3.9,
            -3.9,
            2.0_f64.powi(-30),
        ] {
            let scaled = (constant * 536_870_912.0).abs();
            let nearest = libm::round(scaled) * if constant < 0.0 { -1.0 } else { 1.0 };
            assert_eq!(
                f64::from(Q29::of(constant).to_bits()),
                nearest,
                "{constant}"
            );
        }
        assert_eq!(Q29::of(f64::NAN), Q29::ZERO);
        assert_eq!(Q29::of(1e300).to_bits(), i32::MAX);
        assert_eq!(Q29::of(f64::NEG_INFINITY).to_bits(), i32::MIN);
        assert_eq!(Q29::of(-4.0).to_bits(), i32::MIN);
        assert_eq!(Q24::of(4.0).to_bits(), 4 << 24);
        assert_eq!(f64::from(Q24::of(-127.5)), -127.5);
        assert!((f64::from(Q29::PI) - core::f64::consts::PI).abs() < 2e-9);
    }

    #[test]
    fn operations_saturate_where_floats_overflow() {
        let (large, small) = (Q29::of(3.0), Q29::of(0.25));
        assert_eq!(f64::from(large * small), 0.75);
        assert_eq!(f64::from(small - large), -2.75);
        assert_eq!(f64::from(Q29::of(0.75) / large), 0.25);
        for saturated in [
            large + large,
            large * large,
            large / small,
            large / Q29::ZERO,
        ] {
            assert_eq!(saturated.to_bits(), i32::MAX);
        }
        assert_eq!((-large / Q29::ZERO).to_bits(), i32::MIN);
        assert_eq!(Q29::ZERO / Q29::ZERO, Q29::ZERO);
        let lowest = Q29::from_bits(i32::MIN);
        assert_eq!((-lowest).to_bits(), i32::MAX);
        assert_eq!((lowest / -Q29::ONE).to_bits(), i32::MAX);
        assert_eq!((lowest * lowest).to_bits(), i32::MAX);
    }

    #[test]
    fn roots_keep_their_stated_error() {
        let (mut worst, mut checked) = (0.0_f64, 0);
        let steps = (1_u32 << 30..=u32::MAX).step_by(65_521);
        for x in steps.chain([u32::MAX, (1 << 30) + 1]) {
            let exact = 1.0 / libm::sqrt(f64::from(x) / WORD);
            let got = f64::from(reciprocal_root(x)) / 1_073_741_824.0;
            worst = worst.max((got / exact - 1.0).abs());
            checked += 1;
        }
        assert!(worst < 2.1e-9 && checked > 40_000, "{worst:e}");
    }

    #[test]
    fn reciprocals_keep_their_stated_error() {
        let mut worst = 0.0_f64;
        for t in (1_u32 << 30..=1 << 31).step_by(16_381).chain([1 << 31]) {
            let exact = 1_073_741_824.0 / f64::from(t);
            let got = f64::from(reciprocal(t)) / 2_147_483_648.0;
            worst = worst.max((got / exact - 1.0).abs());
        }
        assert!(worst < 1e-9, "{worst:e}");
    }

    #[test]
    fn arc_tangents_keep_their_stated_errors() {
        let (mut worst_5, mut worst_8) = (0.0_f64, 0.0_f64);
        for q in (0..=u32::MAX).step_by(65_521).chain([1, u32::MAX]) {
            let root = libm::sqrt(f64::from(q) / WORD);
            let exact = if q == 0 { 1.0 } else { libm::atan(root) / root };
            let of = |word: u32| (f64::from(word) / WORD / exact - 1.0).abs();
            worst_5 = worst_5.max(of(scaled_arctangent_word::<5>(q)));
            worst_8 = worst_8.max(of(scaled_arctangent_word::<8>(q)));
        }
        assert!(
            worst_5 < 4.5e-6 && worst_8 < 1.7e-8,
            "{worst_5:e} {worst_8:e}"
        );
    }
}
