//! Arc tangents without a library call: polynomials, in variables chosen so that
//! few powers do.
//!
//! Minimax fits of the relative error (Remez exchange), ascending powers. The
//! errors beside them are those of the polynomial in exact arithmetic; the tests
//! of this file measure them again.
//!
//! # Why this variable
//!
//! Snell's quotient 3 sin γ/(2 + cos γ) (1621) is γ to within γ⁵/180. What takes
//! the place of its 3, written in x = y/(2 + y) with y = cos γ, is
//!
//! ```text
//! s(x) = (2 + y) γ/sin γ = 3 + 3/20 z² − 3/140 z³ + …,   z = 1 − 3x
//! ```
//!
//! γ/sin γ has its only branch cut at y ≤ −1. A map of y to z of the form
//! (1 − y)/(1 + μ y), or to any linear function of that, moves the cut's ends to
//! 2/(1 − μ) and −1/μ, and a
//! polynomial of degree n errs by ρ⁻ⁿ on 0 ≤ z ≤ 1, ρ + 1/ρ being twice
//! the distance of the nearer end from z = 1/2, in half intervals. μ = 1 is
//! the half angle's squared tangent, ρ = 5.8; μ = √2 − 1 puts both ends at the
//! same distance, ρ = 11.6. Near that, μ = 1/2 is Snell's, exact in every number,
//! gives ρ = 9.9, and makes the linear term vanish where γ is small: there rounding
//! x does no harm, and fits of even degree err by less than ρ⁻ⁿ.

use super::Number;

/// s(x) on 0 ≤ x ≤ 1/3, relative error 4.6e-5.
const SNELL_2: [f64; 3] = [3.14144783544, -0.846399348421, 1.26734633601];

/// The same, 3.9e-7.
pub(super) const SNELL_4: [f64; 5] = [
    3.14159387971,
    -0.858505712085,
    1.42548282574,
    -0.66349471236,
    0.871593836107,
];

/// The same, 5.4e-9.
pub(super) const SNELL_6: [f64; 7] = [
    3.14159267056,
    -0.858411674528,
    1.42495634504,
    -0.678152464042,
    1.03992079002,
    -0.609673122556,
    0.731353092636,
];

/// The same, 5.7e-11.
const SNELL_8: [f64; 9] = [
    3.14159265377,
    -0.858407427128,
    1.42478396364,
    -0.67568859442,
    1.02597686973,
    -0.596828164998,
    0.905493559838,
    -0.657149325347,
    0.704699533329,
];

/// k(w) = (1 − h(w))/w on 0 ≤ w ≤ 1, relative error 2.8e-7.
const RESIDUAL: [f64; 8] = [
    0.3333332397,
    -0.1999876106,
    0.1425826676,
    -0.1087284675,
    0.08029405713,
    -0.04919754547,
    0.02022917255,
    -0.003923737123,
];

/// s(x) = (2 + y) γ/sin γ with γ in turns, for x = y/(2 + y), y = cos γ,
/// 0 ≤ γ ≤ 90° (0 ≤ x ≤ 1/3), by a polynomial of degree 2, 4, 6 or 8; other
/// degrees do not compile.
///
/// Of two vectors with d = a·b ≥ 0 and t = 2|a||b| + d, x = d/t and
/// γ/|a×b| = s(x)/t: an edge's angle over its sine with one division. In turns,
/// because a quarter of one is a number of `f32` and a quarter of π is not.
///
/// Relative error 4.6e-5, 3.9e-7, 5.4e-9 and 5.7e-11 (fit) and at most 1 ulp of
/// rounding. `DEGREE` multiplications and additions.
/// Outside of its domain the value is meaningless but finite for |x| < 1e4
/// (`f32`). Never panics.
#[inline(always)]
pub fn turn_over_sine<const DEGREE: usize, N: Number>(x: N) -> N {
    const {
        assert!(
            matches!(DEGREE, 2 | 4 | 6 | 8),
            "there are fits of degree 2, 4, 6 and 8"
        );
    }
    match DEGREE {
        2 => horner(const { &in_turns(SNELL_2) }, x),
        4 => horner(const { &in_turns(SNELL_4) }, x),
        6 => horner(const { &in_turns(SNELL_6) }, x),
        _ => horner(const { &in_turns(SNELL_8) }, x),
    }
}

/// Coefficients of an angle in turns from those in radians.
const fn in_turns<const TERMS: usize>(radians: [f64; TERMS]) -> [f64; TERMS] {
    let (mut turns, mut index) = (radians, 0);
    while index < TERMS {
        turns[index] *= 0.5 / core::f64::consts::PI;
        index += 1;
    }
    turns
}

/// k(w) = (1 − h(w))/w for 0 ≤ w ≤ 1, h(w) = atan(√w)/√w: what is left of h
/// when its leading 1 is taken away, to full relative precision at w → 0, where
/// k → 1/3.
///
/// Relative error 2.8e-7 (fit) and at most 2 ulp of rounding. 7
/// multiplications, 7 additions. Never panics.
#[inline(always)]
pub fn residual_arctangent<N: Number>(w: N) -> N {
    horner(&RESIDUAL, w)
}

/// A polynomial by Horner's rule, of at most nine terms.
///
/// Written out: as a loop, which it stays where the compiler is to save bytes, it would
/// round every coefficient while it runs, in software.
#[inline(always)]
fn horner<N: Number, const TERMS: usize>(ascending: &[f64; TERMS], x: N) -> N {
    const { assert!(TERMS <= 9) }
    let mut sum = N::ZERO;
    sum = with_term(ascending, x, sum, 8);
    sum = with_term(ascending, x, sum, 7);
    sum = with_term(ascending, x, sum, 6);
    sum = with_term(ascending, x, sum, 5);
    sum = with_term(ascending, x, sum, 4);
    sum = with_term(ascending, x, sum, 3);
    sum = with_term(ascending, x, sum, 2);
    sum = with_term(ascending, x, sum, 1);
    with_term(ascending, x, sum, 0)
}

/// Horner's step to the coefficient of x^`power`; the sum itself above the highest.
#[inline(always)]
fn with_term<N: Number, const TERMS: usize>(
    ascending: &[f64; TERMS],
    x: N,
    sum: N,
    power: usize,
) -> N {
    match ascending.get(power) {
        Some(&highest) if power + 1 == TERMS => N::of(highest),
        Some(&coefficient) => sum * x + N::of(coefficient),
        None => sum,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (2 + y) γ/sin γ in turns by libm, by its series where γ is small.
    fn exact_snell(x: f64) -> f64 {
        let z = 1.0 - 3.0 * x;
        if z < 1e-6 {
            return (3.0 + 0.15 * z * z) / core::f64::consts::TAU;
        }
        let y = 2.0 * x / (1.0 - x);
        // From the half angle's tangent: 1 − y has all of its digits.
        let tangent = libm::sqrt((1.5 * z / (1.0 + 0.5 * z)) / (1.0 + y));
        let sine = 2.0 * tangent / (1.0 + tangent * tangent);
        (2.0 + y) * libm::atan(tangent) / (core::f64::consts::PI * sine)
    }

    /// The largest relative error of a fit of s.
    fn worst<const DEGREE: usize>() -> f64 {
        let errors = (0..=100_000_u32).map(|step| {
            let x = f64::from(step) / 3e5;
            (turn_over_sine::<DEGREE, f64>(x) / exact_snell(x) - 1.0).abs()
        });
        errors.fold(0.0, f64::max)
    }

    #[test]
    fn fits_keep_their_stated_errors() {
        for (worst, stated) in [
            (worst::<2>(), 4.62e-5),
            (worst::<4>(), 3.91e-7),
            (worst::<6>(), 5.41e-9),
            (worst::<8>(), 5.75e-11),
        ] {
            assert!(worst < stated, "{worst:e} {stated:e}");
            assert!(worst > 0.97 * stated, "{worst:e} {stated:e}");
        }
        let mut residual = 0.0_f64;
        for step in 0..=100_000_u32 {
            let w = f64::from(step) / 1e5;
            // (1 − h)/w loses digits near 0: there its series is exact enough.
            let k = if w < 1e-2 {
                1.0 / 3.0 - w / 5.0 + w * w / 7.0 - w * w * w / 9.0 + w * w * w * w / 11.0
            } else {
                (1.0 - libm::atan(libm::sqrt(w)) / libm::sqrt(w)) / w
            };
            residual = residual.max((residual_arctangent(w) / k - 1.0).abs());
        }
        assert!(residual < 2.9e-7, "{residual:e}");
    }

    #[test]
    fn snells_quotient_is_what_is_left_at_small_angles() {
        let small = turn_over_sine::<8, f64>(1.0 / 3.0) * core::f64::consts::TAU;
        assert!((small - 3.0).abs() < 2e-10);
        // At 90° s is half a turn.
        let quarter = turn_over_sine::<8, f64>(0.0);
        assert!((quarter - 0.5).abs() < 1e-10);
    }

    #[test]
    fn single_precision_adds_at_most_an_ulp() {
        for step in 0..=10_000_u16 {
            let x = f32::from(step) / 3e4;
            let value = turn_over_sine::<6, f32>(x);
            let error = f64::from(value) / exact_snell(f64::from(x)) - 1.0;
            assert!(
                error.abs() < 5.4e-9 + f64::from(f32::EPSILON),
                "{x} {error:e}"
            );
        }
    }
}
