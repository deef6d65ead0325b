//! A loop of unit vectors summed edge by edge: the integer form of the
//! sum by Snell's quotient with exact horizon caps.
//!
//! With unit vectors a and b and d = a·b, half an edge's term is
//!
//! ```text
//! d ≥ 0   s(x)/2t n·(a×b),                      t = 2 + d, x = d/t
//! d < 0   (π/2 − |a×b| s(x)/2t) n·(a×b)/|a×b|,  t = 2 − d, x = −d/t
//! ```
//!
//! with s of [`turn_over_sine`](crate::number::turn_over_sine) in radians. The first needs one division and no root. The second, for edges seen under
//! more than 90°, takes the supplement's angle and the direction of a×b, which
//! is normalised from its full 64 bits.
//!
//! The horizon crosses the arc from a to b where a |n·b| + b |n·a| points: the
//! lengths of the vertices have cancelled, so that it does not matter from
//! which endpoint the crossing is computed, nor how far away either is.

use super::direction::{coarse, difference, dot, product, unit};
use super::{Coordinate, Format, Plane, Receiver, wide};
use crate::clip::Corner;
use crate::geometry::Vector;
use crate::number::fixed_point::{quarter_angle_over_sine, reciprocal, upper};

/// The direction of a vertex, and its sine over the horizon.
#[derive(Clone, Copy)]
pub(super) struct Vertex<F> {
    pub(super) direction: Vector<F>,
    pub(super) height: F,
}

impl<F: Format> Vertex<F> {
    /// A place seen from the receiver.
    #[inline(always)]
    pub(super) fn new<C: Coordinate>(receiver: &Receiver<F>, place: &[C; 3]) -> Self {
        let to = difference(place.map(Into::into), receiver.position);
        let direction = unit(to.map(|along| along.wrapping_shl(room::<C>())));
        let height = dot(words(receiver.normal), words(direction));
        Self {
            direction,
            height: F::from_bits(narrow::<F>(height)),
        }
    }
}

impl<F: Format> Vertex<F> {
    /// A crossing.
    pub(super) fn on_horizon(direction: Vector<F>) -> Self {
        Self {
            direction,
            height: F::ZERO,
        }
    }
}

impl<F: Format> Corner<F> for Vertex<F> {
    #[inline(always)]
    fn height(&self) -> F {
        self.height
    }

    /// Both endpoints of an edge are on the unit sphere.
    #[inline(always)]
    fn farness(&self) -> F {
        F::ONE
    }

    /// The crossing's direction; the heights say where it is more exactly than
    /// their quotient does.
    #[inline]
    fn toward(&self, other: &Self, _: F) -> Self {
        let (near, far) = (self.height.to_bits(), other.height.to_bits());
        let (near, far) = (near.wrapping_abs(), far.wrapping_abs());
        let (a, b) = (words(self.direction), words(other.direction));
        let between = |a, b| product(a, far).wrapping_add(product(b, near));
        Self {
            direction: unit([
                between(a[0], b[0]),
                between(a[1], b[1]),
                between(a[2], b[2]),
            ]),
            height: F::ZERO,
        }
    }
}

/// A vector's words.
#[inline(always)]
pub(super) fn words<F: Format>(vector: Vector<F>) -> [i32; 3] {
    [vector.x, vector.y, vector.z].map(Format::to_bits)
}

/// Products of two words of `F`, back in `F`, rounded down.
#[inline(always)]
pub(super) fn narrow<F: Format>(product: i64) -> i32 {
    (product.wrapping_shl(32 - F::FRACTION) >> 32) as i32
}

/// a×b in units of 2^(−2 `F::FRACTION`).
#[inline(always)]
pub(super) fn cross(a: [i32; 3], b: [i32; 3]) -> [i64; 3] {
    // Products are added up as they come, a difference would keep both.
    let minus = a.map(i32::wrapping_neg);
    [
        product(a[1], b[2]).wrapping_add(product(minus[2], b[1])),
        product(a[2], b[0]).wrapping_add(product(minus[0], b[2])),
        product(a[0], b[1]).wrapping_add(product(minus[1], b[0])),
    ]
}

/// 1 in units of 2^−30.
const ONE: u32 = 1 << 30;

/// |d| of a product of `F`, at most 1, in units of 2^−30.
#[inline(always)]
fn cosine<F: Format>(d: i64) -> u32 {
    let magnitude = d.unsigned_abs() >> (2 * F::FRACTION - 30);
    if magnitude < u64::from(ONE) {
        magnitude as u32
    } else {
        ONE
    }
}

/// Half an angle of up to 90° over its sine, from its [`cosine`], in units of
/// 2^−31: s(x)/2t with t = 2 + d and x = d/t.
#[inline(always)]
fn half_per_sine<F: Format>(cosine: u32) -> u32 {
    let inverse = reciprocal(ONE.wrapping_add(cosine >> 1)); // 2/t, 2^−31
    let twice = upper(cosine << 1, inverse) << 2; // 2x, 2^−32
    let quarter = if F::DEGREE == 4 {
        quarter_angle_over_sine::<4>(twice)
    } else {
        quarter_angle_over_sine::<6>(twice)
    };
    upper(quarter, inverse)
}

/// Half the angle of which `sine`, in units of 2^−30, and `d` are sine and
/// cosine, in `F`.
#[inline(always)]
pub(super) fn half_angle<F: Format>(sine: u32, d: i64) -> i32 {
    /// π/2 in units of 2^−30.
    const QUARTER_TURN: u32 = 1_686_629_713;
    let sine = if sine < ONE { sine } else { ONE };
    let half = upper(half_per_sine::<F>(cosine::<F>(d)) << 1, sine); // 2^−30
    let half = if d < 0 {
        QUARTER_TURN.wrapping_sub(half)
    } else {
        half
    };
    (half >> (30 - F::FRACTION)) as i32
}

/// What the edges are summed against.
pub(super) struct Snell<'a, F> {
    pub(super) normal: Vector<F>,
    plane: &'a Plane,
}

impl<'a, F: Format> Snell<'a, F> {
    pub(super) fn new(receiver: &Receiver<F>, plane: &'a Plane) -> Self {
        Self {
            normal: receiver.normal,
            plane,
        }
    }

    /// γ/2 n·(a×b)/|a×b| in units of 2^(−2 `F::FRACTION`); `None` where the edge is
    /// seen under nearly 180°.
    #[inline(always)]
    fn edge(&self, a: Vertex<F>, b: Vertex<F>) -> Option<i64> {
        let (from, to) = (words(a.direction), words(b.direction));
        let d = dot(from, to);
        if d < 0 {
            let ([ax, ay, az], [bx, by, bz]) = (from, to);
            return self.unless_wide(ax, ay, az, bx, by, bz);
        }
        Some(self.acute(from, to, d))
    }

    /// The same of any edge, or part of one.
    #[inline(never)]
    pub(super) fn any_edge(&self, a: Vertex<F>, b: Vertex<F>) -> i64 {
        let (from, to) = (words(a.direction), words(b.direction));
        let d = dot(from, to);
        if d < 0 {
            self.beyond_a_right_angle(from, to)
        } else {
            self.acute(from, to, d)
        }
    }

    /// The same where the edge is seen under at most 90°.
    #[inline(always)]
    fn acute(&self, from: [i32; 3], to: [i32; 3], d: i64) -> i64 {
        let sine = dot(words(self.normal), cross(from, to).map(narrow::<F>));
        let per_sine = half_per_sine::<F>(cosine::<F>(d)) >> (31 - F::FRACTION);
        product(narrow::<F>(sine), per_sine as i32)
    }

    /// The same where it is seen under more than 90°. The coordinates come one by
    /// one so that the usual way need not put them in memory.
    #[cold]
    #[inline(never)]
    fn unless_wide(&self, ax: i32, ay: i32, az: i32, bx: i32, by: i32, bz: i32) -> Option<i64> {
        let (a, b) = ([ax, ay, az], [bx, by, bz]);
        if wide::is_wide::<F>(cross(a, b)) {
            return None;
        }
        Some(self.beyond_a_right_angle(a, b))
    }

    /// The same where it is seen under more than 90°.
    #[inline]
    fn beyond_a_right_angle(&self, a: [i32; 3], b: [i32; 3]) -> i64 {
        let (d, c) = (dot(a, b), cross(a, b));
        let axis = words(unit::<F>(c));
        let sine = dot(axis, c.map(narrow::<F>)).unsigned_abs() >> (2 * F::FRACTION - 30);
        let along = narrow::<F>(dot(words(self.normal), axis));
        product(along, half_angle::<F>(sine as u32, d))
    }

    /// ±γ/2. The sign is that of n·(a×b); where the cap is seen under nearly
    /// 180° and that drowns in rounding, that of (b − a)·(m×n), m being the
    /// normal of the emitter's plane: along the line in which that plane meets
    /// the horizon, directions are in the same order as places.
    #[inline(never)]
    pub(super) fn along_horizon(&self, sum: i64, from: Vertex<F>, to: Vertex<F>) -> i64 {
        let normal = words(self.normal);
        let (a, b) = (words(from.direction), words(to.direction));
        let d = dot(a, b);
        let c = cross(a, b).map(narrow::<F>);
        let signed = narrow::<F>(dot(normal, c));
        let sine = signed.unsigned_abs() << (30 - F::FRACTION);
        let half = half_angle::<F>(sine, d);
        let mut sign = i64::from(signed);
        if d < 0 && sine < ONE >> 8 {
            let along = coarse(cross(self.plane.coarse, normal));
            let step = coarse(difference(b.map(i64::from), a.map(i64::from)));
            sign = dot(along, step);
        }
        let half = i64::from(half) << F::FRACTION;
        if sign < 0 {
            sum.wrapping_sub(half)
        } else {
            sum.wrapping_add(half)
        }
    }
}

/// Bits by which the difference of two coordinates may be shifted: those of
/// words need it for their directions to be found on the short way.
const fn room<C>() -> u32 {
    if size_of::<C>() <= 4 { 29 } else { 0 }
}

/// Half of Σ γ_i n·unit(v_i × v_{i+1}) over the part of the loop above the
/// horizon, in units of 2^(−2 `F::FRACTION`).
///
/// As long as the loop is above it and has no edge towards 180°, nothing is called;
/// from the first vertex or edge that is otherwise, the rest is summed with care.
pub(super) fn contour<F: Format, C: Coordinate>(
    receiver: &Receiver<F>,
    plane: &Plane,
    outline: &[[C; 3]],
) -> i64 {
    let Some((first, others)) = outline.split_first() else {
        return 0;
    };
    let edges = Snell::new(receiver, plane);
    let first = Vertex::new(receiver, first);
    let (mut sum, mut from, mut ahead) = (0_i64, first, others.iter());
    let mut left = others.len();
    if first.height >= F::ZERO {
        left = loop {
            let Some(next) = ahead.next() else {
                match edges.edge(from, first) {
                    Some(term) => return sum.wrapping_add(term),
                    None => break 0,
                }
            };
            let to = Vertex::new(receiver, next);
            let term = if to.height < F::ZERO {
                None
            } else {
                edges.edge(from, to)
            };
            let Some(term) = term else {
                break ahead.len().wrapping_add(1);
            };
            (sum, from) = (sum.wrapping_add(term), to);
        };
    }
    wide::rest(receiver, &edges, outline, [first, from], left, sum)
}
