//! Instructions of both methods at equal error: the classical method as the paper
//! has it, and the smallest plan of ours that errs no more.
//!
//! ```text
//! cargo bench --bench equal              prints it
//! cargo bench --bench equal -- --write   also writes benches/equal.md
//! ```
//!
//! Needs the emulator and the Rust target: without them it says so and measures nothing;
//! with `ISOLUX_REQUIRE_QEMU=1` in the environment it fails.

#[path = "parts/by_default.rs"]
mod by_default;
#[path = "equal/cornell.rs"]
mod cornell;
#[path = "parts/grid.rs"]
mod grid;
#[path = "equal/ours.rs"]
mod ours;
#[path = "equal/paper.rs"]
mod paper;
#[path = "table3/pixels.rs"]
#[allow(dead_code, reason = "table 3 uses the rest")]
mod pixels;
#[path = "parts/prices.rs"]
mod prices;
#[path = "parts/room.rs"]
mod room;
#[path = "parts/written.rs"]
mod written;

use by_default::Failed;
use grid::grid;
use isolux_host::report::quantity;
use prices::Prices;
use std::process::ExitCode;

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/equal.md");

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        return ExitCode::SUCCESS; // `cargo test` builds it, and no more
    }
    let prices = match Prices::measure() {
        Ok(prices) => prices,
        Err(error) => {
            let required = std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some();
            eprintln!("SKIPPED instructions at equal error: {error}");
            return match required || !error.is_missing() {
                true => ExitCode::FAILURE,
                false => ExitCode::SUCCESS,
            };
        }
    };
    let text = match document(&prices) {
        Ok(text) => text,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    written::answer(&text, PATH)
}

fn document(prices: &Prices) -> Result<String, Failed> {
    let ray = cornell::price_of_a_ray()?;
    let priced = [
        ["operation", "instructions"].map(str::to_owned).to_vec(),
        of("delta form factor on the light source", prices.on_source),
        of("delta form factor on a patch", prices.on_patch),
        of("ray", ray),
        of("form factor of a rectangle, rung `best`", prices.exact),
    ];
    let paper = grid(&paper::rows(prices)?);
    let cornell = grid(&cornell::rows(prices, ray)?);
    let before = include_str!("equal/before.md").trim_end();
    Ok(format!(
        "{before}\n\n{}\n## paper, Scene 1\n\n{paper}\n## cornell, same quality\n\n{cornell}",
        grid(&priced)
    ))
}

fn of(name: &str, figure: f64) -> Vec<String> {
    vec![name.to_owned(), quantity(figure)]
}
