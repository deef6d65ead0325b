//! Integer vectors, their directions, and what is decided exactly.

use super::{Format, reciprocal_root};
use crate::geometry::Vector;

/// a − b.
#[inline(always)]
pub(super) fn difference(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    [
        a[0].wrapping_sub(b[0]),
        a[1].wrapping_sub(b[1]),
        a[2].wrapping_sub(b[2]),
    ]
}

/// a·b.
#[inline(always)]
pub(super) fn dot(a: [i32; 3], b: [i32; 3]) -> i64 {
    product(a[0], b[0])
        .wrapping_add(product(a[1], b[1]))
        .wrapping_add(product(a[2], b[2]))
}

/// The product of two words, which 64 bits hold.
#[inline(always)]
pub(super) fn product(a: i32, b: i32) -> i64 {
    i64::from(a).wrapping_mul(i64::from(b))
}

/// The vector times the power of two that brings its largest coordinate to 30
/// bits and a sign, rounded down; 0 for 0.
#[inline(always)]
pub(super) fn coarse(vector: [i64; 3]) -> [i32; 3] {
    wide(vector).map(|word| word >> 1)
}

/// As [`coarse`], to 31 bits and a sign; −2^31 may occur.
#[inline(always)]
fn wide(vector: [i64; 3]) -> [i32; 3] {
    let upper = (largest(vector) >> 32) as u32;
    if upper == 0 {
        return small(vector);
    }
    // Nothing but the sign is left before the first bit.
    let shift = upper.leading_zeros().saturating_sub(1) & 31;
    vector.map(|coordinate| {
        let (upper, lower) = ((coordinate >> 32) as i32, coordinate as u32);
        // In two steps: a shift by 32 is none.
        (upper << shift) | ((lower >> 1) >> (31 - shift)) as i32
    })
}

/// A number with as many bits as the largest coordinate; of −2^k as of
/// 2^k − 1, which two's complement holds in as many.
#[inline(always)]
fn largest([x, y, z]: [i64; 3]) -> u64 {
    ((x ^ (x >> 63)) | (y ^ (y >> 63)) | (z ^ (z >> 63))) as u64
}

/// [`wide`] of a vector whose coordinates fit in 32 bits and a sign.
#[cold]
#[inline(never)]
fn small(vector: [i64; 3]) -> [i32; 3] {
    let shift = largest(vector).leading_zeros().saturating_sub(1);
    vector.map(|coordinate| (coordinate.wrapping_shl(shift) >> 32) as i32)
}

/// The unit vector along an integer vector; 0 for 0.
///
/// Each coordinate is within 1.5 units in the last place of `F`.
#[inline(always)]
pub(super) fn unit<F: Format>(vector: [i64; 3]) -> Vector<F> {
    let vector = wide(vector);
    // From 2^60 up to 3 · 2^62, unless the vector is 0. Its root wants the
    // upper word of an even power of two times it.
    let squared = dot(vector, vector) as u64;
    let upper = (squared >> 32) as u32;
    let (square, shift) = if upper < 1 << 30 {
        ((squared >> 30) as u32, 29)
    } else {
        (upper, 30)
    };
    // vector/|vector| is the vector times this, a 32-bit shift from `F`.
    let factor = reciprocal_root(square) >> (shift - F::FRACTION);
    let [x, y, z] = vector.map(|word| {
        let scaled = product(word, factor).wrapping_add(1 << 31) >> 32;
        F::from_bits(scaled as i32)
    });
    Vector { x, y, z }
}

/// Products of more than 64 bits: slow, and rarely needed.
pub(super) mod exact {
    fn wide_product(a: i64, b: i64) -> i128 {
        i128::from(a).wrapping_mul(i128::from(b))
    }

    /// a×b.
    pub(in super::super) fn cross(a: [i64; 3], b: [i64; 3]) -> [i128; 3] {
        let minor = |i: usize, j: usize| -> i128 {
            let (ai, aj) = (a.get(i).copied(), a.get(j).copied());
            let (bi, bj) = (b.get(i).copied(), b.get(j).copied());
            match (ai, aj, bi, bj) {
                (Some(ai), Some(aj), Some(bi), Some(bj)) => {
                    wide_product(ai, bj).wrapping_sub(wide_product(aj, bi))
                }
                _ => 0,
            }
        };
        [minor(1, 2), minor(2, 0), minor(0, 1)]
    }

    /// a + b.
    pub(in super::super) fn sum(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
        [
            a[0].wrapping_add(b[0]),
            a[1].wrapping_add(b[1]),
            a[2].wrapping_add(b[2]),
        ]
    }

    /// Whether a·b > 0, for |a| up to 2^126 and |b| up to 2^59.
    #[cold]
    #[inline(never)]
    pub(in super::super) fn is_positive_product(a: [i128; 3], b: [i64; 3]) -> bool {
        // a = upper 2^64 + lower, and so is the product.
        let (mut upper, mut lower) = (0_i128, 0_i128);
        for (a, b) in a.into_iter().zip(b) {
            upper = upper.wrapping_add(wide_product((a >> 64) as i64, b));
            lower = lower.wrapping_add(i128::from(a as u64).wrapping_mul(i128::from(b)));
        }
        let upper = upper.wrapping_add(lower >> 64);
        upper > 0 || (upper == 0 && lower as u64 != 0)
    }

    /// As [`super::coarse`].
    pub(in super::super) fn coarse(vector: [i128; 3]) -> [i32; 3] {
        let [x, y, z] = vector.map(i128::unsigned_abs);
        let shift = (x | y | z).leading_zeros().saturating_sub(1);
        vector.map(|coordinate| (coordinate.wrapping_shl(shift) >> 97) as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::fixed_point::{Q24, Q29};

    fn length<F: Format>(vector: Vector<F>) -> f64 {
        let [x, y, z] = [vector.x, vector.y, vector.z].map(|c| f64::from(c.to_bits()));
        libm::sqrt(x * x + y * y + z * z) / f64::from(1_u32 << F::FRACTION)
    }

    #[test]
    fn heights_of_one_unit_are_told_from_none() {
        let far = 1_i64 << 58;
        let normal = exact::cross([far, 0, 0], [0, far, 1]);
        // The plane z = y / 2^58.
        assert!(!exact::is_positive_product(normal, [0, far, 1]));
        assert!(exact::is_positive_product(normal, [0, far, 2]));
        assert!(!exact::is_positive_product(normal, [5, far, 0]));
        assert!(exact::is_positive_product(normal, [-far, far - 1, 1]));
        assert!(!exact::is_positive_product(normal, [far, 1 - far, -1]));
    }

    #[test]
    fn directions_are_of_unit_length_at_every_magnitude() {
        for shift in 0..60 {
            for pattern in [[1_i64, 0, 0], [-1, 1, 1], [3, -2, 7], [5, 5, 0]] {
                let vector = pattern.map(|c| c << shift);
                assert!(
                    (length::<Q29>(unit(vector)) - 1.0).abs() < 6e-9,
                    "{vector:?}"
                );
                assert!(
                    (length::<Q24>(unit(vector)) - 1.0).abs() < 2e-7,
                    "{vector:?}"
                );
            }
        }
        for extreme in [[i64::MIN; 3], [i64::MAX; 3], [i64::MIN, 0, i64::MAX]] {
            assert!((length::<Q29>(unit(extreme)) - 1.0).abs() < 6e-9);
        }
        assert_eq!(unit::<Q29>([0; 3]), Vector::ZERO);
    }
}
