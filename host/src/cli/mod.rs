//! The command line: one file per command, on top of every other room.
//!
//! stdout carries the answer alone; progress and complaints go to stderr. Exit
//! codes: 0 done, 1 a stated limit or comparison failed, 2 bad usage or input.

mod bake;
mod check;
mod choice;
mod device;
mod failure;
mod form_factor;
mod pipeline;
mod plan;
mod render;
mod sheet;
mod solve;
mod trade;

use crate::scene::diagnostic::Diagnostic;
use crate::scene::memory::Memory;
use clap::{Args, Parser, Subcommand};
use failure::Failure;
use std::path::PathBuf;
use std::process::ExitCode;

/// How much light reaches every surface of a scene, on a microcontroller,
/// inside a fixed budget.
///
/// Without a command: renders the paper's scene into ./isolux-out.
#[derive(Debug, Parser)]
#[command(name = "isolux", version, max_term_width = 100)]
struct Arguments {
    /// Print one JSON document on stdout.
    #[arg(long, global = true)]
    json: bool,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Validate a scene and say what it requires.
    Check(check::Arguments),
    /// Place the samples of a scene within its budget, and write them down.
    Plan(plan::Arguments),
    /// Bake a scene for a firmware of your own: tables, Rust source, budget sheet.
    Bake(bake::Arguments),
    /// Plan, solve and judge a scene; draw pictures and the error table.
    Render(render::Arguments),
    /// Irradiance at points, evaluated by the kernel.
    Solve(solve::Arguments),
    /// Form factors of polygons, JSON lines in and out.
    FormFactor(form_factor::Arguments),
    /// Run the baked scene on an emulated Cortex-M and compare the bits.
    Device(device::Arguments),
    /// Measure every rung of arithmetic: error against cost.
    Trade(trade::Arguments),
}

/// A scene file, by path or by the name of a shipped scene.
#[derive(Debug, Args)]
struct SceneArgument {
    /// The scene file, or the name of a scene that isolux ships: paper, paper-aspect,
    /// penumbra, cornell, cornell-rgb, office.
    scene: PathBuf,
}

/// A plan to use in place of planning.
#[derive(Clone, Debug, Default, Args)]
struct PlanArgument {
    /// A plan file that `isolux plan` wrote for these surfaces: nothing is planned.
    #[arg(long, value_name = "FILE")]
    plan: Option<PathBuf>,
}

/// What the device has.
#[derive(Clone, Debug, Default, Args)]
struct MemoryArgument {
    /// The linker script of your firmware, such as memory.x: no more than the regions FLASH
    /// (beside 96 KiB or half of it for code) and RAM hold. Default: the board that isolux
    /// is tested on, 256 KiB and 64 KiB, where the scene has no [budget].
    #[arg(long, value_name = "FILE")]
    memory: Option<PathBuf>,
}

impl MemoryArgument {
    /// The memory that was given, and the name of its file.
    fn read(&self) -> Result<Option<(Memory, String)>, Failure> {
        let Some(path) = &self.memory else {
            return Ok(None);
        };
        let name = path.display().to_string();
        let source = std::fs::read_to_string(path).map_err(|error| {
            let remedy = "name the linker script that says what the device has";
            Diagnostic::of_file(&name, format!("cannot read it: {error}"), remedy)
        })?;
        Ok(Some((Memory::parse(&name, &source)?, name)))
    }
}

/// Whether walls are painted.
#[derive(Clone, Copy, Debug, Default, Args)]
struct RepaintArgument {
    /// Leaves room on the device for reflectances that change there (`set_reflectance`), 4
    /// bytes a surface and channel; a plan file that says so does it as well.
    #[arg(long)]
    repaint: bool,
}

/// What a part draws.
#[derive(Clone, Copy, Debug, Default, Args)]
struct CurrentArgument {
    /// The current that the part draws for each megahertz of its clock, in µA: the sheet
    /// then has the charge of a run.
    #[arg(long = "microamperes-per-mhz", value_name = "µA")]
    microamperes: Option<f64>,
}

/// How often light is reflected.
#[derive(Debug, Args)]
struct BouncesArgument {
    /// Light reflected at most so many times; 0 is direct light only.
    /// Default: until the unshot power is below 0.001 of the emitted power.
    #[arg(long, value_name = "N")]
    bounces: Option<u32>,
}

/// Runs the program on its command line.
pub fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            let usage = error.use_stderr();
            // A closed stdout or stderr leaves nobody to tell.
            let _ = error.print();
            return ExitCode::from(if usage { 2 } else { 0 });
        }
    };
    if arguments.json {
        crate::report::silence();
    }
    match run(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.tell(),
    }
}

fn run(arguments: Arguments) -> Result<(), Failure> {
    let json = arguments.json;
    match arguments.command {
        None => render::run(&render::Arguments::of_the_paper(), json),
        Some(Command::Check(arguments)) => check::run(&arguments, json),
        Some(Command::Plan(arguments)) => plan::run(&arguments, json),
        Some(Command::Bake(arguments)) => bake::run(&arguments, json),
        Some(Command::Render(arguments)) => render::run(&arguments, json),
        Some(Command::Solve(arguments)) => solve::run(&arguments, json),
        Some(Command::FormFactor(arguments)) => form_factor::run(&arguments, json),
        Some(Command::Device(arguments)) => device::run(&arguments, json),
        Some(Command::Trade(arguments)) => trade::run(&arguments, json),
    }
}
