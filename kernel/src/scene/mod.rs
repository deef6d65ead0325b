//! The baked scene: tables borrowed from flash, checked once.
//!
//! [`Scene::load`] reads a byte string in place. It checks everything, the
//! checksum, every count, index and number, in time proportional to the
//! length; after that nothing can fail. The records are in [`records`]; the
//! whole format:
//!
//! # Format, version 6
//!
//! Little-endian, 4-byte aligned, no padding but where said. Every record has its
//! fields in the order in which its type declares them, without gaps; their units are
//! with them. A header ([`records::Header`]) of 168 bytes comes first:
//!
//! | offset | field | holds |
//! | ---: | --- | --- |
//! | 0 | `magic` | the eight bytes of [`MAGIC`] |
//! | 8 | `version` | `u32`, [`VERSION`] |
//! | 12 | `bytes` | `u32`, length of the tables, header included |
//! | 16 | `checksum` | `u32`, [`records::checksum`] of everything from offset 20 on |
//! | 20 | `counts` | 31 `u32`, [`records::Counts`] |
//! | 144 | `sight` | 4 `u32`, [`records::Sight`] |
//! | 160 | `tolerance` | `f32`, metres |
//! | 164 | `ahead` | `f32`, below 1 |
//!
//! Then follow, without gaps,
//!
//! | section | record | bytes each |
//! | --- | --- | --- |
//! | surfaces | [`records::Surface`], the named points behind the surfaces | 88 |
//! | reflectances | `f32`, one a surface and channel | 4 |
//! | emitters | [`records::Emitter`] | 24 |
//! | exitances | `f32`, π L in W m⁻², one a luminaire and channel | 4 |
//! | shapes | [`records::Shape`] | 20 |
//! | loops | [`records::Loop`] | 12 |
//! | vertices | `[f32; 3]`, metres | 12 |
//! | corners | `[f32; 2]`, the vertices in the coordinates of their emitter | 8 |
//! | occluders | [`Occluder`] | 32 |
//! | faces | [`Face`] | 16 |
//! | edges | [`Edge`] | 8 |
//! | places | `[f32; 3]`, the occluders' vertices in metres | 12 |
//! | blockers | [`Blocker`] | 8 |
//! | samples | `[f32; 2]`, metres in the surface's frame | 8 |
//! | weights | `f32`, one a coefficient of every member | 4 |
//! | members | `u16` sample indices, padded to 4 bytes with 0 | 2 |
//! | scales | `f32`, of terms one a receiver, of responses one a luminaire and channel | 4 |
//! | fractions or responses | `u16`, padded to 4 bytes with 0 | 2 |
//! | codes or terms | [`Code`], 2 a byte, or [`Term`], the first in the lowest bits, padded to 4 bytes with 0 | ½, 1, 1½ or 2 |
//! | fields | [`fields::Field`] | 8 |
//! | tensors | [`fields::Tensor`] | 52 |
//! | matrices | `f32`, what makes Chebyshev coefficients of values at nodes | 4 |
//! | meshes | [`fields::Mesh`] | 28 |
//! | nodes | [`fields::Node`] | 12 |
//! | shares | [`fields::Share`] | 4 |
//! | triangles | `[u16; 3]`, nodes of their mesh, padded to 4 bytes with 0 | 6 |
//!
//! Luminaires come first among the emitters and have no members. A secondary
//! emitter reflects, with its surface's reflectance, what its members receive:
//! the mean of them where radiosities are constant (no weights then), with one
//! weight a member the increment of a layer, or with three the mean and the two
//! gradients of a linear radiosity.
//! Shapes and corners are there where radiosities are linear or something
//! occludes; loops are then convex. Samples are ordered by surface, and on a
//! surface by what they receive.
//!
//! Tables with codes hold no occluders: what each sample sees of each emitter is
//! written in the fractions (luminaires, in 65 535ths) and codes (what reflects).
//! Both are ordered by emitter, and for one emitter by receiver; where there are codes
//! but no fractions, every luminaire is seen whole. Tables with a matrix have terms in
//! place of codes. Tables with responses hold luminaires alone, and for each of them
//! and each channel what every sample receives of its light in the end.
//!
//! A named point is written as a surface that neither emits nor reflects, of one
//! sample at its corner, which receives all light; such records come last.
//!
//! A secondary emitter without loops is a point at the centre of its shape. What
//! becomes of the samples' values between them is said with
//! [`resample`](crate::resample).

pub(crate) mod check;
mod coded;
pub mod fields;
pub(crate) mod matrix;
pub mod parts;
mod point;
mod received;
pub mod records;

pub(crate) use check::BRIGHTEST;
pub use coded::{Code, Method};
pub use matrix::{Response, Term};

use crate::Error;
use crate::error::What;
use crate::form_factor::{self, Arithmetic, Outline};
use crate::geometry::{Plane, Receiver, Vector};
use crate::luminance::Colour;
use crate::visibility::records::{Blocker, Edge, Face, Occluder, Occluders};
use core::mem::size_of;
use core::ops::Range;
use fields::{Field, Fields, Mesh, Node, Share, Tensor};
use records::{Counts, Emitter, Header, Loop, Shape, Sight, Surface};
use zerocopy::FromBytes;

/// The version of the format that this kernel reads.
pub const VERSION: u32 = 6;

/// The first eight bytes of every table.
pub const MAGIC: [u8; 8] = *b"isolux\r\n";

/// Gives its content the alignment that [`Scene::load`] asks for:
/// `static TABLES: Aligned<[u8; N]> = Aligned(*include_bytes!("tables.bin"))`.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(4))]
pub struct Aligned<T>(
    /// The content.
    pub T,
);

/// A checked scene, borrowed from its tables. Copying it copies a few slices.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'t> {
    header: &'t Header,
    surfaces: &'t [Surface],
    reflectances: &'t [f32],
    emitters: &'t [Emitter],
    exitances: &'t [f32],
    shapes: &'t [Shape],
    loops: &'t [Loop],
    vertices: &'t [[f32; 3]],
    corners: &'t [[f32; 2]],
    occluders: Occluders<'t>,
    blockers: &'t [Blocker],
    samples: &'t [[f32; 2]],
    weights: &'t [f32],
    members: &'t [u16],
    scales: &'t [f32],
    /// Fractions, or responses.
    fractions: &'t [u16],
    /// Codes, or terms.
    codes: &'t [u8],
    fields: Fields<'t>,
}

/// Splits `count` records off the front of `bytes`.
pub(crate) fn section<T: FromBytes + zerocopy::KnownLayout + zerocopy::Immutable>(
    bytes: &[u8],
    count: u32,
) -> Result<(&[T], &[u8]), Error> {
    <[T]>::ref_from_prefix_with_elems(bytes, count as usize).map_err(|_| Error::Range {
        what: What::Header,
        record: 0,
    })
}

impl<'t> Scene<'t> {
    /// A scene with nothing in it.
    pub const EMPTY: Self = Self {
        header: &Header::EMPTY,
        surfaces: &[],
        reflectances: &[],
        emitters: &[],
        exitances: &[],
        shapes: &[],
        loops: &[],
        vertices: &[],
        corners: &[],
        occluders: Occluders {
            occluders: &[],
            faces: &[],
            edges: &[],
            vertices: &[],
            flat: 0.0,
        },
        blockers: &[],
        samples: &[],
        weights: &[],
        members: &[],
        scales: &[],
        fractions: &[],
        codes: &[],
        fields: Fields::NONE,
    };

    /// Reads and checks baked tables in place; nothing is copied.
    ///
    /// Time: about 12 instructions a byte for the checksum, 20 a record.
    ///
    /// # Errors
    /// Every variant of [`Error`] that speaks of tables; see there.
    pub fn load(tables: &'t [u8]) -> Result<Self, Error> {
        Self::load_with::<{ parts::ALL }>(tables)
    }

    /// As [`load`](Self::load), of tables that have no [`parts`] but these: no check of
    /// others is linked. What a bake writes calls it with those of its tables.
    ///
    /// # Errors
    /// As [`load`](Self::load), and [`Error::Capacity`] where tables have other parts.
    pub fn load_with<const PARTS: u32>(tables: &'t [u8]) -> Result<Self, Error> {
        let (header, rest) = check::header(tables, &MAGIC, VERSION, |header: &Header| {
            required_bytes(&header.counts)
        })?;
        parts::within(PARTS, &header.counts)?;
        // Of parts that are not named there is nothing: the compiler is to know it.
        let of_part = |part: u32, count: u32| if PARTS & part == 0 { 0 } else { count };
        let hiding = |count| of_part(parts::OCCLUDERS, count);
        let written = |count| of_part(parts::WRITTEN, count);
        let made = |count| of_part(parts::FIELDS, count);
        let shaped = |count| of_part(parts::SHAPES, count);
        let counts = &header.counts;
        let (surfaces, rest) = section::<Surface>(rest, receiving(counts))?;
        let (reflectances, rest) =
            section::<f32>(rest, counts.surfaces.saturating_mul(counts.channels))?;
        let (emitters, rest) = section::<Emitter>(rest, counts.emitters)?;
        let (exitances, rest) =
            section::<f32>(rest, counts.luminaires.saturating_mul(counts.channels))?;
        let (shapes, rest) = section::<Shape>(rest, shaped(counts.shapes))?;
        let (loops, rest) = section::<Loop>(rest, counts.loops)?;
        let (vertices, rest) = section::<[f32; 3]>(rest, counts.vertices)?;
        let (corners, rest) = section::<[f32; 2]>(rest, shaped(counts.corners))?;
        let (occluders, rest) = section::<Occluder>(rest, hiding(counts.occluders))?;
        let (faces, rest) = section::<Face>(rest, hiding(counts.faces))?;
        let (edges, rest) = section::<Edge>(rest, hiding(counts.edges))?;
        let (places, rest) = section::<[f32; 3]>(rest, hiding(counts.places))?;
        let (blockers, rest) = section::<Blocker>(rest, hiding(counts.blockers))?;
        let (samples, rest) = section::<[f32; 2]>(rest, counts.samples)?;
        let (weights, rest) = section::<f32>(rest, counts.weights)?;
        let (members, rest) = section::<u16>(rest, even(counts.members))?;
        let (scales, rest) = section::<f32>(rest, written(matrix::scales(counts)))?;
        let fractions = written(counts.fractions.saturating_add(counts.responses));
        let (half_words, rest) = section::<u16>(rest, even(fractions))?;
        let codes = coded::bytes(counts).saturating_add(matrix::bytes(counts));
        let (codes, rest) = section::<u8>(rest, written(u32::try_from(codes).unwrap_or(u32::MAX)))?;
        let (fields, rest) = section::<Field>(rest, made(counts.fields))?;
        let (tensors, rest) = section::<Tensor>(rest, made(counts.tensors))?;
        let (matrices, rest) = section::<f32>(rest, made(counts.matrices))?;
        let (meshes, rest) = section::<Mesh>(rest, made(counts.meshes))?;
        let (nodes, rest) = section::<Node>(rest, made(counts.nodes))?;
        let (shares, rest) = section::<Share>(rest, made(counts.shares))?;
        let (triangles, _) = section::<[u16; 3]>(rest, made(counts.triangles))?;
        let scene = Self {
            header,
            surfaces,
            reflectances,
            emitters,
            exitances,
            shapes,
            loops,
            vertices,
            corners,
            occluders: Occluders {
                occluders,
                faces,
                edges,
                vertices: places,
                flat: header.tolerance,
            },
            blockers,
            samples,
            weights,
            members: slice(members, 0, counts.members),
            scales,
            fractions: slice(half_words, 0, fractions),
            codes,
            fields: Fields {
                fields,
                tensors,
                matrices,
                meshes,
                nodes,
                shares,
                triangles,
            },
        };
        check::records(&scene, PARTS)?;
        Ok(scene)
    }

    /// The surfaces, in the order of the scene file.
    pub fn surfaces(&self) -> &'t [Surface] {
        slice(self.surfaces, 0, self.header.counts.surfaces)
    }

    /// The named points, in the order of the scene file: the place is the origin.
    pub fn points(&self) -> &'t [Surface] {
        let counts = &self.header.counts;
        slice(self.surfaces, counts.surfaces, counts.points)
    }

    /// Surfaces and named points: all that has samples.
    pub(crate) fn receiving(&self) -> &'t [Surface] {
        self.surfaces
    }

    /// Luminaires, then secondary emitters.
    pub fn emitters(&self) -> &'t [Emitter] {
        self.emitters
    }

    /// The shapes of the emitters, one each; none where radiosities are constant and
    /// nothing occludes.
    pub fn shapes(&self) -> &'t [Shape] {
        self.shapes
    }

    /// All samples, ordered by surface: coordinates (u, v) in metres in the
    /// frame of their surface.
    pub fn samples(&self) -> &'t [[f32; 2]] {
        self.samples
    }

    /// Bytes of the tables.
    pub fn bytes(&self) -> usize {
        self.header.bytes as usize
    }

    /// One surface.
    ///
    /// # Errors
    /// [`Error::Unknown`] where there is no such surface.
    pub fn surface(&self, index: usize) -> Result<&'t Surface, Error> {
        let surfaces = self.surfaces();
        surfaces.get(index).ok_or(Error::Unknown {
            what: What::Surfaces,
            asked: index as u32,
            have: surfaces.len() as u32,
        })
    }

    /// The samples of one surface, and where they begin among all.
    pub fn samples_of(&self, surface: &Surface) -> (usize, &'t [[f32; 2]]) {
        let first = surface.first_sample as usize;
        (
            first,
            slice(self.samples, surface.first_sample, surface.samples),
        )
    }

    /// Which of all samples receive, on one surface, from an emitter: from
    /// luminaires not those for reflected light, from others not those for
    /// direct light.
    pub fn receivers(&self, surface: &Surface, is_luminaire: bool) -> Range<usize> {
        let first = surface.first_sample as usize;
        let end = first.saturating_add(surface.samples as usize);
        if is_luminaire {
            first..end.saturating_sub(surface.indirect as usize)
        } else {
            first.saturating_add(surface.direct as usize)..end
        }
    }

    /// What surfaces are reconstructed from.
    pub fn fields(&self) -> Fields<'t> {
        self.fields
    }

    /// How many of everything there are.
    pub fn counts(&self) -> &'t Counts {
        &self.header.counts
    }

    /// The part of light still to come that emitters may send ahead of it.
    pub(crate) fn ahead(&self) -> f32 {
        self.header.ahead
    }

    /// What a workspace must hold so that visibility is exact at every sample.
    pub fn sight(&self) -> &'t Sight {
        &self.header.sight
    }

    /// Whether an emitter emits by itself.
    pub fn is_luminaire(&self, emitter: usize) -> bool {
        emitter < self.header.counts.luminaires as usize
    }

    /// The emitted radiosity π L of an emitter in W m⁻² (lm m⁻²); dark for one
    /// that only reflects.
    pub fn exitance<C: Colour>(&self, emitter: usize) -> C {
        channels(self.exitances, emitter)
    }

    /// The diffuse reflectance of a surface, 0 ≤ ρ < 1; 0 where there is no
    /// such surface.
    pub fn reflectance<C: Colour>(&self, surface: usize) -> C {
        channels(self.reflectances, surface)
    }

    /// The samples that an emitter's radiosity is had from, indices among all
    /// samples, each with its weights (none where it is a plain mean). Empty for
    /// a luminaire.
    pub fn members_of(&self, emitter: &Emitter) -> impl Iterator<Item = (usize, &'t [f32])> {
        let stride = match self.weights.is_empty() {
            true => 0,
            false => self.header.counts.coefficients,
        };
        self.members_with(emitter, stride)
    }

    /// The same, each with so many weights.
    #[inline(always)]
    pub(crate) fn members_with(
        &self,
        emitter: &Emitter,
        stride: u32,
    ) -> impl Iterator<Item = (usize, &'t [f32])> + use<'t> {
        let weights = self.weights;
        (emitter.first_member..)
            .zip(slice(self.members, emitter.first_member, emitter.members))
            .map(move |(index, &sample)| {
                let weights = slice(weights, index.saturating_mul(stride), stride);
                (usize::from(sample), weights)
            })
    }

    /// The loops of an emitter's polygon: pieces counter-clockwise, holes
    /// clockwise.
    pub fn loops_of(&self, emitter: &Emitter) -> impl Iterator<Item = Outline<'t, f32>> + use<'t> {
        let vertices = self.vertices;
        slice(self.loops, emitter.first_loop, emitter.loops)
            .iter()
            .map(move |outline| {
                Outline::with_reach(
                    slice(vertices, outline.first_vertex, outline.vertices),
                    outline.reach_squared,
                )
            })
    }

    /// The form factor of an emitter seen from a receiver, 0 ≤ F ≤ 1.
    ///
    /// 0 where the receiver lies in the emitter's own plane, facing the same
    /// way: within the scene's tolerance, 1e-6 of its largest coordinate, the
    /// two cannot see each other, and rounding must not decide it.
    /// Cost: one call of the rung per loop. Never panics.
    #[inline]
    pub fn form_factor<A: Arithmetic<f32>>(
        &self,
        receiver: &Receiver<f32>,
        emitter: &Emitter,
    ) -> f32 {
        match self.plane_facing(receiver, emitter) {
            Some((_, plane)) => {
                form_factor::of_loops::<A, f32>(receiver, &plane, self.loops_of(emitter))
            }
            None => 0.0,
        }
    }

    /// The surface of an emitter and its plane, unless the receiver lies in it
    /// and faces the same way.
    #[inline(always)]
    fn plane_facing(
        &self,
        receiver: &Receiver<f32>,
        emitter: &Emitter,
    ) -> Option<(&'t Surface, Plane<f32>)> {
        let surface = self.surfaces.get(emitter.surface as usize)?;
        let plane = Plane {
            normal: Vector::from(surface.normal),
            point: Vector::from(surface.origin),
        };
        let coplanar = plane.height(receiver.position()) <= self.header.tolerance
            && plane.normal.dot(receiver.normal()) > PARALLEL;
        (!coplanar).then_some((surface, plane))
    }
}

/// One value of a section with as many for each channel.
#[inline(always)]
fn channels<C: Colour>(all: &[f32], index: usize) -> C {
    let first = index.saturating_mul(C::CHANNELS);
    C::read(all.get(first..).unwrap_or(&[]))
}

/// The cosine above which two unit normals count as equal where coplanar
/// surfaces are told apart: 0.26°, at which a receiver within the tolerance of
/// a plane sees less than 1e-5 of it.
const PARALLEL: f32 = 0.999_99;

/// A range that [`check::records`] has found to be inside; empty otherwise, so
/// that no panic can be reached.
#[inline(always)]
pub(crate) fn slice<T>(all: &[T], first: u32, count: u32) -> &[T] {
    all.get(first as usize..)
        .and_then(|rest| rest.get(..count as usize))
        .unwrap_or(&[])
}

/// Surfaces and named points together.
pub(crate) const fn receiving(counts: &Counts) -> u32 {
    counts.surfaces.saturating_add(counts.points)
}

/// Half-words with their padding to whole words; the last number of all, which
/// no table reaches, stays as it is.
pub(crate) const fn even(half_words: u32) -> u32 {
    half_words.saturating_add(half_words % 2)
}

/// Bytes of tables with these counts: what a bake writes and
/// [`Scene::load`] demands. `None` where they exceed 4 GiB.
pub const fn required_bytes(counts: &Counts) -> Option<u32> {
    // More channels than any tables have: held where no sum below leaves 64 bits.
    let channels = if counts.channels > 0xffff {
        0xffff
    } else {
        counts.channels
    };
    let half_words = even(counts.fractions.saturating_add(counts.responses));
    let bytes = size_of::<Header>() as u64
        + section_bytes::<Surface>(receiving(counts))
        + counts.surfaces as u64 * (4 * channels) as u64
        + section_bytes::<Emitter>(counts.emitters)
        + counts.luminaires as u64 * (4 * channels) as u64
        + section_bytes::<Shape>(counts.shapes)
        + section_bytes::<Loop>(counts.loops)
        + section_bytes::<[f32; 3]>(counts.vertices)
        + section_bytes::<[f32; 2]>(counts.corners)
        + section_bytes::<Occluder>(counts.occluders)
        + section_bytes::<Face>(counts.faces)
        + section_bytes::<Edge>(counts.edges)
        + section_bytes::<[f32; 3]>(counts.places)
        + section_bytes::<Blocker>(counts.blockers)
        + section_bytes::<[f32; 2]>(counts.samples)
        + section_bytes::<f32>(counts.weights)
        + section_bytes::<u16>(even(counts.members))
        + section_bytes::<f32>(matrix::scales(counts))
        + section_bytes::<u16>(half_words)
        + coded::bytes(counts)
        + matrix::bytes(counts)
        + section_bytes::<Field>(counts.fields)
        + section_bytes::<Tensor>(counts.tensors)
        + section_bytes::<f32>(counts.matrices)
        + section_bytes::<Mesh>(counts.meshes)
        + section_bytes::<Node>(counts.nodes)
        + section_bytes::<Share>(counts.shares)
        // An odd number of triangles ends on a half-word: it is filled up.
        + section_bytes::<[u16; 3]>(even(counts.triangles));
    if bytes <= u32::MAX as u64 {
        Some(bytes as u32)
    } else {
        None
    }
}

/// Bytes of so many records: no product of two 32-bit numbers leaves 64 bits.
const fn section_bytes<T>(count: u32) -> u64 {
    count as u64 * size_of::<T>() as u64
}
