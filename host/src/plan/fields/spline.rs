//! Polyharmonic splines: values between scattered places.

use nalgebra::{DMatrix, DVector};

/// Places that a value between them is made of.
const NEAREST: usize = 14;

/// The weights of the nearest of some places in the value at another one: those of
/// the spline Σ c_k |x − x_k|³ + a linear function through them, which is linear in
/// their values.
///
/// Where the places lie on a line, or are too few, the nearest one counts alone.
/// Costs the cube of their number, 14.
pub fn weights(places: &[[f64; 2]], at: [f64; 2]) -> Vec<(usize, f64)> {
    let squared = |place: [f64; 2]| (place[0] - at[0]).powi(2) + (place[1] - at[1]).powi(2);
    let mut nearest: Vec<usize> = (0..places.len()).collect();
    let by_distance = |&a: &usize, &b: &usize| {
        squared(places[a])
            .total_cmp(&squared(places[b]))
            .then(a.cmp(&b))
    };
    if nearest.len() > NEAREST {
        nearest.select_nth_unstable_by(NEAREST - 1, by_distance);
        nearest.truncate(NEAREST);
    }
    nearest.sort_by(by_distance);
    let Some(&first) = nearest.first() else {
        return Vec::new();
    };
    if squared(places[first]) == 0.0 {
        return vec![(first, 1.0)];
    }
    // In units of the farthest one's distance the matrix is of order 1.
    let scale = nearest
        .last()
        .map_or(0.0, |&last| squared(places[last]))
        .sqrt();
    let local: Vec<[f64; 2]> = nearest
        .iter()
        .map(|&k| [0, 1].map(|axis| (places[k][axis] - at[axis]) / scale))
        .collect();
    let count = local.len();
    let cube = |a: [f64; 2], b: [f64; 2]| {
        let squared = (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
        squared * squared.sqrt()
    };
    let linear = |place: [f64; 2], k: usize| [1.0, place[0], place[1]][k];
    let matrix = DMatrix::from_fn(count + 3, count + 3, |i, j| match (i < count, j < count) {
        (true, true) => cube(local[i], local[j]),
        (true, false) => linear(local[i], j - count),
        (false, true) => linear(local[j], i - count),
        (false, false) => 0.0,
    });
    let right = DVector::from_fn(count + 3, |i, _| match i < count {
        true => cube(local[i], [0.0; 2]),
        false => linear([0.0; 2], i - count),
    });
    let solved = matrix.lu().solve(&right);
    match solved.filter(|w| w.iter().take(count).all(|w| w.abs() < 2.0)) {
        Some(solved) => nearest.into_iter().zip(solved.iter().copied()).collect(),
        None => vec![(first, 1.0)],
    }
}
