//! Plan files that are wrong: exit 2, with line, column and remedy.

use crate::{directory, isolux, planned, scene, with_line, write};
use std::path::Path;

/// That a plan is refused with these words at a line, or at any line.
fn refused(directory: &Path, scene: &str, plan: &str, words: &str, line: Option<usize>) {
    write(directory, "wrong.plan", plan);
    let ran = isolux(&["check", scene, "--plan", "wrong.plan"], directory, "");
    let said = &ran.stderr;
    assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{words}: {said}");
    assert!(said.contains(words), "{words}: {said}");
    assert!(!said.contains("panicked"), "{said}");
    assert!(said.contains("help: "), "a remedy: {said}");
    let place = said.split("wrong.plan:").nth(1).expect("file and place");
    let place = place.lines().next().expect("a line");
    let numbers: Vec<usize> = place
        .split(':')
        .filter_map(|part| part.trim().parse().ok())
        .collect();
    let [found, column] = numbers[..] else {
        panic!("{words}: line and column, not {place}");
    };
    assert!(column > 0, "{said}");
    if let Some(line) = line {
        assert_eq!(found, line, "{words}: {said}");
    }
}

#[test]
fn every_number_name_and_index_is_checked() {
    let directory = directory();
    let path = directory.path();
    let plan = planned("penumbra", path, "a.plan");
    // What is replaced, by what, and what is said of it.
    let cases = [
        ("isolux-plan = 1", "isolux-plan = 2", "unknown version"),
        ("isolux-plan = 1", "", "no plan file"),
        ("arithmetic = ", "arithmetic = \"poly9\"", "unknown rung"),
        ("arithmetic = ", "emitters = \"linear\"", "unknown key"),
        (
            "name = \"receiver\"",
            "name = \"reciever\"",
            "did you mean `receiver`",
        ),
        ("name = \"light\"", "name = \"receiver\"", "planned twice"),
        ("name = \"light\"", "", "has no `name`"),
        (
            "origin = ",
            "origin = [-4.0, -4.0, 0.1]",
            "the place of surface `receiver`",
        ),
        (
            "u = ",
            "u = [0.0, 1.0, 0.0]",
            "the direction of surface `receiver`",
        ),
        (
            "size = ",
            "size = [8.0, 8.00001]",
            "the size of surface `receiver`",
        ),
        (
            "area = ",
            "area = 63.999999",
            "the area of surface `receiver`",
        ),
        ("area = ", "area = nan", "finite number"),
        (
            "\"penumbra\"]",
            "  [nan, 4.0, \"penumbra\"],",
            "finite number",
        ),
        (
            "\"penumbra\"]",
            "  [9.0, 4.0, \"penumbra\"],",
            "not on the surface",
        ),
        (
            "\"penumbra\"]",
            "  [3.0, 4.0, \"penumbre\"],",
            "did you mean `penumbra`",
        ),
        ("\"penumbra\"]", "  [3.0, 4.0, \"lit\", 3.0],", "4 parts"),
        (
            "\"penumbra\"]",
            "  [3.0, 4.0, \"grid\"],",
            "cannot stand here",
        ),
        ("\"lit\"]", "  [0.3, 0.3, \"lit\"],", "not at its node"),
        ("\"lit\"]", "", "not at its node"),
        ("nodes-u = ", "nodes-u = [0.0, -0.5]", "nodes must rise"),
        ("nodes-u = ", "nodes-u = [0.0, 1e-9, 0.5]", "too steep"),
        ("nodes-u = ", "nodes-u = []", "1 to 16 nodes"),
        ("half = ", "half = [0.0, 4.0]", "nothing like half"),
        (
            "first = 0",
            "first = 81",
            "beyond the samples of this surface",
        ),
        ("first = 0", "first = 60", "the grid needs 25 samples"),
        ("first = 25", "first = -1", "no number of samples"),
        (
            "samples = 56",
            "samples = 57",
            "the mesh needs 57 samples from sample 25 on",
        ),
        ("outside = ", "outside = 1.5", "between 0.0 and 1.0"),
        ("pieces = [", "pieces = []\nold = [", "unknown key `old`"),
        (
            "triangles = [",
            "triangles = [[0, 1]]\nold = [",
            "unknown key `old`",
        ),
        ("[end]", "", "breaks off"),
    ];
    for (what, by, words) in cases {
        let (wrong, line) = with_line(&plan, what, by);
        let at = !by.is_empty() && !words.starts_with("unknown key `old`");
        refused(path, "penumbra", &wrong, words, at.then_some(line));
    }
}

#[test]
fn records_of_emitters_and_meshes_are_checked() {
    let directory = directory();
    let path = directory.path();
    let plan = planned("penumbra", path, "a.plan");
    // The line behind the one that is named is replaced.
    let cases = [
        (
            "members = [",
            "  [81, 1.0, 0.0, 0.0],",
            "81 is beyond the samples",
        ),
        (
            "members = [",
            "  [0, 65.0, 0.0, 0.0],",
            "between -64.0 and 64.0",
        ),
        ("members = [", "  [0, 1.0, 0.0],", "a member is"),
        (
            "pieces = [",
            "  [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]],",
            "counter-clockwise",
        ),
        (
            "pieces = [",
            "  [[0.0, 0.0], [1.0, 0.0]],",
            "counter-clockwise",
        ),
        (
            "nodes = [",
            "  [1.0, 1.0, 0.0, [56, 0.5]],",
            "56 is beyond the samples of this mesh",
        ),
        ("nodes = [", "  [1.0, 1.0, 0.0, [0, 4.5]],", "between -3.99"),
        ("nodes = [", "  [1.0, 1.0, inf],", "finite number"),
        ("nodes = [", "  [1.0, 1.0],", "a node is"),
        (
            "triangles = [",
            "  [0, 1, 5000],",
            "5000 is beyond the nodes",
        ),
        ("triangles = [", "  [0, 1],", "three nodes"),
        (
            "predicted = [",
            "  [\"glow\", 0.1, 1.0],",
            "no part of the light",
        ),
        (
            "predicted-by-tag = [",
            "  [\"grid\", 0.1, 1.0],",
            "no place has this tag",
        ),
    ];
    for (head, by, words) in cases {
        let mut lines: Vec<&str> = plan.lines().collect();
        let at = lines.iter().position(|line| *line == head).expect(head) + 1;
        lines[at] = by;
        refused(path, "penumbra", &lines.join("\n"), words, Some(at + 1));
    }
}

#[test]
fn a_file_that_breaks_off_is_refused_wherever_it_does() {
    let directory = directory();
    let path = directory.path();
    let plan = planned("paper", path, "a.plan");
    for part in 0..24 {
        let end = plan.len() * part / 24;
        refused(path, "paper", &plan[..end], "", None);
    }
    let last = plan.rfind("# Nothing is missing").expect("the end");
    refused(path, "paper", &plan[..last], "breaks off", None);
}

#[test]
fn what_the_plan_knows_nothing_of_is_refused() {
    let directory = directory();
    let path = directory.path();
    let plan = planned("paper", path, "a.plan");
    let paper = scene("paper");
    let moved = paper.replace(
        "[3.7, 2.5, 2.2], [8.7, 2.5, 2.2], [8.7, -2.5, 2.2], [3.7, -2.5, 2.2]",
        "[3.8, 2.5, 2.2], [8.8, 2.5, 2.2], [8.8, -2.5, 2.2], [3.8, -2.5, 2.2]",
    );
    let shining = paper.replace("name = \"B\"", "name = \"B\"\nradiance = 1.0");
    let mirror = paper.replace("radiance = 12.0", "radiance = 12.0\nreflectance = 0.1");
    let other = paper.replace("name = \"B\"", "name = \"C\"");
    let more =
        paper.clone() + "[[surface]]\nname = \"C\"\nvertices = [[9,9,9],[10,9,9],[10,10,9]]\n";
    for (scene, words) in [
        (moved, "the place of surface `B`"),
        (shining, "emits now"),
        (mirror, "reflects now"),
        (other, "no surface `B`"),
        (more, "knows nothing of the scene's surface `C`"),
    ] {
        write(path, "scene.toml", &scene);
        refused(path, "scene.toml", &plan, words, None);
    }
    let scene_file = scene("paper");
    refused(path, "paper", &scene_file, "no plan file", Some(1));
}

#[test]
fn a_flag_for_other_samples_or_emitters_is_refused() {
    let directory = directory();
    let path = directory.path();
    planned("paper", path, "a.plan");
    for (flag, rung) in [
        ("--emitters", "linear"),
        ("--placement", "isolux"),
        ("--reconstruction", "cone"),
    ] {
        let ran = isolux(
            &["check", "paper", "--plan", "a.plan", flag, rung],
            path,
            "",
        );
        assert_eq!(
            (ran.code, ran.stdout.as_str()),
            (2, ""),
            "{flag}: {}",
            ran.stderr
        );
        assert!(
            ran.stderr.contains(&format!("leave out {flag}")),
            "{}",
            ran.stderr
        );
    }
}
