//! Vectors, planes, the receiver of light.

use crate::Error;
use crate::number::{Floating, Number, Root, difference_of_products};
use core::ops::{Add, Mul, Sub};

/// A vector or a place in space, in metres where it is a place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Vector<N> {
    /// First coordinate.
    pub x: N,
    /// Second coordinate.
    pub y: N,
    /// Third coordinate.
    pub z: N,
}

impl<N: Number> Vector<N> {
    /// The zero vector.
    pub const ZERO: Self = Self {
        x: N::ZERO,
        y: N::ZERO,
        z: N::ZERO,
    };

    /// a·b. Exact to 3 roundings of the largest product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> N {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// a×b.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// |a|².
    #[inline(always)]
    pub fn norm_squared(self) -> N {
        self.dot(self)
    }

    /// No coordinate is infinite or NaN.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }
}

impl<N: Floating> Vector<N> {
    /// a×b with every coordinate to within two roundings of itself, also where
    /// a and b are nearly parallel. 120 operations.
    #[inline]
    pub fn accurate_cross(self, other: Self) -> Self {
        Self {
            x: difference_of_products(self.y, other.z, self.z, other.y),
            y: difference_of_products(self.z, other.x, self.x, other.z),
            z: difference_of_products(self.x, other.y, self.y, other.x),
        }
    }

    /// What rounding takes from every coordinate of `self - other`, exactly
    /// (Knuth 1969).
    #[inline]
    pub fn rest_of_difference(self, other: Self) -> Self {
        let rest = |a: N, b: N| {
            let difference = a - b;
            let subtracted = difference - a;
            (a - (difference - subtracted)) - (b + subtracted)
        };
        Self {
            x: rest(self.x, other.x),
            y: rest(self.y, other.y),
            z: rest(self.z, other.z),
        }
    }
}

impl<N> From<[N; 3]> for Vector<N> {
    #[inline(always)]
    fn from([x, y, z]: [N; 3]) -> Self {
        Self { x, y, z }
    }
}

impl<N> From<Vector<N>> for [N; 3] {
    #[inline(always)]
    fn from(v: Vector<N>) -> Self {
        [v.x, v.y, v.z]
    }
}

impl<N: Number> Add for Vector<N> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
            z: self.z + other.z,
        }
    }
}

impl<N: Number> Sub for Vector<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            z: self.z - other.z,
        }
    }
}

impl<N: Number> Mul<N> for Vector<N> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: N) -> Self {
        Self {
            x: self.x * factor,
            y: self.y * factor,
            z: self.z * factor,
        }
    }
}

/// An oriented plane: all x with normal·(x − point) = 0; its front is where
/// that is positive.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plane<N> {
    /// Normal, of any length.
    pub normal: Vector<N>,
    /// A place on the plane.
    pub point: Vector<N>,
}

impl<N: Number> Plane<N> {
    /// The plane of a polygon by Newell's method about its first vertex; the
    /// normal's length is twice the area. A polygon of fewer than 3 vertices
    /// has normal 0. Never panics.
    pub fn of_polygon(vertices: &[[N; 3]]) -> Self {
        let Some((&first, rest)) = vertices.split_first() else {
            return Self {
                normal: Vector::ZERO,
                point: Vector::ZERO,
            };
        };
        let point = Vector::from(first);
        let mut normal = Vector::ZERO;
        let mut last = Vector::ZERO;
        for &vertex in rest {
            let offset = Vector::from(vertex) - point;
            normal = normal + last.cross(offset);
            last = offset;
        }
        Self { normal, point }
    }

    /// normal·(x − point): positive in front, scaled by the normal's length.
    #[inline(always)]
    pub fn height(&self, place: Vector<N>) -> N {
        self.normal.dot(place - self.point)
    }
}

/// A differential area that receives light.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Receiver<N> {
    position: Vector<N>,
    normal: Vector<N>,
}

impl<N: Number> Receiver<N> {
    /// A receiver at a place, facing along a normal of any length, which is
    /// normalised here.
    ///
    /// # Errors
    /// [`Error::Receiver`] where a coordinate is not finite or the normal has
    /// no direction that this number can hold.
    pub fn new<R: Root<N>>(position: [N; 3], normal: [N; 3]) -> Result<Self, Error> {
        let (position, normal) = (Vector::from(position), Vector::from(normal));
        // Scaling by the largest coordinate keeps the squares representable.
        let (x, y, z) = (normal.x.abs(), normal.y.abs(), normal.z.abs());
        let larger = if x > y { x } else { y };
        let largest = if larger > z { larger } else { z };
        if !(position.is_finite() && normal.is_finite() && largest > N::ZERO) {
            return Err(Error::Receiver);
        }
        let scaled = Vector {
            x: normal.x / largest,
            y: normal.y / largest,
            z: normal.z / largest,
        };
        let unit = scaled * (N::ONE / R::sqrt(scaled.norm_squared()));
        if unit.is_finite() {
            Ok(Self {
                position,
                normal: unit,
            })
        } else {
            Err(Error::Receiver)
        }
    }

    /// A receiver whose normal is known to be finite and of unit length, as
    /// the surfaces of checked tables are.
    #[inline(always)]
    pub(crate) fn of_unit(position: Vector<N>, normal: Vector<N>) -> Self {
        Self { position, normal }
    }

    /// Position in metres.
    #[inline(always)]
    pub fn position(&self) -> Vector<N> {
        self.position
    }

    /// Unit normal.
    #[inline(always)]
    pub fn normal(&self) -> Vector<N> {
        self.normal
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::SoftRoot;

    #[test]
    fn normals_of_any_length_are_normalised() {
        for length in [1e-30_f32, 1e-3, 1.0, 1e30] {
            let receiver = Receiver::new::<SoftRoot>([0.0; 3], [3.0 * length, 0.0, -4.0 * length]);
            let normal = receiver.map(|receiver| receiver.normal());
            assert!(
                normal.is_ok_and(|n| (n.x - 0.6).abs() < 1e-7 && (n.z + 0.8).abs() < 1e-7),
                "{length:e}"
            );
        }
    }

    #[test]
    fn receivers_without_a_direction_are_refused() {
        for normal in [[0.0; 3], [f32::NAN, 0.0, 1.0], [f32::INFINITY, 0.0, 1.0]] {
            assert_eq!(
                Receiver::new::<SoftRoot>([0.0; 3], normal),
                Err(Error::Receiver)
            );
        }
        assert_eq!(
            Receiver::new::<SoftRoot>([0.0, f32::NAN, 0.0], [0.0, 0.0, 1.0]),
            Err(Error::Receiver)
        );
    }

    #[test]
    fn the_plane_of_a_polygon_faces_its_counter_clockwise_side() {
        let plane = Plane::of_polygon(&[[0.0_f32, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0]]);
        assert_eq!(
            plane.normal,
            Vector {
                x: 0.0,
                y: 0.0,
                z: 1.0
            }
        );
        assert!(
            plane.height(Vector {
                x: 5.0,
                y: 5.0,
                z: 3.0
            }) > 0.0
        );
    }
}
