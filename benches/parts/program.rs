//! The program of this checkout, built and run by cargo.

use std::path::Path;
use std::process::{Command, Output};

/// Runs `isolux` in a directory.
pub(crate) fn isolux<S: AsRef<std::ffi::OsStr>>(arguments: &[S], directory: &Path) -> Output {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    Command::new(cargo)
        .args(["run", "--quiet", "--bin", "isolux", "--manifest-path"])
        .args([manifest, "--"])
        .args(arguments)
        .current_dir(directory)
        .output()
        .expect("cargo runs")
}
