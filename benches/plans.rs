//! What plans err by in the shipped scenes and in variants of them.
//!
//! ```text
//! cargo bench --bench plans              prints it
//! cargo bench --bench plans -- --write   also writes benches/plans.md
//! ```
//!
//! Some minutes, more the first time, when the references are solved; they are kept.

#[path = "parts/by_default.rs"]
mod by_default;
#[path = "parts/grid.rs"]
mod grid;
#[path = "plans/measure.rs"]
mod measure;
#[path = "plans/variants.rs"]
mod variants;
#[path = "parts/written.rs"]
mod written;

use by_default::Failed;
use grid::grid;
use isolux_host::compare::Statistics;
use isolux_host::report::quantity;
use measure::Row;
use std::process::ExitCode;

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/plans.md");

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        return ExitCode::SUCCESS; // `cargo test` builds it, and no more
    }
    let text = match document() {
        Ok(text) => text,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    written::answer(&text, PATH)
}

fn document() -> Result<String, Failed> {
    let mut rows = Vec::new();
    for variant in variants::all()? {
        eprintln!("{}", variant.what);
        rows.extend(measure::rows(&variant)?);
    }
    let relative = table(&rows, |row| &row.errors.relative);
    let full_scale = table(&rows, |row| &row.errors.full_scale);
    let before = include_str!("plans/before.md").trim_end();
    Ok(format!(
        "{before}\n\n## Relative to the value\n\n{relative}\n## Of full scale\n\n{full_scale}"
    ))
}

fn table(rows: &[Row], of: fn(&Row) -> &Statistics) -> String {
    const HEAD: [&str; 11] = [
        "scene", "places", "samples", "tables", "max", "p95", "rms", "> 1 %", "> 2 %", "> 5 %",
        "> 15 %",
    ];
    let line = |row: &Row| {
        let errors = of(row);
        let [over_1, over_2, over_5, _, over_15] = errors.over;
        let figures = [
            errors.max, errors.p95, errors.rms, over_1, over_2, over_5, over_15,
        ];
        let counts = [row.samples, row.table_bytes].map(|count| count.to_string());
        let names = [row.scene.clone(), row.places.clone()];
        let cells = names.into_iter().chain(counts);
        cells.chain(figures.map(quantity)).collect()
    };
    let head = HEAD.map(str::to_owned).to_vec();
    grid(
        &std::iter::once(head)
            .chain(rows.iter().map(line))
            .collect::<Vec<_>>(),
    )
}
