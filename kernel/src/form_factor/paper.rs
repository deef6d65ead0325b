//! Eq. 3 of the paper, corrected, through libm.

use super::{Arithmetic, Outline, TURN, places};
use crate::clip::{self, Edges, Place};
use crate::geometry::{Receiver, Vector};
use crate::number::{ArcCosine, Root, SoftRoot};
use core::marker::PhantomData;

/// The rung `libm`: γ = acos(unit v_i · unit v_{i+1}) for every edge of the
/// clipped loop, with libm's arc cosine.
///
/// A yardstick: acos loses half of the digits of a small angle, so the error
/// of F in `f32` is 4e-7 at best, 2e-5 for emitters that fill the view, and the
/// relative error is of order u/s³ for an emitter of angular radius s: nothing
/// is right about F < 1e-6. Caps are ordinary edges here; a receiver close to
/// the emitter's plane loses up to 4e-4. Three times the cost of
/// [`Best`](super::Best).
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Libm<R = SoftRoot>(PhantomData<R>);

struct ArcCosines<N, R> {
    normal: Vector<N>,
    root: PhantomData<R>,
}

impl<N: ArcCosine, R: Root<N>> ArcCosines<N, R> {
    #[inline(never)]
    fn add(&self, sum: N, a: Vector<N>, b: Vector<N>) -> N {
        let norms = R::sqrt(a.norm_squared()) * R::sqrt(b.norm_squared());
        let c = a.cross(b);
        let sine = R::sqrt(c.norm_squared());
        if norms <= N::ZERO || sine <= N::ZERO {
            return sum; // the receiver is on the edge or its line
        }
        let cosine = a.dot(b) / norms;
        let cosine = if cosine > N::ONE {
            N::ONE
        } else if cosine < -N::ONE {
            -N::ONE
        } else {
            cosine
        };
        sum + cosine.acos() * self.normal.dot(c) / sine
    }
}

impl<N: ArcCosine, R: Root<N>> Edges<N, Place<N>> for ArcCosines<N, R> {
    type Sum = N;

    fn whole(&self, sum: N, from: Place<N>, to: Place<N>) -> N {
        self.add(sum, from.position, to.position)
    }

    fn cut(&self, sum: N, [from, to]: [Place<N>; 2], _: [Place<N>; 2]) -> N {
        self.add(sum, from.position, to.position)
    }

    fn cap(&self, sum: N, from: Place<N>, to: Place<N>) -> N {
        self.add(sum, from.position, to.position)
    }
}

impl<N: ArcCosine, R: Root<N> + Copy> Arithmetic<N> for Libm<R> {
    type Root = R;

    fn contour(receiver: &Receiver<N>, _: Vector<N>, outline: &Outline<'_, N>) -> N {
        let edges = ArcCosines::<N, R> {
            normal: receiver.normal(),
            root: PhantomData,
        };
        clip::walk(places(receiver, outline), &edges, N::ZERO) * N::of(TURN)
    }
}
