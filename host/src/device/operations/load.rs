//! What a load does: it goes once over every word, and once or twice over every record.
//!
//! The compiler sees the tables in flash and unrolls each of these loops by a divisor of its
//! own length, or wholly: that is told of the longest, the checksum's, alone, and loads are
//! predicted worse than anything else.

use super::{Done, add};
use isolux::scene::records::Counts;

/// Every kind of record has its own check, and so its own cost.
pub(super) fn of(counts: &Counts, bytes: usize) -> Done {
    let mut done = Done::new();
    let mut put = |operation, count: u32| add(&mut done, operation, u64::from(count));
    put("load", 1);
    let words = (bytes / 4).saturating_sub(BEFORE) as u32;
    put("word", words);
    put("turn", words / unrolled(words));
    // Named points are records of surfaces.
    put("surface", counts.surfaces.saturating_add(counts.points));
    put("reflectance", counts.surfaces * counts.channels);
    put("emitter", counts.emitters);
    put("exitance", counts.luminaires * counts.channels);
    put("shape", counts.shapes);
    put("loop", counts.loops);
    put("vertex", counts.vertices);
    put("corner", counts.corners);
    put("occluder", counts.occluders);
    put("face", counts.faces);
    put("edge", counts.edges);
    put("place", counts.places);
    put("blocker", counts.blockers);
    put("sample", counts.samples);
    put("weight", counts.weights);
    put("member", counts.members);
    put("scale", scales(counts));
    put("field", counts.fields);
    put("tensor", counts.tensors);
    put("matrix", counts.matrices);
    put("mesh", counts.meshes);
    put("node", counts.nodes);
    put("share", counts.shares);
    put("triangle", counts.triangles);
    // The dark state.
    put("dark-sample", counts.samples * counts.channels);
    put(
        "dark-emitter",
        2 * counts.emitters * counts.coefficients * counts.channels,
    );
    done
}

/// Words before those that the checksum is of.
const BEFORE: usize = 5;

/// How many words the compiler, which knows the length of tables in flash, takes at once:
/// the most that divide them, or four with a rest.
fn unrolled(words: u32) -> u32 {
    const MOST: u32 = 37;
    let divides = |count: &u32| words.is_multiple_of(*count);
    (2..=MOST).rev().find(divides).unwrap_or(4)
}

/// Scales of terms, one a receiver.
fn scales(counts: &Counts) -> u32 {
    let secondary = counts.emitters.saturating_sub(counts.luminaires);
    counts.terms.checked_div(secondary).unwrap_or(0)
}
