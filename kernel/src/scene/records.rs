//! The records of the table format, as they lie in flash.

use crate::geometry::Vector;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// The head of the tables.
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Header {
    /// [`MAGIC`](super::MAGIC).
    pub magic: [u8; 8],
    /// [`VERSION`](super::VERSION).
    pub version: u32,
    /// Length of the tables in bytes, header included.
    pub bytes: u32,
    /// [`checksum`] of everything behind this field.
    pub checksum: u32,
    /// How many surfaces.
    pub surfaces: u32,
    /// How many emitters.
    pub emitters: u32,
    /// How many loops.
    pub loops: u32,
    /// How many vertices.
    pub vertices: u32,
    /// How many samples.
    pub samples: u32,
    /// How many members.
    pub members: u32,
    /// Distance in metres within which a place lies on a plane: 1e-6 of the
    /// largest absolute coordinate of the scene.
    pub tolerance: f32,
}

/// A surface: its frame, its reflectance, its samples.
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Surface {
    /// Corner (0, 0) of the bounding rectangle, in metres.
    pub origin: [f32; 3],
    /// Unit vector of the coordinate u.
    pub axis_u: [f32; 3],
    /// Unit vector of the coordinate v; `axis_u` × `axis_v` is the normal.
    pub axis_v: [f32; 3],
    /// Unit normal of the front.
    pub normal: [f32; 3],
    /// Width and height of the bounding rectangle, in metres.
    pub size: [f32; 2],
    /// Diffuse reflectance, 0 ≤ ρ < 1.
    pub reflectance: f32,
    /// Radius of the cone filter in metres; 0 where there are no samples.
    pub filter_radius: f32,
    /// Where its samples begin.
    pub first_sample: u32,
    /// How many samples it has.
    pub samples: u32,
}

impl Surface {
    /// The place in space, in metres, of coordinates in the surface's frame.
    #[inline]
    pub fn place(&self, [u, v]: [f32; 2]) -> Vector<f32> {
        Vector::from(self.origin) + Vector::from(self.axis_u) * u + Vector::from(self.axis_v) * v
    }
}

/// A polygon that shoots light: a luminaire, or a secondary emitter.
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
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
    /// How many samples its irradiance is the mean of; 0 for a luminaire.
    pub members: u32,
    /// Emitted radiosity π L in W m⁻² (lm m⁻²); 0 for a secondary emitter.
    pub exitance: f32,
    /// Reflectance it returns its members' mean irradiance with.
    pub reflectance: f32,
    /// Area in m².
    pub area: f32,
}

/// A closed loop of vertices.
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Loop {
    /// Where its vertices begin.
    pub first_vertex: u32,
    /// How many vertices it has, at least 3.
    pub vertices: u32,
    /// Squared distance in m² from the first vertex to the farthest other one.
    pub reach_squared: f32,
}

/// FNV-1a over the 32-bit little-endian words of `bytes`; a tail shorter than
/// a word counts as if filled up with zeros.
///
/// Detects every change of a single word; not a defence against forgery. Five
/// instructions a word.
pub fn checksum(bytes: &[u8]) -> u32 {
    let (words, tail) = bytes.as_chunks::<4>();
    let mut last = [0; 4];
    for (to, from) in last.iter_mut().zip(tail) {
        *to = *from;
    }
    words
        .iter()
        .chain((!tail.is_empty()).then_some(&last))
        .fold(0x811c_9dc5, |hash, word| {
            (hash ^ u32::from_le_bytes(*word)).wrapping_mul(0x0100_0193)
        })
}
