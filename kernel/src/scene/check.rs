//! Everything that is demanded of tables, once.

use super::records::{Counts, HEAVIEST, Loop, Sight, Surface, checksum};
use super::{Scene, parts};
use crate::Error;
use crate::error::What;
use crate::visibility::records::Occluders;
use core::mem::align_of;
use zerocopy::{FromBytes, Immutable, KnownLayout};

/// How the tables of every format begin.
#[derive(FromBytes, Immutable, KnownLayout)]
#[repr(C)]
struct Beginning {
    magic: [u8; 8],
    version: u32,
    bytes: u32,
    checksum: u32,
}

/// The header of a format and what follows it: magic, version, alignment,
/// length, checksum.
pub(crate) fn header<'t, H: FromBytes + Immutable + KnownLayout>(
    tables: &'t [u8],
    magic: &[u8; 8],
    version: u32,
    required: impl FnOnce(&H) -> Option<u32>,
) -> Result<(&'t H, &'t [u8]), Error> {
    if tables.get(..magic.len()) != Some(&magic[..]) {
        return Err(Error::NotTables);
    }
    if !tables.as_ptr().addr().is_multiple_of(align_of::<H>()) {
        return Err(Error::Misaligned);
    }
    let have = u32::try_from(tables.len()).unwrap_or(u32::MAX);
    let length = |needed| Error::Length { needed, have };
    let short = || length(size_of::<H>() as u32);
    let (beginning, behind) = Beginning::ref_from_prefix(tables).map_err(|_| short())?;
    let (header, rest) = H::ref_from_prefix(tables).map_err(|_| short())?;
    if beginning.version != version {
        return Err(Error::Version {
            found: beginning.version,
            supported: version,
        });
    }
    if beginning.bytes as usize != tables.len() {
        return Err(length(beginning.bytes));
    }
    let needed = required(header);
    if needed != Some(beginning.bytes) {
        return Err(length(needed.unwrap_or(u32::MAX)));
    }
    let computed = checksum(behind);
    if computed != beginning.checksum {
        return Err(Error::Checksum {
            stored: beginning.checksum,
            computed,
        });
    }
    Ok((header, rest))
}

/// Every record: its numbers finite and in their domain, its ranges inside.
#[cfg_attr(feature = "small", inline(always))]
pub(super) fn records(scene: &Scene<'_>, named: u32) -> Result<(), Error> {
    let (tolerance, ahead) = (scene.header.tolerance, scene.header.ahead);
    numbers(
        What::Header,
        0,
        non_negative(tolerance) && (0.0..1.0).contains(&ahead),
    )?;
    ranges(What::Header, 0, counts_agree(&scene.header.counts))?;
    // Where nothing occludes no workspace is needed.
    let sight = scene.header.sight == Sight::default();
    ranges(What::Header, 0, sight || scene.header.counts.occluders > 0)?;
    surfaces(scene)?;
    emitters(scene)?;
    all(What::Reflectances, scene.reflectances, |&rho| {
        (0.0..1.0).contains(&rho)
    })?;
    all(What::Exitances, scene.exitances, |&exitance| {
        (0.0..=BRIGHTEST).contains(&exitance)
    })?;
    all(What::Shapes, scene.shapes, |shape| {
        coordinates(&shape.center) && (0.0..=FARTHEST).contains(&shape.scale)
    })?;
    all(What::Loops, scene.loops, loop_is_sound)?;
    for (index, outline) in (0..).zip(scene.loops) {
        let vertices = inside(
            outline.first_vertex,
            outline.vertices,
            scene.header.counts.vertices,
        );
        ranges(What::Loops, index, vertices)?;
    }
    all(What::Vertices, scene.vertices, |vertex| coordinates(vertex))?;
    all(What::Corners, scene.corners, |corner| {
        corner.iter().all(|x| (-CORNER..=CORNER).contains(x))
    })?;
    for (index, shape) in (0..).zip(scene.shapes) {
        let blockers = scene.header.counts.blockers;
        let sound = inside(shape.first_blocker, shape.blockers, blockers);
        ranges(What::Shapes, index, sound)?;
    }
    if named & parts::OCCLUDERS != 0 {
        occluders(scene)?;
    }
    all(What::Samples, scene.samples, |place| coordinates(place))?;
    all(What::Weights, scene.weights, |weight| {
        (-HEAVIEST..=HEAVIEST).contains(weight)
    })?;
    for (index, &member) in (0..).zip(scene.members) {
        let there = u32::from(member) < scene.header.counts.samples;
        ranges(What::Members, index, there)?;
    }
    points(scene)?;
    if named & parts::WRITTEN != 0 {
        codes(scene)?;
    }
    if named & parts::FIELDS != 0 {
        super::fields::check(scene)?;
    }
    Ok(())
}

/// One code, term or fraction for each pair, and no occluders beside them.
#[cfg_attr(feature = "small", inline(always))]
fn codes(scene: &Scene<'_>) -> Result<(), Error> {
    let counts = &scene.header.counts;
    let pairs = |of_luminaires, emitters: u32| {
        let receivers = |surface| scene.receivers(surface, of_luminaires).len() as u64;
        let receivers: u64 = scene.receiving().iter().map(receivers).sum();
        receivers.saturating_mul(u64::from(emitters))
    };
    let secondary = counts.emitters.saturating_sub(counts.luminaires);
    let coded = counts.is_coded();
    let reflected = pairs(false, secondary);
    let (codes, terms) = (u64::from(counts.codes), u64::from(counts.terms));
    let linear = counts.coefficients == 3;
    let responses = counts.responses > 0;
    ranges(What::Codes, 0, !coded || counts.occluders == 0)?;
    let sound = match (terms > 0, responses) {
        (false, false) => !coded || (codes == reflected && linear),
        _ => codes == 0,
    };
    ranges(What::Codes, 0, sound)?;
    let sound = terms == 0 || (terms == reflected && linear && !responses);
    ranges(What::Terms, 0, sound)?;
    let bits = match terms {
        0 => counts.bits == 0,
        _ => matches!(counts.bits, 4 | 6 | 8),
    };
    ranges(What::Bits, 0, bits)?;
    let direct = u64::from(counts.fractions);
    let sound = direct == 0 || (coded && !responses && direct == pairs(true, counts.luminaires));
    ranges(What::Fractions, 0, sound)?;
    self::responses(scene)?;
    all(What::Scales, scene.scales, |scale| {
        (0.0..=1.0).contains(scale)
    })
}

/// One response for each luminaire, channel and sample, and nothing that reflects.
#[cfg_attr(feature = "small", inline(always))]
fn responses(scene: &Scene<'_>) -> Result<(), Error> {
    let counts = &scene.header.counts;
    let rows = u64::from(counts.luminaires).saturating_mul(counts.channels.into());
    let all = rows.saturating_mul(counts.samples.into());
    let every = scene.receiving().iter().all(|surface| {
        // Every sample counts, by its index among all.
        surface.direct == 0 && surface.indirect == 0
    });
    let sound = counts.responses == 0
        || (u64::from(counts.responses) == all && counts.emitters == counts.luminaires && every);
    ranges(What::Responses, 0, sound)
}

/// Named points have one sample each, which receives all light.
#[cfg_attr(feature = "small", inline(always))]
fn points(scene: &Scene<'_>) -> Result<(), Error> {
    for (index, point) in (0..).zip(scene.points()) {
        let sound =
            point.samples == 1 && point.direct == 0 && point.indirect == 0 && point.fields == 0;
        ranges(What::Points, index, sound)?;
    }
    Ok(())
}

/// Whether the sections that belong together are equally long.
fn counts_agree(counts: &Counts) -> bool {
    let weights = u64::from(counts.members) * u64::from(counts.coefficients);
    matches!(counts.channels, 1 | 3)
        && counts.luminaires <= counts.emitters
        && (counts.shapes == 0 || counts.shapes == counts.emitters)
        && (counts.corners == 0 || counts.corners == counts.vertices)
        && (counts.shapes == 0) == (counts.corners == 0)
        && (counts.occluders == 0 || counts.shapes == counts.emitters)
        && match counts.coefficients {
            1 => counts.weights == 0 || u64::from(counts.weights) == weights,
            3 => {
                u64::from(counts.weights) == weights
                    && counts.shapes == counts.emitters
                    && counts.corners == counts.vertices
            }
            _ => false,
        }
}

#[cfg_attr(feature = "small", inline(always))]
fn surfaces(scene: &Scene<'_>) -> Result<(), Error> {
    all(What::Surfaces, scene.surfaces, surface_is_sound)?;
    let mut sample = 0_u32;
    for (index, surface) in (0..).zip(scene.surfaces) {
        // Ordered by surface, without gaps: no sample belongs to two.
        ranges(What::Surfaces, index, surface.first_sample == sample)?;
        sample = sample.checked_add(surface.samples).ok_or(Error::Range {
            what: What::Surfaces,
            record: index,
        })?;
        // All samples receive all light, or each one kind of it.
        let of_a_kind = surface.direct.checked_add(surface.indirect);
        let sound = of_a_kind.is_some_and(|some| some == 0 || some == surface.samples)
            && surface.unshadowed <= surface.direct
            && inside(
                surface.first_field,
                surface.fields,
                scene.header.counts.fields,
            );
        ranges(What::Surfaces, index, sound)?;
    }
    ranges(What::Samples, sample, sample == scene.header.counts.samples)
}

#[cfg_attr(feature = "small", inline(always))]
fn emitters(scene: &Scene<'_>) -> Result<(), Error> {
    let counts = &scene.header.counts;
    all(What::Emitters, scene.emitters, |emitter| {
        (0.0..=LARGEST).contains(&emitter.area)
    })?;
    for (index, emitter) in (0..).zip(scene.emitters) {
        let sound = emitter.surface < counts.surfaces
            && inside(emitter.first_loop, emitter.loops, counts.loops)
            && inside(emitter.first_member, emitter.members, counts.members)
            && (index >= counts.luminaires || (emitter.members == 0 && emitter.loops > 0))
            // A point lies at the centre of its shape.
            && (emitter.loops > 0 || counts.shapes > 0);
        ranges(What::Emitters, index, sound)?;
    }
    Ok(())
}

/// Occluders and the lists of them.
#[cfg_attr(feature = "small", inline(always))]
fn occluders(scene: &Scene<'_>) -> Result<(), Error> {
    let counts = &scene.header.counts;
    let Occluders {
        occluders,
        faces,
        edges,
        vertices,
        ..
    } = scene.occluders;
    all(What::Occluders, occluders, |occluder| {
        coordinates(&occluder.centre) && (0.0..=FARTHEST).contains(&occluder.radius)
    })?;
    for (index, occluder) in (0..).zip(occluders) {
        let sound = inside(occluder.first_face, occluder.faces, counts.faces)
            && inside(occluder.first_edge, occluder.edges, counts.edges);
        ranges(What::Occluders, index, sound)?;
    }
    all(What::Faces, faces, |face| {
        unit(&face.normal) && coordinates(&[face.offset])
    })?;
    for (index, edge) in (0..).zip(edges) {
        let ends = [edge.a, edge.b].map(u32::from);
        ranges(
            What::Edges,
            index,
            ends.iter().all(|&end| end < counts.places),
        )?;
    }
    all(What::Places, vertices, |vertex| coordinates(vertex))?;
    for (index, blocker) in (0..).zip(scene.blockers) {
        ranges(What::Blockers, index, blocker.occluder < counts.occluders)?;
    }
    Ok(())
}

/// Every record of a section, its numbers.
pub(crate) fn all<T>(what: What, records: &[T], sound: impl Fn(&T) -> bool) -> Result<(), Error> {
    for (index, record) in (0..).zip(records) {
        numbers(what, index, sound(record))?;
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

/// The largest coordinate of a corner in its emitter's own frame, of which the
/// farthest is 1, with room for rounding.
const CORNER: f32 = 1.001;

fn surface_is_sound(surface: &Surface) -> bool {
    let axes = [&surface.axis_u, &surface.axis_v, &surface.normal];
    coordinates(&surface.origin)
        && axes.into_iter().all(unit)
        && coordinates(&surface.size)
        && surface.size.iter().all(|&length| length > 0.0)
        && non_negative(surface.filter_radius)
        && (surface.samples == 0 || surface.fields > 0 || surface.filter_radius > 0.0)
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

fn non_negative(x: f32) -> bool {
    x >= 0.0 && x.is_finite()
}

pub(crate) fn inside(first: u32, count: u32, all: u32) -> bool {
    first.checked_add(count).is_some_and(|end| end <= all)
}

pub(crate) fn ranges(what: What, record: u32, sound: bool) -> Result<(), Error> {
    if sound {
        Ok(())
    } else {
        Err(Error::Range { what, record })
    }
}

pub(crate) fn numbers(what: What, record: u32, sound: bool) -> Result<(), Error> {
    if sound {
        Ok(())
    } else {
        Err(Error::Number { what, record })
    }
}
