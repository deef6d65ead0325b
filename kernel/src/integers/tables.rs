//! The integer tables as they lie in flash.
//!
//! Little-endian, 4-byte aligned. A header, then without gaps
//!
//! | section | record | bytes each |
//! | --- | --- | --- |
//! | surfaces | [`Surface`], the named points behind the surfaces | 84 |
//! | reflectances | `u32`, one a surface, in 2⁻³² | 4 |
//! | emitters | [`Emitter`] | 24 |
//! | exitances | `i32`, one a luminaire, not below 0 | 4 |
//! | loops | [`Loop`] | 8 |
//! | vertices | `[i32; 3]` | 12 |
//! | samples | `[i32; 2]`, in the frame of their surface | 8 |
//! | weights | `[i32; 3]`, of the coefficients of a linear radiosity, one a member, in 2⁻²⁴ | 12 |
//! | members | `u16` sample indices, padded to 4 bytes with 0 | 2 |
//! | scales | `u32`, of terms, one a receiver, in 2^−(31 + 2 bits) | 4 |
//! | fractions | `u16`, in 65 535ths, padded to 4 bytes with 0 | 2 |
//! | terms | [`Term`](crate::scene::Term), 2 bits a bit of its factor, padded to 4 bytes with 0 | 1, 1½ or 2 |
//!
//! Orders and meanings are those of [`scene`](crate::scene). Where radiosities are constant
//! there are no weights, scales, fractions and terms; where they are linear what reflects
//! has terms and needs no loops.

use crate::scene::matrix;
use crate::scene::records::Counts;
use crate::scene::{even, receiving};
use core::mem::size_of;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// The version of the format that this kernel reads.
pub const VERSION: u32 = 2;

/// The first eight bytes of integer tables.
pub const MAGIC: [u8; 8] = *b"isoluxi\n";

/// The largest [`Header::shift`].
pub const LARGEST_SHIFT: u32 = 16;

/// The head of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Header {
    /// [`MAGIC`].
    pub magic: [u8; 8],
    /// [`VERSION`].
    pub version: u32,
    /// Length of the tables in bytes, header included.
    pub bytes: u32,
    /// [`checksum`](crate::scene::records::checksum) of everything behind this
    /// field.
    pub checksum: u32,
    /// How many there are of everything: one channel, and nothing of what only the
    /// floating-point tables have.
    pub counts: Counts,
    /// Binary logarithm of the unit of length in metres.
    pub length: i32,
    /// Binary logarithm of the unit of irradiance in W m⁻².
    pub irradiance: i32,
    /// By how many powers of two the unit of exitance is larger than that of
    /// irradiance; at most [`LARGEST_SHIFT`].
    pub shift: u32,
    /// Distance within which a place lies on a plane: 1e-6 of the largest
    /// absolute coordinate.
    pub tolerance: i32,
}

impl Header {
    /// Binary logarithm of the unit of exitance in W m⁻².
    pub(super) fn exitance(&self) -> i32 {
        self.irradiance.saturating_add_unsigned(self.shift)
    }

    /// That of a scene with nothing in it.
    pub(super) const EMPTY: Self = Self {
        magic: MAGIC,
        version: VERSION,
        bytes: 0,
        checksum: 0,
        counts: Counts::NONE,
        length: 0,
        irradiance: 0,
        shift: 0,
        tolerance: 0,
    };
}

/// A surface: its frame and its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Surface {
    /// Corner (0, 0) of the bounding rectangle.
    pub origin: [i32; 3],
    /// Unit vector of the coordinate u, in 2⁻³⁰.
    pub axis_u: [i32; 3],
    /// Unit vector of the coordinate v, in 2⁻³⁰.
    pub axis_v: [i32; 3],
    /// Unit normal of the front, in 2⁻³⁰.
    pub normal: [i32; 3],
    /// Width and height of the bounding rectangle.
    pub size: [i32; 2],
    /// Radius of the cone filter; 0 where there are no samples.
    pub filter_radius: i32,
    /// Where its samples begin.
    pub first_sample: u32,
    /// How many samples it has in all.
    pub samples: u32,
    /// How many of them, the first, receive only from luminaires, ...
    pub direct: u32,
    /// ... and how many, the others, only from what reflects. Both are 0 where every
    /// sample receives all light.
    pub indirect: u32,
}

impl Surface {
    /// The place in space of coordinates in the surface's frame, each
    /// coordinate rounded to nearest.
    #[inline]
    pub fn place(&self, [u, v]: [i32; 2]) -> [i64; 3] {
        let along = |origin: i32, axis_u: i32, axis_v: i32| {
            let (u, v) = (i64::from(u), i64::from(v));
            let offset = i64::from(axis_u)
                .wrapping_mul(u)
                .wrapping_add(i64::from(axis_v).wrapping_mul(v));
            let rounded = offset.wrapping_add(1 << 29) >> 30;
            rounded.wrapping_add(i64::from(origin))
        };
        let ([x, y, z], [ux, uy, uz], [vx, vy, vz]) = (self.origin, self.axis_u, self.axis_v);
        [along(x, ux, vx), along(y, uy, vy), along(z, uz, vz)]
    }
}

/// A polygon that shoots light: a luminaire, or a secondary emitter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Emitter {
    /// The surface it lies on.
    pub surface: u32,
    /// Where its loops begin.
    pub first_loop: u32,
    /// How many loops it has.
    pub loops: u32,
    /// Where its members begin.
    pub first_member: u32,
    /// How many samples its radiosity is the mean of; 0 for a luminaire.
    pub members: u32,
    /// Area, in a unit that all emitters share: only ratios of powers are asked
    /// for.
    pub area: u32,
}

/// A closed loop of vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Loop {
    /// Where its vertices begin.
    pub first_vertex: u32,
    /// How many vertices it has, at least 3.
    pub vertices: u32,
}

/// Bytes of integer tables with these counts: what a bake writes and
/// [`Scene::load`](super::Scene::load) demands. `None` where they exceed 4 GiB.
pub const fn required_bytes(counts: &Counts) -> Option<u32> {
    let weighted = if counts.weights > 0 {
        counts.members
    } else {
        0
    };
    let sections = [
        (receiving(counts) as u64, size_of::<Surface>() as u64),
        (counts.surfaces as u64, 4),
        (counts.emitters as u64, size_of::<Emitter>() as u64),
        (counts.luminaires as u64, 4),
        (counts.loops as u64, size_of::<Loop>() as u64),
        (counts.vertices as u64, 12),
        (counts.samples as u64, 8),
        (weighted as u64, 12),
        (even(counts.members) as u64, 2),
        (matrix::scales(counts) as u64, 4),
        (even(counts.fractions) as u64, 2),
        (matrix::bytes(counts), 1),
    ];
    // Twelve products below 2^40.
    let mut bytes = size_of::<Header>() as u64;
    let mut rest: &[(u64, u64)] = &sections;
    while let [(count, size), others @ ..] = rest {
        bytes = bytes.saturating_add(count.saturating_mul(*size));
        rest = others;
    }
    if bytes <= u32::MAX as u64 {
        Some(bytes as u32)
    } else {
        None
    }
}
