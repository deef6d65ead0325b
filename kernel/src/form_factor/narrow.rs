//! A loop of edges seen under at most 45°, summed without a root.
//!
//! The angle per sine of twice an angle, ϑ = 2γ, needs no lengths but their
//! squares: with d = a·b and p = a²b², cos ϑ = 2d²/p − 1, and γ/sin γ = cos γ ·
//! ϑ/sin ϑ. Snell's quotient of ϑ is then, with t = 2d² + p and x = (2d² − p)/t,
//!
//! ```text
//! γ/|a×b| = d s(x)/t
//! ```
//!
//! with the s of [`turn_over_sine`] that edges up to 90° take: ϑ is no more than
//! that. One division an edge, no root; 3 operations more than with the vertices'
//! lengths, against a root each.
//!
//! Every edge of a loop whose vertices are seen within 22.5° of the first one is
//! narrow enough ([`residual::is_small`](super::residual::is_small)).

use super::{Outline, snell, tally::Tally};
use crate::geometry::{Receiver, Vector};
use crate::number::{Floating, Root, turn_over_sine};

/// A vertex relative to the receiver.
#[derive(Clone, Copy)]
struct Vertex<N> {
    position: Vector<N>,
    squared: N,
}

impl<N: Floating> Vertex<N> {
    /// The vertex; `None` where it is below the horizon.
    #[inline(always)]
    fn new(vertex: &[N; 3], receiver: &Receiver<N>) -> Option<Self> {
        let position = Vector::from(*vertex) - receiver.position();
        (receiver.normal().dot(position) >= N::ZERO).then(|| Self {
            position,
            squared: position.norm_squared(),
        })
    }
}

/// γ n·c/|c| of an edge, in turns.
#[cfg_attr(feature = "small", inline(never))]
#[cfg_attr(not(feature = "small"), inline(always))]
fn term<const DEGREE: usize, N: Floating>(normal: Vector<N>, a: &Vertex<N>, b: &Vertex<N>) -> N {
    let (a, b, product) = (a.position, b.position, a.squared * b.squared);
    let d = a.dot(b);
    let squared = d * d;
    let twice = squared + squared;
    let inverse = N::ONE / (twice + product);
    let per_sine = turn_over_sine::<DEGREE, N>((twice - product) * inverse) * inverse;
    per_sine * d * normal.dot(a.cross(b))
}

/// Σ γ_i n·unit(v_i × v_{i+1}) in turns over the part above the horizon of a loop
/// that has no edge above 45°; from the first vertex below it on, the rest is
/// summed with care.
#[inline]
pub(super) fn contour<const DEGREE: usize, N: Floating, R: Root<N> + Copy>(
    receiver: &Receiver<N>,
    facing: Vector<N>,
    outline: &Outline<'_, N>,
) -> N {
    let vertices = outline.vertices();
    let Some((first, others)) = vertices.split_first() else {
        return N::ZERO;
    };
    let (normal, mut sum) = (receiver.normal(), Tally::<DEGREE, N>::ZERO);
    let (mut left, mut ahead) = (others.len(), others.iter());
    if let Some(first) = Vertex::new(first, receiver) {
        let mut from = first;
        left = loop {
            let Some(next) = ahead.next() else {
                return sum.total(term::<DEGREE, N>(normal, &from, &first));
            };
            let Some(to) = Vertex::new(next, receiver) else {
                break ahead.len().wrapping_add(1);
            };
            sum = sum.plus(term::<DEGREE, N>(normal, &from, &to));
            from = to;
        };
    }
    snell::rest::<DEGREE, N, R>(receiver, facing, vertices, left, sum)
}
