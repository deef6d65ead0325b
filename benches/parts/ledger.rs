//! Instructions on the emulated cores: measured, written down, read back.

use super::planned::{self, Planned};
use isolux::shoot::Stop;
use isolux_host::device::{self, Core, Cost, Error, Job, Options, Steps};
use isolux_host::solve::Rung;
use std::time::Duration;

/// The command that writes the ledger anew.
pub(crate) const COMMAND: &str = "cargo bench --bench instructions -- --write";

/// Where the ledger is.
pub(crate) const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/instructions.csv");

/// The columns of the ledger; the first six name the operation.
const COLUMNS: &str = "core,operation,rung,root,of,size,calls,mean,largest";

/// The cores that whole scenes are measured on.
const SCENE_CORES: [Core; 2] = [Core::CortexM4F, Core::CortexM7];

/// How long one emulation may take.
const TIME_LIMIT: Duration = Duration::from_secs(120);

/// What an operation costs on a core.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    /// Core, operation, rung, root, emitter or scene, vertices or samples.
    pub(crate) name: [String; 6],
    /// Calls measured.
    pub(crate) calls: u32,
    /// Instructions of a call on the average.
    pub(crate) mean: f64,
    /// Instructions of the dearest call.
    pub(crate) largest: u64,
}

/// Measures everything the ledger holds: single operations, with the answers
/// they gave, and the steps of whole scenes.
///
/// # Errors
/// See [`Error`].
pub(crate) fn measure() -> Result<(Vec<Row>, Vec<Cost>), Error> {
    let mut rows = Vec::new();
    let costs = device::costs(&Core::ALL, TIME_LIMIT)?;
    for (core, costs) in Core::ALL.iter().zip(&costs) {
        rows.extend(costs.iter().map(|cost| Row {
            name: [
                core.name().to_owned(),
                cost.operation.clone(),
                cost.rung.clone(),
                cost.root.clone(),
                cost.case.clone(),
                cost.size.to_string(),
            ],
            calls: cost.calls,
            mean: cost.mean(),
            largest: cost.largest,
        }));
    }
    for planned in planned::scenes() {
        rows.extend(scene(&planned)?);
    }
    let first = costs.into_iter().next();
    Ok((rows, first.unwrap_or_default()))
}

/// The steps of a scene until a thousandth of the light is unshot, on the
/// first core, and their sum on every core.
fn scene(planned: &Planned) -> Result<Vec<Row>, Error> {
    let job = Job {
        scene: &planned.scene.name,
        tables: planned.tables.bytes(),
        arithmetic: Rung::Best.name(),
        visibility: "none",
        stop: Stop::below(0.001),
        resolution: 200,
        // Whether the bits are the host's is another test's business.
        expected: &[],
        budget: planned.scene.budget,
    };
    let options = Options {
        cores: SCENE_CORES.to_vec(),
        software_root: false,
        ..Options::default()
    };
    let measured = device::run(&job, &options)?;
    let row = |core: &str, step: &str, instructions: u64| Row {
        name: [
            core.to_owned(),
            step.to_owned(),
            Rung::Best.name().to_owned(),
            "fpu".to_owned(),
            planned.scene.name.clone(),
            planned.plan.samples().to_string(),
        ],
        calls: 1,
        mean: instructions as f64,
        largest: instructions,
    };
    let Steps {
        load,
        direct,
        shoot,
        resample,
    } = measured.instructions_by_step;
    let steps = [
        ("load", load),
        ("direct", direct),
        ("shoot", shoot),
        ("resample", resample),
    ];
    let first = SCENE_CORES[0].name();
    let mut rows: Vec<Row> = steps
        .iter()
        .map(|&(step, instructions)| row(first, step, instructions))
        .collect();
    let whole = measured.targets.iter();
    rows.extend(whole.map(|target| row(&target.core, "scene", target.instructions)));
    Ok(rows)
}

/// The ledger as text.
pub(crate) fn write(rows: &[Row]) -> String {
    let mut text =
        format!("# Instructions on emulated cores; written by `{COMMAND}`.\n{COLUMNS}\n");
    for row in rows {
        let Row {
            name,
            calls,
            mean,
            largest,
        } = row;
        let name = name.join(",");
        text.push_str(&format!("{name},{calls},{mean:.2},{largest}\n"));
    }
    text
}

/// Reads a ledger; the message says which line is none.
pub(crate) fn read(text: &str) -> Result<Vec<Row>, String> {
    let mut lines = (1..)
        .zip(text.lines())
        .filter(|(_, line)| !line.starts_with('#'));
    match lines.next() {
        Some((_, COLUMNS)) => {}
        _ => return Err(format!("the columns are not {COLUMNS}")),
    }
    lines
        .map(|(number, line)| {
            row_of(line).ok_or_else(|| format!("line {number} is no row of {COLUMNS}: {line}"))
        })
        .collect()
}

fn row_of(line: &str) -> Option<Row> {
    let cells: Vec<&str> = line.split(',').collect();
    let [core, operation, rung, root, of, size, calls, mean, largest] = *cells.as_slice() else {
        return None;
    };
    Some(Row {
        name: [core, operation, rung, root, of, size].map(str::to_owned),
        calls: calls.parse().ok()?,
        mean: mean.parse().ok()?,
        largest: largest.parse().ok()?,
    })
}
