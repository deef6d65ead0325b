//! The built program, and one run of it.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

/// What a run of the program left behind.
#[derive(Debug)]
pub(crate) struct Ran {
    /// The exit code; -1 where a signal ended it.
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

/// The program, built in the profile of this test: cargo builds the binary of
/// another package for nobody's tests, and an old one would pass or fail for
/// the wrong reasons. This test is named beside it, though built already: cargo then
/// chooses the features of every crate as it did for the test, and compiles none twice.
pub(crate) fn path() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        let test = std::env::current_exe().expect("this test's path");
        // target/<profile>/deps/<test>
        let profile = test.ancestors().nth(2).and_then(Path::file_name);
        let profile = profile.and_then(|name| name.to_str()).expect("a profile");
        let profile = if profile == "debug" { "dev" } else { profile };
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let built = Command::new(cargo)
            .args([
                "build",
                "--bin",
                "isolux",
                "--test",
                env!("CARGO_CRATE_NAME"),
            ])
            .args(["--profile", profile, "--message-format", "json"])
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .stderr(Stdio::inherit())
            .output()
            .expect("cargo runs");
        assert!(built.status.success(), "the program does not build");
        String::from_utf8(built.stdout)
            .expect("cargo writes UTF-8")
            .lines()
            .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
            .filter(|message| message["target"]["kind"][0] == "bin")
            .find_map(|message| message["executable"].as_str().map(PathBuf::from))
            .expect("cargo names the program")
    })
}

/// Runs the program in a directory with this on stdin.
pub(crate) fn isolux(arguments: &[&str], directory: &Path, stdin: &str) -> Ran {
    isolux_bytes(arguments, directory, stdin.as_bytes())
}

/// As [`isolux`], with any bytes on stdin.
pub(crate) fn isolux_bytes(arguments: &[&str], directory: &Path, stdin: &[u8]) -> Ran {
    let mut child = Command::new(path())
        .args(arguments)
        .current_dir(directory)
        // No directory can be made there: what is judged is not what an earlier
        // build of the reference has left behind.
        .env("ISOLUX_CACHE", "/dev/null/cache")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut input = child.stdin.take().expect("a pipe");
    let stdin = stdin.to_vec();
    // A program that refuses its arguments never reads: its closed end is no
    // error of the test.
    let writer = std::thread::spawn(move || drop(input.write_all(&stdin)));
    let output = child.wait_with_output().expect("the program ends");
    writer.join().expect("the writer ends");
    Ran {
        code: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8(output.stdout).expect("the answer is UTF-8"),
        stderr: String::from_utf8(output.stderr).expect("complaints are UTF-8"),
    }
}
