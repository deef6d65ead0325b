//! Everything that can go wrong, once, on load.

use core::fmt;

/// Why a table, a buffer or an input was refused.
///
/// Every variant says what was needed and what there was. After
/// [`Scene::load`](crate::scene::Scene::load) and
/// [`Light::new`](crate::shoot::Light::new) have succeeded, only a caller's
/// own argument (a surface that does not exist, a slice that is too short) can
/// be refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Error {
    /// The bytes are no isolux tables.
    NotTables,
    /// The tables are of a format version this kernel does not read.
    Version {
        /// Version in the tables.
        found: u32,
        /// Version this kernel reads.
        supported: u32,
    },
    /// The tables are longer or shorter than their header says.
    Length {
        /// Bytes the header asks for.
        needed: u32,
        /// Bytes there are.
        have: u32,
    },
    /// The tables do not start at a multiple of four bytes.
    Misaligned,
    /// A byte of the tables changed since they were baked.
    Checksum {
        /// Checksum in the header.
        stored: u32,
        /// Checksum of the bytes.
        computed: u32,
    },
    /// An index or a count in the tables points outside of what there is.
    Range {
        /// Which records.
        what: What,
        /// Position of the record among its kind.
        record: u32,
    },
    /// A number in the tables, or one of a caller's, is not finite or outside of its
    /// domain.
    Number {
        /// Which records.
        what: What,
        /// Position of the record among its kind.
        record: u32,
    },
    /// The scene is larger than the type that was to hold it.
    Capacity {
        /// Which records.
        what: What,
        /// How many the scene has.
        needed: u32,
        /// How many the type holds.
        have: u32,
    },
    /// There is no such surface, sample or row.
    Unknown {
        /// Which records.
        what: What,
        /// The index asked for.
        asked: u32,
        /// How many there are.
        have: u32,
    },
    /// A caller's slice is shorter than the answer.
    Slice {
        /// Elements needed.
        needed: u32,
        /// Elements the slice has.
        have: u32,
    },
    /// A receiver's position or normal is not finite, or its normal is zero.
    Receiver,
}

/// The kinds of records an [`Error`] speaks of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum What {
    /// The header.
    Header,
    /// Surfaces.
    Surfaces,
    /// Samples.
    Samples,
    /// Emitters.
    Emitters,
    /// Emitters that emit by themselves.
    Luminaires,
    /// Loops of emitters.
    Loops,
    /// Vertices of loops.
    Vertices,
    /// Reflectances.
    Reflectances,
    /// Emitted radiosities.
    Exitances,
    /// The emitters' own coordinates.
    Shapes,
    /// The samples an emitter's radiosity is had from.
    Members,
    /// What those samples weigh.
    Weights,
    /// Things that hide others.
    Occluders,
    /// Faces of occluders.
    Faces,
    /// Edges of occluders.
    Edges,
    /// Vertices of occluders.
    Places,
    /// What can hide emitters.
    Blockers,
    /// Pieces of an emitter that wait to be looked at.
    Pieces,
    /// Lines that occluders cut an emitter along.
    Lines,
    /// Channels of light.
    Channels,
    /// Coefficients of an emitter's radiosity.
    Coefficients,
    /// Rows of a grid.
    Rows,
    /// Corners of polygons in the plane.
    Corners,
    /// How samples receive from secondary emitters.
    Codes,
    /// What samples see of luminaires.
    Fractions,
    /// Fields that a surface's irradiance is the sum of.
    Fields,
    /// Tensor grids.
    Tensors,
    /// Numbers of the tensors' matrices.
    Matrices,
    /// Meshes.
    Meshes,
    /// Nodes of meshes.
    Nodes,
    /// Triangles of meshes.
    Triangles,
    /// What samples contribute to nodes.
    Shares,
    /// Named points.
    Points,
    /// Terms of the matrix.
    Terms,
    /// Bits of a term's factor.
    Bits,
    /// Scales of terms or responses.
    Scales,
    /// What samples receive of a luminaire's light, reflected light included.
    Responses,
}

impl fmt::Display for What {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Header => "header",
            Self::Surfaces => "surfaces",
            Self::Samples => "samples",
            Self::Emitters => "emitters",
            Self::Luminaires => "luminaires",
            Self::Loops => "loops",
            Self::Vertices => "vertices",
            Self::Reflectances => "reflectances",
            Self::Exitances => "exitances",
            Self::Shapes => "shapes",
            Self::Members => "members",
            Self::Weights => "weights",
            Self::Occluders => "occluders",
            Self::Faces => "faces",
            Self::Edges => "edges",
            Self::Places => "places",
            Self::Blockers => "blockers",
            Self::Pieces => "pieces",
            Self::Lines => "lines",
            Self::Channels => "channels",
            Self::Coefficients => "coefficients",
            Self::Rows => "rows",
            Self::Corners => "corners",
            Self::Codes => "codes",
            Self::Fractions => "visible fractions",
            Self::Fields => "fields",
            Self::Tensors => "tensors",
            Self::Matrices => "matrices",
            Self::Meshes => "meshes",
            Self::Nodes => "nodes",
            Self::Triangles => "triangles",
            Self::Shares => "shares",
            Self::Points => "named points",
            Self::Terms => "terms of the matrix",
            Self::Bits => "bits of a term",
            Self::Scales => "scales",
            Self::Responses => "responses",
        })
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotTables => f.write_str("these bytes are no isolux tables"),
            Self::Version { found, supported } => write!(
                f,
                "tables of version {found}; this kernel reads version {supported}: bake the scene again"
            ),
            Self::Length { needed, have } => {
                write!(f, "the tables need {needed} bytes, there are {have}")
            }
            Self::Misaligned => {
                f.write_str("the tables must start at a multiple of 4 bytes (scene::Aligned)")
            }
            Self::Checksum { stored, computed } => write!(
                f,
                "checksum {computed:08x}, the header says {stored:08x}: the tables changed since they were baked"
            ),
            Self::Range { what, record } => {
                write!(f, "{what}: record {record} points outside of the tables")
            }
            Self::Number { what, record } => write!(
                f,
                "{what}: record {record} has a number that is not finite or out of its domain"
            ),
            Self::Capacity { what, needed, have } => {
                write!(f, "the scene has {needed} {what}, the type holds {have}")
            }
            Self::Unknown { what, asked, have } => {
                write!(f, "{what}: {asked} asked for, there are {have}")
            }
            Self::Slice { needed, have } => {
                write!(f, "the answer has {needed} values, the slice {have}")
            }
            Self::Receiver => f.write_str(
                "a receiver needs a finite position and a finite normal that is not zero",
            ),
        }
    }
}

impl core::error::Error for Error {}
