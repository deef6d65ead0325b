//! Parts of tables that not every scene has.
//!
//! A firmware that names those of its scene links no check of the others
//! ([`Scene::load_with`](super::Scene::load_with)).

use super::records::Counts;
use crate::Error;
use crate::error::What;

/// What hides emitters: occluders, their faces, edges and places, and the emitters'
/// lists of them.
pub const OCCLUDERS: u32 = 1;

/// What the host found out beforehand: codes, terms, fractions or responses.
pub const WRITTEN: u32 = 2;

/// What surfaces are reconstructed from: fields with their tensors and meshes.
pub const FIELDS: u32 = 4;

/// The emitters' own coordinates: shapes and corners.
pub const SHAPES: u32 = 8;

/// None of them.
pub const NONE: u32 = 0;

/// All parts.
pub const ALL: u32 = OCCLUDERS | WRITTEN | FIELDS | SHAPES;

/// The parts of tables with these counts.
pub const fn of(counts: &Counts) -> u32 {
    let bodies = counts.occluders | counts.faces | counts.edges | counts.places;
    let pairs = counts.codes | counts.terms | counts.bits;
    let samples = counts.fractions | counts.responses;
    let grids = counts.fields | counts.tensors | counts.matrices;
    let meshes = counts.meshes | counts.nodes | counts.triangles | counts.shares;
    part(OCCLUDERS, bodies | counts.blockers)
        | part(WRITTEN, pairs | samples)
        | part(FIELDS, grids | meshes)
        | part(SHAPES, counts.shapes | counts.corners)
}

/// A part, if there is any of its records.
const fn part(part: u32, records: u32) -> u32 {
    if records == 0 { 0 } else { part }
}

/// What of [`WRITTEN`] there is, and how many.
const fn written(counts: &Counts) -> (What, u32) {
    match counts {
        Counts { codes: 1.., .. } => (What::Codes, counts.codes),
        Counts { terms: 1.., .. } => (What::Terms, counts.terms),
        Counts { fractions: 1.., .. } => (What::Fractions, counts.fractions),
        Counts { responses: 1.., .. } => (What::Responses, counts.responses),
        _ => (What::Bits, counts.bits),
    }
}

/// Refuses tables with other parts than these.
pub(super) fn within(parts: u32, counts: &Counts) -> Result<(), Error> {
    let others = of(counts) & !parts;
    if others == 0 {
        return Ok(());
    }
    let (what, needed) = if others & OCCLUDERS != 0 {
        (What::Occluders, counts.occluders)
    } else if others & WRITTEN != 0 {
        written(counts)
    } else if others & FIELDS != 0 {
        (What::Fields, counts.fields)
    } else {
        (What::Shapes, counts.shapes)
    };
    Err(Error::Capacity {
        what,
        needed,
        have: 0,
    })
}
