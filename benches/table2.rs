//! Table 2 of the paper with this project's figures beside the paper's.
//!
//! ```text
//! cargo bench --bench table2              prints it
//! cargo bench --bench table2 -- --write   also writes benches/table2.md
//! ```
//!
//! Without the emulator or the Rust target the instructions are missing: it
//! says so, prints the rest and writes nothing; with `ISOLUX_REQUIRE_QEMU=1`
//! in the environment it fails.

#[path = "../tests/firmware/src/cost_samples.rs"]
mod cost_samples;
#[path = "parts/grid.rs"]
mod grid;
#[path = "table2/markdown.rs"]
mod markdown;
#[path = "table2/measure.rs"]
mod measure;
#[path = "parts/planned.rs"]
mod planned;
#[path = "parts/prices.rs"]
mod prices;

use isolux_host::report::write_file;
use prices::Prices;
use std::path::Path;
use std::process::ExitCode;

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/table2.md");

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        return ExitCode::SUCCESS; // `cargo test` builds it, and no more
    }
    let prices = match Prices::measure() {
        Ok(prices) => Some(prices),
        Err(error) => {
            let required = std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some();
            eprintln!("SKIPPED the instructions: {error}");
            if required || !error.is_missing() {
                return ExitCode::FAILURE;
            }
            None
        }
    };
    let mut scenes = Vec::new();
    for planned in planned::scenes() {
        match measure::scene(&planned, prices.as_ref()) {
            Ok(scene) => scenes.push(scene),
            Err(error) => {
                eprintln!("{}: {error}", planned.scene.name);
                return ExitCode::FAILURE;
            }
        }
    }
    let text = markdown::document(&scenes);
    print!("{text}");
    if arguments.iter().any(|argument| argument == "--write") {
        if prices.is_none() {
            eprintln!("nothing was written: the instructions are missing");
            return ExitCode::FAILURE;
        }
        if let Err(error) = write_file(Path::new(PATH), text.as_bytes()) {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
        eprintln!("wrote {PATH}");
    }
    ExitCode::SUCCESS
}
