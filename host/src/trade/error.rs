//! How wrong a rung is on the form factors of [`super::suite`].

use super::suite::{CLASSES, CONDITIONED, Case, RELATIVE};
use crate::solve::FormFactorRung;
use serde::Serialize;

/// Errors of a class of form factors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClassErrors {
    /// The class.
    pub class: &'static str,
    /// Cases in it.
    pub cases: usize,
    /// The largest |F − exact|.
    pub max: f64,
    /// 95 % of the cases err by no more.
    pub p95: f64,
    /// The largest |F − exact|/exact; `None` where every F is 0.
    pub relative_max: Option<f64>,
    /// 95 % of the cases err by no more, relatively.
    pub relative_p95: Option<f64>,
}

/// Errors of a rung on the whole suite.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SuiteErrors {
    /// The largest |F − exact| of all classes but [`CONDITIONED`].
    pub max: f64,
    /// 95 % of these cases err by no more.
    pub p95: f64,
    /// The largest |F − exact|/exact of the class [`RELATIVE`].
    pub tiny_relative_max: f64,
    /// By class.
    pub classes: Vec<ClassErrors>,
}

impl SuiteErrors {
    /// The relative error of tiny emitters by which rungs are ranked: 1 at the
    /// most, for then no digit is right and more is no worse.
    #[must_use]
    pub fn tiny_relative(&self) -> f64 {
        self.tiny_relative_max.min(1.0)
    }
}

/// The cases of every class, in the order of [`CLASSES`].
pub type Suite = Vec<(&'static str, Vec<Case>)>;

/// Generates the whole suite, 13 classes of 200 cases.
#[must_use]
pub fn suite() -> Suite {
    CLASSES
        .map(|class| (class, super::suite::cases(class)))
        .into()
}

/// Judges a rung.
#[must_use]
pub fn judge(rung: FormFactorRung, suite: &Suite) -> SuiteErrors {
    let mut classes = Vec::new();
    let mut counted = Vec::new();
    for (class, cases) in suite {
        let errors: Vec<f64> = cases.iter().map(|case| error(rung, case)).collect();
        let mut relative: Vec<f64> = errors
            .iter()
            .zip(cases)
            .filter(|(_, case)| case.exact > 0.0)
            .map(|(error, case)| error / case.exact)
            .collect();
        if *class != CONDITIONED {
            counted.extend_from_slice(&errors);
        }
        let mut absolute = errors;
        let (max, p95) = largest_and_p95(&mut absolute).unwrap_or_default();
        let relative = largest_and_p95(&mut relative);
        classes.push(ClassErrors {
            class,
            cases: cases.len(),
            max,
            p95,
            relative_max: relative.map(|(max, _)| max),
            relative_p95: relative.map(|(_, p95)| p95),
        });
    }
    let (max, p95) = largest_and_p95(&mut counted).unwrap_or_default();
    let tiny = classes.iter().find(|errors| errors.class == RELATIVE);
    SuiteErrors {
        max,
        p95,
        tiny_relative_max: tiny.and_then(|tiny| tiny.relative_max).unwrap_or_default(),
        classes,
    }
}

/// |F − exact|. A receiver that the kernel refuses errs by everything.
fn error(rung: FormFactorRung, case: &Case) -> f64 {
    match rung.form_factor(case.position, case.normal, &case.vertices) {
        Ok((got, _)) => (got - case.exact).abs(),
        Err(_) => 1.0,
    }
}

/// The largest value and the one that 95 % do not exceed; `None` of none.
pub(super) fn largest_and_p95(values: &mut [f64]) -> Option<(f64, f64)> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    let rank = (0.95 * values.len() as f64).ceil() as usize;
    Some((values[last], values[rank.saturating_sub(1).min(last)]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_percentile_is_a_value_that_occurred() {
        let mut values: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(largest_and_p95(&mut values), Some((100.0, 95.0)));
        assert_eq!(largest_and_p95(&mut [3.0]), Some((3.0, 3.0)));
        assert_eq!(largest_and_p95(&mut []), None);
    }
}
