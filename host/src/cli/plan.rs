//! `isolux plan`: the samples of a scene within its budget, as a file.

mod search;

use super::choice::RungArguments;
use super::failure::Failure;
use super::pipeline;
use super::sheet::{self, Sheet};
use super::{MemoryArgument, RepaintArgument, SceneArgument};
use crate::plan::file;
use crate::report::write_file;
use crate::scene::Rungs;
use crate::scene::memory::Memory;
use crate::scene::settings::parse_bytes;
use clap::Args;
use search::Wishes;
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Places the samples of a scene, decides what shoots and what reconstructs, and
/// writes that as a file that can be edited and used again with --plan, also when
/// radiances or reflectances have changed since. Prints what it holds, costs and is
/// predicted to err by.
///
/// The samples, RAM and flash of the scene's budget are the most it takes, and the memory
/// of the tested board (memory.x) where that says nothing; a flag goes before each, and
/// the device that --memory names holds whatever they say. With --max-error it takes no
/// more samples than that needs.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArgument,
    /// The file to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// At most so many samples.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    samples: Option<u64>,
    /// At most so much RAM for light, visibility and reconstruction, such as 16KiB.
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    ram: Option<u64>,
    /// At most so much flash for the tables, such as 128KiB.
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    flash: Option<u64>,
    /// At most so many instructions of a Cortex-M4F for direct light and all shots until
    /// 0.1 % is unshot, as the budget sheet predicts them at most; without the load and
    /// without grids of surfaces.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    instructions: Option<u64>,
    /// The fewest samples with at most this predicted error, such as 2%: relative, the
    /// root of the mean square over all planned surfaces.
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    max_error: Option<f64>,
    #[command(flatten)]
    memory: MemoryArgument,
    #[command(flatten)]
    repaint: RepaintArgument,
    #[command(flatten)]
    rungs: RungArguments,
}

fn bytes(text: &str) -> Result<u64, String> {
    match parse_bytes(text)? {
        0 => Err("0 bytes hold no scene".to_owned()),
        bytes => Ok(bytes),
    }
}

/// "2%" as 0.02.
fn percent(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix('%').map(str::trim);
    let number = number.and_then(|number| number.parse::<f64>().ok());
    match number.filter(|&number| number > 0.0 && number.is_finite()) {
        Some(percent) => Ok(percent / 100.0),
        None => Err("an error is a number of percent above 0, such as 2% or 0.5%".to_owned()),
    }
}

#[derive(Serialize)]
struct Written {
    #[serde(flatten)]
    sheet: Sheet,
    file: String,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<(), Failure> {
    let scene = pipeline::read(&arguments.scene.scene)?;
    writable(&arguments.output)?;
    let budget = scene.budget;
    let memory = arguments.memory.read()?.map(|(memory, _)| memory);
    let device = memory.unwrap_or_else(Memory::of_the_board);
    // A device that is named holds whatever is wished for.
    let within = |wish: Option<u64>, has: u64| match memory {
        Some(_) => wish.map_or(has, |wish| wish.min(has)),
        None => wish.unwrap_or(has),
    };
    let ram = arguments.ram.or(budget.ram);
    let flash = arguments.flash.or(budget.flash);
    let wishes = Wishes {
        samples: arguments.samples.or(budget.samples),
        ram: Some(within(ram, device.ram)),
        flash: Some(within(flash, device.for_tables())),
        instructions: arguments.instructions,
        error: arguments.max_error,
    };
    let repaint = arguments.repaint.repaint;
    let found = search::plan(&scene, &arguments.rungs, repaint, &wishes)?;
    let planned = &found.planned;
    let rungs = Rungs {
        arithmetic: Some(planned.rung.name().to_owned()),
        visibility: Some(planned.sight.name().to_owned()),
        transfer: Some(planned.transfer.name().to_owned()),
        ..Rungs::default()
    };
    let operations = match found.operations {
        Some(operations) => operations,
        None => sheet::operations(planned, pipeline::stop(None))?,
    };
    let sheet = Sheet::of(planned)?.with_cost(&operations, None);
    let text = file::text(&planned.scene, &rungs, &planned.plan);
    write_file(&arguments.output, text.as_bytes()).map_err(|error| Failure::usage(error, ""))?;
    let file = arguments.output.display().to_string();
    let mut out = std::io::stdout().lock();
    if json {
        let written = Written { sheet, file };
        serde_json::to_writer(&mut out, &written).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        writeln!(out, "{}wrote {file}", sheet.in_words())?;
    }
    out.flush()?;
    Ok(())
}

/// Finds out before the work is done that there is no such directory.
fn writable(file: &Path) -> Result<(), Failure> {
    let directory = file
        .parent()
        .filter(|parent| !parent.as_os_str().is_empty());
    match directory {
        Some(directory) if !directory.is_dir() => Err(Failure::usage(
            format!(
                "cannot write {}: there is no such directory",
                file.display()
            ),
            "create it first, or name another file with -o FILE",
        )),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_percent_and_bytes_are_some() {
        assert_eq!(percent("2%"), Ok(0.02));
        assert_eq!(percent("0.5 %"), Ok(0.005));
        for wrong in ["2", "0%", "-1%", "nan%", "inf%", "%", ""] {
            assert!(percent(wrong).is_err(), "{wrong}");
        }
        assert_eq!(bytes("16KiB"), Ok(16384));
        assert!(bytes("0").is_err() && bytes("many").is_err());
    }
}
