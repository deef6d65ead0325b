//! Table 3 of the paper with this project's figures beside the paper's.
//!
//! ```text
//! cargo bench --bench table3              prints it
//! cargo bench --bench table3 -- --write   also writes benches/table3.md
//! ```
//!
//! Some minutes the first time, when the references are solved; they are kept.

#[path = "parts/clock.rs"]
mod clock;
#[path = "parts/grid.rs"]
mod grid;
#[path = "table3/measure.rs"]
mod measure;
#[path = "table3/pixels.rs"]
mod pixels;
#[path = "parts/room.rs"]
mod room;
#[path = "parts/written.rs"]
mod written;

use grid::grid;
use isolux_host::compare::{Errors, Statistics};
use isolux_host::report::quantity;
use measure::Column;
use std::process::ExitCode;

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/table3.md");

/// Heads of the columns: what the paper calls them, or what they are.
const HEADS: [&str; 7] = [
    "",
    "structured, the paper's way",
    "ours, resampled",
    "ours, at the pixels",
    "same speed",
    "same quality",
    "converged",
];

/// What the paper prints, row by row.
const PAPER: [[&str; 7]; 5] = [
    [
        "paper: error (> 15 %), %",
        "23.00",
        "-",
        "-",
        "41.48",
        "23.30",
        "-",
    ],
    [
        "paper: computation time, s",
        "150",
        "-",
        "-",
        "200",
        "491",
        "4200",
    ],
    [
        "paper: ratio of time",
        "1",
        "-",
        "-",
        "1.33",
        "3.27",
        "28.0",
    ],
    [
        "paper: samples (floor)",
        "194",
        "-",
        "-",
        "225",
        "400",
        "4225",
    ],
    [
        "paper: samples (walls)",
        "493",
        "-",
        "-",
        "720",
        "900",
        "12500",
    ],
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        return ExitCode::SUCCESS; // `cargo test` builds it, and no more
    }
    let columns = match measure::columns() {
        Ok(columns) => columns,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    let before = include_str!("table3/before.md").trim_end();
    let after = include_str!("table3/after.md");
    let text = format!("{before}\n\n{}\n{after}", grid(&rows(&columns)));
    written::answer(&text, PATH)
}

fn rows(columns: &[Column]) -> Vec<Vec<String>> {
    let line = |name: &str, figure: &dyn Fn(&Column) -> String| {
        let cells = columns.iter().map(figure);
        std::iter::once(name.to_owned()).chain(cells).collect()
    };
    let both = |errors: &Errors, of: &dyn Fn(&Statistics) -> f64| {
        format!(
            "{:.2} \\| {:.2}",
            of(&errors.relative),
            of(&errors.full_scale)
        )
    };
    let over = |index: usize| {
        move |column: &Column| both(&column.errors, &|statistics| statistics.over[index])
    };
    let maybe = |count: Option<u64>| count.map_or("-".to_owned(), |count| count.to_string());
    let ours = columns.first().map_or(f64::NAN, |column| column.seconds);
    let mut rows = vec![
        HEADS.map(str::to_owned).to_vec(),
        line("error (> 15 %), %, relative \\| full scale", &over(4)),
        line("error (> 10 %), %", &over(3)),
        line("error (> 5 %), %", &over(2)),
        line("rms error, %", &|c| both(&c.errors, &|s| s.rms)),
        line("error (> 15 %), %, border vertices drawn in", &|c| {
            let errors = c.drawn_in.as_ref();
            errors.map_or("-".to_owned(), |errors| both(errors, &|s| s.over[4]))
        }),
        line("samples or vertices (floor)", &|c| c.on_floor.to_string()),
        line("samples or vertices (all others)", &|c| {
            c.elsewhere.to_string()
        }),
        line("polygons or patches that shoot", &|c| {
            c.emitters.to_string()
        }),
        line("shots", &|c| c.shots.to_string()),
        line("form factors or delta form factors", &|c| {
            c.evaluations.to_string()
        }),
        line("rays", &|c| maybe(c.rays)),
        line("computation time, s", &|c| quantity(c.seconds)),
        line("ratio of time", &|c| quantity(c.seconds / ours)),
        line("then the pixels, s", &|c| quantity(c.pixels)),
    ];
    rows.extend(PAPER.map(|row| row.map(str::to_owned).to_vec()));
    rows
}
