//! Eq. 3 through micromath.

use super::{Arithmetic, Outline, TURN, places};
use crate::clip::{self, Edges, Place};
use crate::geometry::{Receiver, Vector};
use crate::number::SoftRoot;
use micromath::F32Ext;

/// The rung `micromath`: γ = atan2(|v_i × v_{i+1}|, v_i · v_{i+1}), with
/// micromath's arc tangent and square root.
///
/// A yardstick: |error of F| up to 5e-2 (the root alone errs by 6 %, the arc
/// tangent by 3e-3), and more instructions than [`Poly3`](super::Poly3), which is
/// 200 times better. Needs the feature `micromath`. Its functions are called by
/// their trait, never as methods: where std is linked, as in a crate's own tests,
/// `x.sqrt()` is std's, and a test would measure another function than is
/// shipped.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Micromath;

struct ArcTangents {
    normal: Vector<f32>,
}

impl ArcTangents {
    #[inline(never)]
    fn add(&self, sum: f32, a: Vector<f32>, b: Vector<f32>) -> f32 {
        let c = a.cross(b);
        let sine = F32Ext::sqrt(c.norm_squared());
        if sine <= 0.0 {
            return sum; // the receiver is on the edge or its line
        }
        sum + F32Ext::atan2(sine, a.dot(b)) * self.normal.dot(c) / sine
    }
}

impl Edges<f32, Place<f32>> for ArcTangents {
    type Sum = f32;

    fn whole(&self, sum: f32, from: Place<f32>, to: Place<f32>) -> f32 {
        self.add(sum, from.position, to.position)
    }

    fn cut(&self, sum: f32, [from, to]: [Place<f32>; 2], _: [Place<f32>; 2]) -> f32 {
        self.add(sum, from.position, to.position)
    }

    fn cap(&self, sum: f32, from: Place<f32>, to: Place<f32>) -> f32 {
        self.add(sum, from.position, to.position)
    }
}

impl Arithmetic<f32> for Micromath {
    type Root = SoftRoot;

    fn contour(receiver: &Receiver<f32>, _: Vector<f32>, outline: &Outline<'_, f32>) -> f32 {
        let edges = ArcTangents {
            normal: receiver.normal(),
        };
        clip::walk(places(receiver, outline), &edges, 0.0) * TURN as f32
    }
}
