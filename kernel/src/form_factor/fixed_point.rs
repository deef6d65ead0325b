//! Form factors in integers, for cores without a floating-point unit: the
//! rungs [`Q29`] and [`Q24`].
//!
//! A form factor does not depend on the unit of length, so places come as
//! integers with a common scale, a power of two ([`Scale`]). From there on only
//! directions matter: of every vertex the kernel takes the difference to the
//! receiver, exactly, and normalises it to a unit vector with 29 or 24 bits
//! after the point. The horizon cuts the arcs between the unit vectors; the
//! edge's term is Snell's quotient corrected by a polynomial, as in floating
//! point, in words of 32 bits whose products have 64.
//!
//! No floating-point operation is reachable from here. [`Scale`] reads
//! coordinates given as `f32` by their bits.
//!
//! # Domain
//!
//! Coordinates are integers of magnitude up to 2^58: the scale that
//! [`Scale::of`] finds keeps them within. Tables in which coordinates are `i32`
//! always are. Up to 128 vertices a polygon. Outside of that, values are
//! meaningless, in [0, 1] all the same. Nothing here panics, whatever the
//! integers.
//!
//! # Errors
//!
//! |error of F| ≤ 5e-8 (`Q29`) and 5e-6 (`Q24`) in every position in front of the
//! emitter; 1.1e-8 and 5.7e-7 at the most in a million positions of all kinds, of
//! which the angle's fit has 5.4e-9 and 3.9e-7. Close to an edge too, which unit
//! vectors in words alone would miss by 1e-9 L/h (3e-8 L/h): there its plane comes
//! from the integers themselves.
//!
//! The errors are absolute, and there is no relative accuracy below F = 1e-6
//! (1e-4).
//!
//! # Cost
//!
//! Some 200 instructions an edge on a Cortex-M4, 243 cycles of the model (`Q24`: 231),
//! its translation and the horizon's test included, and about 170 a polygon; one division of 32 by
//! 32 bits an edge, no table.

mod contour;
mod direction;
mod wide;

pub use crate::number::fixed_point::{Format, Q24, Q29};

use crate::Error;
use crate::geometry::Vector;
use crate::number::fixed_point::reciprocal_root;
use direction::{coarse, difference, dot, exact, unit};

/// A coordinate that is an integer: `i32` in tables, `i64` where the scale
/// needs more bits.
pub trait Coordinate: Copy + Into<i64> {}

impl<C: Copy + Into<i64>> Coordinate for C {}

/// What an integer coordinate is worth: a power of two in metres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Scale {
    /// The biased exponent of the largest coordinate, at least 1.
    largest: u32,
}

/// Bits of a coordinate, its sign apart.
const BITS: u32 = 58;

impl Scale {
    /// The finest scale on which all these coordinates, in metres, fit in 58
    /// bits and a sign; `None` where one is infinite or NaN.
    ///
    /// Of the receiver and the polygon together, or of a whole scene. Reads the
    /// bits of the coordinates and computes in integers.
    pub fn of(coordinates: impl IntoIterator<Item = f32>) -> Option<Self> {
        let mut largest = 1;
        for coordinate in coordinates {
            let biased = biased_exponent(coordinate.to_bits());
            if biased == 0xff {
                return None;
            }
            if biased > largest {
                largest = biased;
            }
        }
        Some(Self { largest })
    }

    /// The binary logarithm of what 1 is worth in metres.
    pub fn exponent(self) -> i32 {
        (self.largest as i32).wrapping_sub(126 + BITS as i32)
    }

    /// The scale on which 1 is worth 2^`exponent` metres, at least 2^−183: what
    /// tables say of theirs.
    pub fn with_exponent(exponent: i32) -> Self {
        let largest = exponent.saturating_add(126 + BITS as i32);
        Self {
            largest: if largest > 1 { largest as u32 } else { 1 },
        }
    }

    /// A place in metres as integers of this scale.
    ///
    /// Exact for coordinates of at least 2^−35 of the largest the scale was
    /// made for; rounded to nearest, ties away from 0, below; saturated above.
    pub fn place(self, place: [f32; 3]) -> [i64; 3] {
        place.map(|coordinate| self.coordinate(coordinate.to_bits()))
    }

    fn coordinate(self, bits: u32) -> i64 {
        let biased = biased_exponent(bits);
        let fraction = i64::from(bits & 0x007f_ffff);
        let (mantissa, exponent) = match biased {
            0 => (fraction, 1),
            _ => (fraction | 0x0080_0000, biased),
        };
        let magnitude = if exponent > self.largest {
            1 << BITS
        } else {
            let below = self.largest.wrapping_sub(exponent);
            let doubled = mantissa << (BITS - 23);
            let drop = if below < 62 { below } else { 62 };
            (doubled >> drop).wrapping_add(1) >> 1
        };
        if bits >> 31 == 1 {
            -magnitude
        } else {
            magnitude
        }
    }
}

fn biased_exponent(bits: u32) -> u32 {
    (bits >> 23) & 0xff
}

/// A differential area that receives light, in integers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Receiver<F> {
    position: [i64; 3],
    normal: Vector<F>,
}

impl<F: Format> Receiver<F> {
    /// A receiver at a place of the polygon's scale, facing along a normal of
    /// any length and any scale, which is normalised here.
    ///
    /// # Errors
    /// [`Error::Receiver`] where the normal is zero.
    pub fn new<C: Coordinate>(position: [C; 3], normal: [C; 3]) -> Result<Self, Error> {
        let normal = normal.map(Into::into);
        if normal == [0; 3] {
            return Err(Error::Receiver);
        }
        Ok(Self {
            position: position.map(Into::into),
            normal: unit(normal),
        })
    }

    /// The same normal at another place.
    #[inline(always)]
    pub fn moved_to(self, position: [i64; 3]) -> Self {
        Self { position, ..self }
    }

    /// Its place, in its scale.
    #[inline(always)]
    pub fn position(&self) -> [i64; 3] {
        self.position
    }

    /// Its unit normal.
    #[inline(always)]
    pub fn normal(&self) -> Vector<F> {
        self.normal
    }
}

/// The oriented plane of a polygon, in integers; its front is where the
/// polygon's vertices are seen to run counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plane {
    normal: [i128; 3],
    /// The normal's direction, its largest coordinate 30 bits long.
    coarse: [i32; 3],
    point: [i64; 3],
}

impl Plane {
    /// The plane through a place with a normal of any length.
    pub fn new(point: [i32; 3], normal: [i32; 3]) -> Self {
        Self {
            normal: normal.map(i128::from),
            coarse: coarse(normal.map(i64::from)),
            point: point.map(i64::from),
        }
    }

    /// The plane of a polygon by Newell's method about its first vertex,
    /// exactly. A polygon of fewer than 3 vertices has no front.
    pub fn of_polygon<C: Coordinate>(vertices: &[[C; 3]]) -> Self {
        let mut normal = [0_i128; 3];
        let mut point = [0; 3];
        if let Some((&first, rest)) = vertices.split_first() {
            point = first.map(Into::into);
            let mut last = [0; 3];
            for &vertex in rest {
                let offset = difference(vertex.map(Into::into), point);
                normal = exact::sum(normal, exact::cross(last, offset));
                last = offset;
            }
        }
        Self {
            normal,
            coarse: exact::coarse(normal),
            point,
        }
    }

    /// Whether a place is in front of the plane, decided exactly.
    ///
    /// Words of 30 bits decide, unless the height is within what they cannot
    /// tell from 0; then the exact product of up to 186 bits does.
    pub fn is_before(&self, place: [i64; 3]) -> bool {
        let to = difference(place, self.point);
        let height = dot(self.coarse, coarse(to));
        // Both words are rounded down: a product of two of up to 2^30 misses at
        // most 2^31 + 1, and there are three.
        if height.unsigned_abs() > 1 << 33 {
            return height > 0;
        }
        exact::is_positive_product(self.normal, to)
    }
}

/// The form factor of a polygon seen from a receiver, 0 ≤ F ≤ 1, on the same
/// scale as the receiver's position.
///
/// `vertices` of a planar simple polygon, convex or not, counter-clockwise seen
/// from its emitting side. 0 where the receiver is on or behind the polygon's
/// plane, where the polygon is below its horizon, and where there are fewer
/// than 3 vertices. Errors: those of the table above. Never panics.
pub fn form_factor<F: Format, C: Coordinate>(receiver: &Receiver<F>, vertices: &[[C; 3]]) -> F {
    let plane = Plane::of_polygon(vertices);
    of_loops(receiver, &plane, core::iter::once(vertices))
}

/// The form factor of a planar polygon of several loops, 0 ≤ F ≤ 1: pieces
/// counter-clockwise seen from the front of `plane`, holes clockwise.
///
/// As [`form_factor`] otherwise.
pub fn of_loops<'a, F: Format, C: Coordinate + 'a>(
    receiver: &Receiver<F>,
    plane: &Plane,
    outlines: impl Iterator<Item = &'a [[C; 3]]>,
) -> F {
    if !plane.is_before(receiver.position) {
        return F::ZERO;
    }
    let mut sum = 0_i64;
    for outline in outlines {
        sum = sum.wrapping_add(contour::contour(receiver, plane, outline));
    }
    fraction(sum)
}

/// −1/π of a sum of half the edges' terms, clamped to [0, 1].
fn fraction<F: Format>(sum: i64) -> F {
    /// 1/π in units of 2^−29.
    const PER_PI: u64 = 170_891_319;
    let turned = sum.wrapping_neg() >> (2 * F::FRACTION - 32); // 2^−32
    if turned <= 0 {
        return F::ZERO;
    }
    // More than π is more than 1.
    let turned = if turned < 1 << 34 {
        turned as u64
    } else {
        1 << 34
    };
    let scaled = turned.wrapping_mul(PER_PI); // 2^−61
    let rounded = (scaled >> (60 - F::FRACTION)).wrapping_add(1) >> 1;
    let one = 1 << F::FRACTION;
    F::from_bits(if rounded < one {
        rounded as i32
    } else {
        one as i32
    })
}
