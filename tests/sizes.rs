//! What firmwares take of flash, RAM and stack does not creep up unseen: every figure is
//! held against benches/sizes.csv.
//!
//! Skipped, loudly, where a tool or a Rust target is missing; with
//! `ISOLUX_REQUIRE_QEMU=1` in the environment that is a failure instead.

#[path = "command_line/program.rs"]
mod program;
#[path = "../benches/parts/sizes.rs"]
mod sizes;

use std::collections::BTreeMap;

/// What a figure may be above its committed value: 3 %.
const ALLOWANCE: f64 = 1.03;

#[test]
fn firmwares_are_not_larger_than_committed() {
    let bake = |arguments: &[&str], directory: &std::path::Path| {
        let ran = program::isolux(arguments, directory, "");
        assert_eq!(ran.code, 0, "{arguments:?}: {}{}", ran.stdout, ran.stderr);
    };
    let rows = match sizes::measure(bake) {
        Ok(rows) => rows,
        Err(error) => {
            let required = std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some();
            assert!(error.is_missing() && !required, "{error}");
            eprintln!("SKIPPED: {error}");
            return;
        }
    };
    let committed = std::fs::read_to_string(sizes::PATH).expect("committed figures");
    assert_eq!(committed.lines().next(), Some(sizes::HEAD));
    // Code, constants, tables, RAM and stack are the last five cells.
    let figures = |line: &str| -> (String, Vec<f64>) {
        let cells: Vec<&str> = line.split(',').collect();
        let (key, figures) = cells.split_at(cells.len() - 5);
        let figures = figures.iter().map(|cell| cell.parse().expect("a number"));
        (key.join(","), figures.collect())
    };
    let mut known: BTreeMap<String, Vec<f64>> = committed.lines().skip(1).map(figures).collect();
    for row in &rows {
        let (key, now) = figures(&row.line());
        let before = known.remove(&key).unwrap_or_else(|| panic!("{key} is new"));
        for (now, before) in now.iter().zip(&before) {
            assert!(
                *now <= ALLOWANCE * before,
                "{key}: {now} bytes, committed are {before}; if that is meant: \
                 cargo bench --bench sizes -- --write"
            );
        }
    }
    assert!(known.is_empty(), "{known:?} are known to the file alone");
}
