//! The integer tables as they lie in flash.
//!
//! Little-endian, 4-byte aligned. A header, then without gaps surfaces,
//! reflectances (`u32`, one a surface), emitters, exitances (`u32`, one a
//! luminaire), loops, vertices (`[i32; 3]`), samples (`[i32; 2]`, in the frame of
//! their surface) and members (`u16` sample indices, padded to 4 bytes with 0).
//! Orders and meanings are those of [`scene`](crate::scene).

use crate::scene::records::Counts;
use core::mem::size_of;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// The version of the format that this kernel reads.
pub const VERSION: u32 = 1;

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
    /// How many there are of everything: one channel, one coefficient, and
    /// nothing of what only the floating-point tables have.
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
    /// How many samples it has.
    pub samples: u32,
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
    let members = counts.members as u64 + counts.members as u64 % 2;
    let sections = [
        (counts.surfaces as u64, size_of::<Surface>() as u64 + 4),
        (counts.emitters as u64, size_of::<Emitter>() as u64),
        (counts.luminaires as u64, 4),
        (counts.loops as u64, size_of::<Loop>() as u64),
        (counts.vertices as u64, 12),
        (counts.samples as u64, 8),
        (members, 2),
    ];
    // Seven products below 2^39.
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
