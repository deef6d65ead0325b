//! The budget sheet against the emulated part: RAM and flash to the byte, the stack within
//! the proved bound, instructions at most what the sheet says.
//!
//! Skipped, loudly, where the emulator or the Rust target is missing; with
//! `ISOLUX_REQUIRE_QEMU=1` in the environment that is a failure instead.

#[path = "command_line/program.rs"]
mod program;

use program::isolux;
use serde_json::Value;

/// The answer of `isolux device --sheet`; `None` where the machine lacks what it takes.
fn run(arguments: &[&str]) -> Option<Value> {
    let directory = tempfile::tempdir().expect("a directory");
    let all = [&["device"], arguments, &["--sheet", "--json"]].concat();
    let ran = isolux(&all, directory.path(), "");
    if ran.code == 1 && ran.stdout.is_empty() {
        let required = std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some();
        assert!(
            ran.stderr.contains("install") && !required,
            "{}",
            ran.stderr
        );
        eprintln!("SKIPPED: {}", ran.stderr);
        return None;
    }
    assert_eq!(ran.code, 0, "{arguments:?}: {}{}", ran.stdout, ran.stderr);
    Some(serde_json::from_str(&ran.stdout).expect("one JSON document"))
}

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn runs_keep_to_their_sheets() {
    let runs: [&[&str]; 7] = [
        &["paper"],
        &["cornell"],
        &["office"],
        &["office", "--transfer", "codes"],
        &["paper", "--placement", "isolux"],
        &["paper-aspect", "--emitters", "layer-cake"],
        &["penumbra", "--microamperes-per-mhz", "100"],
    ];
    runs.into_iter().for_each(keeps);
}

#[test]
fn runs_on_other_rungs_keep_to_their_sheets() {
    let runs: [&[&str]; 8] = [
        &["cornell-rgb"],
        &["penumbra", "--transfer", "codes"],
        &["paper", "--arithmetic", "q29"],
        &["office", "--arithmetic", "q29", "--transfer", "matrix"],
        &["paper", "--arithmetic", "poly5"],
        &["penumbra", "--arithmetic", "libm"],
        &["penumbra", "--visibility", "vertex-rays"],
        &["office", "--transfer", "vectors"],
    ];
    runs.into_iter().for_each(keeps);
}

/// Runs it and holds every figure against the sheet.
fn keeps(arguments: &[&str]) {
    let Some(answer) = run(arguments) else {
        return;
    };
    assert_eq!(
        answer["memory"]["ram_bytes"], answer["ram_bytes"],
        "{arguments:?}"
    );
    assert_eq!(
        answer["memory"]["flash_bytes"], answer["flash_bytes"],
        "{arguments:?}"
    );
    assert!(number(&answer["stack_bytes"]) <= number(&answer["stack_bound_bytes"]));
    let cost = &answer["sheet"]["cost"];
    for step in ["load", "direct", "shoot", "resample"] {
        let measured = number(&answer["instructions_by_step"][step]);
        let predicted = &cost["instructions"][step];
        let (expected, most) = (
            number(&predicted["expected"]),
            number(&predicted["at_most"]),
        );
        println!(
            "{arguments:?} {step}: {measured}, predicted {expected} ({:+.2} %), at most {most}",
            100.0 * (expected / measured - 1.0)
        );
        assert!(measured <= most, "{arguments:?} {step}");
        // Loads are other ones for every table that the compiler sees.
        let most = if step == "load" { 0.05 } else { 0.017 };
        assert!(
            (expected / measured - 1.0).abs() < most,
            "{arguments:?} {step}"
        );
    }
    // All of a run, and what the sheet has for it at the most.
    let total = number(&answer["instructions"]);
    let predicted = &cost["instructions_total"];
    let (expected, at_most) = (
        number(&predicted["expected"]),
        number(&predicted["at_most"]),
    );
    println!("{arguments:?}: {total}, predicted {expected}, at most {at_most}");
    assert!((expected / total - 1.0).abs() < 0.015, "{arguments:?}");
    assert!(at_most < 1.035 * total, "{arguments:?}");
    let times = cost["milliseconds"].as_array().expect("times at clocks");
    assert_eq!(times.len(), 3);
    let charged = arguments.contains(&"--microamperes-per-mhz");
    assert_eq!(cost["microcoulombs"].is_number(), charged);
}

/// Rungs that no costs were measured for have none in their sheet.
#[test]
fn what_was_not_measured_is_not_predicted() {
    let directory = tempfile::tempdir().expect("a directory");
    let arguments = [
        "--json",
        "bake",
        "penumbra",
        "--arithmetic",
        "poly3",
        "--visibility",
        "vertex-rays",
        "-o",
        "a",
    ];
    let ran = isolux(&arguments, directory.path(), "");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let sheet: Value = serde_json::from_str(&ran.stdout).expect("JSON");
    assert!(
        sheet["cost"].is_null() && sheet["ram_bytes"].is_number(),
        "{sheet}"
    );
}

/// What memory.x has no room for is said when a scene is baked, not when a firmware is
/// linked.
#[test]
fn tables_beyond_the_flash_are_told_of() {
    let directory = tempfile::tempdir().expect("a directory");
    // 186 KiB: they fit, beside less than 96 KiB of code.
    let arguments = ["bake", "cornell", "--transfer", "matrix", "-o", "a"];
    let ran = isolux(&arguments, directory.path(), "");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let warned = ran.stderr.contains("163840") && ran.stderr.contains("isolux plan");
    assert!(warned, "{}", ran.stderr);
}
