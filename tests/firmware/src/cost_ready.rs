//! The sum of the rung `poly5` over vertices that are ready: relative to the
//! receiver, none below its horizon. What the rung takes more than this is the
//! price of the horizon and of bringing vertices to the receiver.

use crate::cost_cases::Case;
use isolux::geometry::{Receiver, Vector};
use isolux::number::{Root, turn_over_sine};

/// An emitter relative to a receiver.
pub(crate) fn seen(case: &Case, receiver: &Receiver<f32>, vertices: usize) -> [[f32; 3]; 8] {
    let relative = |corner| (Vector::from(corner) - receiver.position()).into();
    case.emitter(vertices).map(relative)
}

/// Σ γ n·unit(a × b), γ in turns, over the edges of a loop of which none is seen under more
/// than 90°; 0 where one is. Operation for operation what the kernel does.
#[inline(always)]
pub(crate) fn ready<R: Root<f32>>(normal: Vector<f32>, vertices: &[[f32; 3]]) -> f32 {
    let Some((first, others)) = vertices.split_first() else {
        return 0.0;
    };
    let distance = |vertex: Vector<f32>| R::sqrt(vertex.norm_squared());
    let term = |(a, twice): (Vector<f32>, f32), b: Vector<f32>, norm: f32| {
        let (c, d) = (a.cross(b), a.dot(b));
        let inverse = 1.0 / (twice * norm + d);
        let per_sine = turn_over_sine::<4, f32>(d * inverse) * inverse;
        (d >= 0.0).then_some(per_sine * normal.dot(c))
    };
    let first = Vector::from(*first);
    let first_norm = distance(first);
    let (mut sum, mut from) = (0.0, (first, first_norm + first_norm));
    for next in others {
        let to = Vector::from(*next);
        let norm = distance(to);
        let Some(term) = term(from, to, norm) else {
            return 0.0;
        };
        (sum, from) = (sum + term, (to, norm + norm));
    }
    match term(from, first, first_norm) {
        Some(term) => sum + term,
        None => 0.0,
    }
}
