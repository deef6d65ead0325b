//! `isolux solve`.

use crate::program::{Ran, isolux};
use crate::{desk, document, keys, refused, set, write};
use std::path::Path;

/// Points with digits of every kind, comments and blank lines between.
const POINTS: &str = "# sensors\n1.5 1.5 0 0 0 1\n\n0.1 0.30000000000000004 0.7 0 0 2\r\n\
                      -3 2e0 1e-7 0.5 -0.25 +1 # beside\n\t2 2 1 0 0 -1\n1.5 1.5 0 0 0 1\n";

const GIVEN: [&str; 5] = [
    "1.5,1.5,0,0,0,1,",
    "0.1,0.30000000000000004,0.7,0,0,2,",
    "-3,2,0.0000001,0.5,-0.25,1,",
    "2,2,1,0,0,-1,",
    "1.5,1.5,0,0,0,1,",
];

fn solve(directory: &Path, arguments: &[&str]) -> Ran {
    write(directory, "desk.toml", &desk());
    isolux(
        &[&["solve", "desk.toml"], arguments].concat(),
        directory,
        "",
    )
}

fn values(ran: &Ran) -> Vec<f64> {
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let mut rows = ran.stdout.lines();
    assert_eq!(rows.next(), Some("x,y,z,nx,ny,nz,E"));
    let value = |row: &str| {
        let fields: Vec<f64> = row
            .split(',')
            .map(|x| x.parse().expect("a number"))
            .collect();
        assert_eq!(fields.len(), 7, "{row}");
        fields[6]
    };
    rows.map(value).collect()
}

#[test]
fn rows_are_the_points_in_order_with_digits_that_round_trip() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "f.pts", POINTS);
    for (arguments, single) in [
        (&["--points", "f.pts"][..], true),
        (&["--points", "f.pts", "--bounces", "0"], true),
        (&["--points", "f.pts", "--arithmetic", "libm"], true),
        (
            &["--points", "f.pts", "--reference", "--bounces", "1"],
            false,
        ),
    ] {
        let ran = solve(directory.path(), arguments);
        assert_eq!(ran.stderr, "", "nothing to complain about");
        let answers = values(&ran);
        for (row, given) in ran.stdout.lines().skip(1).zip(GIVEN) {
            let digits = row
                .strip_prefix(given)
                .unwrap_or_else(|| panic!("{row} for {given}"));
            let again = if single {
                digits.parse::<f32>().expect("a number").to_string()
            } else {
                digits.parse::<f64>().expect("a number").to_string()
            };
            assert_eq!(digits, again, "the shortest digits");
        }
        assert_eq!(answers.len(), GIVEN.len());
        assert_eq!(answers[0], answers[4], "the same place, the same light");
        assert!(answers[0] > 100.0, "lx below the light");
    }
}

#[test]
fn bounces_are_reflections() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "f.pts", "2 2 1 0 0 -1\n2 2 1 0 0 1\n");
    let at = |arguments: &[&str]| {
        values(&solve(
            directory.path(),
            &[&["--points", "f.pts"], arguments].concat(),
        ))
    };
    let direct = at(&["--bounces", "0"]);
    // Facing down, nothing arrives but what the floor reflects, once: the
    // light itself reflects nothing.
    assert_eq!(direct[0], 0.0);
    let once = at(&["--bounces", "1"]);
    assert!(once[0] > 0.0);
    assert_eq!(once[1], direct[1]);
    assert_eq!(at(&["--bounces", "2"]), once);
    assert_eq!(at(&[]), once);
    let reference = at(&["--bounces", "1", "--reference"]);
    assert!(
        (once[0] / reference[0] - 1.0).abs() < 0.1,
        "{once:?} {reference:?}"
    );
    assert!(
        (once[1] / reference[1] - 1.0).abs() < 2e-6,
        "{once:?} {reference:?}"
    );
}

#[test]
fn answers_do_not_depend_on_the_other_points() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "f.pts", POINTS);
    let together = values(&solve(directory.path(), &["--points", "f.pts"]));
    let lines: Vec<&str> = POINTS
        .lines()
        .filter(|l| l.starts_with(|c: char| !"# ".contains(c)) && !l.is_empty())
        .collect();
    let mut backwards = lines.clone();
    backwards.reverse();
    write(directory.path(), "g.pts", &backwards.join("\n"));
    let mut reversed = values(&solve(directory.path(), &["--points", "g.pts"]));
    reversed.reverse();
    assert_eq!(together, reversed);
}

#[test]
fn named_points_are_answered_without_a_file() {
    let directory = tempfile::tempdir().expect("a directory");
    assert_eq!(values(&solve(directory.path(), &[])).len(), 2);
    let solved = document(&solve(directory.path(), &["--json", "--bounces", "1"]));
    assert_eq!(
        keys(&solved),
        set([
            "scene", "unit", "method", "bounces", "points", "inexact", "balance"
        ])
    );
    assert_eq!(solved["unit"], "lx");
    assert_eq!(solved["points"][0]["name"], "desk-1");
    assert_eq!(
        keys(&solved["points"][0]),
        set(["name", "position", "normal", "E"])
    );
    assert!(solved["points"][0]["E"].as_f64().expect("a number") > 0.0);
    // A scene without points needs a file.
    let ran = isolux(&["solve", "paper"], directory.path(), "");
    refused(&ran, 2);
    assert!(ran.stderr.contains("--points"), "{}", ran.stderr);
}

#[test]
fn reconstructed_answers_lie_on_planned_surfaces() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "on.pts", "2 2 0 0 0 1\n0.5 3 0 0 0 5\n");
    let on = ["--points", "on.pts", "--bounces", "0"];
    let resampled = values(&solve(
        directory.path(),
        &[&on[..], &["--reconstructed"]].concat(),
    ));
    let evaluated = values(&solve(directory.path(), &on));
    for (a, b) in resampled.iter().zip(&evaluated) {
        assert!((a / b - 1.0).abs() < 0.5, "{a} {b}");
        assert_ne!(a, b);
    }
    for off in [
        "2 2 0.5 0 0 1",
        "2 2 0 0 0 -1",
        "2 2 0 1 0 1",
        "5 5 0 0 0 1",
        "2 2 2 0 0 -1",
    ] {
        write(
            directory.path(),
            "off.pts",
            &format!("2 2 0 0 0 1\n\n{off}\n"),
        );
        let ran = solve(
            directory.path(),
            &["--points", "off.pts", "--reconstructed"],
        );
        refused(&ran, 2);
        assert!(ran.stderr.contains("off.pts:3:"), "{off}: {}", ran.stderr);
    }
    let both = ["--points", "on.pts", "--reconstructed", "--reference"];
    refused(&solve(directory.path(), &both), 2);
}

#[test]
fn bad_points_are_named_by_line_and_column() {
    let directory = tempfile::tempdir().expect("a directory");
    for (line, column) in [
        ("1 2 3 0 0", 10),
        ("1 2 3 0 0 1 7", 13),
        ("1 2 x 0 0 1", 5),
        ("1 nan 3 0 0 1", 3),
        ("inf 2 3 0 0 1", 1),
        ("1 2 3 0 0 0", 7),
        ("1e9 2 3 0 0 1", 1),
        ("1,2,3,0,0,1", 1),
    ] {
        write(
            directory.path(),
            "bad.pts",
            &format!("0 0 0 0 0 1\n{line}\n"),
        );
        for arguments in [&[][..], &["--reference"], &["--reconstructed"], &["--json"]] {
            let arguments = [&["--points", "bad.pts"], arguments].concat();
            let ran = solve(directory.path(), &arguments);
            refused(&ran, 2);
            let place = format!("bad.pts:2:{column}");
            assert!(ran.stderr.contains(&place), "{place}: {}", ran.stderr);
            assert!(ran.stderr.contains("help"), "{}", ran.stderr);
        }
    }
    write(directory.path(), "empty.pts", "# none\n");
    assert!(values(&solve(directory.path(), &["--points", "empty.pts"])).is_empty());
    refused(&solve(directory.path(), &["--points", "missing.pts"]), 2);
    refused(&solve(directory.path(), &["--points", "."]), 2);
    std::fs::write(directory.path().join("binary.pts"), b"0 0 0 0 0 1\n\xff\n").expect("a file");
    refused(&solve(directory.path(), &["--points", "binary.pts"]), 2);
}
