//! The weights of a patch's places, for the light that is planned for.
//!
//! Least squares over a few places errs where light is not linear between them:
//! at the edge of a shadow the mean over four places is not the patch's. Where
//! the planner knows the light, it knows the linear function that fits it best
//! all over the patch; the places keep their weights but for the least change
//! that gives this function.

/// The most that the weight of a place is changed by.
const MOST: f64 = 8.0;

/// Values nearer to their mean than this part of it are all the same.
const SAME: f64 = 1e-6;

/// Changes the weights of mean and gradients, which make Σ w_j x_j of the values,
/// into the nearest ones (least squares) that make `wanted` and have the same
/// sum, as far as [`MOST`] allows: w_j + β (x_j − x̄),
/// β = (wanted − Σ w_j x_j)/Σ (x_j − x̄)².
///
/// With the same sum a radiosity that is the same all over stays so. Values that
/// are all the same tell nothing: the weights stay.
pub(super) fn correct(weights: &mut [[f64; 3]], values: &[f64], wanted: [f64; 3]) {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    let off: Vec<f64> = values.iter().map(|value| value - mean).collect();
    let spread: f64 = off.iter().map(|x| x * x).sum();
    let farthest = off.iter().map(|x| x.abs()).fold(0.0, f64::max);
    if farthest <= SAME * mean.abs() {
        return;
    }
    let made = made(weights, values);
    for k in 0..3 {
        let slope = (wanted[k] - made[k]) / spread;
        let slope = slope.clamp(-MOST / farthest, MOST / farthest);
        for (weights, off) in weights.iter_mut().zip(&off) {
            weights[k] += slope * off;
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

    #[test]
    fn corrected_weights_make_what_is_wanted_and_keep_their_sums() {
        let mut weights = [[0.25, -0.5, -0.5], [0.25, 0.5, -0.5]].repeat(2);
        let values = [1.0, 0.0, 3.0, 2.0];
        let wanted = [1.7, 0.2, -0.4];
        correct(&mut weights, &values, wanted);
        for (made, wanted) in made(&weights, &values).into_iter().zip(wanted) {
            assert!((made - wanted).abs() < 1e-12, "{made} {wanted}");
        }
        let even = made(&weights, &[1.0; 4]);
        assert!((even[0] - 1.0).abs() < 1e-12 && even[1].abs() < 1e-12);
    }

    #[test]
    fn values_that_tell_nothing_change_nothing() {
        let plain = [[0.5, 0.0, 0.0]; 2];
        for values in [[0.0; 2], [3.0; 2]] {
            let mut weights = plain;
            correct(&mut weights, &values, [1.0, 1.0, 1.0]);
            assert_eq!(weights, plain);
        }
        let mut weights = plain;
        correct(&mut weights, &[1.0, 1.0 + 1e-5], [1e9, 0.0, 0.0]);
        assert!(weights.iter().all(|w| w[0].abs() <= MOST + 0.5));
    }
}
