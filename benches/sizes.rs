//! What firmwares of several kinds of scene take of flash, RAM and stack: the program
//! `yours` of tests/firmware, linked for size (`opt-level = "s"`, the kernel's feature
//! `small`) and for speed (3).
//!
//! ```text
//! cargo bench --bench sizes              prints the table
//! cargo bench --bench sizes -- --write   also writes benches/sizes.csv
//! ```
//!
//! Says loudly what is missing where a tool or a Rust target is, and ends well; with
//! `ISOLUX_REQUIRE_QEMU=1` in the environment it fails.

#[path = "parts/program.rs"]
mod program;
#[path = "parts/sizes.rs"]
mod sizes;

use isolux_host::report::write_file;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        return ExitCode::SUCCESS; // `cargo test` builds it, and no more
    }
    let rows = match sizes::measure(bake) {
        Ok(rows) => rows,
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
    let lines: Vec<String> = rows.iter().map(sizes::Row::line).collect();
    let text = format!("{}\n{}\n", sizes::HEAD, lines.join("\n"));
    print!("{text}");
    if arguments.iter().any(|argument| argument == "--write") {
        if let Err(error) = write_file(Path::new(sizes::PATH), text.as_bytes()) {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
        println!("wrote {}", sizes::PATH);
    }
    ExitCode::SUCCESS
}

/// The program of this checkout.
fn bake(arguments: &[&str], directory: &Path) {
    let output = program::isolux(arguments, directory);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {said}");
}
