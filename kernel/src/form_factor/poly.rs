//! The rungs without a special case for small emitters.

use super::{Arithmetic, Outline, narrow, snell};
use crate::geometry::{Receiver, Vector};
use crate::number::{Floating, Root, SoftRoot};
use core::marker::PhantomData;

/// The rungs `poly3`, `poly5` and `poly8`: Snell's quotient corrected by a
/// polynomial of degree 2, 4 and 8
/// ([`turn_over_sine`](crate::number::turn_over_sine)), with exact horizon
/// caps. They are named after the degree that would take with the tangent of half
/// the angle in place of Snell's variable.
///
/// Bounds of |error of F| in `f32`: 5e-5, 6.5e-7 and 2.5e-7, of which the fit
/// has 4.6e-5, 3.9e-7 and 6e-11 and rounding the rest (the largest of a million
/// positions: 4.6e-5, 6.1e-7, 2.3e-7); in all positions, next to
/// an edge too, see [`Best`](super::Best). In `f32` the eighth degree is no better
/// than the sixth that `Best` takes; it is for `f64`, where it errs by 6e-11. No
/// relative accuracy is promised: for an emitter of angular radius s the
/// rounding alone is of order u/s², so F below 1e-6 has few right digits and
/// below 1e-12 none. Past 90° an edge's angle is π less its supplement's, which
/// keeps the fit inside its domain for every loop.
///
/// A loop whose vertices are seen within 22.5° of the first one has no edge above
/// 45°, and is summed without a root: Snell's quotient of twice an edge's angle
/// takes the squares of the vertices' distances alone. The fit, and so the bounds,
/// are the same; an edge takes 17 estimated cycles less on a Cortex-M4F (81 for 98
/// of `poly5`), and with [`SoftRoot`] two instructions of five less.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Poly<const DEGREE: usize, R = SoftRoot>(PhantomData<R>);

/// The rung `poly3`: |error of F| ≤ 5e-5, for previews and 8-bit output.
pub type Poly3<R = SoftRoot> = Poly<2, R>;

/// The rung `poly5`: |error of F| ≤ 6.5e-7.
pub type Poly5<R = SoftRoot> = Poly<4, R>;

/// The rung `poly8`: |error of F| ≤ 2.5e-7.
pub type Poly8<R = SoftRoot> = Poly<8, R>;

impl<const DEGREE: usize, N: Floating, R: Root<N> + Copy> Arithmetic<N> for Poly<DEGREE, R> {
    type Root = R;

    #[inline]
    fn contour(receiver: &Receiver<N>, facing: Vector<N>, outline: &Outline<'_, N>) -> N {
        if super::is_small(receiver, outline) {
            narrow::contour::<DEGREE, N, R>(receiver, facing, outline)
        } else {
            snell::contour::<DEGREE, N, R>(receiver, facing, outline)
        }
    }
}
