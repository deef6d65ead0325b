//! `isolux trade`: every rung measured.

mod rooms;
mod whole;

use super::choice::RungArguments;
use super::failure::Failure;
use super::pipeline;
use super::render::make;
use crate::picture::{TradeMark, TradePanel, trade_off};
use crate::reference::Reflections;
use crate::report::{Progress, write_file};
use crate::solve::FormFactorRung;
use crate::trade::room::InRoom;
use crate::trade::scene::{InScene, Judged};
use crate::trade::{self, FormFactors, Part, Trade, table};
use clap::Args;
use serde::Serialize;
use std::io::Write;
use std::path::PathBuf;

/// Measures every rung of arithmetic: error by class on 2400 form factors,
/// exact instructions, estimated cycles and bytes of code on the emulated
/// device, time on this machine; with a scene, its irradiance and its cost as
/// well, and so with every rung of visibility, emitters and transfer. Writes
/// trade.csv, trade-classes.csv and trade.png; with a scene trade-scene.csv,
/// trade-room.csv and trade-room.png too; with --whole trade-whole.csv and
/// trade-whole.png alone.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The scene file, or the name of a scene that isolux ships; without one,
    /// form factors alone.
    scene: Option<PathBuf>,
    /// The directory for the files; made where it does not exist.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Light in the scene is reflected at most so many times. Without it once
    /// where rungs of arithmetic are measured, else until 0.1 % is unshot.
    #[arg(long, value_name = "N", requires = "scene")]
    bounces: Option<u32>,
    /// Only the rungs of visibility, emitters and transfer in the scene.
    #[arg(long, requires = "scene")]
    without_arithmetic: bool,
    /// Only the whole way from samples to surfaces: numbers of samples by reconstruction
    /// and emitters, each planned anew, error against predicted instructions and bytes of
    /// tables. Writes trade-whole.csv and trade-whole.png.
    #[arg(long, requires = "scene", conflicts_with_all = ["without_arithmetic", "plan", "bounces"])]
    whole: bool,
    /// Samples that --whole plans with.
    #[arg(long, value_name = "N,N,..", requires = "whole", value_delimiter = ',',
          default_values_t = whole::SAMPLES, value_parser = clap::value_parser!(u64).range(1..))]
    samples: Vec<u64>,
    /// A plan file that `isolux plan` wrote for the scene: what has its emitters is not
    /// planned.
    #[arg(long, value_name = "FILE", requires = "scene")]
    plan: Option<PathBuf>,
    #[command(flatten)]
    rungs: RungArguments,
}

#[derive(Serialize)]
struct Traded<'a> {
    form_factors: &'a [FormFactors],
    parts: &'a [Part],
    scene: Option<SceneTraded<'a>>,
    /// Why the device's figures are missing.
    missing: Option<String>,
    files: &'a [String],
}

#[derive(Serialize)]
struct SceneTraded<'a> {
    name: &'a str,
    reflections: u32,
    rungs: &'a [InScene],
    room: &'a [InRoom],
}

/// What was measured in a scene.
struct OfScene {
    name: String,
    reflections: u32,
    rungs: Vec<InScene>,
    room: Vec<InRoom>,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<(), Failure> {
    if let (true, Some(scene)) = (arguments.whole, &arguments.scene) {
        let scene = pipeline::read(scene)?;
        make(&arguments.output)?;
        return whole::run(arguments, &scene, json);
    }
    // A scene that cannot be and a directory that cannot be made are found out
    // before the work is done.
    // All rungs in floating point share one bake, whatever the scene asks for.
    let mut every_rung = arguments.rungs.clone();
    // Emitters are what is traded: light is evaluated from them.
    every_rung.at_points = true;
    every_rung.arithmetic = Some(FormFactorRung::default().name().to_owned());
    let planned = match &arguments.scene {
        Some(path) => {
            let plan = arguments.plan.as_deref();
            Some(pipeline::plan_or_read(
                pipeline::read(path)?,
                &every_rung,
                plan,
                &[],
            )?)
        }
        None => None,
    };
    make(&arguments.output)?;
    let step = |name: &str| Progress::start(name, 0).finish();
    if let (true, Some(planned)) = (arguments.without_arithmetic, &planned) {
        return rooms::run(arguments, planned, json, step);
    }
    let measured = trade::form_factors(step).map_err(|error| Failure::limit(error, ""))?;
    let Trade {
        rungs: rows,
        parts,
        missing,
    } = measured;
    let missing = missing.map(|error| error.to_string());
    if let Some(missing) = &missing {
        // A closed stderr leaves nobody to tell.
        let _ = writeln!(
            std::io::stderr(),
            "no figures of the device, or not all: {missing}"
        );
    }
    let scene = match &planned {
        Some(planned) => {
            let reflections = arguments.bounces.unwrap_or(1);
            let judged = Judged {
                scene: &planned.scene,
                plan: &planned.plan,
                tables: &planned.tables,
                sight: planned.sight,
                reflections,
                direct: &pipeline::judge(&planned.scene, Reflections::AtMost(0))?,
                all: &pipeline::judge(&planned.scene, Reflections::AtMost(reflections as usize))?,
            };
            let on_device = rows.iter().any(|row| row.device.is_some());
            let found = trade::scene(&judged, on_device, step);
            let found = found.map_err(|error| Failure::limit(error, ""))?;
            let scene = &planned.scene;
            Some(OfScene {
                name: scene.name.clone(),
                reflections,
                rungs: found,
                room: rooms::measure(arguments, planned, on_device, step)?,
            })
        }
        None => None,
    };
    let files = write(arguments, (&rows, &parts), scene.as_ref())?;
    let mut out = std::io::stdout().lock();
    if json {
        let traded = Traded {
            form_factors: &rows,
            parts: &parts,
            scene: scene.as_ref().map(|scene| SceneTraded {
                name: &scene.name,
                reflections: scene.reflections,
                rungs: &scene.rungs,
                room: &scene.room,
            }),
            missing,
            files: &files,
        };
        serde_json::to_writer(&mut out, &traded).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        writeln!(
            out,
            "form factors: |F - exact|, and of tiny emitters |F - exact|/exact"
        )?;
        writeln!(
            out,
            "cost of a quad's on a Cortex-M4F, cycles estimated; on M3: instructions there; front: * absolute, o relative"
        )?;
        writeln!(out, "{}", table::terminal(&rows))?;
        for part in &parts {
            writeln!(out, "{}", table::part_terminal(part))?;
        }
        if let Some(OfScene {
            name,
            reflections: times,
            rungs,
            room,
        }) = &scene
        {
            writeln!(
                out,
                "\n{name}: irradiance, percent of full scale, light reflected at most {times} times"
            )?;
            writeln!(out, "{}", table::scene_terminal(rungs))?;
            write!(out, "\n{}", rooms::in_words(name, room))?;
        }
        for file in &files {
            writeln!(out, "wrote {file}")?;
        }
    }
    out.flush()?;
    Ok(())
}

/// Writes the files and gives their names.
fn write(
    arguments: &Arguments,
    (rows, parts): (&[FormFactors], &[Part]),
    scene: Option<&OfScene>,
) -> Result<Vec<String>, Failure> {
    let picture = plot(rows).and_then(|picture| picture.png());
    let picture = picture.map_err(|error| Failure::limit(error, ""))?;
    let mut files = vec![
        ("trade.csv", table::csv(rows, parts).into_bytes()),
        ("trade-classes.csv", table::classes_csv(rows).into_bytes()),
        ("trade.png", picture),
    ];
    if let Some(scene) = scene {
        let text = table::scene_csv(&scene.name, scene.reflections, &scene.rungs);
        files.push(("trade-scene.csv", text.into_bytes()));
        files.extend(rooms::files(&scene.name, &scene.room)?);
    }
    written(arguments, files)
}

/// Writes files into the directory and gives their paths.
fn written(arguments: &Arguments, files: Vec<(&str, Vec<u8>)>) -> Result<Vec<String>, Failure> {
    let mut written = Vec::new();
    for (name, bytes) in files {
        let path = arguments.output.join(name);
        write_file(&path, &bytes).map_err(|error| Failure::usage(error, ""))?;
        written.push(path.display().to_string());
    }
    Ok(written)
}

fn plot(rows: &[FormFactors]) -> Result<crate::picture::Picture, crate::picture::PictureError> {
    let device = rows.iter().filter_map(|row| row.device.as_ref());
    let cost = match (
        device.clone().count() > 0,
        device.clone().all(|d| d.m4f_cycles.is_some()),
    ) {
        (true, true) => "estimated cycles of a quad, Cortex-M4F",
        (true, false) => "instructions of a quad, Cortex-M4F",
        _ => "nanoseconds of a form factor, this machine",
    };
    let panel = |error: &str, of: fn(&FormFactors) -> (f64, bool)| TradePanel {
        cost: cost.to_owned(),
        error: error.to_owned(),
        marks: rows
            .iter()
            .map(|row| {
                let (error, on_front) = of(row);
                TradeMark {
                    name: row.rung.to_owned(),
                    cost: row.cost(),
                    error,
                    on_front,
                }
            })
            .collect(),
        lines: Vec::new(),
    };
    let captions = [
        "left: any emitter, the largest error; right: relative error for F from 1e-13 to 1e-3 (1: no digit is right)",
        "filled: on the Pareto front, nothing is both as cheap and as good; the line is what a cost buys",
    ];
    trade_off(
        "Rungs of arithmetic: error of a form factor against its cost",
        &captions.map(str::to_owned),
        &[
            panel("largest |F - exact|", |row| (row.error.max, row.on_front)),
            panel("largest |F - exact| / exact", |row| {
                (row.error.tiny_relative(), row.on_relative_front)
            }),
        ],
    )
}
