//! What holds for the program as a whole: help, versions, usage, closed pipes.

use crate::program::{isolux, path};
use crate::{desk, refused, write};
use std::path::Path;
use std::process::{Command, Stdio};

/// The commands that --help lists.
fn listed() -> Vec<String> {
    let ran = isolux(&["--help"], Path::new("."), "");
    assert_eq!((ran.code, ran.stderr.as_str()), (0, ""));
    ran.stdout
        .lines()
        .skip_while(|line| !line.starts_with("Commands:"))
        .skip(1)
        .take_while(|line| !line.is_empty())
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next().map(str::to_owned))
        .collect()
}

#[test]
fn help_lists_what_works_and_nothing_else() {
    let listed = listed();
    assert_eq!(
        listed,
        [
            "check",
            "plan",
            "bake",
            "render",
            "solve",
            "form-factor",
            "device",
            "trade",
            "help"
        ]
    );
    for command in &listed[..8] {
        let ran = isolux(&[command, "--help"], Path::new("."), "");
        assert_eq!((ran.code, ran.stderr.as_str()), (0, ""), "{command}");
        assert!(ran.stdout.contains("Usage: isolux"), "{command}");
        assert!(ran.stdout.contains("--json"), "{command}");
    }
    refused(&isolux(&["bake", "paper"], Path::new("."), ""), 2);
}

#[test]
fn usage_that_is_wrong_exits_two() {
    let directory = tempfile::tempdir().expect("a directory");
    for arguments in [
        &["chekc", "paper"][..],
        &["check"],
        &["check", "paper", "paper"],
        &["check", "paper", "--jsno"],
        &["render", "paper"],
        &["render", "paper", "-o"],
        &["render", "paper", "-o", "x", "--resolution", "0"],
        &["render", "paper", "-o", "x", "--bounces", "-1"],
        &["solve", "paper", "--bounces", "many"],
        &["solve", "paper", "--points"],
        &["form-factor", "paper"],
        &["--frobnicate"],
    ] {
        refused(&isolux(arguments, directory.path(), ""), 2);
    }
    let left = std::fs::read_dir(directory.path())
        .expect("a directory")
        .count();
    assert_eq!(left, 0, "nothing is written");
}

#[test]
fn the_version_is_the_packages() {
    let ran = isolux(&["--version"], Path::new("."), "");
    assert_eq!(ran.code, 0);
    assert!(ran.stdout.starts_with("isolux "), "{}", ran.stdout);
}

/// Runs the program with nobody at the other end of stdout, and of stderr.
fn unheard(arguments: &[&str], directory: &Path, input: &str) -> (Option<i32>, String) {
    write(directory, "stdin", input);
    let stdin = std::fs::File::open(directory.join("stdin")).expect("a file");
    let mut child = Command::new(path())
        .args(arguments)
        .current_dir(directory)
        .stdin(stdin)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("the program ends");
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    (output.status.code(), stderr)
}

#[test]
fn a_reader_that_goes_away_is_no_crash() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "desk.toml", &desk());
    write(directory.path(), "many.pts", &"1 1 0 0 0 1\n".repeat(5000));
    let line = r#"{"id":1,"p":[0,0,0],"n":[0,0,1],"v":[[-1,-1,1],[-1,1,1],[1,1,1]]}"#;
    let many = format!("{line}\n").repeat(5000);
    for arguments in [
        &["--help"][..],
        &["--version"],
        &["check", "desk.toml"],
        &["check", "desk.toml", "--json"],
        &["solve", "desk.toml", "--points", "many.pts"],
        &["solve", "desk.toml", "--points", "many.pts", "--json"],
        &["form-factor"],
        &["form-factor", "--json"],
    ] {
        let (code, stderr) = unheard(arguments, directory.path(), &many);
        assert_eq!(code, Some(0), "{arguments:?}: {stderr}");
        assert_eq!(stderr, "", "{arguments:?}");
    }
}

/// A disk that is full is not a reader that went away.
#[cfg(target_os = "linux")]
#[test]
fn an_answer_that_cannot_be_written_is_a_failure() {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), "desk.toml", &desk());
    for arguments in [
        &["check", "desk.toml"][..],
        &["solve", "desk.toml"],
        &["solve", "desk.toml", "--json"],
    ] {
        let full = std::fs::File::options()
            .write(true)
            .open("/dev/full")
            .expect("/dev/full");
        let output = Command::new(path())
            .args(arguments)
            .current_dir(directory.path())
            .stdin(Stdio::null())
            .stdout(full)
            .output()
            .expect("the program ends");
        let stderr = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(stderr.starts_with("error"), "{arguments:?}: {stderr}");
    }
}
