//! Plans that a hand has changed, and scenes whose light has.

use crate::{answered, directory, irradiances, planned, scene, with_line, write};

/// A sample in the penumbra, as it is written.
fn penumbra_sample(plan: &str) -> &str {
    let tagged = |line: &&str| line.ends_with("\"penumbra\"],");
    plan.lines().find(tagged).expect("a sample")
}

#[test]
fn a_sample_that_was_moved_is_used() {
    let directory = directory();
    let path = directory.path();
    let plan = planned("penumbra", path, "a.plan");
    let line = penumbra_sample(&plan);
    let numbers: Vec<f64> = line
        .split(['[', ','])
        .filter_map(|part| part.trim().parse().ok())
        .collect();
    let [u, v] = numbers[..] else {
        panic!("a sample has two coordinates: {line}");
    };
    let moved = format!("  [{:?}, {v:?}, \"penumbra\"],", u + 0.1);
    write(path, "b.plan", &with_line(&plan, line, &moved).0);
    // The surface's frame begins at (-4, -4).
    write(
        path,
        "a.pts",
        &format!("{} {} 0 0 0 1\n3.5 3.5 0 0 0 1\n", u - 4.0, v - 4.0),
    );
    let solve = |plan: &str, how: &str| {
        let csv = answered(
            &[
                "solve", "penumbra", "--points", "a.pts", how, "--plan", plan,
            ],
            path,
        );
        irradiances(&csv)
    };
    let [before, after] = ["a.plan", "b.plan"].map(|plan| solve(plan, "--reconstructed"));
    let change = (after[0] - before[0]).abs() / before[0];
    assert!((1e-4..0.2).contains(&change), "{before:?} {after:?}");
    assert_eq!(before[1], after[1], "where it has no share nothing changes");
}

#[test]
fn a_plan_serves_the_scene_with_other_radiances_and_reflectances() {
    let directory = directory();
    let path = directory.path();
    planned("paper", path, "a.plan");
    let original = scene("paper");
    let changed = with_line(&original, "reflectance = 0.5", "reflectance = 0.2").0;
    let changed = with_line(&changed, "radiance = 12.0", "radiance = 30.0").0;
    write(path, "changed.toml", &changed);
    write(
        path,
        "a.pts",
        "0.3 1.2 0 0 0 1\n-2 -2 0 0 0 1\n5 0.5 2.2 0 0 -1\n8 -2 2.2 0 0 -1\n",
    );
    let solve = |more: &[&str]| {
        let mut arguments = vec!["solve", "changed.toml", "--points", "a.pts"];
        arguments.extend(more);
        irradiances(&answered(&arguments, path))
    };
    let exact = solve(&["--reference"]);
    for how in [
        &["--plan", "a.plan"][..],
        &["--plan", "a.plan", "--reconstructed"],
    ] {
        for (found, exact) in solve(how).into_iter().zip(&exact) {
            let error = (found / exact - 1.0).abs();
            assert!(error < 0.03, "{how:?}: {found}, and it is {exact}");
        }
    }
    let bright = irradiances(&answered(&["solve", "paper", "--points", "a.pts"], path));
    assert!(
        (exact[0] / bright[0] - 2.5).abs() < 0.1,
        "it is another light"
    );
}

#[test]
fn every_command_that_plans_takes_a_plan() {
    let directory = directory();
    let path = directory.path();
    planned("penumbra", path, "a.plan");
    let checked = answered(&["check", "penumbra", "--plan", "a.plan", "--json"], path);
    let checked: serde_json::Value = serde_json::from_str(&checked).expect("JSON");
    assert_eq!(checked["capacities"]["samples"], 81 + 3);
    for command in ["render", "solve", "device", "trade", "check"] {
        let help = answered(&[command, "--help"], path);
        assert!(help.contains("--plan <FILE>"), "{command}");
        let missing = ["--plan", "none.plan", "--json"];
        let mut arguments = vec![command, "penumbra"];
        if ["render", "trade"].contains(&command) {
            arguments.extend(["-o", "out"]);
        }
        arguments.extend(missing);
        let ran = crate::isolux(&arguments, path, "");
        assert_eq!(ran.code, 2, "{command}: {}", ran.stderr);
        assert!(
            ran.stderr.contains("none.plan"),
            "{command}: {}",
            ran.stderr
        );
    }
}
