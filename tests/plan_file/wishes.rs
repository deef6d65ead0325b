//! `isolux plan` with wishes: it meets them, or says which it cannot.

use crate::{answered, directory, isolux};
use isolux_host::scene::shipped;
use serde_json::Value;
use std::path::Path;

fn sheet(arguments: &[&str], directory: &Path) -> Value {
    let mut all = vec!["plan"];
    all.extend(arguments);
    all.extend(["-o", "a.plan", "--json"]);
    serde_json::from_str(&answered(&all, directory)).expect("one JSON document")
}

fn count(value: &Value) -> u64 {
    value.as_u64().expect("a count")
}

/// Named points of a shipped scene.
fn shipped_points(scene: &str) -> u64 {
    let named = |(file, _): &&(&str, &str)| file.trim_end_matches(".toml") == scene;
    let (_, source) = shipped::ALL.iter().find(named).expect("a shipped scene");
    source.matches("[[point]]").count() as u64
}

#[test]
fn the_sheet_adds_up_and_check_agrees() {
    let directory = directory();
    for scene in ["paper", "penumbra"] {
        let sheet = sheet(&[scene], directory.path());
        let surfaces = sheet["surfaces"].as_array().expect("surfaces");
        let sum = |key: &str| {
            surfaces
                .iter()
                .map(|surface| count(&surface[key]))
                .sum::<u64>()
        };
        for key in ["samples", "emitters", "free_samples"] {
            assert_eq!(sum(key), count(&sheet[key]), "{scene} {key}");
        }
        for surface in surfaces {
            let tags = surface["by_tag"].as_object().expect("tags");
            let tagged: u64 = tags.values().map(count).sum();
            assert_eq!(tagged, count(&surface["samples"]), "{surface}");
            errors_add_up(surface);
        }
        errors_add_up(&sheet);
        let parts = ["light_bytes", "workspace_bytes", "room_bytes"];
        let ram: u64 = parts.iter().map(|key| count(&sheet[*key])).sum();
        assert_eq!(ram, count(&sheet["ram_bytes"]), "{scene}");
        let checked = answered(
            &["check", scene, "--plan", "a.plan", "--json"],
            directory.path(),
        );
        let checked: Value = serde_json::from_str(&checked).expect("JSON");
        assert_eq!(checked["flash_bytes"], sheet["table_bytes"], "{scene}");
        // Named points are samples of the tables, and none of the plan.
        let points = shipped_points(scene);
        assert_eq!(
            count(&checked["capacities"]["samples"]),
            count(&sheet["samples"]) + points,
            "{scene}"
        );
    }
}

/// Squares of the errors by tag have the predicted error's as their mean over the area.
fn errors_add_up(of: &Value) {
    let number = |value: &Value| value.as_f64().expect("a number");
    let tags = of["predicted_by_tag"].as_array().expect("tags");
    let (mut loss, mut area) = (0.0, 0.0);
    for tag in tags {
        loss += number(&tag["error"]).powi(2) * number(&tag["area"]);
        area += number(&tag["area"]);
    }
    let error = number(&of["predicted_error"]);
    assert!(((loss / area).sqrt() / error - 1.0).abs() < 1e-6, "{of}");
}

#[test]
fn a_wished_error_takes_fewer_samples_the_larger_it_is() {
    let directory = directory();
    let of = |error: &str| sheet(&["penumbra", "--max-error", error], directory.path());
    let mut before = u64::MAX;
    for (wish, most) in [("0.5%", 0.5), ("1%", 1.0), ("3%", 3.0)] {
        let sheet = of(wish);
        let predicted = sheet["predicted_error"].as_f64().expect("a number");
        assert!(predicted <= most, "{wish}: {predicted}");
        let samples = count(&sheet["samples"]);
        assert!(samples < before, "{wish}: {samples}, {before} for less");
        before = samples;
    }
}

#[test]
fn bytes_are_kept() {
    let directory = directory();
    let flash = sheet(&["penumbra", "--flash", "12KiB"], directory.path());
    assert!(count(&flash["table_bytes"]) <= 12 * 1024, "{flash}");
    let both = sheet(
        &["penumbra", "--ram", "2KiB", "--max-error", "1%"],
        directory.path(),
    );
    assert!(count(&both["ram_bytes"]) <= 2048, "{both}");
    assert!(
        both["predicted_error"].as_f64().expect("a number") <= 1.0,
        "{both}"
    );
    let few = sheet(&["penumbra", "--samples", "30"], directory.path());
    assert!(count(&few["samples"]) <= 30, "{few}");
}

#[test]
fn instructions_are_kept() {
    let directory = directory();
    let of = |wish: &str| {
        let sheet = sheet(&["penumbra", "--instructions", wish], directory.path());
        let steps = &sheet["cost"]["instructions"];
        let at_most = ["direct", "shoot"].map(|step| count(&steps[step]["at_most"]));
        let takes: u64 = at_most.iter().sum();
        let most: u64 = wish.parse().expect("a number");
        assert!(takes <= most, "{wish}: {takes}");
        (takes, count(&sheet["samples"]))
    };
    let (many, few) = (of("1500000"), of("700000"));
    assert!(few.0 < many.0 && few.1 < many.1, "{few:?} {many:?}");
}

#[test]
fn what_cannot_be_met_is_named_with_the_nearest_and_nothing_is_written() {
    let directory = directory();
    for (wishes, words) in [
        (&["--ram", "500"][..], ["the wish --ram", "bytes of RAM"]),
        (
            &["--flash", "1KiB"],
            ["the wish --flash", "bytes of tables"],
        ),
        (
            &["--instructions", "1000"],
            ["the wish --instructions", "raise --instructions"],
        ),
        (
            &[
                "--instructions",
                "1000000",
                "--arithmetic",
                "poly3",
                "--visibility",
                "vertex-rays",
            ],
            ["no instructions are predicted", "leave out --instructions"],
        ),
        (
            &["--max-error", "0.001%", "--samples", "60"],
            ["the wish --max-error", "nearest"],
        ),
        (
            &["--max-error", "0.5%", "--ram", "2KiB"],
            ["the wish --max-error", "raise --ram"],
        ),
        (
            &["--max-error", "1%", "--placement", "isolux"],
            ["predicts no error", "help"],
        ),
    ] {
        let mut arguments = vec!["plan", "penumbra", "-o", "a.plan"];
        arguments.extend(wishes);
        let ran = isolux(&arguments, directory.path(), "");
        assert_eq!(
            (ran.code, ran.stdout.as_str()),
            (1, ""),
            "{wishes:?}: {}",
            ran.stderr
        );
        for word in words {
            assert!(ran.stderr.contains(word), "{word}: {}", ran.stderr);
        }
        assert!(!directory.path().join("a.plan").exists(), "{wishes:?}");
    }
}

#[test]
fn wishes_that_are_none_are_refused() {
    let directory = directory();
    for wishes in [
        ["--max-error", "2"],
        ["--max-error", "-1%"],
        ["--ram", "0"],
        ["--samples", "0"],
        ["--instructions", "0"],
    ] {
        let ran = isolux(
            &["plan", "paper", "-o", "a.plan", wishes[0], wishes[1]],
            directory.path(),
            "",
        );
        assert_eq!(
            (ran.code, ran.stdout.as_str()),
            (2, ""),
            "{wishes:?}: {}",
            ran.stderr
        );
    }
    let ran = isolux(
        &["plan", "paper", "-o", "none/a.plan"],
        directory.path(),
        "",
    );
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("no such directory"), "{}", ran.stderr);
}

/// Many nodes that are drawn together stand for less than nothing, some of them: those
/// grids are no plans.
#[test]
fn many_samples_are_planned_in_the_open() {
    let directory = directory();
    for samples in ["90", "96"] {
        let sheet = sheet(&["paper", "--samples", samples], directory.path());
        assert!(count(&sheet["samples"]) <= samples.parse::<u64>().expect("a number"));
    }
}
