//! Numbers of samples, by reconstruction and emitters: each planned anew.

use crate::cli::failure::Failure;
use crate::cli::pipeline::{self, Planned};
use crate::cli::sheet;
use crate::device::model::Model;
use crate::picture::{Picture, PictureError, TradeLine, TradePanel, trade_off};
use crate::report::Progress;
use crate::scene::{Budget, Scene};
use crate::trade::room::{self, Baked, Field};
use crate::trade::whole::{self, Row, WAYS, Way};
use serde::Serialize;
use std::io::Write;

/// Samples that are planned with where nothing else is asked for.
pub(super) const SAMPLES: [u64; 5] = [12, 24, 48, 96, 200];

/// A plan that cannot be had.
#[derive(Serialize)]
struct Refused {
    #[serde(flatten)]
    way: Way,
    asked: u64,
    why: String,
}

#[derive(Serialize)]
struct Traded<'a> {
    scene: &'a str,
    plans: &'a [Row],
    refused: &'a [Refused],
    files: &'a [String],
}

/// Measures every plan of a scene and writes it down.
pub(super) fn run(arguments: &super::Arguments, scene: &Scene, json: bool) -> Result<(), Failure> {
    let (rows, refused) = measure(arguments, scene)?;
    let picture = plot(&scene.name, &rows).and_then(|picture| picture.png());
    let picture = picture.map_err(|error| Failure::limit(error, "give other --samples"))?;
    let csv = whole::csv(&scene.name, &rows).into_bytes();
    let files = vec![("trade-whole.csv", csv), ("trade-whole.png", picture)];
    let files = super::written(arguments, files)?;
    let mut out = std::io::stdout().lock();
    if json {
        let traded = Traded {
            scene: &scene.name,
            plans: &rows,
            refused: &refused,
            files: &files,
        };
        serde_json::to_writer(&mut out, &traded).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        writeln!(
            out,
            "{}: irradiance on all surfaces as it is reconstructed, relative error; instructions of the solution, of grids beside them\n{}",
            scene.name,
            whole::terminal(&rows)
        )?;
        for Refused { way, asked, why } in &refused {
            writeln!(out, "no plan by {} with {asked} samples: {why}", way.name())?;
        }
        for file in &files {
            writeln!(out, "wrote {file}")?;
        }
    }
    out.flush()?;
    Ok(())
}

fn measure(
    arguments: &super::Arguments,
    scene: &Scene,
) -> Result<(Vec<Row>, Vec<Refused>), Failure> {
    let reference = pipeline::judge(scene, pipeline::all_light(None))?;
    let field = Field::new(scene, &reference);
    let plans = WAYS.len() * arguments.samples.len();
    let progress = Progress::start("plans", plans as u64);
    let (mut rows, mut refused) = (Vec::new(), Vec::new());
    for way in WAYS {
        for &asked in &arguments.samples {
            let planned = planned(arguments, scene, way, asked);
            match planned.and_then(|planned| row(way, asked, &planned, &field)) {
                Ok(row) => rows.push(row),
                // That is an answer, too.
                Err(Failure::Limit { message, .. }) => refused.push(Refused {
                    way,
                    asked,
                    why: message,
                }),
                Err(failure) => return Err(failure),
            }
            progress.advance(1);
        }
    }
    progress.finish();
    whole::mark(&mut rows);
    Ok((rows, refused))
}

/// A plan of the scene, within so many samples, one way.
fn planned(
    arguments: &super::Arguments,
    scene: &Scene,
    way: Way,
    samples: u64,
) -> Result<Planned, Failure> {
    let named = |name: &str| Some(name.to_owned());
    let mut rungs = arguments.rungs.clone();
    rungs.placement = named(way.placement());
    rungs.reconstruction = named(way.reconstruction);
    rungs.emitters = named(way.emitters);
    let scene = Scene {
        budget: Budget {
            samples: Some(samples),
            ram: None,
            flash: None,
        },
        ..scene.clone()
    };
    pipeline::attempt(scene, &rungs, &[])
}

fn row(way: Way, asked: u64, planned: &Planned, field: &Field) -> Result<Row, Failure> {
    let unknown = |error: isolux::Error| Failure::limit(error, "");
    let solution = planned.solve(None)?;
    let operations = sheet::operations(planned, pipeline::stop(None))?;
    let model = Model::committed();
    let steps = { model.knows(&operations) }.then(|| model.steps(&operations));
    let ram_bytes = planned.ram()?.0;
    let counted = match steps {
        Some(_) => None,
        None => {
            let baked = Baked {
                scene: &planned.scene,
                plan: &planned.plan,
                tables: &planned.tables,
                sight: planned.sight,
                ram_bytes,
                stop: pipeline::stop(None),
            };
            room::instructions(&baked).map_err(|error| Failure::limit(error, ""))?
        }
    };
    let predicted = steps.map(|steps| steps.direct.expected + steps.shoot.expected);
    Ok(Row {
        way,
        asked,
        samples: planned.plan.samples(),
        shooters: planned.tables.counts.emitters,
        error: field.reconstructed(&solution).map_err(unknown)?,
        instructions: predicted.or(counted),
        counted: counted.is_some(),
        grid_instructions: steps.map(|steps| steps.resample.expected),
        table_bytes: planned.tables.bytes().len(),
        ram_bytes,
        on_front: false,
    })
}

fn plot(name: &str, rows: &[Row]) -> Result<Picture, PictureError> {
    let panel =
        |cost: &str, of: &dyn Fn(&Row) -> Option<f64>, error: &str, by: &dyn Fn(&Row) -> f64| {
            let line = |way: &Way| TradeLine {
                name: way.name(),
                points: rows
                    .iter()
                    .filter(|row| row.way == *way)
                    .filter_map(|row| Some([of(row)?, by(row)]))
                    .collect(),
            };
            TradePanel {
                cost: cost.to_owned(),
                error: error.to_owned(),
                marks: Vec::new(),
                lines: WAYS.iter().map(line).collect(),
            }
        };
    let instructions = |row: &Row| row.instructions.map(|count| count as f64);
    let bytes = |row: &Row| Some(row.table_bytes as f64);
    let rms = |row: &Row| row.error.relative.rms;
    let p95 = |row: &Row| row.error.relative.p95;
    let captions = [
        "irradiance at places on all surfaces, reconstructed from the samples; a point is a plan, from few samples to many",
        "the paper's: on isolux outlines, bands between them shoot, cone filter; named where it has most samples",
    ];
    trade_off(
        &format!("From samples to surfaces in {name}: error against cost"),
        &captions.map(str::to_owned),
        &[
            panel(
                "instructions of the solution, Cortex-M4F",
                &instructions,
                "relative error, rms, %",
                &rms,
            ),
            panel(
                "instructions of the solution, Cortex-M4F",
                &instructions,
                "relative error, p95, %",
                &p95,
            ),
            panel("bytes of tables", &bytes, "relative error, rms, %", &rms),
        ],
    )
}
