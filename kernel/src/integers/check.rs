//! Everything that is demanded of integer tables, once.

use super::scene::Scene;
use super::tables::{LARGEST_SHIFT, Surface};
use crate::Error;
use crate::error::What;
use crate::scene::check::{all, inside, numbers, ranges};
use crate::scene::records::Counts;

/// Largest exponents of the units: far beyond what `f32` could name.
const EXPONENT: i32 = 256;

/// Every record: its numbers in their domain, its ranges inside.
pub(super) fn records(scene: &Scene<'_>) -> Result<(), Error> {
    let (header, counts) = (scene.header(), scene.counts());
    let exponents = [header.length, header.irradiance];
    let sound = exponents.iter().all(|e| (-EXPONENT..=EXPONENT).contains(e))
        && header.shift <= LARGEST_SHIFT
        && header.tolerance >= 0;
    numbers(What::Header, 0, sound)?;
    ranges(What::Header, 0, counts_agree(counts))?;
    all(What::Surfaces, scene.surfaces(), surface_is_sound)?;
    let mut sample = 0_u32;
    for (index, surface) in (0..).zip(scene.surfaces()) {
        // Ordered by surface, without gaps: no sample belongs to two.
        let end = sample.checked_add(surface.samples);
        ranges(What::Surfaces, index, surface.first_sample == sample)?;
        sample = end.ok_or(Error::Range {
            what: What::Surfaces,
            record: index,
        })?;
    }
    ranges(What::Samples, sample, sample == counts.samples)?;
    for (index, emitter) in (0..).zip(scene.emitters()) {
        let sound = emitter.surface < counts.surfaces
            && inside(emitter.first_loop, emitter.loops, counts.loops)
            && inside(emitter.first_member, emitter.members, counts.members)
            && (index >= counts.luminaires || emitter.members == 0);
        ranges(What::Emitters, index, sound)?;
    }
    for (index, outline) in (0..).zip(scene.loops()) {
        numbers(What::Loops, index, outline.vertices >= 3)?;
        let there = inside(outline.first_vertex, outline.vertices, counts.vertices);
        ranges(What::Loops, index, there)?;
    }
    all(What::Vertices, scene.vertices(), |place| coordinates(place))?;
    all(What::Samples, scene.samples(), |place| coordinates(place))?;
    for (index, &member) in (0..).zip(scene.members()) {
        ranges(What::Members, index, u32::from(member) < counts.samples)?;
    }
    Ok(())
}

/// Whether there is nothing but what integer tables hold.
fn counts_agree(counts: &Counts) -> bool {
    let known = Counts {
        channels: 1,
        coefficients: 1,
        surfaces: counts.surfaces,
        luminaires: counts.luminaires,
        emitters: counts.emitters,
        loops: counts.loops,
        vertices: counts.vertices,
        samples: counts.samples,
        members: counts.members,
        ..Counts::default()
    };
    *counts == known && counts.luminaires <= counts.emitters
}

/// The largest coordinate: twice what the bake writes, and differences of two
/// are words.
const FARTHEST: i32 = 1 << 30;

fn coordinates(all: &[i32]) -> bool {
    all.iter().all(|x| (-FARTHEST..=FARTHEST).contains(x))
}

fn surface_is_sound(surface: &Surface) -> bool {
    let axes = [&surface.axis_u, &surface.axis_v, &surface.normal];
    coordinates(&surface.origin)
        && axes.into_iter().all(unit)
        && surface.size.iter().all(|&length| length > 0)
        && surface.filter_radius >= 0
        && (surface.samples == 0 || surface.filter_radius > 0)
}

/// Of length 1 to within the rounding of its coordinates.
fn unit(axis: &[i32; 3]) -> bool {
    /// 2e-6 of 2^60.
    const SLACK: i64 = 2_305_843_009_214;
    let square = |x: &i32| i64::from(*x).wrapping_mul(i64::from(*x));
    let squared = axis.iter().map(square).fold(0, i64::wrapping_add);
    coordinates(axis) && squared.abs_diff(1 << 60) <= SLACK as u64
}
