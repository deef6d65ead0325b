//! The rungs that change what is planned and baked, one combination after the
//! other.

use crate::cli::choice::RungArguments;
use crate::cli::failure::Failure;
use crate::cli::pipeline;
use crate::picture::{Picture, PictureError, TradeMark, TradePanel, trade_off};
use crate::scene::Scene;
use crate::scene::requires::requirements;
use crate::trade::room::{self, Baked, Choice, Field, InRoom};

/// Measures every combination in a scene, by all light or by what `bounces` asks
/// for.
pub(super) fn measure(
    scene: &Scene,
    rungs: &RungArguments,
    bounces: Option<u32>,
    on_device: bool,
    step: impl Fn(&str),
) -> Result<Vec<InRoom>, Failure> {
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
        let mut rungs = rungs.clone();
        rungs.arithmetic = None;
        rungs.visibility = named(visibility);
        rungs.emitters = named(emitters);
        rungs.transfer = named(transfer);
        let planned = pipeline::plan(scene.clone(), &rungs, &[])?;
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

pub(super) fn plot(name: &str, rows: &[InRoom]) -> Result<Picture, PictureError> {
    let counted = rows.iter().all(|row| row.m4f_instructions.is_some());
    let label = |choice: &Choice| {
        let Choice {
            visibility,
            emitters,
            transfer,
        } = choice;
        match (*visibility, *emitters, *transfer) {
            (_, "linear", "codes") => "codes".to_owned(),
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
