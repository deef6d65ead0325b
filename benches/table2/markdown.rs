//! The table as Markdown, aligned so that a terminal shows it well.

use super::grid::grid;
use super::measure::{Column, Legs, Table};
use isolux_host::compare::{Errors, TOLERANCES};
use isolux_host::report::{percent, quantity};

/// The paper's own column heads.
const HEADS: [&str; 6] = ["", "structured", "scene 1", "scene 2", "scene 3", "scene 4"];

/// What the paper prints, row by row.
const PAPER: [[&str; 6]; 8] = [
    [
        "paper: % > 10 % err (B)",
        "0.02",
        "0.00",
        "0.02",
        "0.92",
        "2.92",
    ],
    [
        "paper: % > 10 % err (A)",
        "1.52",
        "0.53",
        "2.54",
        "2.54",
        "2.54",
    ],
    [
        "paper: time LS -> A, s",
        "0.02",
        "0.97",
        "0.69",
        "0.69",
        "0.69",
    ],
    [
        "paper: time A -> B, s",
        "0.01",
        "0.06",
        "0.05",
        "0.04",
        "0.03",
    ],
    [
        "paper: time total, s",
        "0.03",
        "1.03",
        "0.74",
        "0.88",
        "0.68",
    ],
    [
        "paper: ratio of time LS -> A",
        "1",
        "48.5",
        "34.5",
        "34.5",
        "34.5",
    ],
    [
        "paper: ratio of time A -> B",
        "1",
        "6.0",
        "5.0",
        "4.0",
        "3.0",
    ],
    [
        "paper: ratio of time total",
        "1",
        "34.3",
        "24.7",
        "29.3",
        "22.7",
    ],
];

/// Which of [`TOLERANCES`] the paper uses.
const TEN_PERCENT: usize = 3;

/// The whole document.
pub(crate) fn document(tables: &[Table]) -> String {
    let mut text = format!("{}\n", include_str!("before.md").trim_end());
    for table in tables {
        text.push_str(&format!("\n## {}\n\n{}", table.scene, grid(&rows(table))));
    }
    text.push_str(&format!("\n{}", include_str!("after.md")));
    text
}

/// One line from a figure of every column.
fn line(name: &str, table: &Table, figure: impl Fn(&Column) -> String) -> Vec<String> {
    let mut cells = vec![name.to_owned(), figure(&table.structured)];
    cells.extend(table.classical.iter().map(figure));
    cells
}

fn rows(table: &Table) -> Vec<Vec<String>> {
    let [source, patch] = [400, 16].map(|n: u32| n.to_string());
    let only = |name: &str, text: &str| {
        let mut cells = vec![name.to_owned(), "-".to_owned()];
        cells.extend(std::iter::repeat_n(text.to_owned(), table.classical.len()));
        cells
    };
    let err = |errors: &Errors| {
        let [relative, full] = [errors.relative, errors.full_scale];
        let over = |over: [f64; TOLERANCES.len()]| format!("{:.2}", over[TEN_PERCENT]);
        format!("{} \\| {}", over(relative.over), over(full.over))
    };
    let mut rows = vec![
        HEADS.map(str::to_owned).to_vec(),
        line("polygons or patches on A", table, |c| {
            c.polygons.to_string()
        }),
        line("samples or vertices on A", table, |c| c.on_a.to_string()),
        line("samples or vertices on B", table, |c| c.on_b.to_string()),
        only("samples on the source", &source),
        only("samples a patch", &patch),
        line("% > 10 % err (B), relative \\| full scale", table, |c| {
            err(&c.error_b)
        }),
        line("% > 10 % err (A), relative \\| full scale", table, |c| {
            err(&c.error_a)
        }),
        line("largest error at the samples of B, %", table, |c| {
            c.at_samples.map_or("-".to_owned(), |[_, b]| percent(b))
        }),
        line("largest error at the samples of A, %", table, |c| {
            c.at_samples.map_or("-".to_owned(), |[a, _]| percent(a))
        }),
        line("time LS -> A, µs", table, |c| micro(c.seconds.first)),
        line("time A -> B, µs", table, |c| micro(c.seconds.second)),
        line("time total, µs", table, |c| micro(c.seconds.total())),
        line("time total in lean f32, µs", table, |c| {
            c.lean_seconds.map_or("-".to_owned(), micro)
        }),
        line("form factors LS -> A", table, |c| {
            c.evaluations.first.to_string()
        }),
        line("form factors A -> B", table, |c| {
            c.evaluations.second.to_string()
        }),
    ];
    rows.extend(instructions(table));
    rows.extend(ratios(table));
    rows.extend(PAPER.map(|row| row.map(str::to_owned).to_vec()));
    rows
}

fn micro(seconds: f64) -> String {
    quantity(1e6 * seconds)
}

fn instructions(table: &Table) -> Vec<Vec<String>> {
    let thousands = |legs: Option<Legs>, leg: fn(Legs) -> f64| {
        legs.map_or("-".to_owned(), |legs| quantity(1e-3 * leg(legs)))
    };
    [
        (
            "instructions LS -> A, thousands",
            (|legs| legs.first) as fn(Legs) -> f64,
        ),
        ("instructions A -> B, thousands", |legs| legs.second),
        ("instructions total, thousands", Legs::total),
    ]
    .map(|(name, leg)| line(name, table, |c| thousands(c.instructions, leg)))
    .to_vec()
}

/// How many times dearer than structured sampling each column is.
fn ratios(table: &Table) -> Vec<Vec<String>> {
    let ratio = |theirs: Option<f64>, ours: Option<f64>| match (theirs, ours) {
        (Some(theirs), Some(ours)) => format!("{:.2}", theirs / ours),
        _ => "-".to_owned(),
    };
    let ours = &table.structured;
    let counted = ours.instructions;
    vec![
        line("ratio of time LS -> A", table, |c| {
            ratio(Some(c.seconds.first), Some(ours.seconds.first))
        }),
        line("ratio of time A -> B", table, |c| {
            ratio(Some(c.seconds.second), Some(ours.seconds.second))
        }),
        line("ratio of time total", table, |c| {
            ratio(Some(c.seconds.total()), Some(ours.seconds.total()))
        }),
        line("ratio of time total, lean f32", table, |c| {
            ratio(c.lean_seconds, Some(ours.seconds.total()))
        }),
        line("ratio of instructions LS -> A", table, |c| {
            ratio(c.instructions.map(|l| l.first), counted.map(|l| l.first))
        }),
        line("ratio of instructions A -> B", table, |c| {
            ratio(c.instructions.map(|l| l.second), counted.map(|l| l.second))
        }),
        line("ratio of instructions total", table, |c| {
            ratio(c.instructions.map(Legs::total), counted.map(Legs::total))
        }),
        line("ratio of instructions, source shot exactly", table, |c| {
            ratio(c.exact_first, counted.map(Legs::total))
        }),
    ]
}
