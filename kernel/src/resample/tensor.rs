//! Tensor grids: a product of polynomials through samples.
//!
//! Irradiance from an unoccluded source falls off like h²/(h² + r²)², so
//!
//! ```text
//! g = √(s/E),      s = (d·n_r)(−d·n_s),
//! ```
//!
//! d being the way from the receiver to the source's centroid, is nearly a
//! quadratic function of place, and a polynomial through few samples of g errs a
//! hundred times less than one through samples of E. On a plane s is linear in u
//! and v. Where g does not exist, the polynomials are of E itself.
//!
//! The polynomials are sums of Chebyshev's, which rounding does not spoil at
//! any degree; a matrix for each axis makes their coefficients of the values at the
//! nodes, whichever nodes these are.

use crate::luminance::Colour;
use crate::number::Root;
use crate::scene::fields::{Fields, MOST_NODES, Tensor};

/// How far above the largest of its samples a tensor may go: what a polynomial
/// through few samples makes of a peak between them stays below.
const HEADROOM: f32 = 4.0;

/// In place of g where there is no light: s/g² is then as good as nothing.
const DARK: f32 = 1e15;

/// Fills `room` with the coefficients for the values at the nodes of a tensor,
/// those for the lowest degree in v first, and behind them with the largest that it
/// may answer.
///
/// Cost: n_u n_v (n_u + n_v) multiplications, and a root and a division a node.
pub(super) fn coefficients<R: Root<f32>, C: Colour>(
    tensor: &Tensor,
    fields: Fields<'_>,
    places: &[[f32; 2]],
    values: &[C],
    room: &mut [C],
) {
    let [n_u, n_v] = tensor.nodes;
    let Some((limit, room)) = room.split_last_mut() else {
        return;
    };
    *limit = C::DARK;
    for ((cell, &place), &value) in room.iter_mut().zip(places).zip(values) {
        *limit = limit.zip(value, |most, x| if x > most { x } else { most });
        *cell = match tensor.transformed {
            0 => value,
            _ => {
                let s = tensor.factor_at(place);
                value.map(|irradiance| transformed::<R>(s, irradiance))
            }
        };
    }
    *limit = limit.times(HEADROOM);
    let [of_u, of_v] = tensor.matrices;
    let (along_u, along_v) = (fields.matrix(of_u, n_u), fields.matrix(of_v, n_v));
    let (n_u, n_v) = (n_u as usize, n_v as usize);
    for row in 0..n_v {
        apply(along_u, room, row.wrapping_mul(n_u), [1, n_u]);
    }
    for column in 0..n_u {
        apply(along_v, room, column, [n_u, n_v]);
    }
}

/// g where there is light.
#[inline(always)]
fn transformed<R: Root<f32>>(s: f32, irradiance: f32) -> f32 {
    if s <= 0.0 || irradiance <= 0.0 {
        return if s <= 0.0 { 0.0 } else { DARK };
    }
    let g = R::sqrt(s / irradiance);
    if g < DARK { g } else { DARK }
}

/// Replaces `count` values, from the first on and `stride` apart, by a matrix times
/// them.
fn apply<C: Colour>(matrix: &[f32], values: &mut [C], first: usize, [stride, count]: [usize; 2]) {
    let mut old = [C::DARK; MOST_NODES];
    let mut place = first;
    for old in old.iter_mut().take(count) {
        *old = values.get(place).copied().unwrap_or(C::DARK);
        place = place.wrapping_add(stride);
    }
    let mut rest = matrix;
    let mut place = first;
    for _ in 0..count {
        let Some((row, others)) = rest.split_at_checked(count) else {
            return;
        };
        rest = others;
        let mut sum = C::DARK;
        for (&value, &weight) in old.iter().zip(row) {
            sum = sum.plus(value.times(weight));
        }
        if let Some(cell) = values.get_mut(place) {
            *cell = sum;
        }
        place = place.wrapping_add(stride);
    }
}

impl Tensor {
    #[inline(always)]
    fn factor_at(&self, [u, v]: [f32; 2]) -> f32 {
        let [constant, along_u, along_v] = self.factor;
        constant + along_u * u + along_v * v
    }
}

/// A tensor grid along one line of constant v.
pub(super) struct Line<C: Colour> {
    /// Of the Chebyshev polynomials of u.
    coefficients: [C; MOST_NODES],
    count: usize,
    center: f32,
    inverse: f32,
    /// s on the line: at u = 0, and what it grows by for a metre.
    factor: [f32; 2],
    transformed: bool,
    limit: C,
}

impl<C: Colour> Line<C> {
    /// The line at `v` of a tensor whose [`coefficients`] are in `room`. Cost: two
    /// operations a node.
    pub(super) fn at(tensor: &Tensor, room: &[C], v: f32) -> Self {
        let [constant, along_u, along_v] = tensor.factor;
        let mut line = Self {
            coefficients: [C::DARK; MOST_NODES],
            count: tensor.nodes[0] as usize,
            center: tensor.center[0],
            inverse: tensor.inverse[0],
            factor: [constant + along_v * v, along_u],
            transformed: tensor.transformed != 0,
            limit: C::DARK,
        };
        let Some((&limit, room)) = room.split_last() else {
            return line;
        };
        line.limit = limit;
        let t = variable(v, tensor.center[1], tensor.inverse[1]);
        let (mut before, mut now) = (t, 1.0);
        let mut rest = room;
        while let Some((row, others)) = rest.split_at_checked(line.count) {
            if row.is_empty() {
                break;
            }
            rest = others;
            for (sum, &coefficient) in line.coefficients.iter_mut().zip(row) {
                *sum = sum.plus(coefficient.times(now));
            }
            (before, now) = (now, (t + t) * now - before);
        }
        line
    }

    /// The irradiance at `u`: not below 0, and not far above the samples. Cost:
    /// three operations a node along u by Clenshaw's recurrence, and where it is of
    /// g a division.
    #[inline(always)]
    pub(super) fn value(&self, u: f32) -> C {
        let t = variable(u, self.center, self.inverse);
        let twice = t + t;
        let (mut b1, mut b2) = (C::DARK, C::DARK);
        let coefficients = self.coefficients.get(..self.count).unwrap_or(&[]);
        let (first, others) = match coefficients {
            [first, others @ ..] => (*first, others),
            [] => return C::DARK,
        };
        for &coefficient in others.iter().rev() {
            let next = b1.times(twice).zip(b2, |a, b| a - b).plus(coefficient);
            (b1, b2) = (next, b1);
        }
        let sum = b1.times(t).zip(b2, |a, b| a - b).plus(first);
        let value = if self.transformed {
            let [constant, along_u] = self.factor;
            let s = constant + along_u * u;
            sum.map(|g| {
                let squared = g * g;
                if s > 0.0 && g > 0.0 && squared > 0.0 {
                    s / squared
                } else {
                    0.0
                }
            })
        } else {
            sum
        };
        value.zip(self.limit, |x, limit| {
            if x > 0.0 {
                if x < limit { x } else { limit }
            } else {
                0.0
            }
        })
    }
}

/// The variable of the polynomials, within the nodes' own interval: outside of it
/// they say nothing.
#[inline(always)]
fn variable(x: f32, center: f32, inverse: f32) -> f32 {
    let t = (x - center) * inverse;
    if t > 1.0 {
        1.0
    } else if t > -1.0 {
        t
    } else {
        -1.0
    }
}
