//! What single rungs take of the flash, each in a program of its own.
//!
//! [`flash`] builds the firmware's program `rung` with one rung, and once with
//! none: the difference is the rung's. Nothing is run.

use std::collections::BTreeSet;

use super::emulator::Core;
use super::error::Error;
use super::firmware::{Build, Toolchain};
use super::size;

/// The program of the firmware's package.
const PROGRAM: &str = "rung";

/// How much of the kernel a program holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// The form factor with the emitter's plane and reach known.
    FormFactor,
    /// All that a firmware calls: loading, direct light, shooting, resampling;
    /// with an integer rung also the form factor and the light at a place.
    WholeKernel,
}

/// What a program with one rung takes, less one with none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flash {
    /// The rung.
    pub rung: String,
    /// Bytes of code, with the constants inside it.
    pub code_bytes: u64,
    /// Bytes of constants apart from the code.
    pub constant_bytes: u64,
    /// The mangled names of all functions in the program, also of those that
    /// are part of others.
    pub functions: BTreeSet<String>,
}

/// What each rung takes on a core.
///
/// # Errors
/// See [`Error`]: what is missing, a program that does not build.
pub fn flash(core: Core, rungs: &[&str], extent: Extent) -> Result<Vec<Flash>, Error> {
    let toolchain = Toolchain::find()?;
    toolchain.require(core)?;
    let directory = tempfile::tempdir().map_err(Error::io("creating a temporary directory"))?;
    let path = directory.path().join(PROGRAM);
    let link = |features: &[&str]| {
        let build = Build {
            features,
            bare: true,
            ..Build::of(PROGRAM)
        };
        toolchain.link(core, &build, &path)?;
        super::read(&path)
    };
    let (start, start_constants) = size::code_and_constants(&link(&[])?)?;
    let mut found = Vec::new();
    for rung in rungs {
        let feature = format!("rung-{rung}");
        let program = match extent {
            Extent::FormFactor => link(&[&feature])?,
            Extent::WholeKernel => link(&[&feature, "whole-kernel"])?,
        };
        let (code, constants) = size::code_and_constants(&program)?;
        found.push(Flash {
            rung: (*rung).to_owned(),
            code_bytes: code.saturating_sub(start),
            constant_bytes: constants.saturating_sub(start_constants),
            functions: size::function_names(&program)?,
        });
    }
    Ok(found)
}
