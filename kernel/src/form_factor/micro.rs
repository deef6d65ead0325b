//! Eq. 3 through micromath.

use super::{Arithmetic, Outline};
use crate::clip::{self, Edges, Place};
use crate::geometry::{Receiver, Vector};
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

struct Sum {
    normal: Vector<f32>,
    total: f32,
}

impl Sum {
    #[inline(never)]
    fn edge(&mut self, a: Vector<f32>, b: Vector<f32>) {
        let c = a.cross(b);
        let sine = F32Ext::sqrt(c.norm_squared());
        if sine > 0.0 {
            let angle = F32Ext::atan2(sine, a.dot(b));
            self.total += angle * self.normal.dot(c) / sine;
        }
    }
}

impl Edges<f32, Place<f32>> for Sum {
    fn whole(&mut self, from: &Place<f32>, to: &Place<f32>) {
        self.edge(from.position, to.position);
    }

    fn cut(&mut self, from: &Place<f32>, to: &Place<f32>) {
        self.edge(from.position, to.position);
    }

    fn cap(&mut self, from: &Place<f32>, to: &Place<f32>) {
        self.edge(from.position, to.position);
    }
}

impl Arithmetic<f32> for Micromath {
    fn contour(receiver: &Receiver<f32>, _: Vector<f32>, outline: &Outline<'_, f32>) -> f32 {
        let corners = outline.vertices().iter().map(|&vertex| {
            let position = Vector::from(vertex) - receiver.position();
            Place {
                position,
                height: receiver.normal().dot(position),
            }
        });
        let mut sum = Sum {
            normal: receiver.normal(),
            total: 0.0,
        };
        clip::walk(corners, &mut sum);
        sum.total
    }
}
