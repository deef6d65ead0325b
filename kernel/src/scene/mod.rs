//! The baked scene: tables borrowed from flash, checked once.
//!
//! [`Scene::load`] reads a byte string in place. It checks everything, the
//! checksum, every count, index and number, in time proportional to the
//! length; after that nothing can fail. The records are in [`records`]; the
//! whole format:
//!
//! # Format, version 1
//!
//! Little-endian, 4-byte aligned, no padding but where said. A header
//! ([`records::Header`]) gives the counts; then follow, without gaps,
//!
//! | section | record | bytes each |
//! | --- | --- | --- |
//! | surfaces | [`records::Surface`] | 72 |
//! | emitters | [`records::Emitter`] | 32 |
//! | loops | [`records::Loop`] | 12 |
//! | vertices | `[f32; 3]`, metres | 12 |
//! | samples | `[f32; 2]`, metres in the surface's frame | 8 |
//! | members | `u16` sample indices, padded to 4 bytes with 0 | 2 |
//!
//! A luminaire is an emitter with an exitance and no members. A secondary
//! emitter has the reflectance of its surface and members: its radiosity is the
//! reflectance times the mean irradiance of those samples. Samples are ordered
//! by surface.

mod check;
pub mod records;

pub(crate) use check::BRIGHTEST;

use crate::Error;
use crate::error::What;
use crate::form_factor::{self, Arithmetic, Outline};
use crate::geometry::{Plane, Receiver, Vector};
use core::mem::size_of;
use records::{Emitter, Header, Loop, Surface};
use zerocopy::FromBytes;

/// The version of the format that this kernel reads.
pub const VERSION: u32 = 1;

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
    emitters: &'t [Emitter],
    loops: &'t [Loop],
    vertices: &'t [[f32; 3]],
    samples: &'t [[f32; 2]],
    members: &'t [u16],
}

/// Splits `count` records off the front of `bytes`.
fn section<T: FromBytes + zerocopy::KnownLayout + zerocopy::Immutable>(
    bytes: &[u8],
    count: u32,
) -> Result<(&[T], &[u8]), Error> {
    <[T]>::ref_from_prefix_with_elems(bytes, count as usize).map_err(|_| Error::Range {
        what: What::Header,
        record: 0,
    })
}

impl<'t> Scene<'t> {
    /// Reads and checks baked tables in place; nothing is copied.
    ///
    /// Time: about 12 instructions a byte for the checksum, 20 a record.
    ///
    /// # Errors
    /// Every variant of [`Error`] that speaks of tables; see there.
    pub fn load(tables: &'t [u8]) -> Result<Self, Error> {
        let (header, rest) = check::header(tables)?;
        let (surfaces, rest) = section::<Surface>(rest, header.surfaces)?;
        let (emitters, rest) = section::<Emitter>(rest, header.emitters)?;
        let (loops, rest) = section::<Loop>(rest, header.loops)?;
        let (vertices, rest) = section::<[f32; 3]>(rest, header.vertices)?;
        let (samples, rest) = section::<[f32; 2]>(rest, header.samples)?;
        let (members, _) = section::<u16>(rest, header.members)?;
        let scene = Self {
            header,
            surfaces,
            emitters,
            loops,
            vertices,
            samples,
            members,
        };
        check::records(&scene)?;
        Ok(scene)
    }

    /// The surfaces, in the order of the scene file.
    pub fn surfaces(&self) -> &'t [Surface] {
        self.surfaces
    }

    /// Luminaires, then secondary emitters.
    pub fn emitters(&self) -> &'t [Emitter] {
        self.emitters
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
        self.surfaces.get(index).ok_or(Error::Unknown {
            what: What::Surfaces,
            asked: index as u32,
            have: self.surfaces.len() as u32,
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

    /// The samples whose mean irradiance an emitter reflects: indices among
    /// all samples. Empty for a luminaire.
    pub fn members_of(&self, emitter: &Emitter) -> &'t [u16] {
        slice(self.members, emitter.first_member, emitter.members)
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
        let Some(surface) = self.surfaces.get(emitter.surface as usize) else {
            return 0.0;
        };
        let plane = Plane {
            normal: Vector::from(surface.normal),
            point: Vector::from(surface.origin),
        };
        if plane.height(receiver.position()) <= self.header.tolerance
            && plane.normal.dot(receiver.normal()) > PARALLEL
        {
            return 0.0;
        }
        form_factor::of_loops::<A, f32>(receiver, &plane, self.loops_of(emitter))
    }
}

/// The cosine above which two unit normals count as equal where coplanar
/// surfaces are told apart: 0.26°, at which a receiver within the tolerance of
/// a plane sees less than 1e-5 of it.
const PARALLEL: f32 = 0.999_99;

/// A range that [`check::records`] has found to be inside; empty otherwise, so
/// that no panic can be reached.
#[inline(always)]
fn slice<T>(all: &[T], first: u32, count: u32) -> &[T] {
    all.get(first as usize..)
        .and_then(|rest| rest.get(..count as usize))
        .unwrap_or(&[])
}

/// Bytes of tables with these counts: what a bake writes and
/// [`Scene::load`] demands. `None` where they exceed 4 GiB.
pub const fn required_bytes(
    surfaces: u32,
    emitters: u32,
    loops: u32,
    vertices: u32,
    samples: u32,
    members: u32,
) -> Option<u32> {
    let members = members as u64 + members as u64 % 2;
    let bytes = size_of::<Header>() as u64
        + surfaces as u64 * size_of::<Surface>() as u64
        + emitters as u64 * size_of::<Emitter>() as u64
        + loops as u64 * size_of::<Loop>() as u64
        + vertices as u64 * size_of::<[f32; 3]>() as u64
        + samples as u64 * size_of::<[f32; 2]>() as u64
        + members * size_of::<u16>() as u64;
    if bytes <= u32::MAX as u64 {
        Some(bytes as u32)
    } else {
        None
    }
}
