//! Arc tangents without a library call: polynomials, in variables chosen so that
//! few powers do.
//!
//! Minimax fits of the relative error (Remez exchange), ascending powers. The
//! errors beside them are those of the polynomial in exact arithmetic; the tests
//! of this file measure them again.
//!
//! # Why this variable
//!
//! Snell's quotient 3 sin γ/(2 + cos γ) (1621) is γ to within γ⁵/180. What is
//! left, written in z = (1 − y)/(1 + y/2) with y = cos γ, is
//!
//! ```text
//! s(z) = (1 + y/2) γ/sin γ = 3/2 + 3/40 z² − 3/280 z³ + …
//! ```
//!
//! γ/sin γ has its only branch cut at y ≤ −1. A map of y to z of the form
//! (1 − y)/(1 + μ y) moves the cut's ends to 2/(1 − μ) and −1/μ, and a
//! polynomial of degree n errs by ρ⁻ⁿ on 0 ≤ z ≤ 1, ρ + 1/ρ being twice
//! the distance of the nearer end from z = 1/2, in half intervals. μ = 1 is
//! the half angle's squared tangent, ρ = 5.8; μ = √2 − 1 puts both ends at the
//! same distance, ρ = 11.6. Near that, μ = 1/2 is exact in every number, gives
//! ρ = 9.9, and makes the linear term vanish, so that one term less is summed and
//! rounding z does no harm where γ is small.

use super::Number;

/// (s(z) − 3/2)/z² on 0 ≤ z ≤ 1: s to a relative error of 6.8e-5.
const SNELL_3: [f64; 2] = [0.07164261411, -0.000953092481];

/// The same to 3.0e-7.
const SNELL_5: [f64; 4] = [
    0.07491954063,
    -0.01010329962,
    0.006388837095,
    -0.0004092153952,
];

/// The same to 1.04e-8.
const SNELL_6: [f64; 5] = [
    0.07499399573,
    -0.01064592311,
    0.007744423286,
    -0.001818206419,
    0.0005220535964,
];

/// The same to 9.4e-11.
const SNELL_8: [f64; 7] = [
    0.07499986229,
    -0.01071171837,
    0.00801725818,
    -0.002366095168,
    0.001090585426,
    -0.0002897964079,
    0.00005623098617,
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

/// s(z) = (1 + y/2) γ/sin γ for z = (1 − y)/(1 + y/2), y = cos γ, 0 ≤ γ ≤ 90°
/// (0 ≤ z ≤ 1), by a polynomial of degree 3, 5, 6 or 8; other degrees do not
/// compile.
///
/// Of two vectors with d = a·b ≥ 0 and r = |a||b|, z = (r − d)/(r + d/2), and
/// γ/|a×b| = s(z)/(r + d/2): an edge's angle over its sine with one division.
///
/// Relative error 6.8e-5, 3.0e-7, 1.04e-8 and 9.4e-11 (fit), none at z = 0, and
/// at most 1 ulp of rounding. `DEGREE` multiplications, one addition less.
/// Outside of its domain the value is meaningless but finite for |z| < 1e4
/// (`f32`). Never panics.
#[inline(always)]
pub fn angle_over_sine<const DEGREE: usize, N: Number>(z: N) -> N {
    const {
        assert!(
            matches!(DEGREE, 3 | 5 | 6 | 8),
            "there are fits of degree 3, 5, 6 and 8"
        );
    }
    let above_square = match DEGREE {
        3 => horner(&SNELL_3, z),
        5 => horner(&SNELL_5, z),
        6 => horner(&SNELL_6, z),
        _ => horner(&SNELL_8, z),
    };
    z * z * above_square + N::of(1.5)
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

#[inline(always)]
fn horner<N: Number, const TERMS: usize>(ascending: &[f64; TERMS], x: N) -> N {
    let [lower @ .., highest] = ascending.as_slice() else {
        return N::ZERO;
    };
    let mut sum = N::of(*highest);
    for &coefficient in lower.iter().rev() {
        sum = sum * x + N::of(coefficient);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (1 + y/2) γ/sin γ by libm, by its series near 0.
    fn exact_snell(z: f64) -> f64 {
        if z < 1e-6 {
            return 1.5 + 0.075 * z * z;
        }
        let y = (1.0 - z) / (1.0 + 0.5 * z);
        // From the half angle's tangent: 1 − y has all of its digits.
        let tangent = libm::sqrt((1.5 * z / (1.0 + 0.5 * z)) / (1.0 + y));
        let sine = 2.0 * tangent / (1.0 + tangent * tangent);
        (1.0 + 0.5 * y) * 2.0 * libm::atan(tangent) / sine
    }

    /// The largest relative error of a fit of s.
    fn worst<const DEGREE: usize>() -> f64 {
        let errors = (0..=100_000_u32).map(|step| {
            let z = f64::from(step) / 1e5;
            (angle_over_sine::<DEGREE, f64>(z) / exact_snell(z) - 1.0).abs()
        });
        errors.fold(0.0, f64::max)
    }

    #[test]
    fn fits_keep_their_stated_errors() {
        for (worst, stated) in [
            (worst::<3>(), 6.81e-5),
            (worst::<5>(), 2.96e-7),
            (worst::<6>(), 1.05e-8),
            (worst::<8>(), 9.4e-11),
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
        assert_eq!(angle_over_sine::<3, f32>(0.0), 1.5);
        assert_eq!(angle_over_sine::<8, f64>(0.0), 1.5);
        // At 90° s is π/2.
        let quarter = angle_over_sine::<8, f64>(1.0);
        assert!((quarter - core::f64::consts::FRAC_PI_2).abs() < 2e-10);
    }

    #[test]
    fn single_precision_adds_at_most_an_ulp() {
        for step in 0..=10_000_u16 {
            let z = f32::from(step) / 1e4;
            let value = angle_over_sine::<6, f32>(z);
            let error = f64::from(value) / exact_snell(f64::from(z)) - 1.0;
            assert!(
                error.abs() < 1.04e-8 + f64::from(f32::EPSILON),
                "{z} {error:e}"
            );
        }
    }
}
