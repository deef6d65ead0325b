//! `isolux device`: the baked scene on an emulated Cortex-M, bit by bit.

use super::choice::RungArguments;
use super::failure::Failure;
use super::pipeline::{self, Planned};
use super::render::GRID;
use super::sheet::{self, Sheet};
use super::{BouncesArgument, CurrentArgument, PlanArgument, SceneArgument};
use crate::device::operations::Operations;
use crate::device::{self, Core, Job, Measured, Options};
use crate::report::Progress;
use crate::scene::memory::Memory;
use crate::solve::Solution;
use clap::Args;
use serde::Serialize;
use std::io::Write;

/// Bakes a scene, builds the firmware around it, runs it on an emulated
/// Cortex-M4F, M7 and M3, and compares every sample and every resampled value with
/// the host's, bit by bit. Reports instructions, stack, RAM and flash.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArgument,
    #[command(flatten)]
    bounces: BouncesArgument,
    /// Build a firmware that is wrong by one bit: the comparison must fail.
    #[arg(long)]
    negative_control: bool,
    #[command(flatten)]
    plan: PlanArgument,
    /// Print the budget sheet too, made before the run, and hold the run to it: on the
    /// Cortex-M4F alone, in integers on the Cortex-M3 alone.
    #[arg(long)]
    sheet: bool,
    #[command(flatten)]
    current: CurrentArgument,
    #[command(flatten)]
    rungs: RungArguments,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<(), Failure> {
    let mut planned = pipeline::plan_or_read(
        pipeline::read(&arguments.scene.scene)?,
        &arguments.rungs,
        arguments.plan.plan.as_deref(),
        &[],
    )?;
    // The program that runs paints nothing.
    planned.plan.repaint = false;
    let bounces = arguments.bounces.bounces;
    let solution = planned.solve(bounces)?;
    let expected = expected(&planned, &solution)?;
    let job = Job {
        scene: &planned.scene.name,
        tables: planned.tables.bytes(),
        arithmetic: planned.rung.name(),
        visibility: planned.sight.name(),
        stop: pipeline::stop(bounces),
        resolution: GRID,
        expected: &expected,
        budget: planned.scene.budget,
    };
    let options = Options {
        negative_control: arguments.negative_control,
        // Integers have no use for the FPU's root.
        software_root: !planned.rung.is_integer() && !arguments.sheet,
        cores: match (arguments.sheet, planned.rung.is_integer()) {
            (true, false) => vec![Core::CortexM4F],
            (true, true) => vec![Core::CortexM3],
            (false, _) => Core::ALL.to_vec(),
        },
        ..Options::default()
    };
    let board = Memory::of_the_board();
    fits(&planned, "memory.x", board.flash, board.ram)?;
    let sheet = match arguments.sheet {
        true => Some(sheet_of(&planned, arguments)?),
        false => None,
    };
    let progress = Progress::start("building and emulating", 0);
    let measured = device::run(&job, &options).map_err(|error| Failure::limit(error, ""))?;
    progress.finish();
    let mut out = std::io::stdout().lock();
    if json {
        let answer = Answer {
            measured: &measured,
            sheet: sheet.as_ref(),
        };
        serde_json::to_writer(&mut out, &answer).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        if let Some(Sheeted { sheet, .. }) = &sheet {
            out.write_all(sheet.in_words().as_bytes())?;
        }
        out.write_all(in_words(&measured).as_bytes())?;
    }
    out.flush()?;
    verdict(&measured)?;
    match &sheet {
        Some(sheet) => kept(&sheet.sheet, &measured),
        None => Ok(()),
    }
}

#[derive(Serialize)]
struct Answer<'a> {
    #[serde(flatten)]
    measured: &'a Measured,
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    sheet: Option<&'a Sheeted>,
}

/// The sheet, and the operations that its instructions are the sum of.
#[derive(Serialize)]
struct Sheeted {
    sheet: Sheet,
    operations: Operations,
}

fn sheet_of(planned: &Planned, arguments: &Arguments) -> Result<Sheeted, Failure> {
    let operations = sheet::operations(planned, pipeline::stop(arguments.bounces.bounces))?;
    let current = arguments.current.microamperes;
    let sheet = Sheet::of(planned)?.with_cost(&operations, current);
    Ok(Sheeted { sheet, operations })
}

/// Refuses tables and a state that take more bytes of flash and of RAM than there are.
pub(super) fn fits(planned: &Planned, file: &str, flash: u64, ram: u64) -> Result<(), Failure> {
    let (tables, state) = (planned.tables.bytes().len() as u64, planned.ram()?.0 as u64);
    for (what, wish, needed, have) in [
        ("flash for its tables", "--flash", tables, flash),
        ("RAM", "--ram", state, ram),
    ] {
        if needed > have {
            return Err(Failure::limit(
                format!(
                    "scene `{}` needs {needed} bytes of {what}, {file} has {have} for that",
                    planned.scene.name
                ),
                format!(
                    "make a smaller plan: isolux plan SCENE {wish} {have} -o FILE, and --plan FILE"
                ),
            ));
        }
    }
    Ok(())
}

/// Whether the run kept to its sheet: RAM and flash to the byte, the stack within the
/// proved bound, instructions not above what was predicted at most.
fn kept(sheet: &Sheet, measured: &Measured) -> Result<(), Failure> {
    let memory = measured.memory;
    let bytes = memory.ram_bytes == measured.ram_bytes
        && memory.flash_bytes == measured.flash_bytes
        && measured.stack_bytes <= measured.stack_bound_bytes;
    let steps = sheet
        .predicted()
        .is_none_or(|steps| steps.hold(&measured.instructions_by_step));
    if bytes && steps {
        return Ok(());
    }
    Err(Failure::limit(
        "the run did not keep to its sheet",
        "bake the costs anew: cargo bench --bench model -- --write",
    ))
}

/// The bits of every sample and of every resampled grid, as the host has them.
fn expected(planned: &Planned, solution: &Solution<'_>) -> Result<Vec<u32>, Failure> {
    let mut bits = solution.irradiance_bits();
    for (index, surface) in planned.plan.surfaces.iter().enumerate() {
        if !surface.samples.is_empty() {
            let grid = solution.resample(index, GRID as u32);
            let grid = grid.map_err(|error| Failure::limit(error, ""))?;
            bits.extend(grid.bits);
        }
    }
    Ok(bits)
}

fn verdict(measured: &Measured) -> Result<(), Failure> {
    if !measured.bits_equal {
        return Err(Failure::limit(
            "the device's bits differ from the host's",
            "build this program again if the sources are newer than it; else a kernel operation is not the same on both (README, determinism)",
        ));
    }
    if !measured.budget.kept {
        return Err(Failure::limit(
            "the budget of the scene or the device is exceeded",
            "raise [budget] ram or flash in the scene, or lower its samples",
        ));
    }
    Ok(())
}

fn in_words(measured: &Measured) -> String {
    let mut text = format!(
        "{} on the device, {} values compared\n",
        measured.scene, measured.values
    );
    for target in &measured.targets {
        let verdict = if target.bits_equal {
            "all bits equal"
        } else {
            "BITS DIFFER"
        };
        text.push_str(&format!(
            "  {:<28} {verdict}, {} instructions\n",
            target.core, target.instructions
        ));
    }
    for skipped in &measured.skipped {
        text.push_str(&format!(
            "  {:<28} skipped: {}\n",
            skipped.core, skipped.why
        ));
    }
    let steps = &measured.instructions_by_step;
    text.push_str(&format!(
        "instructions on {}: load {}, direct {}, shoot {}, resample {}\n",
        measured
            .targets
            .first()
            .map_or("no core", |target| &target.core),
        steps.load,
        steps.direct,
        steps.shoot,
        steps.resample,
    ));
    text.push_str(&format!(
        "stack {} bytes (proved bound {}), RAM {} bytes, flash {} bytes ({} tables, {} code)\n",
        measured.stack_bytes,
        measured.stack_bound_bytes,
        measured.ram_bytes,
        measured.flash_bytes,
        measured.flash_tables_bytes,
        measured.flash_code_bytes,
    ));
    text
}
