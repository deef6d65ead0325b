//! The arithmetic everything else is written in.
//!
//! [`Number`] is what the formulas need of a number: four operations, an
//! order, a few constants. It is implemented for `f32`, the number of the
//! device, and for `f64`, with which the host separates rounding from the
//! error of a formula. The square root comes from outside ([`Root`]), because
//! the fastest correct one differs between parts: libm's is software on thumb
//! targets, and a firmware may supply the FPU's instruction. Both are
//! correctly rounded, so the bits are the same.

mod arctangent;
#[cfg(feature = "fixed")]
#[cfg_attr(docsrs, doc(cfg(feature = "fixed")))]
pub mod fixed_point;

pub use arctangent::{residual_arctangent, turn_over_sine};

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A number the kernel can compute with.
///
/// All operations round to nearest, ties to even, and none fuses two of them;
/// so equal inputs give equal bits on every target as long as no NaN occurs.
pub trait Number:
    Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// π, rounded to nearest.
    const PI: Self;

    /// The nearest number to a constant of a formula.
    fn of(constant: f64) -> Self;

    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;

    /// |x|. Exact.
    #[inline]
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }
}

impl Number for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const PI: Self = core::f32::consts::PI;

    #[inline(always)]
    fn of(constant: f64) -> Self {
        constant as Self
    }

    #[inline]
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f32::abs(self)
    }
}

impl Number for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const PI: Self = core::f64::consts::PI;

    #[inline(always)]
    fn of(constant: f64) -> Self {
        constant
    }

    #[inline]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
}

/// A floating-point number: its products can be taken exactly in two parts.
pub trait Floating: Number {
    /// 2^⌈p/2⌉ + 1 for a significand of p bits: times this, a number splits into
    /// two halves whose products are exact (Veltkamp 1968).
    const SPLITTER: Self;
}

impl Floating for f32 {
    const SPLITTER: Self = 4097.0;
}

impl Floating for f64 {
    const SPLITTER: Self = 134_217_729.0;
}

/// a b − c d to within two roundings of the result, however much of it cancels.
///
/// Both products are taken exactly, as a sum of two numbers (Dekker 1971), for
/// magnitudes between 2⁻⁵⁰ and 2⁵⁰ in `f32`. 40 operations, none of them fused:
/// the device has no fused operation that is not emulated. Never panics.
///
/// By itself: what needs it is rare, and takes it three times.
#[cfg_attr(feature = "small", inline(never))]
#[cfg_attr(not(feature = "small"), inline)]
pub fn difference_of_products<N: Floating>(a: N, b: N, c: N, d: N) -> N {
    let ((ab, ab_rest), (cd, cd_rest)) = (exact_product(a, b), exact_product(c, d));
    (ab - cd) + (ab_rest - cd_rest)
}

/// The rounded product and what rounding took from it.
#[inline]
fn exact_product<N: Floating>(a: N, b: N) -> (N, N) {
    let halves = |x: N| {
        let scaled = x * N::SPLITTER;
        let high = scaled - (scaled - x);
        (high, x - high)
    };
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    let product = a * b;
    let rest = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (product, rest)
}

/// A source of square roots.
pub trait Root<N> {
    /// √x, correctly rounded, for x ≥ 0. What it gives for negative x is not
    /// used by the kernel. Never panics.
    fn sqrt(x: N) -> N;
}

/// libm's square root: correct everywhere, software on thumb targets
/// (56 instructions against one of an FPU).
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SoftRoot;

impl Root<f32> for SoftRoot {
    #[inline]
    fn sqrt(x: f32) -> f32 {
        libm::sqrtf(x)
    }
}

impl Root<f64> for SoftRoot {
    #[inline]
    fn sqrt(x: f64) -> f64 {
        libm::sqrt(x)
    }
}

/// libm's arc cosine, for the rung that follows the paper to the letter.
pub trait ArcCosine: Number {
    /// acos x in radians, −1 ≤ x ≤ 1; error at most 1 ulp. Never panics.
    fn acos(self) -> Self;
}

impl ArcCosine for f32 {
    #[inline]
    fn acos(self) -> Self {
        libm::acosf(self)
    }
}

impl ArcCosine for f64 {
    #[inline]
    fn acos(self) -> Self {
        libm::acos(self)
    }
}
