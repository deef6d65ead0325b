//! From numbers to colours, and the round numbers written beside them.

use super::canvas::Rgb;

/// A field that spans more than this is shown on a logarithmic scale.
const LOGARITHMIC_FROM: f64 = 8.0;
/// A logarithmic scale ends this far below its top; darker is drawn as dark.
const DEPTH: f64 = 1e-3;
/// No more levels than can be told apart.
const MAX_LEVELS: usize = 10;

/// The scale of an amount.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Amounts {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) logarithmic: bool,
    /// Whether something darker than `low` is drawn in its colour.
    pub(super) cut: bool,
    /// Round numbers between low and high, rising.
    pub(super) levels: Vec<f64>,
}

impl Amounts {
    /// The scale that fits `values`; those not finite are left out of account.
    pub(super) fn fit(values: impl Iterator<Item = f64>) -> Self {
        let mut low = f64::INFINITY;
        let mut high = f64::NEG_INFINITY;
        for value in values.filter(|value| value.is_finite()) {
            low = low.min(value);
            high = high.max(value);
        }
        if high <= 0.0 || low > high {
            return Self::linear(0.0, 1.0, Vec::new());
        }
        let low = low.max(0.0);
        if high > LOGARITHMIC_FROM * low {
            let cut = low < DEPTH * high;
            let low = low.max(DEPTH * high);
            return Self {
                low,
                high,
                logarithmic: true,
                cut,
                levels: logarithmic_levels(low, high),
            };
        }
        // An even field has no contours but needs a scale that has a width.
        if high - low < 1e-3 * high {
            return Self::linear(0.0, high, Vec::new());
        }
        Self::linear(low, high, linear_levels(low, high, 7))
    }

    fn linear(low: f64, high: f64, levels: Vec<f64>) -> Self {
        Self {
            low,
            high,
            logarithmic: false,
            cut: false,
            levels,
        }
    }

    /// Where `value` lies between low (0) and high (1), clamped.
    pub(super) fn place(&self, value: f64) -> f64 {
        let place = if self.logarithmic {
            (value.max(self.low) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        if place.is_nan() {
            0.0
        } else {
            place.clamp(0.0, 1.0)
        }
    }

    /// The colour of `value`: viridis.
    pub(super) fn colour(&self, value: f64) -> Rgb {
        viridis(self.place(value))
    }
}

/// Viridis from 0 (dark blue) to 1 (yellow).
pub(super) fn viridis(place: f64) -> Rgb {
    colorous::VIRIDIS.eval_continuous(place).as_array()
}

/// The scale of a signed error in percent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SignedErrors {
    /// The scale runs from minus to plus this.
    pub(super) limit: f64,
    /// Whether some errors lie beyond.
    pub(super) exceeded: bool,
}

impl SignedErrors {
    /// A limit of 1, 2 or 5 times a power of ten that 98 % of the errors keep.
    pub(super) fn fit(errors: impl Iterator<Item = f64>) -> Self {
        let mut sizes: Vec<f64> = errors.map(f64::abs).collect();
        if sizes.is_empty() {
            return Self {
                limit: 1.0,
                exceeded: false,
            };
        }
        sizes.sort_by(f64::total_cmp);
        let most = sizes[(0.98 * (sizes.len() - 1) as f64).round() as usize];
        // Where nearly all is right any scale will do.
        let limit = if most > 0.0 {
            round_up(most.clamp(1e-5, 1e3))
        } else {
            1.0
        };
        Self {
            limit,
            exceeded: sizes.last().is_some_and(|size| *size > limit),
        }
    }

    /// The colour of `error` within the limit: purple too dark, white right,
    /// orange too bright.
    pub(super) fn colour(&self, error: f64) -> Rgb {
        let place = 0.5 - 0.5 * (error / self.limit).clamp(-1.0, 1.0);
        // ColorBrewer's PuOr runs from orange to purple.
        colorous::PURPLE_ORANGE
            .eval_continuous(if place.is_nan() { 0.0 } else { 1.0 - place })
            .as_array()
    }
}

/// The least of 1, 2, 5 times a power of ten that is not below `value` > 0.
fn round_up(value: f64) -> f64 {
    let decade = 10.0_f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|step| step * decade)
        .find(|rounded| *rounded >= value * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

/// Multiples of a round step strictly between low and high, about `count`.
pub(super) fn linear_levels(low: f64, high: f64, count: usize) -> Vec<f64> {
    let step = round_up((high - low) / (count + 1) as f64);
    let first = (low / step).floor() as i64;
    let last = (high / step).ceil() as i64;
    // The margin keeps a level off the very edge, where it would be noise.
    let margin = 1e-6 * (high - low);
    (first..=last)
        .map(|k| k as f64 * step)
        .filter(|level| *level > low + margin && *level < high - margin)
        .collect()
}

/// Round numbers strictly between low and high > low > 0, spread evenly over
/// the decades: the densest of some series that has at most [`MAX_LEVELS`].
fn logarithmic_levels(low: f64, high: f64) -> Vec<f64> {
    const SERIES: [&[f64]; 4] = [
        &[1.0, 1.5, 2.0, 3.0, 5.0, 7.0],
        &[1.0, 2.0, 5.0],
        &[1.0, 3.0],
        &[1.0],
    ];
    let mut levels = Vec::new();
    for series in SERIES {
        let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
        levels = decades
            .flat_map(|decade| series.iter().map(move |step| scaled(*step, decade)))
            .filter(|level| *level > low * 1.001 && *level < high * 0.999)
            .collect();
        if levels.len() <= MAX_LEVELS {
            break;
        }
    }
    levels
}

/// step · 10^decade, exact where it can be (0.1 · 3 is not 0.3).
fn scaled(step: f64, decade: i32) -> f64 {
    if decade < 0 {
        step / 10.0_f64.powi(-decade)
    } else {
        step * 10.0_f64.powi(decade)
    }
}

/// A round number without needless digits: "0.2", "1.5", "50", "2e-5".
pub(super) fn label(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&value.abs()) {
        return format!("{:e}", rounded(value));
    }
    format!("{}", rounded(value))
}

/// Six significant digits: multiples of a step carry noise in their last ones,
/// and the narrowest scale needs five.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_wide_range_is_logarithmic_with_round_levels() {
        let scale = Amounts::fit([0.3, 30.0].into_iter());
        assert!(scale.logarithmic && !scale.cut);
        assert_eq!(scale.levels, [0.5, 1.0, 2.0, 5.0, 10.0, 20.0]);
        assert!((scale.place(3.0) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_narrow_range_is_linear_with_round_levels() {
        let scale = Amounts::fit([310.0, 520.0].into_iter());
        assert!(!scale.logarithmic);
        assert_eq!(scale.levels, [350.0, 400.0, 450.0, 500.0]);
    }

    #[test]
    fn darkness_evenness_and_nonsense_have_a_scale() {
        for values in [
            vec![],
            vec![0.0; 3],
            vec![2.0; 3],
            vec![f64::NAN, f64::INFINITY],
        ] {
            let scale = Amounts::fit(values.into_iter());
            assert!(scale.high > scale.low && scale.levels.is_empty());
            assert!(scale.place(f64::NAN).is_finite());
        }
        assert!(Amounts::fit([0.0, 1.0].into_iter()).cut);
    }

    #[test]
    fn too_dark_is_purple_right_is_pale_too_bright_is_orange() {
        let scale = SignedErrors {
            limit: 5.0,
            exceeded: false,
        };
        let [low, right, high] = [-5.0, 0.0, 5.0].map(|error| scale.colour(error));
        assert!(low[2] > low[0], "{low:?}");
        assert!(right.iter().all(|channel| *channel > 230), "{right:?}");
        assert!(high[0] > high[2], "{high:?}");
    }

    #[test]
    fn labels_carry_no_needless_digits() {
        for (value, text) in [
            (0.0, "0"),
            (0.1 * 3.0, "0.3"),
            (150.0, "150"),
            (-0.2, "-0.2"),
            (2e-5, "2e-5"),
        ] {
            assert_eq!(label(value), text);
        }
    }

    proptest! {
        #[test]
        fn levels_rise_within_the_scale(low in 0.0..1e4_f64, factor in 1.001..1e6_f64) {
            let scale = Amounts::fit([low, low * factor + 1e-3].into_iter());
            prop_assert!(scale.levels.windows(2).all(|pair| pair[0] < pair[1]));
            prop_assert!(scale.levels.iter().all(|level| *level > scale.low && *level < scale.high));
            prop_assert!(scale.levels.len() <= MAX_LEVELS + 5, "{:?}", scale.levels);
            prop_assert!(!scale.levels.is_empty());
        }

        #[test]
        fn nearly_all_errors_keep_the_limit(errors in prop::collection::vec(-500.0..500.0_f64, 1..200)) {
            let scale = SignedErrors::fit(errors.iter().copied());
            let beyond = errors.iter().filter(|error| error.abs() > scale.limit).count();
            prop_assert!(beyond as f64 <= 0.02 * errors.len() as f64 + 1.0);
            prop_assert_eq!(beyond > 0, scale.exceeded);
        }
    }
}
