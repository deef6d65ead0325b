//! The rungs without a special case for small emitters.

use super::{Arithmetic, Outline, snell};
use crate::geometry::{Receiver, Vector};
use crate::number::{Floating, Root, SoftRoot};
use core::marker::PhantomData;

/// The rungs `poly3`, `poly5` and `poly8`: half-angle tangents whose arc tangent
/// is a polynomial of that degree, with exact horizon caps.
///
/// Bounds of |error of F| in `f32`: 2.2e-4, 4.5e-6 and 2.5e-7, where a polygon
/// fills the view and every edge is where the fit errs most; half of it
/// otherwise; next to an edge 0.03 u L/h more, see [`Best`](super::Best). No
/// relative accuracy is promised: for an emitter of angular radius s the
/// rounding alone is of order u/s², so F below 1e-6 has few right digits and
/// below 1e-12 none. Past 90° an edge's angle is π less its supplement's, which
/// keeps the fit inside its domain for every loop.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Poly<const DEGREE: usize, R = SoftRoot>(PhantomData<R>);

/// The rung `poly3`: |error of F| ≤ 2.2e-4, for previews and 8-bit output.
pub type Poly3<R = SoftRoot> = Poly<3, R>;

/// The rung `poly5`: |error of F| ≤ 4.5e-6.
pub type Poly5<R = SoftRoot> = Poly<5, R>;

/// The rung `poly8`: |error of F| ≤ 2.5e-7.
pub type Poly8<R = SoftRoot> = Poly<8, R>;

impl<const DEGREE: usize, N: Floating, R: Root<N> + Copy> Arithmetic<N> for Poly<DEGREE, R> {
    type Root = R;

    #[inline]
    fn contour(receiver: &Receiver<N>, facing: Vector<N>, outline: &Outline<'_, N>) -> N {
        snell::contour::<DEGREE, N, R>(receiver, facing, outline)
    }
}
