//! A loop of unit vectors summed edge by edge: the integer form of the
//! half-angle sum with exact horizon caps.
//!
//! With unit vectors a and b and d = a·b, half an edge's term is
//!
//! ```text
//! d ≥ 0   h(q)/(1 + d) n·(a×b),                 q = (1 − d)/(1 + d)
//! d < 0   (π/2 − τ h(τ²)) n·(a×b)/|a×b|,        τ = |a×b|/(1 − d)
//! ```
//!
//! The first needs one division and no root. The second, for edges seen under
//! more than 90°, takes the supplement's angle and the direction of a×b, which
//! is normalised from its full 64 bits.
//!
//! The horizon crosses the arc from a to b where a |n·b| + b |n·a| points: the
//! lengths of the vertices have cancelled, so that it does not matter from
//! which endpoint the crossing is computed, nor how far away either is.

use super::direction::{coarse, difference, dot, product, unit};
use super::{Coordinate, Format, Plane, Receiver};
use crate::clip::{self, Corner, Edges};
use crate::geometry::Vector;
use crate::number::fixed_point::{reciprocal, scaled_arctangent_word, upper};

/// The direction of a vertex, and its sine over the horizon.
#[derive(Clone, Copy)]
struct Vertex<F> {
    direction: Vector<F>,
    height: F,
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
fn words<F: Format>(vector: Vector<F>) -> [i32; 3] {
    [vector.x, vector.y, vector.z].map(Format::to_bits)
}

/// Products of two words of `F`, back in `F`, rounded down.
#[inline(always)]
fn narrow<F: Format>(product: i64) -> i32 {
    (product.wrapping_shl(32 - F::FRACTION) >> 32) as i32
}

/// a×b in units of 2^(−2 `F::FRACTION`).
#[inline(always)]
fn cross(a: [i32; 3], b: [i32; 3]) -> [i64; 3] {
    [
        product(a[1], b[2]).wrapping_sub(product(a[2], b[1])),
        product(a[2], b[0]).wrapping_sub(product(a[0], b[2])),
        product(a[0], b[1]).wrapping_sub(product(a[1], b[0])),
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

/// A fraction in units of 2^−30 as one in units of 2^−32, the largest for 1.
#[inline(always)]
fn fraction(word: u32) -> u32 {
    (if word < ONE { word } else { ONE - 1 }) << 2
}

/// h of the degree that suits `F`.
#[inline(always)]
fn arctangent<F: Format>(q: u32) -> u32 {
    if F::DEGREE == 5 {
        scaled_arctangent_word::<5>(q)
    } else {
        scaled_arctangent_word::<8>(q)
    }
}

/// Half the angle of which `sine` and `d` are sine and cosine, in `F`.
#[inline(always)]
fn half_angle<F: Format>(sine: u32, d: i64) -> i32 {
    /// π/2 in units of 2^−30.
    const QUARTER_TURN: u32 = 1_686_629_713;
    let sine = if sine < ONE { sine } else { ONE };
    let tangent = upper(sine << 1, reciprocal(ONE.wrapping_add(cosine::<F>(d)))); // 2^−30
    let q = fraction(upper(tangent << 1, tangent << 1));
    let half = upper(arctangent::<F>(q), tangent);
    let half = if d < 0 {
        QUARTER_TURN.wrapping_sub(half)
    } else {
        half
    };
    (half >> (30 - F::FRACTION)) as i32
}

/// What the edges are summed against.
struct HalfAngle<'a, F> {
    normal: Vector<F>,
    plane: &'a Plane,
}

impl<F: Format> HalfAngle<'_, F> {
    /// γ/2 n·(a×b)/|a×b| in units of 2^(−2 `F::FRACTION`).
    #[inline(always)]
    fn edge(&self, a: Vertex<F>, b: Vertex<F>) -> i64 {
        let (a, b) = (words(a.direction), words(b.direction));
        let d = dot(a, b);
        let c = cross(a, b);
        if d < 0 {
            return self.beyond_a_right_angle(c, d);
        }
        let cosine = cosine::<F>(d);
        let inverse = reciprocal(ONE.wrapping_add(cosine)); // 2^−31
        let q = fraction(upper((ONE - cosine) << 1, inverse));
        let per_sine = upper(arctangent::<F>(q), inverse) >> (31 - F::FRACTION);
        let sine = narrow::<F>(dot(words(self.normal), c.map(narrow::<F>)));
        product(sine, per_sine as i32)
    }

    #[cold]
    #[inline(never)]
    fn beyond_a_right_angle(&self, c: [i64; 3], d: i64) -> i64 {
        let axis = words(unit::<F>(c));
        let sine = dot(axis, c.map(narrow::<F>)).unsigned_abs() >> (2 * F::FRACTION - 30);
        let along = narrow::<F>(dot(words(self.normal), axis));
        product(along, half_angle::<F>(sine as u32, d))
    }
}

impl<F: Format> Edges<F, Vertex<F>> for HalfAngle<'_, F> {
    type Sum = i64;

    #[inline(always)]
    fn whole(&self, sum: i64, from: Vertex<F>, to: Vertex<F>) -> i64 {
        sum.wrapping_add(self.edge(from, to))
    }

    #[inline(never)]
    fn cut(&self, sum: i64, [from, to]: [Vertex<F>; 2], _: [Vertex<F>; 2]) -> i64 {
        sum.wrapping_add(self.edge(from, to))
    }

    /// ±γ/2. The sign is that of n·(a×b); where the cap is seen under nearly
    /// 180° and that drowns in rounding, that of (b − a)·(m×n), m being the
    /// normal of the emitter's plane: along the line in which that plane meets
    /// the horizon, directions are in the same order as places.
    #[inline(never)]
    fn cap(&self, sum: i64, from: Vertex<F>, to: Vertex<F>) -> i64 {
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
pub(super) fn contour<F: Format, C: Coordinate>(
    receiver: &Receiver<F>,
    plane: &Plane,
    outline: &[[C; 3]],
) -> i64 {
    let normal = words(receiver.normal);
    let corners = outline.iter().map(|&vertex| {
        let place = vertex.map(Into::into);
        let to = difference(place, receiver.position).map(|along| along.wrapping_shl(room::<C>()));
        let direction = unit(to);
        let height = F::from_bits(narrow::<F>(dot(normal, words(direction))));
        Vertex { direction, height }
    });
    let edges = HalfAngle {
        normal: receiver.normal,
        plane,
    };
    clip::walk(corners, &edges, 0)
}
