//! The error table, for a terminal and as Markdown.

use comfy_table::{CellAlignment, ContentArrangement, LineStyle, Table, TableStyle, presets};

use super::number::{percent, share};
use crate::compare::{Errors, Statistics, TOLERANCES};

/// One line's worth of the error table.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorRow {
    /// The surface, or what else was compared ("camera").
    pub name: String,
    /// Samples spent on it; `None` where that says nothing.
    pub samples: Option<usize>,
    /// Emitters it shoots from; `None` where that says nothing.
    pub emitters: Option<usize>,
    /// How wrong it is.
    pub error: Errors,
}

/// One rule under the header and nothing else.
const PLAIN: TableStyle = TableStyle::new().header_separator(LineStyle::new('─', '─', '─', '─'));

/// Columns of words; the others are numbers and stand to the right.
const WORDS: [usize; 2] = [0, 3];

/// The errors as a table for a terminal: two lines a row, relative and of full
/// scale, all in percent. About 90 columns wide with short names.
#[must_use]
pub fn error_table(rows: &[ErrorRow]) -> String {
    let mut table = build(rows, PLAIN);
    for column in table.column_iter_mut() {
        column.set_padding((0, 1));
    }
    table.trim_fmt()
}

/// The same table as Markdown.
#[must_use]
pub fn error_table_markdown(rows: &[ErrorRow]) -> String {
    let escaped: Vec<_> = rows
        .iter()
        .map(|row| ErrorRow {
            name: row.name.replace('|', "\\|"),
            ..row.clone()
        })
        .collect();
    let text = build(&escaped, presets::ASCII_MARKDOWN).to_string();
    // Markdown takes a column's alignment from a colon in the line under the
    // header; the table crate draws that line plain.
    let mut lines: Vec<String> = text.lines().map(String::from).collect();
    let rules: Vec<String> = lines[1]
        .trim_matches('|')
        .split('|')
        .enumerate()
        .map(|(index, rule)| match rule.strip_suffix('-') {
            Some(rest) if !WORDS.contains(&index) => format!("{rest}:"),
            _ => rule.to_owned(),
        })
        .collect();
    lines[1] = format!("|{}|", rules.join("|"));
    lines.join("\n")
}

fn build(rows: &[ErrorRow], style: TableStyle) -> Table {
    let mut table = Table::new();
    table
        .load_style(style)
        .set_content_arrangement(ContentArrangement::Disabled);
    let words = [
        "surface", "samples", "emitters", "error", "max %", "rms %", "p95 %",
    ];
    let tolerances = TOLERANCES.map(|tolerance| format!("> {tolerance} %"));
    table.set_header(words.map(String::from).into_iter().chain(tolerances));
    for row in rows {
        let count = |count: Option<usize>| count.map_or("-".to_owned(), |count| count.to_string());
        table.add_row(line(
            [row.name.clone(), count(row.samples), count(row.emitters)],
            "relative",
            &row.error.relative,
        ));
        // Repeating the name would read as a second surface.
        table.add_row(line(
            Default::default(),
            "full scale",
            &row.error.full_scale,
        ));
    }
    for (index, column) in table.column_iter_mut().enumerate() {
        if !WORDS.contains(&index) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

fn line(first: [String; 3], metric: &str, statistics: &Statistics) -> Vec<String> {
    let mut cells = first.to_vec();
    cells.push(metric.to_owned());
    cells.extend([statistics.max, statistics.rms, statistics.p95].map(percent));
    cells.extend(statistics.over.map(share));
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::errors;

    fn rows() -> Vec<ErrorRow> {
        let values = (0..1000).map(|k| {
            let reference = 1.0 + f64::from(k);
            (
                reference * (1.0 + 0.2 * (f64::from(k) * 0.37).sin()),
                reference,
            )
        });
        let error = errors(values, 1000.0);
        vec![
            ErrorRow {
                name: "A".into(),
                samples: Some(48),
                emitters: Some(4),
                error,
            },
            ErrorRow {
                name: "camera".into(),
                samples: None,
                emitters: None,
                error,
            },
        ]
    }

    #[test]
    fn the_table_is_aligned_and_fits_a_terminal() {
        let table = error_table(&rows());
        let widths: Vec<_> = table.lines().map(|line| line.chars().count()).collect();
        let widest = widths.iter().max().unwrap();
        // The rule runs on past the last number.
        assert!(widths.iter().all(|width| width + 2 >= *widest), "{table}");
        assert!(*widest <= 100, "{widest} columns\n{table}");
        assert_eq!(table.matches("relative").count(), 2);
        assert!(table.contains("> 15 %"));
    }

    #[test]
    fn markdown_has_one_line_a_metric_and_escapes_names() {
        let mut rows = rows();
        rows[0].name = "a|b".into();
        let table = error_table_markdown(&rows);
        assert_eq!(table.lines().count(), 2 + 4, "{table}");
        assert!(table.contains("a\\|b"));
        assert_eq!(table.matches("-:|").count(), 10, "{table}");
        let columns = |line: &str| line.replace("\\|", "").matches('|').count();
        assert!(table.lines().all(|line| columns(line) == 13), "{table}");
    }
}
