//! What a firmware of one's own takes for a baked scene, read off a linked program.

use std::path::Path;

use serde::Serialize;

use super::emulator::Core;
use super::error::Error;
use super::firmware::{Build, Toolchain};
use super::{STEPS, size, stack};

/// The program of the firmware's package.
const PROGRAM: &str = "yours";

/// What a program is optimised for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Optimised {
    /// Few instructions: `opt-level = 3`.
    Speed,
    /// Few bytes: `opt-level = "s"` and the kernel's feature `small`.
    Size,
}

impl Optimised {
    /// The profile of the workspace.
    fn profile(self) -> &'static str {
        match self {
            Self::Speed => "firmware",
            Self::Size => "firmware-small",
        }
    }

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Size => "size",
        }
    }
}

/// What a linked program takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Linked {
    /// Bytes of code, start-up code included.
    pub code_bytes: u64,
    /// Bytes of constants beside the tables.
    pub constant_bytes: u64,
    /// Bytes of the tables.
    pub table_bytes: u64,
    /// Bytes of all flash, vector table included.
    pub flash_bytes: u64,
    /// Bytes of statics in RAM.
    pub ram_bytes: u64,
    /// The proved bound of the stack below the kernel's steps, in bytes.
    pub stack_bound_bytes: u64,
}

/// Links the program `yours` around a baked source and reads it: with
/// `samples_alone` nothing is put together from the samples.
///
/// # Errors
/// See [`Error`]: what is missing, a program that does not build.
pub fn linked(
    core: Core,
    baked: &Path,
    optimised: Optimised,
    samples_alone: bool,
) -> Result<Linked, Error> {
    let toolchain = Toolchain::find()?;
    toolchain.require(core)?;
    let disassembler = toolchain.tool("llvm-objdump")?;
    let directory = tempfile::tempdir().map_err(Error::io("creating a temporary directory"))?;
    let program = directory.path().join(PROGRAM);
    let mut features = vec!["ladder"];
    if samples_alone {
        features.push("samples-alone");
    }
    if optimised == Optimised::Size {
        features.push("small");
    }
    let build = Build {
        features: &features,
        bare: true,
        profile: optimised.profile(),
        environment: &[("ISOLUX_BAKED", baked.as_os_str())],
        ..Build::of(PROGRAM)
    };
    toolchain.link(core, &build, &program)?;
    let bytes = super::read(&program)?;
    let (code, constants) = size::code_and_constants(&bytes)?;
    let sizes = size::of(&bytes)?;
    Ok(Linked {
        code_bytes: code,
        constant_bytes: constants.saturating_sub(sizes.tables),
        table_bytes: sizes.tables,
        flash_bytes: sizes.flash,
        ram_bytes: sizes.ram,
        stack_bound_bytes: stack::bounds(&disassembler, &program, STEPS)?.deepest(),
    })
}
