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

/// Three quarters of a share of a fraction in 2⁻³¹ of all, where so many share.
pub(super) fn of_all(all: u64, fraction: i64, shares: usize) -> u64 {
    let shift = 32_u32.saturating_sub(all.leading_zeros());
    let fraction = fraction.clamp(0, i64::from(u32::MAX)) as u64;
    let product = (all >> (shift & 63)).wrapping_mul(fraction) / 4 * 3;
    let share = product.checked_div(shares as u64).unwrap_or(0);
    match shift.checked_sub(31) {
        Some(up) => share.checked_shl(up).unwrap_or(u64::MAX),
        None => share >> (31_u32.wrapping_sub(shift) & 63),
    }
}

/// π and 1/π in units of 2⁻³⁰ and 2⁻³².
const PI: u64 = 3_373_259_426;
const PER_PI: u64 = 1_367_130_551;

/// π times a radiance in units of 2^`unit`, rounded to nearest; `None` where that is
/// below 0, NaN or more than a word.
pub(super) fn exitance(radiance: f32, unit: i32) -> Option<u32> {
    let bits = radiance.to_bits();
    let (exponent, mantissa) = ((bits >> 23) & 0xff, u64::from(bits & 0x007f_ffff));
    // Below −0. Asked as `bits << 1 == 0`, the compiler would compare with 0.0.
    if bits > 1 << 31 || exponent == 0xff {
        return None;
    }
    let (mantissa, exponent) = match exponent {
        0 => (mantissa, 1),
        _ => (mantissa | 0x0080_0000, exponent as i32),
    };
    // 56 bits, of 2^(exponent − 150 − 30) each.
    let product = mantissa.wrapping_mul(PI);
    let down = unit.saturating_add(180).saturating_sub(exponent);
    match u32::try_from(down) {
        Ok(down) if down > 62 => Some(0),
        Ok(down) if down > 0 => {
            let rounded = (product >> (down.wrapping_sub(1) & 63)).wrapping_add(1) >> 1;
            u32::try_from(rounded).ok()
        }
        // Of 32 bits and more.
        _ => u32::try_from(product)
            .ok()
            .filter(|&word| down == 0 || word == 0),
    }
}

/// 1/π times so many 2^`unit` as `f32`, rounded to nearest; where it is beyond what
/// `f32` holds without losing digits, 0 or the largest there is.
pub(super) fn radiance(exitance: u32, unit: i32) -> f32 {
    if exitance == 0 {
        return 0.0;
    }
    let product = u64::from(exitance).wrapping_mul(PER_PI);
    let zeros = product.leading_zeros();
    let mantissa = product.wrapping_shl(zeros) >> 39; // 25 bits
    // The first bit is worth 2^(63 − zeros) of 2^(unit − 32).
    let exponent = unit.saturating_add(31 + 126).saturating_sub(zeros as i32);
    match exponent {
        // Less 1: the mantissa's own first bit adds it, and so does a carry.
        0..=252 => f32::from_bits(
            ((exponent as u32) << 23).wrapping_add((mantissa as u32).wrapping_add(1) >> 1),
        ),
        ..0 => 0.0,
        253.. => f32::MAX,
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

    #[test]
    fn radiances_are_read_and_given() {
        for unit in [-60, -31, -20, 0, 17] {
            let one = 2.0_f64.powi(unit);
            for times in [1.0, 3.3, 1e3, 123_456.7, 6.1e8] {
                let radiance = (times * one / core::f64::consts::PI) as f32;
                let exact = f64::from(radiance) * core::f64::consts::PI / one;
                // No word at all is as wrong as darkness: the exitance is 1 or more.
                let word = exitance(radiance, unit).unwrap_or_default();
                assert!(
                    (f64::from(word) - exact).abs() <= 0.5 + 1e-9 * exact,
                    "{times}"
                );
                let back = super::radiance(word, unit);
                let exact = f64::from(word) * one / core::f64::consts::PI;
                assert!(
                    (f64::from(back) / exact - 1.0).abs() < 6.1e-8,
                    "{back} {exact}"
                );
            }
            for none in [-1.0, -1e-40, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                assert_eq!(exitance(none, unit), None);
            }
            assert_eq!(exitance(-0.0, unit), Some(0));
            assert_eq!(exitance(f32::from_bits(1), unit), Some(0));
            assert_eq!(exitance(1e30, unit), None);
        }
        assert_eq!(super::radiance(0, 0), 0.0);
        assert_eq!(super::radiance(1, -200), 0.0);
        assert_eq!(super::radiance(1, 200), f32::MAX);
    }

    #[test]
    fn shares_are_what_floating_point_says() {
        for all in [0, 1, 77, 1 << 31, (1 << 40) + 12_345, u64::MAX >> 1] {
            for fraction in [0, 1, 1073, 2_147_484, 1 << 31] {
                for shares in [1, 7, 100] {
                    let exact = all as f64 * fraction as f64 / UNIT * 0.75 / shares as f64;
                    let got = of_all(all, fraction, shares) as f64;
                    assert!((got - exact).abs() <= 1.0 + 1e-6 * exact, "{got} {exact}");
                }
            }
        }
        assert_eq!(of_all(5, -1, 3), 0);
        assert_eq!(of_all(5, 5, 0), 0);
    }
}
