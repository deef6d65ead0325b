//! Arc tangents without a library call: polynomials in the squared tangent.
//!
//! Minimax fits of the relative error on [0, 1] (Remez exchange), ascending
//! powers. The errors beside them are those of the polynomial in exact
//! arithmetic; the tests of this file measure them again.

use super::Number;

/// h(q) = atan(√q)/√q on 0 ≤ q ≤ 1, relative error 2.1e-4.
const SCALED_3: [f64; 4] = [0.9997878485, -0.3258084642, 0.1555787833, -0.04432662757];

/// h(q), relative error 4.4e-6.
pub(super) const SCALED_5: [f64; 6] = [
    0.9999956297,
    -0.3329946013,
    0.1956359517,
    -0.1212391229,
    0.05747735311,
    -0.01348047933,
];

/// h(q), relative error 1.5e-8.
pub(super) const SCALED_8: [f64; 9] = [
    0.9999999848,
    -0.3333307335,
    0.1999261945,
    -0.1420364493,
    0.1064093576,
    -0.07504298228,
    0.04269156382,
    -0.01606865739,
    0.002849897048,
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

/// h(q) = atan(√q)/√q for 0 ≤ q ≤ 1, by a polynomial of degree 3, 5 or 8;
/// other degrees do not compile.
///
/// With q = tan²(θ/2) it turns the half-angle tangent of an edge into its
/// angle, θ = 2 √q h(q), without a root and without a branch, for θ ≤ 90°.
///
/// Relative error 2.1e-4, 4.4e-6 and 1.5e-8 (fit) and at most 2 ulp of rounding.
/// `DEGREE` multiplications and additions. Outside of its domain the value is
/// meaningless but finite for |q| < 1e4 (`f32`). Never panics.
#[inline(always)]
pub fn scaled_arctangent<const DEGREE: usize, N: Number>(q: N) -> N {
    const {
        assert!(
            matches!(DEGREE, 3 | 5 | 8),
            "there are fits of degree 3, 5 and 8"
        );
    }
    match DEGREE {
        3 => horner(&SCALED_3, q),
        5 => horner(&SCALED_5, q),
        _ => horner(&SCALED_8, q),
    }
}

/// k(w) = (1 − h(w))/w for 0 ≤ w ≤ 1: what is left of
/// [`scaled_arctangent`] when its leading 1 is taken away, to full relative
/// precision at w → 0, where k → 1/3.
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

    /// atan(√q)/√q by libm, by its series near 0.
    fn exact_scaled(q: f64) -> f64 {
        if q < 1e-6 {
            1.0 - q / 3.0 + q * q / 5.0
        } else {
            let root = libm::sqrt(q);
            libm::atan(root) / root
        }
    }

    /// The largest relative error of a fit of h.
    fn worst<const DEGREE: usize>() -> f64 {
        let errors = (0..=100_000_u32).map(|step| {
            let q = f64::from(step) / 1e5;
            (scaled_arctangent::<DEGREE, f64>(q) / exact_scaled(q) - 1.0).abs()
        });
        errors.fold(0.0, f64::max)
    }

    #[test]
    fn fits_keep_their_stated_errors() {
        for (worst, stated) in [
            (worst::<3>(), 2.13e-4),
            (worst::<5>(), 4.4e-6),
            (worst::<8>(), 1.6e-8),
        ] {
            assert!(worst < stated, "{worst:e} {stated:e}");
        }
        let mut residual = 0.0_f64;
        for step in 0..=100_000_u32 {
            let q = f64::from(step) / 1e5;
            // (1 − h)/q loses digits near 0: there its series is exact enough.
            let k = if q < 1e-2 {
                1.0 / 3.0 - q / 5.0 + q * q / 7.0 - q * q * q / 9.0 + q * q * q * q / 11.0
            } else {
                (1.0 - exact_scaled(q)) / q
            };
            residual = residual.max((residual_arctangent(q) / k - 1.0).abs());
        }
        assert!(residual < 2.9e-7, "{residual:e}");
    }

    #[test]
    fn single_precision_adds_at_most_two_ulp() {
        for step in 0..=10_000_u16 {
            let q = f32::from(step) / 1e4;
            let value = scaled_arctangent::<8, f32>(q);
            let error = f64::from(value) / exact_scaled(f64::from(q)) - 1.0;
            assert!(
                error.abs() < 1.5e-8 + 2.0 * f64::from(f32::EPSILON),
                "{q} {error:e}"
            );
        }
    }
}
