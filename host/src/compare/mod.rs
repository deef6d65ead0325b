//! How far an approximation is from its reference, in the two metrics that
//! are always published together.
//!
//! With approximation a, reference r and full scale f (the largest reference
//! value of the surface), one value's errors in percent are
//!
//! ```text
//! relative   = 100 |a - r| / r      counted where r >= 1e-3 f
//! full scale = 100 |a - r| / f      counted everywhere
//! ```
//!
//! Drettakis & Fiume (1992) leave open which of the two their percentages
//! mean; a relative error blames the dark places, a full-scale error forgives
//! them, so neither is shown alone. Where there is colour, a and r are means of
//! the three channels.

mod balance;
mod camera;
mod regions;
mod surface;

pub use balance::{Balance, balance};
pub use camera::{Evaluated, Seen, camera, effort};
pub use regions::{Regions, Tagged};
pub use surface::{Compared, surface};

use crate::baseline::Baseline;
use crate::plan::Plan;
use crate::reference::Reference;
use crate::scene::Scene;
use crate::solve::Solution;
use glam::DVec3;
use serde::ser::{Serialize, SerializeMap, Serializer};

/// The three answers that are compared: the reference, the kernel's, and where
/// it could be had the classical one.
#[derive(Clone, Copy)]
pub struct Answers<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Where its samples are.
    pub plan: &'a Plan,
    /// The judge.
    pub reference: &'a Reference,
    /// The kernel's solution, resampled.
    pub solution: &'a Solution<'a>,
    /// Ray-traced form factors.
    pub baseline: Option<&'a Baseline>,
}

/// The mean of the channels: what errors are judged by where there is colour.
#[must_use]
pub fn mean([r, g, b]: [f64; 3]) -> f64 {
    if r == g && g == b {
        r
    } else {
        (r + g + b) / 3.0
    }
}

/// Places asked for between two reports of progress.
const BATCH: usize = 1024;

/// The reference at many places with their normals; `done` is told how many
/// more have been answered.
fn exact(
    reference: &Reference,
    places: &[(DVec3, DVec3)],
    done: &mut dyn FnMut(usize),
) -> Vec<[f64; 3]> {
    let mut values = Vec::with_capacity(places.len());
    for batch in places.chunks(BATCH) {
        values.extend(reference.light_at(batch));
        done(batch.len());
    }
    values
}

/// The tolerances, in percent, whose exceedance is counted in [`Statistics::over`].
pub const TOLERANCES: [f64; 5] = [1.0, 2.0, 5.0, 10.0, 15.0];

/// Below this fraction of full scale the relative error says nothing about
/// the picture and is not counted.
pub const NEGLIGIBLE: f64 = 1e-3;

/// What is said of one metric's errors; every number is in percent.
///
/// Of no values at all every number is 0. A value that is not finite counts as
/// an infinite error, so `max`, `rms` and perhaps `p95` are then infinite, never
/// NaN; JSON knows no infinity and shows `null`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// The largest error.
    pub max: f64,
    /// Root of the mean square error.
    pub rms: f64,
    /// The error that 95 % of the values do not exceed (nearest rank).
    pub p95: f64,
    /// How many percent of the counted values err by more than each of [`TOLERANCES`].
    pub over: [f64; 5],
}

/// Both metrics over the same values.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Errors {
    /// |a - r| / r where r is at least [`NEGLIGIBLE`] of full scale.
    pub relative: Statistics,
    /// |a - r| / full scale.
    pub full_scale: Statistics,
}

impl Serialize for Statistics {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        struct Over([f64; 5]);
        impl Serialize for Over {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                let mut map = serializer.serialize_map(Some(TOLERANCES.len()))?;
                for (tolerance, share) in TOLERANCES.iter().zip(self.0) {
                    map.serialize_entry(&format!("{tolerance}"), &share)?;
                }
                map.end()
            }
        }
        let mut map = serializer.serialize_map(Some(4))?;
        map.serialize_entry("max", &self.max)?;
        map.serialize_entry("rms", &self.rms)?;
        map.serialize_entry("p95", &self.p95)?;
        map.serialize_entry("over", &Over(self.over))?;
        map.end()
    }
}

/// The relative error in percent, with its sign (positive: the approximation
/// is too bright); `None` where it is not counted.
#[must_use]
pub fn relative_error(approximate: f64, reference: f64, full_scale: f64) -> Option<f64> {
    if full_scale > 0.0 && reference >= NEGLIGIBLE * full_scale {
        let error = 100.0 * (approximate - reference) / reference;
        Some(if error.is_nan() { f64::INFINITY } else { error })
    } else {
        None
    }
}

/// The full-scale error in percent, with its sign.
///
/// A surface that the reference leaves dark has no scale: there an approximation
/// that is dark too is right (0), and any other is wholly wrong (100).
#[must_use]
pub fn full_scale_error(approximate: f64, reference: f64, full_scale: f64) -> f64 {
    let difference = approximate - reference;
    if !difference.is_finite() {
        return f64::INFINITY;
    }
    if full_scale > 0.0 {
        100.0 * difference / full_scale
    } else if difference == 0.0 {
        0.0
    } else {
        100.0_f64.copysign(difference)
    }
}

/// The errors of pairs (approximate, reference) on one surface, whose largest
/// reference value is `full_scale`.
#[must_use]
pub fn errors(values: impl Iterator<Item = (f64, f64)>, full_scale: f64) -> Errors {
    errors_by_scale(values.map(|(approximate, reference)| (approximate, reference, full_scale)))
}

/// The errors of triples (approximate, reference, full scale): the pixels of a
/// camera, each with the full scale of the surface it shows.
#[must_use]
pub fn errors_by_scale(values: impl Iterator<Item = (f64, f64, f64)>) -> Errors {
    let mut relative = Vec::new();
    let mut full_scale = Vec::new();
    for (approximate, reference, scale) in values {
        relative.extend(relative_error(approximate, reference, scale).map(f64::abs));
        full_scale.push(full_scale_error(approximate, reference, scale).abs());
    }
    Errors {
        relative: statistics(&mut relative),
        full_scale: statistics(&mut full_scale),
    }
}

/// Sums up absolute errors in percent; reorders them.
fn statistics(errors: &mut [f64]) -> Statistics {
    if errors.is_empty() {
        return Statistics::default();
    }
    let count = errors.len() as f64;
    let max = errors.iter().fold(0.0, |max: f64, error| max.max(*error));
    let rms = (errors.iter().map(|error| error * error).sum::<f64>() / count).sqrt();
    let over = TOLERANCES.map(|tolerance| {
        100.0 * errors.iter().filter(|error| **error > tolerance).count() as f64 / count
    });
    let rank = (0.95 * count).ceil() as usize - 1;
    let (_, p95, _) = errors.select_nth_unstable_by(rank, f64::total_cmp);
    Statistics {
        max,
        rms,
        p95: *p95,
        over,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn both_metrics_follow_their_formulas() {
        // Full scale 10: 1 % of 10, 10 % of 1 (1 % of scale).
        let errors = errors([(10.1, 10.0), (0.9, 1.0)].into_iter(), 10.0);
        assert!((errors.relative.max - 10.0).abs() < 1e-12);
        assert!((errors.relative.rms - (101.0_f64 / 2.0).sqrt()).abs() < 1e-9);
        assert!((errors.full_scale.max - 1.0).abs() < 1e-12);
        assert_eq!(errors.relative.over[1..], [50.0, 50.0, 0.0, 0.0]);
        assert!((relative_error(0.9, 1.0, 10.0).unwrap() + 10.0).abs() < 1e-12);
    }

    #[test]
    fn the_dark_is_counted_in_full_scale_only() {
        let errors = errors([(0.5, 0.0009), (1.0, 1.0)].into_iter(), 1.0);
        assert_eq!(errors.relative, Statistics::default());
        assert!((errors.full_scale.max - 49.91).abs() < 1e-9);
        assert_eq!(errors.full_scale.over, [50.0; 5]);
    }

    #[test]
    fn no_values_is_no_error() {
        let errors = errors(std::iter::empty(), 1.0);
        assert_eq!(errors, Errors::default());
    }

    #[test]
    fn light_on_a_dark_surface_is_wholly_wrong() {
        assert_eq!(full_scale_error(0.0, 0.0, 0.0), 0.0);
        assert_eq!(full_scale_error(1e-9, 0.0, 0.0), 100.0);
        assert_eq!(relative_error(1e-9, 0.0, 0.0), None);
    }

    #[test]
    fn what_is_not_finite_is_infinitely_wrong() {
        let errors = errors([(f64::NAN, 1.0), (1.0, 1.0)].into_iter(), 1.0);
        assert_eq!(errors.relative.max, f64::INFINITY);
        assert_eq!(errors.full_scale.rms, f64::INFINITY);
        assert_eq!(errors.full_scale.over, [50.0; 5]);
    }

    #[test]
    fn the_tail_is_the_nearest_rank() {
        let values = (1..=100).map(|k| (100.0 + f64::from(k), 100.0));
        let errors = errors(values, 100.0);
        assert!((errors.relative.p95 - 95.0).abs() < 1e-9);
        assert!((errors.relative.over[3] - 90.0).abs() < 1e-12);
    }

    #[test]
    fn each_pixel_has_its_own_surface() {
        let errors = errors_by_scale([(1.1, 1.0, 1.0), (99.0, 100.0, 100.0)].into_iter());
        assert!((errors.full_scale.max - 10.0).abs() < 1e-9);
        assert!((errors.relative.rms - (101.0_f64 / 2.0).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn the_document_has_the_promised_keys() {
        let json = serde_json::to_value(errors([(1.03, 1.0)].into_iter(), 1.0)).unwrap();
        for metric in ["relative", "full_scale"] {
            let keys: Vec<_> = json[metric].as_object().unwrap().keys().collect();
            assert_eq!(keys.len(), 4);
            assert!(json[metric]["max"].as_f64().unwrap() > 2.9);
            for (tolerance, share) in [("1", 100.0), ("2", 100.0), ("5", 0.0), ("10", 0.0)] {
                assert_eq!(json[metric]["over"][tolerance], share);
            }
            assert_eq!(json[metric]["over"]["15"], 0.0);
        }
    }

    proptest! {
        #[test]
        fn errors_are_ordered_and_scale_free(
            pairs in prop::collection::vec((0.0..10.0_f64, 0.0..10.0_f64), 1..60),
            exponent in -20..20_i32,
        ) {
            let scale = pairs.iter().fold(0.0, |max: f64, pair| max.max(pair.1));
            let errors_here = errors(pairs.iter().copied(), scale);
            for metric in [errors_here.relative, errors_here.full_scale] {
                prop_assert!(metric.rms <= metric.max * (1.0 + 1e-12));
                prop_assert!(metric.p95 <= metric.max);
                prop_assert!(metric.over.windows(2).all(|pair| pair[0] >= pair[1]));
            }
            let factor = 2.0_f64.powi(exponent);
            let scaled = pairs.iter().map(|pair| (pair.0 * factor, pair.1 * factor));
            prop_assert_eq!(errors(scaled, scale * factor), errors_here);
        }
    }
}
