//! Fractions that the interface gives and takes as `f32`, by their bits: no
//! floating-point operation.

/// a/b in units of 2⁻³¹, rounded down, saturated below 2; 0 where b is 0.
pub(super) fn ratio(a: u64, b: u64) -> u32 {
    // Below 2^33, so that the shifted dividend fits.
    let larger = if a > b { a } else { b };
    let shift = 31_u32.saturating_sub(larger.leading_zeros());
    let quotient = ((a >> shift) << 31).checked_div(b >> shift);
    let saturated = if a == 0 { 0 } else { u64::from(u32::MAX) };
    let quotient = quotient.unwrap_or(saturated);
    if b == 0 {
        0
    } else if quotient < u64::from(u32::MAX) {
        quotient as u32
    } else {
        u32::MAX
    }
}

/// The `f32` of so many 2⁻³¹, rounded to nearest, ties away from 0.
pub(super) fn single(ratio: u32) -> f32 {
    if ratio == 0 {
        return 0.0;
    }
    let zeros = ratio.leading_zeros();
    let mantissa = ratio.wrapping_shl(zeros); // from 2^31 up
    // The first bit is worth 2^(−zeros), so the biased exponent is 127 − zeros;
    // the mantissa's own first bit adds the one that is left out here, and so
    // does a carry out of the rounding.
    let exponent = 126_u32.wrapping_sub(zeros) << 23;
    let rounded = (mantissa >> 7).wrapping_add(1) >> 1;
    f32::from_bits(exponent.wrapping_add(rounded))
}

/// The largest number of 2⁻³¹ not above a fraction: −1 for a negative one, the
/// largest there is for infinity and NaN.
pub(super) fn threshold(fraction: f32) -> i64 {
    let bits = fraction.to_bits();
    let (exponent, mantissa) = ((bits >> 23) & 0xff, i64::from(bits & 0x007f_ffff));
    if exponent == 0xff && (mantissa != 0 || bits >> 31 == 0) {
        return i64::MAX;
    }
    // Below −0. Asked as `bits << 1 != 0`, the compiler would compare with 0.0.
    if bits > 1 << 31 {
        return -1;
    }
    let mantissa = mantissa | 0x0080_0000;
    // 2^(exponent − 150) each, in units of 2^−31: 2^(exponent − 119).
    match exponent.checked_sub(119) {
        Some(left) if left < 38 => mantissa << left,
        Some(_) => i64::MAX,
        None => mantissa
            .checked_shr(119_u32.wrapping_sub(exponent))
            .unwrap_or(0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: f64 = 2_147_483_648.0;

    #[test]
    fn fractions_are_what_floating_point_says() {
        for numerator in [0, 1, 3, 1000, 1 << 31, (1 << 40) + 12_345, u64::MAX] {
            for denominator in [1, 2, 7, 999_999, 1 << 33, u64::MAX] {
                let exact = numerator as f64 / denominator as f64;
                let got = f64::from(ratio(numerator, denominator)) / UNIT;
                let nearest = if exact < 2.0 { exact } else { 2.0 };
                assert!((got - nearest).abs() <= 2e-9, "{numerator}/{denominator}");
            }
            assert_eq!(ratio(numerator, 0), 0);
        }
    }

    #[test]
    fn singles_are_rounded_to_nearest() {
        for word in (0..u32::MAX).step_by(7919).chain([1, 2, 3, u32::MAX]) {
            let nearest = (f64::from(word) / UNIT) as f32;
            let got = single(word);
            // A tie goes away from 0 here, to even there.
            assert!(got.to_bits().abs_diff(nearest.to_bits()) <= 1, "{word}");
            if word < 1 << 24 {
                assert_eq!(got, nearest);
            }
        }
    }

    #[test]
    fn thresholds_are_rounded_down() {
        for fraction in [
            0.0_f32, 1e-30, 1e-9, 4.7e-10, 1e-3, 0.1, 0.5, 1.0, 1.99, 3.5, 7e8,
        ] {
            let exact = libm::floor(f64::from(fraction) * UNIT);
            assert_eq!(threshold(fraction) as f64, exact, "{fraction}");
        }
        assert_eq!(threshold(-0.0), 0);
        for below in [-1e-40, -1.0, f32::NEG_INFINITY] {
            assert_eq!(threshold(below), -1);
        }
        for endless in [f32::INFINITY, f32::NAN, 1e30] {
            assert_eq!(threshold(endless), i64::MAX);
        }
    }
}
