//! Plan files: what is written is read back to the same tables, a hand may edit it,
//! scenes may change their light, and what is wrong is refused at its place.

#[path = "plan_file/editing.rs"]
mod editing;
#[path = "command_line/program.rs"]
mod program;
#[path = "plan_file/refusals.rs"]
mod refusals;
#[path = "plan_file/round_trip.rs"]
mod round_trip;
#[path = "plan_file/wishes.rs"]
mod wishes;

use program::{Ran, isolux};
use std::path::Path;
use tempfile::TempDir;

fn directory() -> TempDir {
    tempfile::tempdir().expect("a directory")
}

/// A run that must answer.
fn answered(arguments: &[&str], directory: &Path) -> String {
    let ran: Ran = isolux(arguments, directory, "");
    assert_eq!(ran.code, 0, "{arguments:?}: {}", ran.stderr);
    ran.stdout
}

/// Plans a shipped scene into a file and gives its text.
fn planned(scene: &str, directory: &Path, file: &str) -> String {
    answered(&["plan", scene, "-o", file], directory);
    std::fs::read_to_string(directory.join(file)).expect("a plan file")
}

fn write(directory: &Path, name: &str, text: &str) {
    std::fs::write(directory.join(name), text).expect("a file");
}

/// The text of a shipped scene.
fn scene(name: &str) -> String {
    let found = isolux_host::scene::shipped::ALL.iter();
    let found = { found }.find(|(file, _)| file.trim_end_matches(".toml") == name);
    found.expect("a shipped scene").1.to_owned()
}

/// The last column of a CSV with a header line.
fn irradiances(csv: &str) -> Vec<f64> {
    let last = |line: &str| line.rsplit(',').next().and_then(|cell| cell.parse().ok());
    csv.lines()
        .skip(1)
        .map(|line| last(line).expect("a number"))
        .collect()
}

/// The text with the first line that holds `what` replaced, and that line's number.
fn with_line(text: &str, what: &str, by: &str) -> (String, usize) {
    let mut lines: Vec<&str> = text.lines().collect();
    let at = lines
        .iter()
        .position(|line| line.contains(what))
        .expect("such a line");
    lines[at] = by;
    (lines.join("\n") + "\n", at + 1)
}
