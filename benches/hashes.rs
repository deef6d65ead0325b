//! Hashes of the bits of many form factors on every rung: on this machine as
//! this was built, on the emulated Cortex-M4F and on the M7, beside the
//! committed ones.
//!
//! ```text
//! cargo bench --bench hashes                  a million evaluations a rung
//! cargo bench --bench hashes -- 10000         so many
//! RUSTFLAGS="-C target-cpu=native" cargo bench --bench hashes
//! ```
//!
//! Fails where two hashes differ.

#[path = "../tests/firmware/src/hash_cases.rs"]
mod hash_cases;
#[path = "parts/hashed.rs"]
mod hashed;

use isolux_host::device::{self, Core};
use isolux_host::solve::FormFactorRung;
use std::collections::BTreeMap;
use std::process::ExitCode;
use std::time::Duration;

/// Evaluations where no number is given.
const EVALUATIONS: u32 = 1_000_000;

/// How long one emulation may take.
const TIME_LIMIT: Duration = Duration::from_secs(1200);

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        return ExitCode::SUCCESS; // `cargo test` builds it, and no more
    }
    let given = arguments.iter().find_map(|argument| argument.parse().ok());
    let evaluations = given.unwrap_or(EVALUATIONS);
    let host: BTreeMap<String, u64> = FormFactorRung::ALL
        .into_iter()
        .map(|rung| (rung.name().to_owned(), hashed::of(rung, evaluations)))
        .collect();
    let mut columns = vec![("this build", host)];
    let committed = hashed::committed(evaluations);
    if !committed.is_empty() {
        columns.push(("committed", committed));
    }
    let cores = [Core::CortexM4F, Core::CortexM7];
    match device::hashes(&cores, evaluations, TIME_LIMIT) {
        Ok(found) => columns.extend(cores.iter().map(|core| core.name()).zip(found)),
        Err(error) => {
            eprintln!("SKIPPED: {error}");
            if !error.is_missing() || std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some() {
                return ExitCode::FAILURE;
            }
        }
    }
    println!("hashes of {evaluations} form factors a rung");
    let mut equal = true;
    for rung in FormFactorRung::ALL {
        let hashes: Vec<_> = columns
            .iter()
            .map(|(name, hashes)| (name, hashes.get(rung.name())))
            .collect();
        let same = hashes.iter().all(|(_, hash)| *hash == hashes[0].1);
        equal &= same;
        print!("{:<10}", rung.name());
        for (name, hash) in &hashes {
            let hash = hash.map_or("-".to_owned(), |hash| format!("{hash:016x}"));
            print!("  {name} {hash}");
        }
        println!("{}", if same { "" } else { "  DIFFERENT" });
    }
    if equal {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
