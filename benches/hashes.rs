//! Hashes of the bits of many form factors on every rung: on this machine as
//! this was built, and on every emulated core (of the M3 those in integers),
//! beside the committed ones.
//!
//! ```text
//! cargo bench --bench hashes                  a million evaluations a rung
//! cargo bench --bench hashes -- 10000         so many
//! cargo bench --bench hashes -- --write       also writes tests/data/hashes.csv
//! cargo bench --bench hashes -- --host        this machine alone
//! cargo bench --bench hashes --profile dev -- --host
//! RUSTFLAGS="-C target-cpu=native" cargo bench --bench hashes -- --host
//! ```
//!
//! Fails where two hashes differ; where it is the committed ones that differ from
//! all others, `--write` puts the others in their place.

#[path = "../tests/firmware/src/hash_cases.rs"]
mod hash_cases;
#[path = "parts/hashed.rs"]
mod hashed;

use isolux_host::device::{self, Core, Hashed};
use isolux_host::report::{WriteError, write_file};
use isolux_host::solve::FormFactorRung;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

/// Evaluations where no number is given.
const EVALUATIONS: u32 = 1_000_000;

/// The command that writes the committed hashes anew.
const COMMAND: &str = "cargo bench --bench hashes -- EVALUATIONS --write";

/// Their columns.
const COLUMNS: &str = "evaluations,rung,hash";

/// How long one emulation may take.
const TIME_LIMIT: Duration = Duration::from_secs(3600);

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |name: &str| arguments.iter().any(|argument| argument == name);
    if !has("--bench") {
        return ExitCode::SUCCESS; // `cargo test` builds it, and no more
    }
    let given = arguments.iter().find_map(|argument| argument.parse().ok());
    let evaluations = given.unwrap_or(EVALUATIONS);
    let host = hashed::all(evaluations);
    let mut columns = vec![("this build", host.clone())];
    if !has("--host") {
        for core in Core::ALL {
            let rungs = match core {
                Core::CortexM4F | Core::CortexM7 => Hashed::All,
                Core::CortexM3 => Hashed::Integers,
            };
            match device::hashes(&[core], rungs, evaluations, TIME_LIMIT) {
                Ok(found) => columns.extend(found.into_iter().map(|hashes| (core.name(), hashes))),
                Err(error) => {
                    eprintln!("SKIPPED: {error}");
                    if !error.is_missing() || std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some() {
                        return ExitCode::FAILURE;
                    }
                }
            }
        }
    }
    let measured = columns.len();
    let committed = hashed::read().remove(&evaluations);
    columns.extend(committed.map(|committed| ("committed", committed)));
    print(evaluations, &columns);
    if has("--write") && agree(&columns[..measured]) {
        if let Err(error) = write(evaluations, host) {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
        println!("wrote {}", hashed::PATH);
        return ExitCode::SUCCESS;
    }
    if agree(&columns) {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

/// Where hashes are from, and they by rung.
type Column = (&'static str, hashed::Hashes);

/// Whether every column has the first one's hashes, as far as it goes.
fn agree(columns: &[Column]) -> bool {
    let known = |(rung, hash): (&String, &u64)| columns[0].1.get(rung) == Some(hash);
    columns.iter().all(|(_, hashes)| hashes.iter().all(known))
}

fn print(evaluations: u32, columns: &[Column]) {
    println!("hashes of {evaluations} form factors a rung");
    for rung in FormFactorRung::ALL {
        let of = |(_, hashes): &Column| hashes.get(rung.name()).copied();
        print!("{:<10}", rung.name());
        for column in columns {
            let hash = of(column).map_or("-".to_owned(), |hash| format!("{hash:016x}"));
            print!("  {} {hash}", column.0);
        }
        let same = columns
            .iter()
            .filter_map(of)
            .all(|hash| Some(hash) == of(&columns[0]));
        println!("{}", if same { "" } else { "  DIFFERENT" });
    }
}

/// Puts the hashes of so many evaluations in the place of the committed ones.
fn write(evaluations: u32, hashes: hashed::Hashes) -> Result<(), WriteError> {
    let mut all = hashed::read();
    all.insert(evaluations, hashes);
    let mut text =
        format!("# FNV-1a of the bits of form factors; written by `{COMMAND}`.\n{COLUMNS}\n");
    for (evaluations, hashes) in &all {
        for rung in FormFactorRung::ALL {
            if let Some(hash) = hashes.get(rung.name()) {
                text.push_str(&format!("{evaluations},{},{hash:016x}\n", rung.name()));
            }
        }
    }
    write_file(Path::new(hashed::PATH), text.as_bytes())
}
