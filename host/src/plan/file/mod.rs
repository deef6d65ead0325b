//! Plans as files: to be read, edited by hand and used again.
//!
//! A plan file is TOML. It holds what [`crate::bake`] needs beside the scene, so that
//! a scene whose radiances or reflectances have changed since is baked without being
//! planned anew. What belongs to the scene alone is not in it: a surface's frame is
//! made of the scene's own surface, and only compared with what the plan was made for.
//!
//! Numbers are written with the fewest digits that the tables keep: [`text`] and
//! [`parse`] make a plan that bakes to the same bytes.
//!
//! ```toml
//! isolux-plan = 1
//! scene = "paper"
//! [rungs]
//! arithmetic = "best"
//! [[surface]]
//! name = "A"
//! emits = false
//! origin = [-2.5, -2.5, 0.0]
//! u = [1.0, 0.0, 0.0]
//! v = [0.0, 1.0, 0.0]
//! size = [5.0, 5.0]
//! area = 25.0
//! samples = [
//!   [1.25, 1.25, "grid"],
//! ]
//! [end]
//! ```

mod emitters;
mod fields;
mod samples;
mod surfaces;
mod write;

use super::Plan;
use crate::scene::diagnostic::Diagnostic;
use crate::scene::document::{Document, Table};
use crate::scene::{Rungs, Scene, file, settings};
use std::path::Path;
use toml::de::DeTable;
pub use write::text;

/// The version of plan files that this program reads and writes.
pub const VERSION: i128 = 1;

/// What a plan file holds.
#[derive(Clone, Debug)]
pub struct Saved {
    /// The rungs of arithmetic, visibility and transfer that it was planned for;
    /// those of the other ladders are what the plan is.
    pub rungs: Rungs,
    /// The plan, in the frames of the scene.
    pub plan: Plan,
}

/// Two lengths or areas are the same within this part of them.
const SAME: f64 = 1e-9;

/// What is done about a plan that does not belong to the scene.
const ANEW: &str = "plan the scene anew with `isolux plan`";

/// Reads the plan file at `path` for a scene.
///
/// # Errors
/// A [`Diagnostic`] where the file cannot be read, breaks a rule of the format or was
/// made for other surfaces. Never panics.
pub fn read(path: &Path, scene: &Scene) -> Result<Saved, Diagnostic> {
    parse(&path.display().to_string(), &file::read_text(path)?, scene)
}

/// Validates the plan file `source` for a scene; `name` is what diagnostics call it.
///
/// # Errors
/// As [`read`].
pub fn parse(name: &str, source: &str, scene: &Scene) -> Result<Saved, Diagnostic> {
    let document = Document { name, source };
    let entries = DeTable::parse(source).map_err(|error| document.syntax_error(&error))?;
    let root = Table::root(document, entries.get_ref(), "a plan");
    check_version(&root)?;
    let root = root.only(&["isolux-plan", "scene", "repaint", "rungs", "surface", "end"])?;
    let rungs = read_rungs(&root)?;
    let repaint = root.optional("repaint");
    let repaint = repaint.map_or(Ok(false), |field| field.truth("`repaint = true`"))?;
    let surfaces = surfaces::read(&root, scene)?;
    if root.optional("end").is_none() {
        let end = source.len().saturating_sub(1)..source.len();
        return Err(document.error(
            end,
            "the plan breaks off: it has no `[end]`",
            "take a whole copy of the file, or plan the scene anew with `isolux plan`",
        ));
    }
    Ok(Saved {
        rungs,
        plan: Plan { surfaces, repaint },
    })
}

/// The ladders of which the plan itself does not show the rung.
const LADDERS: [&str; 3] = ["arithmetic", "visibility", "transfer"];

fn read_rungs(root: &Table<'_>) -> Result<Rungs, Diagnostic> {
    if let Some(field) = root.optional("rungs") {
        field
            .table("the table `[rungs]` of a plan")?
            .only(&LADDERS)?;
    }
    settings::rungs(root)
}

fn check_version(root: &Table<'_>) -> Result<(), Diagnostic> {
    let Some(version) = root.optional("isolux-plan") else {
        return Err(root.error(
            "this is no plan file: it has no `isolux-plan`",
            "name a file that `isolux plan` wrote",
        ));
    };
    if version.as_integer() != Some(VERSION) {
        return Err(version.error(
            format!("unknown version of plan files: this program reads version {VERSION}"),
            ANEW,
        ));
    }
    Ok(())
}
