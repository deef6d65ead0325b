//! The trade as text: CSV for programs, a table for a terminal.

use super::error::ClassErrors;
use super::scene::InScene;
use super::{FormFactors, Part};
use crate::report::quantity;
use comfy_table::{CellAlignment, ContentArrangement, LineStyle, Table, TableStyle};

/// One rule under the header and nothing else.
const PLAIN: TableStyle = TableStyle::new().header_separator(LineStyle::new('─', '─', '─', '─'));

/// The columns of [`csv`].
pub const COLUMNS: &str = "rung,max,p95,tiny_relative_max,on_front,on_relative_front,\
m4f_instructions,m4f_largest,m7_instructions,m4f_cycles,m4f_cycles_per_edge,m4f_cycles_per_narrow_edge,m3_instructions,\
code_bytes,table_bytes,m3_code_bytes,host_nanoseconds";

/// The columns of [`scene_csv`]; errors in percent of full scale.
pub const SCENE_COLUMNS: &str = "scene,reflections,rung,direct_max,direct_p95,direct_rms,\
all_max,all_p95,all_rms,m4f_instructions,m7_instructions,m3_instructions,kernel_code_bytes";

/// The columns of [`classes_csv`].
pub const CLASS_COLUMNS: &str = "rung,class,cases,max,p95,relative_max,relative_p95";

/// A number for a CSV: four significant digits.
fn digits(value: f64) -> String {
    format!("{value:.3e}")
}

/// Nothing for what is not known.
fn cell(value: Option<impl ToString>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

fn decimals(value: f64) -> String {
    format!("{value:.2}")
}

/// The rungs, one a line, and behind them what is measured beside them.
#[must_use]
pub fn csv(rows: &[FormFactors], parts: &[Part]) -> String {
    let mut text = format!("{COLUMNS}\n");
    for row in rows {
        let device = row.device.as_ref();
        let cells = [
            row.rung.to_owned(),
            digits(row.error.max),
            digits(row.error.p95),
            digits(row.error.tiny_relative_max),
            row.on_front.to_string(),
            row.on_relative_front.to_string(),
            cell(device.map(|device| decimals(device.m4f_instructions))),
            cell(device.map(|device| device.m4f_largest)),
            cell(device.map(|device| decimals(device.m7_instructions))),
            cell(device.and_then(|device| device.m4f_cycles.map(decimals))),
            cell(device.and_then(|device| device.m4f_cycles_per_edge.map(decimals))),
            cell(device.and_then(|device| device.m4f_cycles_per_narrow_edge.map(decimals))),
            cell(device.and_then(|device| device.m3_instructions.map(decimals))),
            cell(device.map(|device| device.code_bytes)),
            cell(device.map(|device| device.table_bytes)),
            cell(device.and_then(|device| device.m3_code_bytes)),
            format!("{:.1}", row.host_nanoseconds),
        ];
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    for part in parts {
        let cell = |column| match column {
            "rung" => part.name.to_owned(),
            "m4f_cycles" => decimals(part.m4f_cycles),
            "m4f_cycles_per_edge" => decimals(part.m4f_cycles_per_edge),
            _ => String::new(),
        };
        let cells: Vec<String> = COLUMNS.split(',').map(cell).collect();
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}

/// The errors by class, one line a rung and class.
#[must_use]
pub fn classes_csv(rows: &[FormFactors]) -> String {
    let mut text = format!("{CLASS_COLUMNS}\n");
    for row in rows {
        for errors in &row.error.classes {
            let ClassErrors {
                class,
                cases,
                max,
                p95,
                relative_max,
                relative_p95,
            } = errors;
            let cells = [
                row.rung.to_owned(),
                (*class).to_owned(),
                cases.to_string(),
                digits(*max),
                digits(*p95),
                cell(relative_max.map(digits)),
                cell(relative_p95.map(digits)),
            ];
            text.push_str(&cells.join(","));
            text.push('\n');
        }
    }
    text
}

/// The rungs in a scene, one a line.
#[must_use]
pub fn scene_csv(name: &str, reflections: u32, rows: &[InScene]) -> String {
    let mut text = format!("{SCENE_COLUMNS}\n");
    for row in rows {
        let mut cells = vec![
            name.to_owned(),
            reflections.to_string(),
            row.rung.to_owned(),
        ];
        for errors in [&row.direct, &row.all] {
            cells.extend([errors.max, errors.p95, errors.rms].map(digits));
        }
        let device = row.device.as_ref();
        cells.push(cell(device.map(|device| device.m4f_instructions)));
        cells.push(cell(device.map(|device| device.m7_instructions)));
        cells.push(cell(device.and_then(|device| device.m3_instructions)));
        cells.push(cell(device.map(|device| device.kernel_code_bytes)));
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}

/// What is measured beside the rungs, for a person.
#[must_use]
pub fn part_terminal(part: &Part) -> String {
    let what = match part.name {
        "clip" => "of which, where nothing is below the horizon, translation and clip",
        _ => "best with a table of its edges, a small emitter above the horizon",
    };
    format!(
        "{what}: {:.0} cycles of a quad, {:.0} of an edge",
        part.m4f_cycles, part.m4f_cycles_per_edge
    )
}

/// The rungs for a person. A star marks those on the front of absolute error,
/// a circle those on the front of relative error.
#[must_use]
pub fn terminal(rows: &[FormFactors]) -> String {
    let unknown = || "-".to_owned();
    let mut table = plain([
        "rung",
        "max error",
        "p95",
        "tiny, relative",
        "instructions",
        "largest",
        "cycles",
        "an edge",
        "a narrow one",
        "on M3",
        "code",
        "tables",
        "code M3",
        "ns here",
        "front",
    ]);
    for row in rows {
        let device = row.device.as_ref();
        let count = |value: Option<f64>| value.map_or_else(unknown, |value| format!("{value:.0}"));
        let marks = [(row.on_front, "*"), (row.on_relative_front, "o")];
        let marks = marks.iter().filter(|(on, _)| *on).map(|(_, mark)| *mark);
        table.add_row([
            row.rung.to_owned(),
            quantity(row.error.max),
            quantity(row.error.p95),
            quantity(row.error.tiny_relative_max),
            count(device.map(|device| device.m4f_instructions)),
            count(device.map(|device| device.m4f_largest as f64)),
            count(device.and_then(|device| device.m4f_cycles)),
            count(device.and_then(|device| device.m4f_cycles_per_edge)),
            count(device.and_then(|device| device.m4f_cycles_per_narrow_edge)),
            count(device.and_then(|device| device.m3_instructions)),
            count(device.map(|device| device.code_bytes as f64)),
            count(device.map(|device| device.table_bytes as f64)),
            count(device.and_then(|device| device.m3_code_bytes.map(|bytes| bytes as f64))),
            count(Some(row.host_nanoseconds)),
            marks.collect(),
        ]);
    }
    finished(table)
}

/// The rungs in a scene for a person.
#[must_use]
pub fn scene_terminal(rows: &[InScene]) -> String {
    let mut table = plain([
        "rung",
        "direct max %",
        "rms %",
        "all max %",
        "rms %",
        "instructions",
        "on M3",
        "kernel code",
    ]);
    for row in rows {
        let device = row.device.as_ref();
        let known = |value: Option<u64>| value.map_or_else(|| "-".to_owned(), |v| v.to_string());
        table.add_row([
            row.rung.to_owned(),
            quantity(row.direct.max),
            quantity(row.direct.rms),
            quantity(row.all.max),
            quantity(row.all.rms),
            known(device.map(|device| device.m4f_instructions)),
            known(device.and_then(|device| device.m3_instructions)),
            known(device.map(|device| device.kernel_code_bytes)),
        ]);
    }
    finished(table)
}

pub(super) fn plain<const N: usize>(header: [&str; N]) -> Table {
    let mut table = Table::new();
    table
        .load_style(PLAIN)
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header(header);
    table
}

pub(super) fn finished(mut table: Table) -> String {
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, 2));
        if index > 0 {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table.trim_fmt()
}
