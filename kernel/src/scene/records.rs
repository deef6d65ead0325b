//! The records of the table format, as they lie in flash.

use crate::geometry::Vector;
use core::mem::{offset_of, size_of};
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
    /// How many there are of everything.
    pub counts: Counts,
    /// What a workspace must hold so that visibility is exact at every sample.
    pub sight: Sight,
    /// Distance in metres within which a place lies on a plane: 1e-6 of the
    /// largest absolute coordinate of the scene.
    pub tolerance: f32,
    /// The part, below 1, of light that is still to come that an emitter of linear
    /// radiosity may send ahead of it: 0 in scenes that much light leaves.
    pub ahead: f32,
}

// The offsets that the format is specified with.
const _: () = assert!(
    offset_of!(Header, version) == 8
        && offset_of!(Header, bytes) == 12
        && offset_of!(Header, checksum) == 16
        && offset_of!(Header, counts) == 20
        && offset_of!(Header, sight) == 144
        && offset_of!(Header, tolerance) == 160
        && offset_of!(Header, ahead) == 164
        && size_of::<Header>() == 168
);

/// The capacities of [`Exact`](crate::visibility::Exact) that a scene was
/// planned for; all 0 where nothing occludes.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, FromBytes, IntoBytes, Immutable, KnownLayout,
)]
#[repr(C)]
pub struct Sight {
    /// Corners of a piece.
    pub vertices: u32,
    /// Pieces that wait.
    pub pieces: u32,
    /// Lines kept.
    pub lines: u32,
    /// Blockers kept.
    pub blockers: u32,
}

impl Header {
    /// That of a scene with nothing in it.
    pub(super) const EMPTY: Self = Self {
        magic: super::MAGIC,
        version: super::VERSION,
        bytes: 0,
        checksum: 0,
        counts: Counts::NONE,
        sight: Sight {
            vertices: 0,
            pieces: 0,
            lines: 0,
            blockers: 0,
        },
        tolerance: 0.0,
        ahead: 0.0,
    };
}

/// The largest weight of a member that tables may hold: sums of weighted irradiances stay
/// finite. Least squares over n members give weights of about 1/n.
pub const HEAVIEST: f32 = 64.0;

/// How many records each section has, in the order of the sections.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, FromBytes, IntoBytes, Immutable, KnownLayout,
)]
#[repr(C)]
pub struct Counts {
    /// Channels: 1 where all light is grey, else 3.
    pub channels: u32,
    /// Coefficients of an emitter's radiosity: 1 where it is constant, 3 where
    /// it is linear.
    pub coefficients: u32,
    /// Surfaces.
    pub surfaces: u32,
    /// Emitters that emit by themselves; they come first.
    pub luminaires: u32,
    /// Emitters in all.
    pub emitters: u32,
    /// Shapes: one an emitter, or none.
    pub shapes: u32,
    /// Loops of emitters.
    pub loops: u32,
    /// Vertices of loops.
    pub vertices: u32,
    /// Corners: one a vertex, or none.
    pub corners: u32,
    /// Occluders.
    pub occluders: u32,
    /// Faces of occluders.
    pub faces: u32,
    /// Edges of occluders.
    pub edges: u32,
    /// Vertices of occluders.
    pub places: u32,
    /// Entries of the emitters' lists of what can hide them.
    pub blockers: u32,
    /// Samples.
    pub samples: u32,
    /// Members of emitters.
    pub members: u32,
    /// Weights: as many as coefficients for each member; none where radiosities
    /// are plain means.
    pub weights: u32,
    /// Codes: one for each secondary emitter and each sample that receives
    /// reflected light, or none.
    pub codes: u32,
    /// Visible fractions: one for each luminaire and each sample that receives
    /// direct light, or none.
    pub fractions: u32,
    /// Fields that surfaces are reconstructed from.
    pub fields: u32,
    /// Tensor grids.
    pub tensors: u32,
    /// Numbers of the tensors' matrices.
    pub matrices: u32,
    /// Meshes.
    pub meshes: u32,
    /// Nodes of meshes.
    pub nodes: u32,
    /// Triangles of meshes.
    pub triangles: u32,
    /// What samples contribute to nodes.
    pub shares: u32,
    /// Values that the reconstruction of a surface needs room for, at the most.
    pub room: u32,
    /// Named points: each a surface record behind the surfaces, with one sample.
    pub points: u32,
    /// Terms of the matrix: one for each secondary emitter and each sample that
    /// receives reflected light, or none.
    pub terms: u32,
    /// Bits of a term's factor, as many as its place has: 4, 6 or 8; 0 where there
    /// is no matrix.
    pub bits: u32,
    /// Responses: one for each luminaire, channel and sample, or none.
    pub responses: u32,
}

impl Counts {
    /// Whether the host wrote down what is seen, in place of occluders.
    pub const fn is_coded(&self) -> bool {
        self.codes > 0 || self.fractions > 0 || self.terms > 0 || self.responses > 0
    }

    /// Of nothing.
    pub(crate) const NONE: Self = Self {
        channels: 0,
        coefficients: 0,
        surfaces: 0,
        luminaires: 0,
        emitters: 0,
        shapes: 0,
        loops: 0,
        vertices: 0,
        corners: 0,
        occluders: 0,
        faces: 0,
        edges: 0,
        places: 0,
        blockers: 0,
        samples: 0,
        members: 0,
        weights: 0,
        codes: 0,
        fractions: 0,
        fields: 0,
        tensors: 0,
        matrices: 0,
        meshes: 0,
        nodes: 0,
        triangles: 0,
        shares: 0,
        room: 0,
        points: 0,
        terms: 0,
        bits: 0,
        responses: 0,
    };
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
    /// Radius of the cone filter in metres; 0 where there are no samples.
    pub filter_radius: f32,
    /// Where its samples begin.
    pub first_sample: u32,
    /// How many samples it has in all.
    pub samples: u32,
    /// How many of them, the first, receive only from luminaires, ...
    pub direct: u32,
    /// ... and how many, the others, only from what reflects. Both are 0 where
    /// every sample receives all light.
    pub indirect: u32,
    /// How many of the samples for direct light, the first, look past what
    /// occludes.
    pub unshadowed: u32,
    /// Where the fields begin whose sum its irradiance is, ...
    pub first_field: u32,
    /// ... and how many there are; 0 where the cone filter spreads the samples.
    pub fields: u32,
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
    /// How many samples its radiosity is had from; 0 for a luminaire.
    pub members: u32,
    /// Area in m².
    pub area: f32,
}

/// The coordinates (a, b) of an emitter: x = O + a e_1 + b e_2, with O on its
/// surface and e_1, e_2 along the surface's axes, both of length `scale`.
///
/// Present where radiosities are linear or something occludes.
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
#[repr(C)]
pub struct Shape {
    /// O in the frame of the surface, in metres: the centroid of the emitter.
    pub center: [f32; 2],
    /// Distance in metres from O to the farthest corner.
    pub scale: f32,
    /// Where the list of what can hide the emitter begins.
    pub first_blocker: u32,
    /// How many entries it has.
    pub blockers: u32,
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
    let mix = |hash: u32, word: u32| (hash ^ word).wrapping_mul(0x0100_0193);
    let hash = words.iter().fold(0x811c_9dc5, |hash, word| {
        mix(hash, u32::from_le_bytes(*word))
    });
    if tail.is_empty() {
        return hash;
    }
    let from_last = tail.iter().rev();
    mix(
        hash,
        from_last.fold(0, |word, &byte| word << 8 | u32::from(byte)),
    )
}
