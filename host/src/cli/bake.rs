//! `isolux bake`: the tables of a scene, and the source a firmware takes them with.

use super::choice::RungArguments;
use super::device;
use super::failure::Failure;
use super::pipeline::{self, Planned};
use super::sheet::{self, Sheet};
use super::{CurrentArgument, MemoryArgument, PlanArgument, RepaintArgument, SceneArgument};
use crate::bake::{Described, Names, source};
use crate::report::{warn, write_file};
use crate::scene::memory::Memory;
use clap::Args;
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Bakes a scene for a firmware of your own: NAME.isolux, the tables; NAME.rs, a Rust
/// module with the types and constants that go with them; NAME.md and NAME.json, the
/// budget sheet. NAME is that of the scene file. The same scene gives the same bytes.
/// Tables or a state larger than what --memory has are refused; without it larger than
/// what the tested board has (memory.x), where the scene has no [budget] flash or ram.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArgument,
    /// The directory for the files; made where it does not exist.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    plan: PlanArgument,
    #[command(flatten)]
    memory: MemoryArgument,
    #[command(flatten)]
    current: CurrentArgument,
    #[command(flatten)]
    repaint: RepaintArgument,
    #[command(flatten)]
    rungs: RungArguments,
}

#[derive(Serialize)]
struct Baked {
    #[serde(flatten)]
    sheet: Sheet,
    files: Vec<String>,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<(), Failure> {
    let scene = pipeline::read(&arguments.scene.scene)?;
    let memory = arguments.memory.read()?;
    let directory = &arguments.output;
    // Before the work is done.
    std::fs::create_dir_all(directory).map_err(|error| {
        Failure::usage(
            format!("cannot make the directory {}: {error}", directory.display()),
            "name another one with -o DIR",
        )
    })?;
    let plan = arguments.plan.plan.as_deref();
    let mut planned = pipeline::plan_or_read(scene, &arguments.rungs, plan, &[])?;
    planned.repaint(arguments.repaint.repaint)?;
    planned.affordable()?;
    held(&planned, memory)?;
    let operations = sheet::operations(&planned, pipeline::stop(None))?;
    let current = arguments.current.microamperes;
    let sheet = Sheet::of(&planned)?.with_cost(&operations, current);
    let files = write(&planned, &sheet, directory, &module(&arguments.scene.scene))?;
    let mut out = std::io::stdout().lock();
    if json {
        let baked = Baked { sheet, files };
        serde_json::to_writer(&mut out, &baked).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        write!(out, "{}", sheet.in_words())?;
        for file in files {
            writeln!(out, "wrote {file}")?;
        }
    }
    out.flush()?;
    Ok(())
}

/// Refuses what the named device cannot hold, or where there is none what that of `memory.x`
/// cannot and the scene has no budget for; warns of tables that leave less to the code than
/// a plan does.
fn held(planned: &Planned, memory: Option<(Memory, String)>) -> Result<(), Failure> {
    let budget = planned.scene.budget;
    let is_named = memory.is_some();
    let (memory, file) = match memory {
        Some(named) => named,
        None => (Memory::of_the_board(), "memory.x".to_owned()),
    };
    let most = |budget: Option<u64>, has: u64| match is_named {
        true => has,
        false => budget.unwrap_or(has),
    };
    let (flash, ram) = (
        most(budget.flash, memory.flash),
        most(budget.ram, memory.ram),
    );
    device::fits(planned, &file, flash, ram)?;
    let tables = planned.tables.bytes().len() as u64;
    let planned_for = most(budget.flash, memory.for_tables());
    if tables > planned_for {
        let for_code = memory.flash - memory.for_tables();
        warn(&format!(
            "the tables take {tables} bytes of flash, and {file} has {planned_for} beside {for_code} of code; \
             `isolux plan SCENE --flash {planned_for} -o FILE` makes a plan that fits"
        ));
    }
    Ok(())
}

/// Writes the four files, each whole or not at all; the source last, so that what it
/// speaks of is there.
fn write(
    planned: &Planned,
    sheet: &Sheet,
    directory: &Path,
    name: &str,
) -> Result<Vec<String>, Failure> {
    let tables = format!("{name}.isolux");
    let source = source(&Described {
        scene: &planned.scene.name,
        tables: planned.tables.bytes(),
        file: &tables,
        arithmetic: planned.rung,
        sight: planned.sight,
        repaint: planned.plan.repaint,
        names: &Names::of(&planned.scene),
    });
    let source = source.ok_or_else(|| Failure::limit("the tables have no head", ""))?;
    let json = serde_json::to_string_pretty(sheet).map_err(std::io::Error::from)?;
    let contents = [
        (tables, planned.tables.bytes().to_vec()),
        (format!("{name}.md"), sheet.in_markdown().into_bytes()),
        (format!("{name}.json"), (json + "\n").into_bytes()),
        (format!("{name}.rs"), source.into_bytes()),
    ];
    let mut files = Vec::new();
    for (file, bytes) in contents {
        let path = directory.join(file);
        write_file(&path, &bytes).map_err(|error| Failure::usage(error, ""))?;
        files.push(path.display().to_string());
    }
    Ok(files)
}

/// The name of a scene file as that of a Rust module.
fn module(scene: &Path) -> String {
    let stem = scene.file_stem().map(|stem| stem.to_string_lossy());
    let letter = |c: char| match c {
        c if c.is_ascii_alphanumeric() => c.to_ascii_lowercase(),
        _ => '_',
    };
    let name: String = stem
        .iter()
        .flat_map(|stem| stem.chars())
        .map(letter)
        .collect();
    match name.chars().next() {
        Some(first) if first.is_ascii_alphabetic() => name,
        _ => format!("scene_{name}"),
    }
}

#[cfg(test)]
mod tests {
    use super::module;
    use std::path::Path;

    #[test]
    fn scene_files_name_modules() {
        for (scene, name) in [
            ("paper", "paper"),
            ("scenes/Paper-Aspect.toml", "paper_aspect"),
            ("2.toml", "scene_2"),
            ("büro.v2.toml", "b_ro_v2"),
        ] {
            assert_eq!(module(Path::new(scene)), name);
        }
    }
}
