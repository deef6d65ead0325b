//! Nested emitters: what each isolux outline encloses, and by how much it is
//! brighter than what is outside.
//!
//! Where radiosity falls off in steps, B = Σ_k ΔB_k [inside outline k], the light
//! that a surface sends is that of nested polygons, one an outline and none with
//! an inner loop for the next brighter outline; the paper's bands have one each.
//! ΔB_k is the step from one band's radiosity to the next one's, and a band's is
//! had from the samples at its vertices. Their plain mean, the paper's, misses the
//! power of the band: a polygon inscribed in an outline leaves the brightest
//! part of what is outside to the darker band, and the mean over two outlines is
//! not the mean between them. Nor is the band's true mean what other surfaces
//! see of it: of the light in a band its brighter side may be the nearer one.
//! So for the light that is planned for each band gets the value with which the
//! others are lit best, under the condition that all power is sent
//! ([`Bands::values`]); and the weights of its samples are those nearest to equal
//! ones that give this value. They sum to 1: light that is even stays so.

use super::isolux::Lit;
use super::map::{CELLS, Map};
use super::{Band, Sample};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// Rows of the rule that integrates over a polygon, on every row of the grid.
const ROWS: usize = 4;

/// The most that a weight differs from an equal one.
const MOST: f64 = 1.0;

/// Values nearer to their mean than this part of it are all the same.
const SAME: f64 = 1e-6;

/// A band with less than this part of the surface's area has no mean of its own.
const SPECK: f64 = 1e-6;

/// What a band's value costs by being off its true mean, where being off as much
/// at the probes costs 1: enough to decide between values that light the
/// probes alike.
const TRUST: f64 = 1e-3;

/// The bands of a surface, darkest first.
struct Bands {
    areas: Vec<f64>,
    powers: Vec<f64>,
    /// By band, its form factors at the probes.
    factors: Vec<Vec<f64>>,
}

impl Map {
    /// The nested emitters of these bands; `outlines` are what each has on its
    /// outside, `lit` the probes.
    pub(super) fn layers(
        &self,
        outlines: Vec<Vec<Vec<usize>>>,
        bands: &[Band],
        samples: &[Sample],
        lit: &[Lit],
    ) -> Vec<Band> {
        let (enclosed, between) = self.measured(&outlines, samples, lit);
        let values: Vec<Vec<f64>> = bands
            .iter()
            .map(|band| {
                let places = band.members.iter().map(|&member| samples[member].place);
                places.map(|place| self.value(place)).collect()
            })
            .collect();
        let wanted = between.values(&values, lit);
        let mut before = BTreeMap::new();
        let mut layers = Vec::new();
        for (k, loops) in outlines.into_iter().enumerate() {
            let weights = weights(&values[k], wanted[k]);
            let mut own = BTreeMap::new();
            for (&member, weight) in bands[k].members.iter().zip(weights) {
                *own.entry(member).or_insert(0.0) += weight;
            }
            let mut step = own.clone();
            for (member, weight) in before {
                *step.entry(member).or_insert(0.0) -= weight;
            }
            let (members, weights) = step.into_iter().unzip();
            layers.push(Band {
                loops,
                members,
                weights,
                area: enclosed[k],
            });
            before = own;
        }
        layers
    }

    /// The area that each outline encloses, and the bands between them.
    fn measured(
        &self,
        outlines: &[Vec<Vec<usize>>],
        samples: &[Sample],
        lit: &[Lit],
    ) -> (Vec<f64>, Bands) {
        let mut enclosed = Vec::new();
        let mut powers = Vec::new();
        let mut factors = Vec::new();
        for loops in outlines {
            let places = |outline: &Vec<usize>| {
                let vertices = outline.iter().map(|&k| samples[k].vertex);
                vertices.collect()
            };
            let loops: Vec<Vec<[f64; 2]>> = loops.iter().map(places).collect();
            let [area, power] = self.enclosed(&loops);
            enclosed.push(area);
            powers.push(power);
            factors.push(self.form_factors(&loops, lit));
        }
        let less_next = |all: &[f64]| {
            let next = all.iter().skip(1).chain(&[0.0]);
            all.iter().zip(next).map(|(own, next)| own - next).collect()
        };
        let none = vec![0.0; lit.len()];
        let next = factors.iter().skip(1).chain([&none]);
        let between = factors.iter().zip(next).map(|(own, next)| {
            let pairs = own.iter().zip(next);
            pairs.map(|(own, next)| own - next).collect()
        });
        let bands = Bands {
            areas: less_next(&enclosed),
            powers: less_next(&powers),
            factors: between.collect(),
        };
        (enclosed, bands)
    }

    /// Area in m² and power in W (lm) of what loops enclose, a place in an odd
    /// number of them: the midpoint rule over rows, and along each.
    fn enclosed(&self, loops: &[Vec<[f64; 2]>]) -> [f64; 2] {
        let height = self.frame.size_v / (CELLS * ROWS) as f64;
        let cell = self.frame.size_u / CELLS as f64;
        let mut sum = [0.0; 2];
        for row in 0..CELLS * ROWS {
            let v = (row as f64 + 0.5) * height;
            let mut crossings: Vec<f64> = loops.iter().flat_map(|l| crossings(l, v)).collect();
            crossings.sort_by(f64::total_cmp);
            for ends in crossings.chunks_exact(2) {
                let length = ends[1] - ends[0];
                let steps = (length / cell).ceil().max(1.0) as usize;
                let at = |k: usize| ends[0] + (k as f64 + 0.5) / steps as f64 * length;
                let values: f64 = (0..steps).map(|k| self.value([at(k), v])).sum();
                sum[0] += length * height;
                sum[1] += values / steps as f64 * length * height;
            }
        }
        sum
    }
}

impl Bands {
    /// Values b_k that light the probes best and send all power:
    ///
    /// ```text
    /// mean_p (Σ_k b_k F_pk / E_p − 1)² + TRUST mean_k (b_k / b̄_k − 1)² → least,
    /// Σ_k b_k A_k = Σ_k b̄_k A_k = P,
    /// ```
    ///
    /// with the bands' true means b̄_k, by a Lagrange multiplier. `values` are those
    /// of each band's members, for a band without area.
    fn values(&self, values: &[Vec<f64>], lit: &[Lit]) -> Vec<f64> {
        let count = self.areas.len();
        let whole: f64 = self.areas.iter().sum();
        let means: Vec<f64> = (0..count)
            .map(|k| {
                if self.areas[k] > SPECK * whole {
                    self.powers[k] / self.areas[k]
                } else {
                    values[k].iter().sum::<f64>() / values[k].len().max(1) as f64
                }
            })
            .collect();
        // In units of the means.
        let part = 1.0 / lit.len().max(1) as f64;
        let trust = TRUST / count.max(1) as f64;
        let mut system = DMatrix::zeros(count + 1, count + 1);
        let mut right = DVector::zeros(count + 1);
        for k in 0..count {
            let of = |k: usize, p: usize| means[k] * self.factors[k][p] / lit[p].irradiance;
            for (p, _) in lit.iter().enumerate() {
                for l in 0..count {
                    system[(k, l)] += part * of(k, p) * of(l, p);
                }
                right[k] += part * of(k, p);
            }
            system[(k, k)] += trust;
            right[k] += trust;
            let power = means[k] * self.areas[k];
            system[(k, count)] = power;
            system[(count, k)] = power;
        }
        right[count] = self.powers.iter().sum();
        match system.lu().solve(&right) {
            Some(scales) if scales.iter().all(|x| x.is_finite()) => {
                (0..count).map(|k| means[k] * scales[k]).collect()
            }
            _ => means,
        }
    }
}

/// Where a loop crosses a row.
fn crossings(outline: &[[f64; 2]], v: f64) -> impl Iterator<Item = f64> + '_ {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).filter_map(move |(a, b)| {
        let crosses = (a[1] > v) != (b[1] > v);
        crosses.then(|| a[0] + (v - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
    })
}

/// The weights nearest to equal ones (least squares) that sum to 1 and make
/// `mean` of these values, as far as [`MOST`] allows: 1/n + β (x − x̄) with
/// β = (mean − x̄)/Σ (x − x̄)².
fn weights(values: &[f64], mean: f64) -> Vec<f64> {
    let equal = 1.0 / values.len().max(1) as f64;
    let middle = equal * values.iter().sum::<f64>();
    let off: Vec<f64> = values.iter().map(|value| value - middle).collect();
    let spread: f64 = off.iter().map(|x| x * x).sum();
    let farthest = off.iter().map(|x| x.abs()).fold(0.0, f64::max);
    if farthest <= SAME * middle.abs() || !mean.is_finite() {
        return vec![equal; values.len()];
    }
    let slope = (mean - middle) / spread;
    let slope = slope.clamp(-MOST / farthest, MOST / farthest);
    off.iter().map(|x| equal + slope * x).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(weights: &[f64], values: &[f64]) -> f64 {
        weights.iter().zip(values).map(|(w, value)| w * value).sum()
    }

    #[test]
    fn weights_sum_to_one_and_make_the_mean() {
        let values = [1.0, 2.0, 2.5, 4.0];
        for wanted in [1.5, 2.375, 3.0] {
            let weights = weights(&values, wanted);
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!((mean(&weights, &values) - wanted).abs() < 1e-12);
        }
        assert_eq!(weights(&values, 2.375), [0.25; 4]);
    }

    #[test]
    fn weights_stay_moderate_and_equal_values_count_alike() {
        let far = weights(&[1.0, 1.001], 1e6);
        assert!(far.iter().all(|w| w.abs() <= MOST + 0.5 + 1e-12), "{far:?}");
        assert_eq!(weights(&[3.0; 5], 7.0), [0.2; 5]);
        assert_eq!(weights(&[1.0, 2.0], f64::NAN), [0.5; 2]);
        assert!(weights(&[], 1.0).is_empty());
    }
}
