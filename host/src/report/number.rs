//! Numbers as people read them: three significant digits, no more.

/// A percentage for a table cell, without its sign: three significant digits,
/// an exponent below 0.001, `inf` where there is no bound.
///
/// `percent(4.0267)` is "4.03", `percent(0.02134)` "0.0213", `percent(2.13e-6)`
/// "2.1e-6", `percent(0.0)` "0".
#[must_use]
pub fn percent(value: f64) -> String {
    quantity(value)
}

/// A value with three significant digits; at least all digits before the point,
/// an exponent below 0.001 or from a million on.
#[must_use]
pub fn quantity(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return if value.is_nan() {
            "-"
        } else if value > 0.0 {
            "inf"
        } else {
            "-inf"
        }
        .to_owned();
    }
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    let exponent = rounded.abs().log10().floor();
    if !(-3.0..6.0).contains(&exponent) {
        return format!("{value:.1e}");
    }
    let decimals = (2.0 - exponent).max(0.0) as usize;
    format!("{value:.decimals$}")
}

/// A share of the values in percent with one decimal: "0" is none at all,
/// "<0.1" more than none, ">99.9" less than all.
pub(crate) fn share(value: f64) -> String {
    if value == 0.0 {
        "0".to_owned()
    } else if value < 0.05 {
        "<0.1".to_owned()
    } else if value == 100.0 {
        "100".to_owned()
    } else if value >= 99.95 {
        ">99.9".to_owned()
    } else {
        format!("{value:.1}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_are_kept() {
        for (value, text) in [
            (0.0, "0"),
            (4.0267, "4.03"),
            (0.02134, "0.0213"),
            (2.13e-6, "2.1e-6"),
            (9.996, "10.0"),
            (123.4, "123"),
            (1234.0, "1234"),
            (-1.5, "-1.50"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "-"),
        ] {
            assert_eq!(quantity(value), text);
        }
    }

    #[test]
    fn few_is_not_none_and_most_is_not_all() {
        for (value, text) in [
            (0.0, "0"),
            (0.01, "<0.1"),
            (23.44, "23.4"),
            (99.99, ">99.9"),
            (100.0, "100"),
        ] {
            assert_eq!(share(value), text);
        }
    }
}
