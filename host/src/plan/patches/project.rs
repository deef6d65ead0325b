//! The weights of a patch's places, for the light that is planned for.
//!
//! Least squares over a few places errs where light is not linear between them:
//! at the edge of a shadow the mean over four places is not the patch's. Where
//! the planner knows the light, it knows the linear function that fits it best
//! all over the patch; the places keep their weights but for the least change
//! that gives this function.

use nalgebra::{DMatrix, DVector};

/// The most that the weight of a place is changed by.
const MOST: f64 = 8.0;

/// What a change of the weights costs beside a miss: the part of the squares of
/// the values below which they tell nothing.
const RIDGE: f64 = 1e-4;

/// Values at the places of a patch, from one luminaire, and the linear function
/// (mean and gradients) that fits this light best all over the patch.
pub(super) struct Known {
    pub(super) values: Vec<f64>,
    pub(super) wanted: [f64; 3],
}

/// Changes the weights of mean and gradients by the least that makes what is wanted
/// of every luminaire's light l, within [`MOST`]:
///
/// ```text
/// Σ_l (Σ_j Δ_j x_lj − t_l)² + RIDGE Σ_lj x_lj² |Δ|²/n → least,   Σ_j Δ_j = 0,
/// ```
///
/// t_l being what the weights miss. With the same sum a radiosity that is the same
/// all over stays so; and luminaires may be dimmed each for itself, since light
/// adds up.
pub(super) fn correct(weights: &mut [[f64; 3]], light: &[Known]) {
    let count = weights.len();
    let mut system = DMatrix::<f64>::zeros(count, count);
    let mut right = DMatrix::<f64>::zeros(count, 3);
    let mut squares = 0.0;
    for known in light {
        let mean = known.values.iter().sum::<f64>() / count.max(1) as f64;
        let off = DVector::from_iterator(count, known.values.iter().map(|x| x - mean));
        let made = made(weights, &known.values);
        let missed = known.wanted.iter().zip(made);
        for (mut column, (wanted, made)) in right.column_iter_mut().zip(missed) {
            column += &off * (wanted - made);
        }
        system += &off * off.transpose();
        squares += known.values.iter().map(|x| x * x).sum::<f64>();
    }
    let ridge = RIDGE * squares / count.max(1) as f64;
    for k in 0..count {
        system[(k, k)] += ridge;
    }
    let Some(change) = system.cholesky().map(|factors| factors.solve(&right)) else {
        return;
    };
    for k in 0..3 {
        let most = change.column(k).amax();
        let scale = if most > MOST { MOST / most } else { 1.0 };
        for (j, weights) in weights.iter_mut().enumerate() {
            weights[k] += scale * change[(j, k)];
        }
    }
}

/// The linear function that weights make of values: mean and gradients.
pub(super) fn made(weights: &[[f64; 3]], values: &[f64]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (weights, value) in weights.iter().zip(values) {
        for (sum, weight) in sum.iter_mut().zip(weights) {
            *sum += weight * value;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(values: [f64; 4], wanted: [f64; 3]) -> Known {
        Known {
            values: values.to_vec(),
            wanted,
        }
    }

    #[test]
    fn corrected_weights_make_what_is_wanted_of_every_light_and_keep_their_sums() {
        let mut weights = [[0.25, -0.5, -0.5], [0.25, 0.5, -0.5]].repeat(2);
        let light = [
            known([1.0, 0.0, 3.0, 2.0], [1.7, 0.2, -0.4]),
            known([2.0, 1.0, 0.0, 0.0], [0.9, -0.1, 0.3]),
        ];
        correct(&mut weights, &light);
        for known in &light {
            let made = made(&weights, &known.values);
            for (made, wanted) in made.into_iter().zip(known.wanted) {
                assert!((made - wanted).abs() < 1e-3, "{made} {wanted}");
            }
        }
        let even = made(&weights, &[1.0; 4]);
        assert!((even[0] - 1.0).abs() < 1e-12 && even[1].abs() < 1e-12);
    }

    #[test]
    fn values_that_tell_nothing_change_next_to_nothing() {
        let plain = [[0.25, 0.0, 0.0]; 4];
        for values in [[0.0; 4], [3.0; 4]] {
            let mut weights = plain;
            correct(&mut weights, &[known(values, [1.0, 1.0, 1.0])]);
            assert_eq!(weights, plain);
        }
        let mut weights = plain;
        let nearly = [1.0, 1.0, 1.0, 1.0 + 1e-5];
        correct(&mut weights, &[known(nearly, [1e9, 0.0, 0.0])]);
        assert!(weights.iter().all(|w| w[0].abs() <= MOST + 0.25));
    }
}
