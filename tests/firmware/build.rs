//! Gives the linker the device's memory and the firmware its job: the baked
//! tables of one scene and the capacities they were planned for.
//!
//! The job comes from the environment, as `isolux device` sets it:
//!
//! | variable | holds |
//! | --- | --- |
//! | `ISOLUX_BAKED` | path of the Rust source that a bake wrote beside the tables |
//! | `ISOLUX_RESOLUTION` | rows and columns of each resampled grid |
//! | `ISOLUX_STOP` | `below FRACTION SHOTS`, `shots N` or `reflections N` |
//!
//! `ISOLUX_EVALUATIONS` is how many form factors a rung the program `hashes`
//! evaluates.
//!
//! Without `ISOLUX_BAKED` the firmware builds, says what it lacks and exits 1.

use isolux::integers;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};

fn main() {
    let manifest = PathBuf::from(variable("CARGO_MANIFEST_DIR").expect("set by cargo"));
    let out = PathBuf::from(variable("OUT_DIR").expect("set by cargo"));
    let memory = manifest.join("../../memory.x");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={}", memory.display());
    println!("cargo::rustc-check-cfg=cfg(integer_tables)");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    fs::copy(&memory, out.join("memory.x")).expect("memory.x is copied beside the linker script");
    println!("cargo::rustc-link-search={}", out.display());
    for argument in ["--nmagic", "-Tlink.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
    for logging in ["firmware", "relight", "cost", "hashes"] {
        println!("cargo::rustc-link-arg-bin={logging}=-Tdefmt.x");
    }
    match count("ISOLUX_EVALUATIONS", 10_000) {
        Ok(count) => {
            let source = format!("/// Form factors a rung.\nconst EVALUATIONS: u32 = {count};\n");
            fs::write(out.join("evaluations.rs"), source).expect("OUT_DIR is writable");
        }
        Err(message) => println!("cargo::error={message}"),
    }
    match job(&manifest) {
        Ok(source) => fs::write(out.join("job.rs"), source).expect("OUT_DIR is writable"),
        Err(message) => println!("cargo::error={message}"),
    }
}

/// An environment variable, watched for changes.
fn variable(name: &str) -> Option<String> {
    println!("cargo::rerun-if-env-changed={name}");
    env::var(name).ok()
}

/// A count from the environment.
fn count(name: &str, default: usize) -> Result<usize, String> {
    match variable(name) {
        None => Ok(default),
        Some(text) => text
            .parse()
            .map_err(|_| format!("{name} is \"{text}\"; it must be a whole number")),
    }
}

/// The stop rule, as an expression of the kernel's type.
fn stop() -> Result<String, String> {
    let text = variable("ISOLUX_STOP").unwrap_or_else(|| "below 0.001 4096".to_owned());
    let words: Vec<&str> = text.split_whitespace().collect();
    let parsed = match *words.as_slice() {
        ["below", fraction, shots] => match (fraction.parse::<f32>(), shots.parse::<u32>()) {
            (Ok(fraction), Ok(shots)) => Some(format!(
                "Below {{ fraction: f32::from_bits({:#x}), shots: {shots} }}",
                fraction.to_bits()
            )),
            _ => None,
        },
        ["shots", shots] => shots.parse().ok().map(|n: u32| format!("Shots({n})")),
        ["reflections", times] => times.parse().ok().map(|n: u32| format!("Reflections({n})")),
        _ => None,
    };
    parsed.ok_or_else(|| {
        format!(
            "ISOLUX_STOP is \"{text}\"; it must be `below FRACTION SHOTS`, `shots N` or `reflections N`"
        )
    })
}

/// Whether the tables beside a baked source are in integers.
fn in_integers(source: &Path) -> Result<bool, String> {
    let tables = source.with_extension("isolux");
    println!("cargo::rerun-if-changed={}", tables.display());
    let bytes =
        fs::read(&tables).map_err(|error| format!("reading {}: {error}", tables.display()))?;
    Ok(bytes.starts_with(&integers::MAGIC))
}

/// The Rust source of the job.
fn job(manifest: &Path) -> Result<String, String> {
    let stop = stop()?;
    let resolution = count("ISOLUX_RESOLUTION", 200)?;
    let baked = match variable("ISOLUX_BAKED") {
        None => manifest.join("src/unbaked.rs"),
        Some(path) => {
            println!("cargo::rerun-if-changed={path}");
            let path = PathBuf::from(path);
            if in_integers(&path)? {
                println!("cargo::rustc-cfg=integer_tables");
            }
            path
        }
    };
    Ok(format!(
        "/// The baked scene.
#[path = {baked:?}]
pub(crate) mod baked;
/// Rows and columns of each resampled grid.
pub(crate) const RESOLUTION: usize = {resolution};
/// When to stop shooting.
pub(crate) const STOP: isolux::shoot::Stop = isolux::shoot::Stop::{stop};
"
    ))
}
