//! The baked scene on an emulated Cortex-M: the same kernel, the same tables,
//! compared bit by bit with the host, and what it costs.
//!
//! [`run`] builds `tests/firmware` for the scene, runs it on each core, reads
//! its log and compares. What it measures:
//!
//! * **Instructions** are counted by the emulator, not sampled: two runs of one
//!   program give the same number. Cycles of a real part depend on its flash
//!   and are not claimed.
//! * **Stack** is painted below each kernel call and looked for afterwards; the
//!   bound read off the linked program ([`stack`]) stands beside it.
//! * **RAM and flash** are the sections of the linked program, logger included;
//!   the parts that are tables and kernel code are told apart.
//!
//! Needs the checkout this program was built from, cargo with the cores' targets
//! ([`Core::target`]) and the component `llvm-tools`, and `qemu-system-arm`; what is missing is an error that says how to install it.

mod cost;
mod emulator;
mod error;
mod firmware;
mod flash;
mod hash;
mod linked;
mod log;
mod measured;
pub mod model;
pub mod operations;
mod relit;
mod size;
pub mod stack;
mod trace;

pub use cost::{Cost, costs};
pub use emulator::Core;
pub use error::Error;
pub use firmware::{Build, Toolchain};
pub use flash::{Extent, Flash, flash};
pub use hash::{Hashed, hashes};
pub use linked::{Linked, Optimised, linked};
pub use measured::{Allowed, Difference, Measured, Skipped, Steps, Target};
pub use relit::{Relit, messages, relit};
pub use trace::{Traced, traces};

use std::fs;
use std::path::Path;
use std::time::Duration;

use isolux::shoot::Stop;

use crate::scene::Budget;
use crate::scene::memory::Memory;
use firmware::Variant;
use log::Log;

/// The functions of the firmware that are the kernel's steps.
const STEPS: &str = "isolux_step_";

/// A baked scene and the answer the host's kernel gave.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// The scene's name.
    pub scene: &'a str,
    /// The baked tables.
    pub tables: &'a [u8],
    /// The name of the rung of arithmetic.
    pub arithmetic: &'a str,
    /// The name of the rung of visibility.
    pub visibility: &'a str,
    /// When to stop shooting.
    pub stop: Stop,
    /// Rows and columns of each resampled grid.
    pub resolution: usize,
    /// Bits of what the host's kernel gives for the same tables: the irradiance
    /// of every sample in the tables' order, then, for every surface that has
    /// samples, its grid row by row.
    pub expected: &'a [u32],
    /// What the scene may spend.
    pub budget: Budget,
}

/// How to run a [`Job`].
#[derive(Clone, Debug)]
pub struct Options {
    /// The cores; the first is the one whose costs are reported.
    pub cores: Vec<Core>,
    /// Also run the first core with libm's square root in place of the FPU's.
    pub software_root: bool,
    /// Flip one bit of one value on the device: the comparison must see it.
    pub negative_control: bool,
    /// How long one emulation may take.
    pub time_limit: Duration,
}

impl Default for Options {
    /// Every core, both roots, two minutes each.
    fn default() -> Self {
        Self {
            cores: Core::ALL.to_vec(),
            software_root: true,
            negative_control: false,
            time_limit: Duration::from_secs(120),
        }
    }
}

/// Builds the firmware for a job, runs it on every core, and compares.
///
/// # Errors
/// See [`Error`]. Values that differ are no error: [`Measured::bits_equal`]
/// says so. A core whose Rust target is not installed is skipped, except the
/// first.
pub fn run(job: &Job<'_>, options: &Options) -> Result<Measured, Error> {
    let Some(&first) = options.cores.first() else {
        return Err(Error::Program {
            what: "no core was asked for".to_owned(),
        });
    };
    let toolchain = Toolchain::find()?;
    toolchain.require(first)?;
    let disassembler = toolchain.tool("llvm-objdump")?;
    let directory = tempfile::tempdir().map_err(Error::io("creating a temporary directory"))?;
    let program = directory.path().join("firmware");
    let variant = Variant {
        wrong_bit: options.negative_control,
        software_root: false,
    };

    let mut reported = None;
    let mut targets = Vec::new();
    let mut skipped = Vec::new();
    for &core in &options.cores {
        if let Err(missing) = toolchain.require(core) {
            skipped.push(Skipped {
                core: core.name().to_owned(),
                why: missing.to_string(),
            });
            continue;
        }
        toolchain.link_for(job, core, variant, &program)?;
        let log = emulate(core, &program, options.time_limit)?;
        targets.push(Target::new(core.name().to_owned(), &log, job.expected));
        if reported.is_none() {
            reported = Some((log, Inspected::new(&disassembler, &program)?));
        }
    }
    let mut instructions_software_root = None;
    if options.software_root {
        let variant = Variant {
            software_root: true,
            ..variant
        };
        toolchain.link_for(job, first, variant, &program)?;
        let log = emulate(first, &program, options.time_limit)?;
        let name = format!("{}, software root", first.name());
        let target = Target::new(name, &log, job.expected);
        instructions_software_root = Some(target.instructions);
        targets.push(target);
    }
    let (log, inspected) = reported.ok_or_else(|| Error::Program {
        what: "no core was run".to_owned(),
    })?;
    let steps = Steps::of(&log);
    let painted = log.steps.values().map(|step| step.stack).max().unwrap_or(0);
    Ok(Measured {
        scene: job.scene.to_owned(),
        bits_equal: targets.iter().all(|target| target.bits_equal),
        targets,
        skipped,
        values: log.values.len(),
        instructions: steps.total(),
        instructions_by_step: steps,
        instructions_software_root,
        shots: log.shots,
        form_factors: log.form_factors,
        unshot: log.unshot,
        memory: log.memory,
        stack_bytes: painted,
        stack_bound_bytes: inspected.stack,
        ram_bytes: inspected.sizes.ram,
        flash_bytes: inspected.sizes.flash,
        flash_tables_bytes: inspected.sizes.tables,
        flash_code_bytes: inspected.sizes.flash - inspected.sizes.tables,
        flash_kernel_code_bytes: inspected.code,
        budget: inspected.allowed(job.budget),
    })
}

/// What the linked program says of itself.
struct Inspected {
    sizes: size::Sizes,
    stack: u64,
    code: u64,
}

impl Inspected {
    /// Sections, the stack's bound and the kernel's share of the code.
    fn new(disassembler: &Path, program: &Path) -> Result<Self, Error> {
        let bounds = stack::bounds(disassembler, program, STEPS)?;
        Ok(Self {
            sizes: size::of(&read(program)?)?,
            stack: bounds.deepest(),
            code: bounds.code,
        })
    }

    /// What was allowed, and whether it was kept.
    fn allowed(&self, budget: Budget) -> Allowed {
        let board = Memory::of_the_board();
        let within = |used, limit: Option<u64>, device| used <= limit.unwrap_or(device).min(device);
        Allowed {
            ram_bytes: budget.ram,
            flash_bytes: budget.flash,
            device_ram_bytes: board.ram,
            device_flash_bytes: board.flash,
            kept: within(self.sizes.ram + self.stack, budget.ram, board.ram)
                && within(self.sizes.flash, budget.flash, board.flash),
        }
    }
}

/// Runs a program on a core and reads its log to the end.
fn emulate(core: Core, program: &Path, limit: Duration) -> Result<Log, Error> {
    let output = emulator::run(core, program, limit)?;
    let log = log::read(&read(program)?, &output.console)?;
    if output.status != Some(0) {
        let mut said = log.errors;
        said.push(output.complaints);
        said.retain(|line| !line.is_empty());
        return Err(Error::Firmware {
            core: core.name(),
            status: output.status,
            said: said.join("; "),
        });
    }
    if log.ended != Some(log.values.len()) {
        return Err(Error::Log {
            what: format!(
                "it holds {} values, and its end speaks of {:?}",
                log.values.len(),
                log.ended
            ),
        });
    }
    Ok(log)
}

/// The bytes of a linked program.
fn read(program: &Path) -> Result<Vec<u8>, Error> {
    fs::read(program).map_err(Error::io(format!("reading {}", program.display())))
}
