//! A plan becomes tables: the bytes that the kernel reads in place from flash.
//!
//! The format is specified with [`isolux::scene`]. Baking the same plan twice
//! gives the same bytes. Beside them goes a Rust [`source`] with the types and
//! constants that a firmware needs.

mod ahead;
mod codes;
mod content;
mod fields;
pub mod integers;
mod matrix;
mod names;
mod room;
mod source;
mod survey;
mod vectors;
mod writing;
mod written;

pub use names::Names;
pub use source::{Described, source};

use crate::occlusion::Occlusion;
use crate::plan::Plan;
use crate::scene::Scene;
use content::Content;
use isolux::scene::records::{Counts, Header, Sight, checksum};
use std::mem::offset_of;
use written::Written;
use zerocopy::IntoBytes;

/// Baked tables and the capacities a firmware needs for them.
#[derive(Clone, Debug)]
pub struct Tables {
    /// Whole words, so that the bytes are aligned as the kernel asks.
    words: Vec<u32>,
    /// How many there are of everything.
    pub counts: Counts,
    /// The same scene with its occluders, where these have codes in place of
    /// them: what the host looks with at places that no code was written for.
    computed: Option<Box<Tables>>,
}

impl Tables {
    /// The tables that any place can be looked at with: these, or where these
    /// have codes the same scene with its occluders.
    pub fn computed(&self) -> &Self {
        self.computed.as_deref().unwrap_or(self)
    }

    /// Writes the capacities that visibility was planned for.
    fn set_sight(&mut self, sight: Sight) {
        let field = offset_of!(Header, sight);
        self.words.as_mut_bytes()[field..][..size_of::<Sight>()].copy_from_slice(sight.as_bytes());
        self.seal();
    }

    fn seal(&mut self) {
        let field = offset_of!(Header, checksum);
        let sum = checksum(&self.bytes()[field + 4..]);
        self.words[field / 4] = sum;
    }

    /// The tables, aligned to four bytes.
    pub fn bytes(&self) -> &[u8] {
        self.words.as_bytes()
    }
}

/// A scene that the tables cannot hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TooLarge {
    /// What there is too much of.
    pub what: &'static str,
}

impl std::fmt::Display for TooLarge {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "the scene has more {} than the tables can index",
            self.what
        )
    }
}

impl std::error::Error for TooLarge {}

/// Distance within which a place lies on a plane, as a part of the scene's
/// largest coordinate.
const TOLERANCE: f64 = 1e-6;

/// Bakes a planned scene, with its occluders where they count.
///
/// # Errors
/// [`TooLarge`] where a count does not fit the tables.
pub fn bake(scene: &Scene, plan: &Plan, occlusion: Option<Occlusion>) -> Result<Tables, TooLarge> {
    Content::of(scene, plan, occlusion)?.surveyed(scene)
}

/// Bakes a planned scene of linear patches with codes in place of its occluders.
///
/// Every sample is looked at once from every emitter: that takes longer than a
/// solve.
///
/// # Errors
/// [`TooLarge`] where a count does not fit the tables.
pub fn bake_coded(
    scene: &Scene,
    plan: &Plan,
    occlusion: Option<Occlusion>,
) -> Result<Tables, TooLarge> {
    in_place_of_occluders(scene, plan, occlusion, |computed, content| {
        content.replace_occluders(codes::of(computed));
        Ok(())
    })
}

/// Bakes a planned scene of linear patches with a matrix in place of its occluders,
/// its terms' factors of so many bits: 4, 6 or 8.
///
/// Takes as long as [`bake_coded`].
///
/// # Errors
/// [`TooLarge`] where a count does not fit the tables.
pub fn bake_matrix(
    scene: &Scene,
    plan: &Plan,
    occlusion: Option<Occlusion>,
    bits: u32,
) -> Result<Tables, TooLarge> {
    in_place_of_occluders(scene, plan, occlusion, |computed, content| {
        content.replace_occluders(matrix::of(computed, bits));
        Ok(())
    })
}

/// Bakes a planned scene with what every sample receives in the end of every
/// luminaire, in place of its occluders and of all that reflects.
///
/// Takes a solution for each luminaire.
///
/// # Errors
/// [`TooLarge`] where a count does not fit the tables, or the host.
pub fn bake_vectors(
    scene: &Scene,
    plan: &Plan,
    occlusion: Option<Occlusion>,
) -> Result<Tables, TooLarge> {
    in_place_of_occluders(scene, plan, occlusion, |computed, content| {
        let responses = vectors::of(computed);
        let responses = responses.map_err(|_| TooLarge { what: "samples" })?;
        content.replace_transfer(responses);
        Ok(())
    })
}

/// Bakes a scene with its occluders, and with what `replace` puts in their place.
fn in_place_of_occluders(
    scene: &Scene,
    plan: &Plan,
    occlusion: Option<Occlusion>,
    replace: impl FnOnce(&Tables, &mut Content) -> Result<(), TooLarge>,
) -> Result<Tables, TooLarge> {
    let mut content = Content::of(scene, plan, occlusion)?;
    let computed = content.surveyed(scene)?;
    replace(&computed, &mut content)?;
    let mut tables = content.tables(scene)?;
    tables.computed = Some(Box::new(computed));
    Ok(tables)
}

fn largest_coordinate(scene: &Scene) -> f64 {
    let vertices = scene.surfaces.iter().flat_map(|surface| &surface.vertices);
    vertices
        .map(|vertex| vertex.abs().max_element())
        .fold(0.0, f64::max)
}
