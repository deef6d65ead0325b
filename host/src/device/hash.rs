//! Hashes of many answers on the device: whether bits differ anywhere, without
//! sending them all.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::time::Duration;

use super::emulator::{self, Core};
use super::error::Error;
use super::firmware::{Build, Toolchain};
use super::log::{self, Line};

/// The program of the firmware's package.
const PROGRAM: &str = "hashes";

/// Which rungs are hashed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hashed {
    /// Every rung.
    All,
    /// Those in integers: without FPU the others take ten times as long.
    Integers,
}

/// Evaluates so many form factors of a fixed sequence on these rungs and on each
/// core; FNV-1a of 64 bits over the answers' bits, by rung.
///
/// # Errors
/// See [`Error`].
pub fn hashes(
    cores: &[Core],
    rungs: Hashed,
    evaluations: u32,
    time_limit: Duration,
) -> Result<Vec<BTreeMap<String, u64>>, Error> {
    let toolchain = Toolchain::find()?;
    let directory = tempfile::tempdir().map_err(Error::io("creating a temporary directory"))?;
    let program = directory.path().join(PROGRAM);
    let evaluations = evaluations.to_string();
    let environment = [("ISOLUX_EVALUATIONS", OsStr::new(&evaluations))];
    let build = Build {
        features: match rungs {
            Hashed::All => &[],
            Hashed::Integers => &["integers-alone"],
        },
        environment: &environment,
        ..Build::of(PROGRAM)
    };
    let mut found = Vec::new();
    for &core in cores {
        toolchain.require(core)?;
        toolchain.link(core, &build, &program)?;
        let output = emulator::run(core, &program, time_limit)?;
        let mut errors = Vec::new();
        let mut hashes = BTreeMap::new();
        let mut announced = None;
        log::lines(&super::read(&program)?, &output.console, |line| {
            match line {
                Line::Error(line) => errors.push(line),
                Line::Message(line) => match *line.split(' ').collect::<Vec<_>>().as_slice() {
                    ["hash", rung, hash] => {
                        let hash = u64::from_str_radix(hash, 16);
                        hashes.insert(rung.to_owned(), hash.map_err(|_| unread(&line))?);
                    }
                    ["end", "hashes", count] => announced = count.parse::<usize>().ok(),
                    _ => return Err(unread(&line)),
                },
            }
            Ok(())
        })?;
        if output.status != Some(0) || announced != Some(hashes.len()) {
            errors.push(output.complaints);
            return Err(Error::Firmware {
                core: core.name(),
                status: output.status,
                said: errors.join("; "),
            });
        }
        found.push(hashes);
    }
    Ok(found)
}

fn unread(line: &str) -> Error {
    Error::Log {
        what: format!("the line \"{line}\""),
    }
}
