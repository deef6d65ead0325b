//! What samples contribute to a value between them: weights fitted to the light
//! that may be.
//!
//! What a place receives of reflected light is a sum over patches, f(x) = Σ_j b_j
//! K_j(x), and a planner knows every K_j, shadows and all. It does not know the
//! radiosities b_j: lamps are dimmed, walls are painted. Let them be b_j (1 + ξ +
//! σ ξ_s + τ ξ_j), j a patch of surface s, with independent ξ of unit variance. The best
//! linear estimate of f(x) from
//! samples f(s_k) then has the weights that solve a least-squares problem in the
//! space of the patches (kriging with the light's own covariance): a row of
//! numbers for every place, and the target's row as a sum of the samples'.
//!
//! Few samples are chosen for each target, one after the other, always the one that
//! lessens the error most (orthogonal matching pursuit).

use nalgebra::{DMatrix, DVector};

/// How far the patches of a surface vary together, σ. With more the light of few samples is
/// followed less well, with less that of a surface painted anew.
const TOGETHER: f64 = 0.15;

/// How far patches vary by themselves, τ.
pub const ALONE: f64 = 0.3;

/// Relative error of samples that weights are made safe against, squared.
const NOISE: f64 = 1e-4;

/// The most samples that contribute to one value.
pub const MOST: usize = 5;

/// The same for a camera: bytes of weights are better spent on corners of meshes there.
pub const MOST_FOR_CAMERA: usize = 3;

/// A relative error, squared, at which no more samples are wanted.
const WELL: f64 = 2e-5;

/// A sample whose light, squared, is less than this part of the brightest one's is not
/// chosen: its weights would be large.
const FAINT: f64 = 0.03;

/// The row of a place: what it gets in all, of each surface, and of each patch alone.
/// `patches` are how many of the parts each surface has, one after the other.
pub fn row(parts: &[f64], patches: &[usize]) -> Vec<f64> {
    let all: f64 = parts.iter().sum();
    let mut rest = parts;
    let together = patches.iter().filter(|&&count| count > 0).map(|&count| {
        let (of_surface, others) = rest.split_at(count.min(rest.len()));
        rest = others;
        TOGETHER * of_surface.iter().sum::<f64>()
    });
    let together: Vec<f64> = together.collect();
    let alone = parts.iter().map(|part| ALONE * part);
    std::iter::once(all).chain(together).chain(alone).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The samples, of those offered and no more than `most`, that make up the target best, and
/// their weights.
pub fn fit(target: &[f64], offered: &[(usize, &[f64])], most: usize) -> Vec<(usize, f64)> {
    let all = dot(target, target);
    let near: Vec<f64> = offered.iter().map(|(_, row)| dot(row, target)).collect();
    let lengths: Vec<f64> = offered.iter().map(|(_, row)| dot(row, row)).collect();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let mut chosen: Vec<usize> = Vec::new();
    let mut weights = DVector::<f64>::zeros(0);
    let mut left: Vec<f64> = target.to_vec();
    while chosen.len() < most && dot(&left, &left) > WELL * all {
        let gain = |k: usize| dot(offered[k].1, &left).powi(2) / lengths[k];
        let best = (0..offered.len())
            .filter(|k| !chosen.contains(k) && lengths[*k] > FAINT * longest)
            .max_by(|&a, &b| gain(a).total_cmp(&gain(b)));
        let Some(best) = best.filter(|&k| gain(k) > 1e-9 * all) else {
            break;
        };
        chosen.push(best);
        let count = chosen.len();
        let normal = DMatrix::from_fn(count, count, |i, j| {
            let (i, j) = (chosen[i], chosen[j]);
            let noise = if i == j { NOISE * lengths[i] } else { 0.0 };
            dot(offered[i].1, offered[j].1) + noise
        });
        let wanted = DVector::from_fn(count, |i, _| near[chosen[i]]);
        let Some(factor) = normal.cholesky() else {
            chosen.pop();
            break;
        };
        weights = factor.solve(&wanted);
        left.copy_from_slice(target);
        for (&k, weight) in chosen.iter().zip(weights.iter()) {
            for (left, x) in left.iter_mut().zip(offered[k].1) {
                *left -= weight * x;
            }
        }
    }
    let weights = weights.iter().copied();
    chosen.iter().map(|&k| offered[k].0).zip(weights).collect()
}

/// The order in which places are best made samples, and after each of them the mean
/// square of what is still unknown of all places: the incomplete Cholesky
/// factorisation of their covariance, the place with the most left always next.
///
/// `weights` say how much the square of each place's error counts.
pub fn order(rows: &[Vec<f64>], weights: &[f64], most: usize) -> Vec<(usize, f64)> {
    let mut left: Vec<f64> = rows.iter().map(|row| dot(row, row)).collect();
    // Orthonormal directions in the space of the patches, and what rows have of
    // each taken away.
    let mut rows: Vec<Vec<f64>> = rows.to_vec();
    let mut found = Vec::new();
    let loss = |left: &[f64]| dot(left, weights);
    let mut total = loss(&left);
    for _ in 0..most.min(rows.len()) {
        let value = |k: usize| left[k] * weights[k];
        let Some(next) = (0..rows.len()).max_by(|&a, &b| value(a).total_cmp(&value(b))) else {
            break;
        };
        if value(next) <= 1e-12 * total {
            break;
        }
        let length = dot(&rows[next], &rows[next]);
        // A sample has an error of its own: it tells a little less than it could.
        let direction = rows[next].clone();
        for (row, left) in rows.iter_mut().zip(&mut left) {
            let part = dot(row, &direction) / (length * (1.0 + NOISE));
            for (x, d) in row.iter_mut().zip(&direction) {
                *x -= part * d;
            }
            *left = dot(row, row);
        }
        left[next] = 0.0;
        rows[next].fill(0.0);
        total = loss(&left);
        found.push((next, total));
    }
    found
}
