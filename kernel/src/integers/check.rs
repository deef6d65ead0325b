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
#[cfg_attr(feature = "small", inline(always))]
pub(super) fn records(scene: &Scene<'_>) -> Result<(), Error> {
    let (header, counts) = (scene.header(), scene.counts());
    let exponents = [header.length, header.irradiance];
    let sound = exponents.iter().all(|e| (-EXPONENT..=EXPONENT).contains(e))
        && header.shift <= LARGEST_SHIFT
        && header.tolerance >= 0;
    numbers(What::Header, 0, sound)?;
    ranges(What::Header, 0, counts_agree(counts))?;
    all(What::Surfaces, scene.receiving(), surface_is_sound)?;
    let mut sample = 0_u32;
    for (index, surface) in (0..).zip(scene.receiving()) {
        // Ordered by surface, without gaps: no sample belongs to two.
        let end = sample.checked_add(surface.samples);
        ranges(What::Surfaces, index, surface.first_sample == sample)?;
        sample = end.ok_or(Error::Range {
            what: What::Surfaces,
            record: index,
        })?;
        // All samples receive all light, or each one kind of it.
        let of_a_kind = surface.direct.checked_add(surface.indirect);
        let sound = of_a_kind.is_some_and(|some| some == 0 || some == surface.samples);
        ranges(What::Surfaces, index, sound)?;
    }
    ranges(What::Samples, sample, sample == counts.samples)?;
    for (index, point) in (0..).zip(scene.points()) {
        let sound = point.samples == 1 && point.direct == 0 && point.indirect == 0;
        ranges(What::Points, index, sound)?;
    }
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
    all(What::Exitances, scene.exitances(), |&exitance| {
        exitance >= 0
    })?;
    written(scene)
}

/// The weights of linear radiosities, and what the host wrote down of their transfer.
#[cfg_attr(feature = "small", inline(always))]
fn written(scene: &Scene<'_>) -> Result<(), Error> {
    let counts = scene.counts();
    for (index, emitter) in (0..).zip(scene.emitters()) {
        // Sums of weighted words have 62 bits.
        let mut sums = [0_u64; 3];
        for weights in scene.weights_of(emitter) {
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum = sum.wrapping_add(weight.unsigned_abs().into());
            }
        }
        let bounded = sums.iter().all(|&sum| sum <= i32::MAX as u64);
        numbers(What::Weights, index, bounded)?;
    }
    let pairs = |of_luminaires, emitters: u32| {
        let receivers = |surface| scene.receivers(surface, of_luminaires).len() as u64;
        let receivers: u64 = scene.receiving().iter().map(receivers).sum();
        receivers.saturating_mul(u64::from(emitters))
    };
    let secondary = counts.emitters.wrapping_sub(counts.luminaires);
    let (terms, fractions) = (u64::from(counts.terms), u64::from(counts.fractions));
    let linear = counts.coefficients == 3;
    let sound = terms == if linear { pairs(false, secondary) } else { 0 };
    ranges(What::Terms, 0, sound)?;
    let bits = match terms {
        0 => counts.bits == 0,
        _ => matches!(counts.bits, 4 | 6 | 8),
    };
    ranges(What::Bits, 0, bits)?;
    let sound = fractions == 0 || (linear && fractions == pairs(true, counts.luminaires));
    ranges(What::Fractions, 0, sound)?;
    // No factor reaches 1.
    let most = (1_u64 << (counts.bits & 31)).wrapping_sub(1);
    let one = 1_u64 << (counts.bits.wrapping_mul(2).wrapping_add(31) & 63);
    all(What::Scales, scene.scales(), |&scale| {
        u64::from(scale).wrapping_mul(most.wrapping_mul(most)) < one
    })
}

/// Whether there is nothing but what integer tables hold.
fn counts_agree(counts: &Counts) -> bool {
    let weights = u64::from(counts.members).wrapping_mul(3);
    let weighted = match counts.coefficients {
        1 => counts.weights == 0,
        3 => u64::from(counts.weights) == weights,
        _ => false,
    };
    let known = Counts {
        channels: 1,
        coefficients: counts.coefficients,
        surfaces: counts.surfaces,
        luminaires: counts.luminaires,
        emitters: counts.emitters,
        loops: counts.loops,
        vertices: counts.vertices,
        samples: counts.samples,
        members: counts.members,
        weights: counts.weights,
        fractions: counts.fractions,
        points: counts.points,
        terms: counts.terms,
        bits: counts.bits,
        ..Counts::default()
    };
    *counts == known && weighted && counts.luminaires <= counts.emitters
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
