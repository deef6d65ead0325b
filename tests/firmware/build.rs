//! Gives the linker the device's memory and the firmware its job: the baked
//! tables of one scene and the capacities they were planned for.
//!
//! The job comes from the environment, as `isolux device` sets it:
//!
//! | variable | holds |
//! | --- | --- |
//! | `ISOLUX_TABLES` | path of the baked tables (bytes) |
//! | `ISOLUX_RESOLUTION` | rows and columns of each resampled grid |
//! | `ISOLUX_ARITHMETIC` | rung of the arithmetic ladder |
//! | `ISOLUX_VISIBILITY` | rung of visibility where something occludes: `exact`, `vertex-rays`; of no effect on tables with codes |
//! | `ISOLUX_STOP` | `below FRACTION SHOTS`, `shots N` or `reflections N` |
//!
//! `ISOLUX_EVALUATIONS` is how many form factors a rung the program `hashes`
//! evaluates.
//!
//! Without `ISOLUX_TABLES` the firmware builds, says what it lacks and exits 1.

use isolux::integers;
use isolux::scene::records::{Counts, Header, Sight};
use std::env;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use zerocopy::FromBytes;

/// The rungs a firmware may be built for, and the kernel's type of each.
const ARITHMETIC: [(&str, &str); 8] = [
    ("libm", "isolux::form_factor::Libm<crate::root::Chosen>"),
    ("micromath", "isolux::form_factor::Micromath"),
    ("poly3", "isolux::form_factor::Poly3<crate::root::Chosen>"),
    ("poly5", "isolux::form_factor::Poly5<crate::root::Chosen>"),
    ("poly8", "isolux::form_factor::Poly8<crate::root::Chosen>"),
    ("best", "isolux::form_factor::Best<crate::root::Chosen>"),
    ("q24", INTEGERS[0]),
    ("q29", INTEGERS[1]),
];

/// Those of them that take tables in integers.
const INTEGERS: [&str; 2] = ["isolux::integers::Q24", "isolux::integers::Q29"];

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
    for logging in ["firmware", "cost", "hashes"] {
        println!("cargo::rustc-link-arg-bin={logging}=-Tdefmt.x");
    }
    match count("ISOLUX_EVALUATIONS", 10_000) {
        Ok(count) => {
            let source = format!("/// Form factors a rung.\nconst EVALUATIONS: u32 = {count};\n");
            fs::write(out.join("evaluations.rs"), source).expect("OUT_DIR is writable");
        }
        Err(message) => println!("cargo::error={message}"),
    }
    match job() {
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

/// What the tables say they hold.
fn contents(path: &str, in_integers: bool) -> Result<(Counts, Sight), String> {
    let bytes = fs::read(path).map_err(|error| format!("reading {path}: {error}"))?;
    if !in_integers {
        // The head alone: tables that have changed since they were baked are the
        // device's to refuse, and a test's to try.
        let (header, _) = Header::read_from_prefix(&bytes)
            .map_err(|_| format!("{path} is too short for tables"))?;
        return Ok((header.counts, header.sight));
    }
    // The kernel reads tables where words may lie: at a multiple of four.
    let room = vec![0_u8; bytes.len() + 4];
    let start = room.as_ptr().align_offset(4);
    let mut room = room;
    let place = &mut room[start..start + bytes.len()];
    place.copy_from_slice(&bytes);
    let scene = integers::Scene::load(place).map_err(|error| format!("{path}: {error}"))?;
    Ok((*scene.counts(), Sight::default()))
}

/// The kernel's type of radiosity for these tables.
fn luminance(counts: &Counts) -> String {
    let colour = if counts.channels == 1 {
        "f32"
    } else {
        "isolux::luminance::Rgb"
    };
    let form = match (counts.coefficients, counts.weights) {
        (1, 0) => "Constant",
        (1, _) => "Increment",
        _ => "Linear",
    };
    format!("isolux::luminance::{form}<{colour}>")
}

/// The kernel's type of transfer for these tables, codes where they have them and
/// else a rung of visibility, and an empty workspace.
fn transfer(counts: &Counts, sight: &Sight) -> Result<[String; 2], String> {
    let rung = variable("ISOLUX_VISIBILITY").unwrap_or_else(|| "exact".to_owned());
    let Sight {
        vertices,
        pieces,
        lines,
        blockers,
    } = sight;
    match rung.as_str() {
        // What is seen is in the tables.
        _ if counts.responses > 0 => Ok(["transfer::Vectors"; 2].map(str::to_owned)),
        _ if counts.terms > 0 => {
            let bits = counts.bits;
            Ok([
                format!("transfer::Matrix<{bits}>"),
                format!("transfer::Matrix::<{bits}>"),
            ])
        }
        _ if counts.is_coded() => Ok(["transfer::Codes"; 2].map(str::to_owned)),
        _ if counts.occluders == 0 => Ok(["visibility::Unoccluded"; 2].map(str::to_owned)),
        "exact" => Ok([
            format!("visibility::Exact<{vertices}, {pieces}, {lines}, {blockers}>"),
            "visibility::Exact::new()".to_owned(),
        ]),
        "vertex-rays" => Ok(["visibility::VertexRays"; 2].map(str::to_owned)),
        _ => Err(format!(
            "ISOLUX_VISIBILITY is \"{rung}\"; the firmware knows exact, vertex-rays"
        )),
    }
}

/// The lines of the job that light in floating point asks for besides.
fn light(counts: &Counts, sight: &Sight) -> Result<[String; 12], String> {
    let [transfer, looking] = transfer(counts, sight)?;
    let reconstruction = match counts.meshes {
        0 => "Tensors",
        _ => "Stencils",
    };
    Ok([
        "/// How surfaces are put together from their fields, where they have them.".to_owned(),
        "pub(crate) type Reconstruction =".to_owned(),
        format!("    isolux::resample::{reconstruction}<crate::root::Chosen>;"),
        "/// How radiosity varies over an emitter, and its channels.".to_owned(),
        format!("pub(crate) type Luminance = {};", luminance(counts)),
        "/// What the workspace of visibility holds.".to_owned(),
        "pub(crate) const SIGHT: isolux::scene::records::Sight =".to_owned(),
        format!("    isolux::scene::records::{sight:?};"),
        "/// The rung of transfer: how what a sample receives is had.".to_owned(),
        format!("pub(crate) type Transfer = isolux::{transfer};"),
        "/// Its workspace, empty.".to_owned(),
        format!("pub(crate) const LOOKING: Transfer = isolux::{looking};"),
    ])
}

/// The Rust source of the job.
fn job() -> Result<String, String> {
    let stop = stop()?;
    let resolution = count("ISOLUX_RESOLUTION", 200)?;
    let rung = variable("ISOLUX_ARITHMETIC").unwrap_or_else(|| "best".to_owned());
    let arithmetic = ARITHMETIC
        .iter()
        .find(|(name, _)| *name == rung)
        .map(|(_, kernel)| *kernel)
        .ok_or_else(|| {
            let names: Vec<&str> = ARITHMETIC.iter().map(|(name, _)| *name).collect();
            format!(
                "ISOLUX_ARITHMETIC is \"{rung}\"; the firmware knows {}",
                names.join(", ")
            )
        })?;
    let in_integers = INTEGERS.contains(&arithmetic);
    if in_integers {
        println!("cargo::rustc-cfg=integer_tables");
    }
    let none = Counts {
        channels: 1,
        coefficients: 1,
        ..Counts::default()
    };
    let (tables, (counts, sight)) = match variable("ISOLUX_TABLES") {
        None => ("b\"\"".to_owned(), (none, Sight::default())),
        Some(path) => {
            if !Path::new(&path).is_file() {
                return Err(format!(
                    "ISOLUX_TABLES names \"{path}\", which is not a file"
                ));
            }
            println!("cargo::rerun-if-changed={path}");
            (
                format!("include_bytes!({path:?})"),
                contents(&path, in_integers)?,
            )
        }
    };
    let mut lines = Vec::new();
    if !in_integers {
        lines.extend(light(&counts, &sight)?);
    }
    lines.extend([
        "/// Rows and columns of each resampled grid.".to_owned(),
        format!("pub(crate) const RESOLUTION: usize = {resolution};"),
        "/// What the tables hold.".to_owned(),
        "pub(crate) const COUNTS: isolux::scene::records::Counts =".to_owned(),
        format!("    isolux::scene::records::{counts:?};"),
        "/// The rung of form-factor arithmetic.".to_owned(),
        format!("pub(crate) type Arithmetic = {arithmetic};"),
        "/// When to stop shooting.".to_owned(),
        format!("pub(crate) const STOP: isolux::shoot::Stop = isolux::shoot::Stop::{stop};"),
        format!("const LENGTH: usize = {tables}.len();"),
        "/// The baked tables, read in place.".to_owned(),
        "#[unsafe(no_mangle)]".to_owned(),
        "pub(crate) static ISOLUX_TABLES: isolux::scene::Aligned<[u8; LENGTH]> =".to_owned(),
        format!("    isolux::scene::Aligned(*{tables});"),
    ]);
    let mut source = String::new();
    for line in lines {
        writeln!(source, "{line}").expect("a String takes any text");
    }
    Ok(source)
}
