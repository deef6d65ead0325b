//! What an operation of the kernel costs on a Cortex-M4F, in integers on a Cortex-M3, fitted
//! to emulated runs of many scenes: the costs that the budget sheet multiplies; and what they
//! err by in others.
//!
//! ```text
//! cargo bench --bench model              prints the costs and what they err by
//! cargo bench --bench model -- --write   also writes benches/model.csv
//! cargo bench --bench model -- q29 poly5 only runs with one of these words among their
//!                                        flags; what others gave stays as it is written
//! ```
//!
//! Says loudly what is missing where the emulator or the Rust target is, and ends.

#[path = "parts/model.rs"]
mod model;
#[path = "parts/program.rs"]
mod program;

use isolux_host::report::write_file;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        return ExitCode::SUCCESS; // `cargo test` builds it, and no more
    }
    let directory = tempfile::tempdir().expect("a directory");
    let words: Vec<&String> = { arguments.iter() }
        .filter(|argument| !argument.starts_with("--"))
        .collect();
    let asked = |run: &&model::Run| words.is_empty() || words.iter().any(|word| run.has(word));
    let (Some(mut fitted), Some(rungs), Some(mut others)) = (
        observed(model::RUNS.iter().filter(asked), directory.path()),
        observed(model::rungs().iter().filter(asked), directory.path()),
        observed(model::OTHERS.iter().filter(asked), directory.path()),
    ) else {
        return ExitCode::FAILURE;
    };
    let (own, shared): (Vec<_>, Vec<_>) =
        { rungs.into_iter() }.partition(|(_, step)| step.group.starts_with("light"));
    fitted.extend(own);
    others.extend(shared);
    let fitted: Vec<model::Observed> = fitted.into_iter().map(|(_, step)| step).collect();
    let written = match words.is_empty() {
        true => String::new(),
        false => std::fs::read_to_string(model::PATH).unwrap_or_default(),
    };
    let (mut text, mut said) = model::model(&fitted, &written);
    if !words.is_empty() {
        text = model::with_others(&written, &text);
    }
    said += &model::tried(&text, &others);
    print!("{text}{said}");
    if arguments.iter().any(|argument| argument == "--write") {
        if let Err(error) = write_file(Path::new(model::PATH), text.as_bytes()) {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
        println!("wrote {}", model::PATH);
    }
    ExitCode::SUCCESS
}

/// The steps of runs, each with the words that ran it; `None` where one does not answer.
fn observed<'a>(
    runs: impl Iterator<Item = &'a model::Run>,
    directory: &Path,
) -> Option<Vec<(String, model::Observed)>> {
    let mut all = Vec::new();
    for run in runs {
        let arguments = run.arguments(directory);
        let answer = answer(&arguments, directory)?;
        let name = run.name();
        for step in model::observed(&answer) {
            println!("{name} {}: {}", step.group, step.instructions);
            all.push((name.clone(), step));
        }
    }
    Some(all)
}

/// What the program of this checkout answers. That the run is above the committed costs is
/// no failure here.
fn answer(arguments: &[String], directory: &Path) -> Option<serde_json::Value> {
    let output = program::isolux(arguments, directory);
    let answer = serde_json::from_slice(&output.stdout).ok();
    if answer.is_none() {
        eprintln!("{}", String::from_utf8_lossy(&output.stderr));
    }
    answer
}
