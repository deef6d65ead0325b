//! Instructions of form factors and of whole scenes, exact, on the emulated
//! Cortex-M4F and M7, of form factors on the M3 too.
//!
//! ```text
//! cargo bench --bench instructions              prints the table
//! cargo bench --bench instructions -- --write   also writes benches/instructions.csv
//! ```
//!
//! Says loudly what is missing where the emulator or the Rust target is, and
//! ends well; with `ISOLUX_REQUIRE_QEMU=1` in the environment it fails.

#[path = "parts/ledger.rs"]
mod ledger;
#[path = "parts/planned.rs"]
mod planned;

use isolux_host::report::write_file;
use ledger::Row;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        return ExitCode::SUCCESS; // `cargo test` builds it, and no more
    }
    let rows = match ledger::measure() {
        Ok((rows, _)) => rows,
        Err(error) => {
            let required = std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some();
            if error.is_missing() && !required {
                eprintln!("SKIPPED: {error}");
                return ExitCode::SUCCESS;
            }
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    let before = std::fs::read_to_string(ledger::PATH).unwrap_or_default();
    print!(
        "{}",
        table(&rows, &ledger::read(&before).unwrap_or_default())
    );
    if arguments.iter().any(|argument| argument == "--write") {
        if let Err(error) = write_file(Path::new(ledger::PATH), ledger::write(&rows).as_bytes()) {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
        println!("wrote {}", ledger::PATH);
    }
    ExitCode::SUCCESS
}

/// The rows for a person, each with its change since the committed ledger.
fn table(rows: &[Row], before: &[Row]) -> String {
    let known: BTreeMap<_, _> = before.iter().map(|row| (&row.name, row.mean)).collect();
    let mut text = format!(
        "{:<11} {:<18} {:<9} {:<5} {:<16} {:>5} {:>6} {:>13} {:>10} {:>8}\n",
        "core", "operation", "rung", "root", "of", "size", "calls", "mean", "largest", "change"
    );
    for row in rows {
        let [core, operation, rung, root, of, size] = &row.name;
        let change = match known.get(&row.name) {
            Some(mean) => format!("{:+.1} %", 100.0 * (row.mean / mean - 1.0)),
            None => "new".to_owned(),
        };
        text.push_str(&format!(
            "{core:<11} {operation:<18} {rung:<9} {root:<5} {of:<16} {size:>5} {:>6} {:>13.2} {:>10} {change:>8}\n",
            row.calls, row.mean, row.largest
        ));
    }
    text
}
