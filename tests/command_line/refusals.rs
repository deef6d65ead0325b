//! Scenes and flags that are refused, by every command that reads them.

use crate::program::{Ran, isolux};
use crate::{HEAD, desk, files, red, refused, shaded, write};
use std::path::Path;

/// Every command that reads a scene and needs no emulator.
fn every_command(directory: &Path, scene: &str, more: &[&str]) -> Vec<(&'static str, Ran)> {
    let out = directory.join("out");
    let out = out.to_str().expect("UTF-8");
    let commands = [
        ("check", vec!["check", scene]),
        ("render", vec!["render", scene, "-o", out]),
        ("solve", vec!["solve", scene]),
        ("solve --reference", vec!["solve", scene, "--reference"]),
    ];
    commands
        .into_iter()
        .map(|(name, arguments)| (name, isolux(&[&arguments, more].concat(), directory, "")))
        .collect()
}

#[test]
fn malformed_scenes_show_the_place_and_the_remedy() {
    let square = "vertices = [[0,0,0],[1,0,0],[1,1,0],[0,1,0]]\n";
    let surface = |rest: &str| format!("{HEAD}[[surface]]\nname = \"A\"\n{square}{rest}\n");
    let cases = [
        ("unknown key", surface("reflectanse = 0.5"), "7:1"),
        ("reflectance of 1", surface("reflectance = 1.0"), "7:15"),
        ("negative radiance", surface("radiance = -1"), "7:12"),
        ("NaN", surface("radiance = nan"), "7:12"),
        ("broken TOML", surface("radiance = "), "7:"),
        ("unknown version", HEAD.replace("= 1", "= 2"), "1:10"),
        (
            "unknown quantity",
            HEAD.replace("radiometric", "metric"),
            "3:12",
        ),
        (
            "not planar",
            format!(
                "{HEAD}[[surface]]\nname = \"A\"\nvertices = [[0,0,0],[1,0,0],[1,1,1],[0,1,0]]\n"
            ),
            "6:",
        ),
        (
            "two vertices",
            format!("{HEAD}[[surface]]\nname = \"A\"\nvertices = [[0,0,0],[1,0,0]]\n"),
            "6:12",
        ),
        (
            "self-crossing",
            format!(
                "{HEAD}[[surface]]\nname = \"A\"\nvertices = [[0,0,0],[1,1,0],[1,0,0],[0,1,0]]\n"
            ),
            "6:",
        ),
        (
            "the same name twice",
            surface(&format!("[[surface]]\nname = \"A\"\n{square}")),
            "8:8",
        ),
        (
            "a body of unknown surfaces",
            surface("[[body]]\nname = \"b\"\nsurfaces = [\"A\", \"Z\"]"),
            "9:",
        ),
        (
            "unknown rung",
            surface("[rungs]\narithmetic = \"bset\""),
            "8:14",
        ),
        (
            "unknown ladder",
            surface("[rungs]\narithmetics = \"best\""),
            "8:1",
        ),
        (
            "not a number of bytes",
            surface("[budget]\nram = \"16 apples\""),
            "8:7",
        ),
    ];
    let directory = tempfile::tempdir().expect("a directory");
    for (what, text, place) in cases {
        write(directory.path(), "bad.toml", &text);
        for (command, ran) in every_command(directory.path(), "bad.toml", &[]) {
            assert_eq!(
                (ran.code, ran.stdout.as_str()),
                (2, ""),
                "{what}, {command}: {ran:?}"
            );
            assert!(
                ran.stderr.contains(&format!("bad.toml:{place}")),
                "{what}: {}",
                ran.stderr
            );
            assert!(ran.stderr.contains("help"), "{what}: {}", ran.stderr);
        }
        assert_eq!(
            files(directory.path()).len(),
            1,
            "{what}: nothing is written"
        );
        assert!(
            !directory.path().join("out").exists(),
            "{what}: no directory is made"
        );
    }
}

#[test]
fn files_that_cannot_be_read_are_refused() {
    let directory = tempfile::tempdir().expect("a directory");
    std::fs::write(
        directory.path().join("binary.toml"),
        [0x69, 0xff, 0x00, 0xfe],
    )
    .expect("a file");
    std::fs::write(directory.path().join("empty.toml"), "").expect("a file");
    std::fs::create_dir(directory.path().join("folder.toml")).expect("a directory");
    for scene in [
        "missing.toml",
        "binary.toml",
        "empty.toml",
        "folder.toml",
        "papre",
        "",
    ] {
        for (command, ran) in every_command(directory.path(), scene, &[]) {
            assert_eq!(
                (ran.code, ran.stdout.as_str()),
                (2, ""),
                "{scene}, {command}: {ran:?}"
            );
            assert!(!ran.stderr.contains("panicked"), "{scene}: {}", ran.stderr);
            assert!(
                ran.stderr.contains(scene),
                "{scene} is named: {}",
                ran.stderr
            );
        }
    }
    assert!(!directory.path().join("out").exists());
}

#[test]
fn what_this_build_lacks_exits_one_from_all_but_check() {
    let directory = tempfile::tempdir().expect("a directory");
    for (name, text, what) in [
        (
            "transfer.toml",
            desk() + "[rungs]\ntransfer = \"matrix\"\nemitters = \"isolux\"\n",
            "matrix",
        ),
        (
            "points.toml",
            shaded() + "[rungs]\nemitters = \"points\"\n",
            "points",
        ),
        (
            "bands.toml",
            red() + "[rungs]\nemitters = \"isolux\"\nplacement = \"error\"\n",
            "isolux",
        ),
    ] {
        write(directory.path(), name, &text);
        for (command, ran) in every_command(directory.path(), name, &[]) {
            if command == "check" {
                assert_eq!(ran.code, 0, "{name}");
                continue;
            }
            refused(&ran, 1);
            assert!(
                ran.stderr.contains(what),
                "{name}, {command}: {}",
                ran.stderr
            );
            assert!(
                ran.stderr.contains("help"),
                "{name}, {command}: {}",
                ran.stderr
            );
        }
        assert!(
            !directory.path().join("out").exists(),
            "{name}: nothing is written"
        );
    }
}

#[test]
fn rungs_on_the_command_line() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "desk.toml", &desk());
    // Every rung of these is there: only nonsense is refused.
    for (ladder, rung) in [
        ("--arithmetic", "q29"),
        ("--visibility", "vertex-rays"),
        ("--emitters", "points"),
        ("--transfer", "vectors"),
        ("--placement", "error"),
        ("--reconstruction", "tensor"),
    ] {
        for (_, ran) in every_command(directory.path(), "desk.toml", &[ladder, "nonsense"]) {
            refused(&ran, 2);
            assert!(ran.stderr.contains(rung), "{}", ran.stderr);
        }
    }
    // A flag goes before the scene's own choice.
    write(
        directory.path(),
        "rung.toml",
        &(desk() + "[rungs]\nplacement = \"error\"\n"),
    );
    let ran = isolux(
        &["solve", "rung.toml", "--placement", "isolux"],
        directory.path(),
        "",
    );
    assert_eq!(ran.code, 0, "{}", ran.stderr);
}

#[test]
fn budgets_that_cannot_be_met_exit_one() {
    let directory = tempfile::tempdir().expect("a directory");
    for samples in ["0", "1", "1000000"] {
        let text = desk().replace("samples = 24", &format!("samples = {samples}"));
        write(directory.path(), "desk.toml", &text);
        let ran = isolux(&["solve", "desk.toml"], directory.path(), "");
        assert!(ran.code == 1 || ran.code == 2, "{samples}: {ran:?}");
        assert!(ran.stderr.contains("help"), "{}", ran.stderr);
    }
}
