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
use super::arctangent::{SNELL_4, SNELL_6};
use core::ops::{Add, Div, Mul, Neg, Sub};
use fixed::types::{I3F29, I8F24};

/// A 32-bit fixed-point number format that form factors can be computed in.
pub trait Format: Number + Eq {
    /// Bits after the binary point.
    const FRACTION: u32;
    /// Degree of the angle's polynomial that suits them: 4 or 6.
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
    Q29, I3F29, 29, 6
}

saturating! {
    /// −128 ≤ x < 128 in steps of 2^−24 = 6.0e-8; saturates.
    Q24, I8F24, 24, 4
}

/// The upper word of a product: the product of two fractions of 32 bits.
#[inline(always)]
pub(crate) fn upper(a: u32, b: u32) -> u32 {
    (u64::from(a).wrapping_mul(u64::from(b)) >> 32) as u32
}

/// |c| of every coefficient of s(x)/4 as a polynomial of 2x, rounded to nearest in
/// units of 2^−32, at compile time.
const fn quarters<const COUNT: usize>(coefficients: &[f64; COUNT]) -> [u32; COUNT] {
    let mut words = [0; COUNT];
    let (mut index, mut scale) = (0, 1_073_741_824.0);
    while index < COUNT {
        let c = coefficients[index];
        let magnitude = if c < 0.0 { -c } else { c };
        words[index] = (magnitude * scale + 0.5) as u32;
        scale /= 2.0;
        index += 1;
    }
    words
}

/// s(x)/4 from 2x, 0 ≤ x ≤ 1/3, both in units of 2^−32: the function of
/// [`super::turn_over_sine`], in radians, as fractions, by its fits of degree 4 or 6; other
/// degrees do not compile.
///
/// The coefficients alternate in sign and fall, so Horner's partial sums do
/// too: each is a coefficient less a fraction of the one before and never
/// negative, which needs neither a sign nor a shift. Relative error 3.9e-7 and
/// 5.4e-9 (fit) plus 5e-10. `DEGREE` multiplications and subtractions. Never
/// panics.
#[inline(always)]
pub fn quarter_angle_over_sine<const DEGREE: usize>(twice: u32) -> u32 {
    const FIT_4: [u32; 5] = quarters(&SNELL_4);
    const FIT_6: [u32; 7] = quarters(&SNELL_6);
    const {
        assert!(
            matches!(DEGREE, 4 | 6),
            "there are fits of degree 4 and 6 in words"
        );
    }
    match DEGREE {
        4 => alternating(&FIT_4, twice),
        _ => alternating(&FIT_6, twice),
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
    let product = u64::from(t).wrapping_mul(u64::from(seed)); // 2^−47
    // What is missing to 1 is less than a word holds, and 1 a whole number of
    // words: no borrow need be taken.
    let missing = ((product >> 1) as u32).wrapping_neg() as i32; // 2^−46
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
/// with either sign; rounding adds 8e-10. 9 multiplications, no loop, no division. Outside of its
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
    /// 1 + 3/2 (3.72e-5)², the excess of the second step, in units of 2^−31;
    /// less 1 for what rounding down adds to what is missing.
    const ONE: u32 = (1 << 31) + 3;

    let y = alternating(&SEED, x); // 2^−29
    let product = upper(upper(x, y), y); // x y², 2^−26
    let y = upper(y, THREE.wrapping_sub(product) << 4); // 2^−28
    let half = (y << 1) as i32;
    let y = half.saturating_add(half); // 2^−30
    // What is missing to x y² = 1 is small: keep its digits.
    let root = upper(x, (y as u32) << 1); // 2^−31
    let product = u64::from(root).wrapping_mul(u64::from(y as u32)); // 2^−61
    let missing = ONE.wrapping_sub((product >> 30) as u32) as i32; // 2^−31
    let correction = i64::from(missing).wrapping_mul(i64::from(y)); // 2^−62 of twice it
    let correction = correction.wrapping_add(1 << 31) >> 32;
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
    fn angles_keep_their_stated_errors() {
        let (mut worst_4, mut worst_6) = (0.0_f64, 0.0_f64);
        let largest = u32::MAX / 3 * 2;
        for twice in (0..=largest).step_by(65_521).chain([1, largest]) {
            let x = f64::from(twice) / WORD / 2.0;
            let exact = crate::number::turn_over_sine::<8, f64>(x) * core::f64::consts::FRAC_PI_2;
            let of = |word: u32| (f64::from(word) / WORD / exact - 1.0).abs();
            worst_4 = worst_4.max(of(quarter_angle_over_sine::<4>(twice)));
            worst_6 = worst_6.max(of(quarter_angle_over_sine::<6>(twice)));
        }
        for (worst, stated) in [(worst_4, 3.91e-7), (worst_6, 5.9e-9)] {
            assert!(
                worst < stated && worst > 0.9 * stated,
                "{worst:e} {stated:e}"
            );
        }
    }
}
