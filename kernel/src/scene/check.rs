//! Everything that is demanded of tables, once.

use super::records::{Emitter, Header, Loop, Surface, checksum};
use super::{MAGIC, Scene, VERSION, required_bytes};
use crate::Error;
use crate::error::What;
use core::mem::{align_of, offset_of};
use zerocopy::FromBytes;

/// The header and what follows it: magic, version, alignment, length, checksum.
pub(super) fn header(tables: &[u8]) -> Result<(&Header, &[u8]), Error> {
    if tables.get(..MAGIC.len()) != Some(&MAGIC[..]) {
        return Err(Error::NotTables);
    }
    if !tables.as_ptr().addr().is_multiple_of(align_of::<Header>()) {
        return Err(Error::Misaligned);
    }
    let have = u32::try_from(tables.len()).unwrap_or(u32::MAX);
    let length = |needed| Error::Length { needed, have };
    let (header, rest) =
        Header::ref_from_prefix(tables).map_err(|_| length(size_of::<Header>() as u32))?;
    if header.version != VERSION {
        return Err(Error::Version {
            found: header.version,
            supported: VERSION,
        });
    }
    if header.bytes as usize != tables.len() {
        return Err(length(header.bytes));
    }
    let needed = required_bytes(
        header.surfaces,
        header.emitters,
        header.loops,
        header.vertices,
        header.samples,
        header.members,
    );
    if needed != Some(header.bytes) {
        return Err(length(needed.unwrap_or(u32::MAX)));
    }
    let behind = offset_of!(Header, checksum) + size_of::<u32>();
    let computed = checksum(tables.get(behind..).unwrap_or(&[]));
    if computed != header.checksum {
        return Err(Error::Checksum {
            stored: header.checksum,
            computed,
        });
    }
    Ok((header, rest))
}

/// Every record: its numbers finite and in their domain, its ranges inside.
pub(super) fn records(scene: &Scene<'_>) -> Result<(), Error> {
    numbers(What::Header, 0, non_negative(scene.header.tolerance))?;
    let mut sample = 0_u32;
    for (index, surface) in (0..).zip(scene.surfaces) {
        numbers(What::Surfaces, index, surface_is_sound(surface))?;
        // Ordered by surface, without gaps: no sample belongs to two.
        ranges(What::Surfaces, index, surface.first_sample == sample)?;
        sample = sample.checked_add(surface.samples).ok_or(Error::Range {
            what: What::Surfaces,
            record: index,
        })?;
        let lacks_radius = surface.samples > 0 && surface.filter_radius == 0.0;
        numbers(What::Surfaces, index, !lacks_radius)?;
    }
    ranges(What::Samples, sample, sample == scene.header.samples)?;
    for (index, emitter) in (0..).zip(scene.emitters) {
        numbers(What::Emitters, index, emitter_is_sound(emitter))?;
        ranges(
            What::Emitters,
            index,
            emitter.surface < scene.header.surfaces,
        )?;
        let loops = inside(emitter.first_loop, emitter.loops, scene.header.loops);
        let members = inside(emitter.first_member, emitter.members, scene.header.members);
        ranges(What::Emitters, index, loops && members)?;
    }
    for (index, outline) in (0..).zip(scene.loops) {
        numbers(What::Loops, index, loop_is_sound(outline))?;
        let vertices = inside(
            outline.first_vertex,
            outline.vertices,
            scene.header.vertices,
        );
        ranges(What::Loops, index, vertices)?;
    }
    for (index, vertex) in (0..).zip(scene.vertices) {
        numbers(What::Vertices, index, coordinates(vertex))?;
    }
    for (index, place) in (0..).zip(scene.samples) {
        numbers(What::Samples, index, coordinates(place))?;
    }
    for (index, &member) in (0..).zip(scene.members) {
        ranges(
            What::Members,
            index,
            u32::from(member) < scene.header.samples,
        )?;
    }
    Ok(())
}

/// The largest coordinate in metres that tables may hold: fourth powers of
/// distances must be finite.
const FARTHEST: f32 = 1e8;

/// The largest emitted radiosity in W m⁻² that tables may hold, and the most
/// that is shot at once: with [`LARGEST`], every power and every sum over
/// samples and emitters stays finite.
pub(crate) const BRIGHTEST: f32 = 1e21;

/// The largest area in m² that tables may hold: a little more than a polygon
/// between [`FARTHEST`] coordinates can have.
const LARGEST: f32 = 1e17;

fn surface_is_sound(surface: &Surface) -> bool {
    let axes = [&surface.axis_u, &surface.axis_v, &surface.normal];
    coordinates(&surface.origin)
        && axes.into_iter().all(unit)
        && coordinates(&surface.size)
        && surface.size.iter().all(|&length| length > 0.0)
        && reflectance(surface.reflectance)
        && non_negative(surface.filter_radius)
}

fn emitter_is_sound(emitter: &Emitter) -> bool {
    non_negative(emitter.exitance)
        && emitter.exitance <= BRIGHTEST
        && reflectance(emitter.reflectance)
        && (0.0..=LARGEST).contains(&emitter.area)
}

fn loop_is_sound(outline: &Loop) -> bool {
    outline.vertices >= 3 && non_negative(outline.reach_squared)
}

fn coordinates(all: &[f32]) -> bool {
    all.iter().all(|x| (-FARTHEST..=FARTHEST).contains(x))
}

/// Of length 1 to within the rounding of its coordinates.
fn unit(axis: &[f32; 3]) -> bool {
    let squared: f32 = axis.iter().map(|x| x * x).sum();
    (0.999_998..=1.000_002).contains(&squared)
}

fn reflectance(rho: f32) -> bool {
    (0.0..1.0).contains(&rho)
}

fn non_negative(x: f32) -> bool {
    x >= 0.0 && x.is_finite()
}

fn inside(first: u32, count: u32, all: u32) -> bool {
    first.checked_add(count).is_some_and(|end| end <= all)
}

fn ranges(what: What, record: u32, sound: bool) -> Result<(), Error> {
    if sound {
        Ok(())
    } else {
        Err(Error::Range { what, record })
    }
}

fn numbers(what: What, record: u32, sound: bool) -> Result<(), Error> {
    if sound {
        Ok(())
    } else {
        Err(Error::Number { what, record })
    }
}
