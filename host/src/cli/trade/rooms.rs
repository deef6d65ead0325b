//! The rungs that change what is planned and baked, one combination after the
//! other.

use crate::cli::failure::Failure;
use crate::cli::pipeline::{self, Planned};
use crate::picture::{Picture, PictureError, TradeMark, TradePanel, trade_off};
use crate::scene::requires::requirements;
use crate::trade::room::{self, Baked, Choice, Field, InRoom};
use serde::Serialize;
use std::io::Write;

/// Everything of a scene that is not arithmetic.
#[derive(Serialize)]
struct Traded<'a> {
    scene: &'a str,
    room: &'a [InRoom],
    files: &'a [String],
}

/// Measures every combination in a scene and writes it down.
pub(super) fn run(
    arguments: &super::Arguments,
    planned: &Planned,
    json: bool,
    step: impl Fn(&str),
) -> Result<(), Failure> {
    let scene = &planned.scene;
    let room = measure(arguments, planned, true, step)?;
    let written = super::written(arguments, files(&scene.name, &room)?.into())?;
    let mut out = std::io::stdout().lock();
    if json {
        let traded = Traded {
            scene: &scene.name,
            room: &room,
            files: &written,
        };
        serde_json::to_writer(&mut out, &traded).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        write!(out, "{}", in_words(&scene.name, &room))?;
        for file in &written {
            writeln!(out, "wrote {file}")?;
        }
    }
    out.flush()?;
    Ok(())
}

/// The table for a person.
pub(super) fn in_words(name: &str, room: &[InRoom]) -> String {
    format!(
        "{name}: irradiance by rungs of visibility, emitters and transfer, relative error\n{}\n",
        room::terminal(room)
    )
}

/// The table for programs and the plot.
pub(super) fn files(name: &str, room: &[InRoom]) -> Result<[(&'static str, Vec<u8>); 2], Failure> {
    let picture = plot(name, room).and_then(|picture| picture.png());
    let picture = picture.map_err(|error| Failure::limit(error, ""))?;
    Ok([
        ("trade-room.csv", room::csv(name, room).into_bytes()),
        ("trade-room.png", picture),
    ])
}

/// Measures every combination in a scene, by all light or by what `--bounces` asks
/// for.
pub(super) fn measure(
    arguments: &super::Arguments,
    default: &Planned,
    on_device: bool,
    step: impl Fn(&str),
) -> Result<Vec<InRoom>, Failure> {
    let (scene, bounces) = (&default.scene, arguments.bounces);
    step("the light that rungs are judged by");
    let reference = pipeline::judge(scene, pipeline::all_light(bounces))?;
    let field = Field::new(scene, &reference);
    let occluded = requirements(scene).visibility.is_some();
    let mut rows = Vec::new();
    for choice in room::choices(occluded) {
        let Choice {
            visibility,
            emitters,
            transfer,
        } = choice;
        step(&format!("{visibility}, {emitters}, {transfer}"));
        let named = |name: &str| Some(name.to_owned());
        let mut rungs = arguments.rungs.clone();
        rungs.at_points = true;
        rungs.arithmetic = None;
        rungs.visibility = named(visibility);
        rungs.emitters = named(emitters);
        rungs.transfer = named(transfer);
        let plan = arguments.plan.as_deref();
        let plan = plan.filter(|_| default.emitters.name() == emitters);
        let planned = pipeline::plan_or_read(scene.clone(), &rungs, plan, &[])?;
        let baked = Baked {
            scene: &planned.scene,
            plan: &planned.plan,
            tables: &planned.tables,
            sight: planned.sight,
            ram_bytes: planned.ram()?.0,
            stop: pipeline::stop(bounces),
        };
        let row = room::measure(choice, &baked, &field, on_device);
        rows.push(row.map_err(|error| Failure::limit(error, ""))?);
    }
    room::mark(&mut rows);
    Ok(rows)
}

fn plot(name: &str, rows: &[InRoom]) -> Result<Picture, PictureError> {
    let counted = rows.iter().all(|row| row.m4f_instructions.is_some());
    let label = |choice: &Choice| {
        let Choice {
            visibility,
            emitters,
            transfer,
        } = choice;
        match (*visibility, *emitters, *transfer) {
            (_, "linear", written @ ("codes" | "matrix")) => written.to_owned(),
            (seen, "linear", _) => format!("{seen}, linear"),
            (_, emitters, _) => emitters.to_owned(),
        }
    };
    let panel = |error: &str, of: fn(&InRoom) -> f64| TradePanel {
        cost: if counted {
            "instructions of the solution, Cortex-M4F"
        } else {
            "bytes of tables"
        }
        .to_owned(),
        error: error.to_owned(),
        marks: rows
            .iter()
            .map(|row| TradeMark {
                name: label(&row.choice),
                cost: if counted {
                    row.cost()
                } else {
                    row.table_bytes as f64
                },
                error: of(row),
                on_front: row.on_front,
            })
            .collect(),
        lines: Vec::new(),
    };
    let captions = [
        "irradiance at places on all surfaces, evaluated from the emitters; left: 95 % of the places err by no more, right: root mean square",
        "filled: on the front of the left panel, nothing is both as cheap and as good",
    ];
    trade_off(
        &format!("Rungs of visibility, emitters and transfer in {name}"),
        &captions.map(str::to_owned),
        &[
            panel("relative error, p95, %", |row| row.error.relative.p95),
            panel("relative error, rms, %", |row| row.error.relative.rms),
        ],
    )
}
