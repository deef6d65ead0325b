//! The paper's visibility: rays to the emitter's vertices.

use super::records::{Blocker, Occluders, Target};
use super::view::{Shadow, View, number};
use super::{Bracket, Capacities, Looked, Sum, Visibility};
use crate::geometry::Receiver;
use crate::number::{Floating, Root};

/// The rung `vertex-rays`: the fraction of the emitter's vertices that a ray
/// from the receiver reaches, times the unoccluded form factor.
///
/// The paper's. It does not converge: at the edge of a shadow it is off by any
/// factor, however many receivers there are; for comparison only. Of an
/// emitter with more than 32 vertices the first 32 are asked. Cost: a quarter
/// to a half of [`Exact`](super::Exact) with one occluder. No workspace.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct VertexRays;

impl VertexRays {
    /// The fraction of the target's vertices that rays reach.
    fn fraction<N: Floating>(
        receiver: &Receiver<N>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
    ) -> N {
        let Some(view) = View::<N>::new(receiver, target, occluders.flat) else {
            return N::ZERO;
        };
        // One bit a vertex: whether it is hidden. What hides it is in front of
        // the emitter's plane, so that the lines alone decide.
        let all = target
            .corners
            .iter()
            .take(32)
            .fold(0_u32, |bits, _| bits << 1 | 1);
        let mut hidden = 0_u32;
        for blocker in blockers {
            let mut inside = all;
            let shadow = view.shadow(occluders, &blocker, |line| {
                for (bit, corner) in (0_u32..32).zip(target.corners) {
                    let within = line.height(corner.map(number)) > N::ZERO;
                    if !within {
                        inside &= !1_u32.wrapping_shl(bit);
                    }
                }
                inside != 0
            });
            if shadow != Shadow::None {
                hidden |= inside;
            }
            if hidden == all {
                return N::ZERO;
            }
        }
        let count = |bits: u32| N::of(f64::from(bits.count_ones()));
        count(all & !hidden) / count(all)
    }
}

impl<N: Floating> Visibility<N> for VertexRays {
    fn form_factor<R: Root<N> + Copy>(
        &mut self,
        receiver: &Receiver<N>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        unoccluded: impl FnOnce() -> N,
    ) -> Bracket<N> {
        let fraction = Self::fraction(receiver, target, occluders, blockers);
        let seen = if fraction > N::ZERO {
            unoccluded() * fraction
        } else {
            N::ZERO
        };
        Bracket::exactly(seen)
    }

    fn look(
        &mut self,
        receiver: &Receiver<N>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        _: &mut impl Sum<N>,
    ) -> Looked<N> {
        let fraction = Self::fraction(receiver, target, occluders, blockers);
        if fraction > N::ZERO {
            Looked::Fraction(fraction)
        } else {
            Looked::Dark
        }
    }

    const CAPACITIES: Capacities = Capacities {
        occluders: true,
        vertices: u32::MAX,
        pieces: u32::MAX,
        lines: u32::MAX,
        blockers: u32::MAX,
    };
}
