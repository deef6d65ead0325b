//! What it costs on the device to light a scene on, and programs by what they say.

use std::path::Path;
use std::time::Duration;

use super::emulator::{self, Core};
use super::error::Error;
use super::firmware::Toolchain;
use super::log::{self, Line};
use super::{Job, read};

/// The program of the firmware's package.
const PROGRAM: &str = "relight";

/// A scene that was solved and lit on, after its first luminaire was dimmed to half.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Relit {
    /// Instructions of the first solution.
    pub solve: u64,
    /// Instructions of the update.
    pub update: u64,
    /// The deepest painted stack of both, in bytes.
    pub stack: u64,
    /// Shots of both.
    pub shots: [u32; 2],
    /// Bits of every sample's irradiance, then of every named point's, channel by
    /// channel.
    pub values: Vec<u32>,
}

/// Builds the firmware that lights a job on, runs it on a core and reads its log. The
/// job's resolution and expected values are of no account.
///
/// # Errors
/// See [`Error`].
pub fn relit(job: &Job<'_>, core: Core, time_limit: Duration) -> Result<Relit, Error> {
    let toolchain = Toolchain::find()?;
    toolchain.require(core)?;
    let directory = tempfile::tempdir().map_err(Error::io("creating a temporary directory"))?;
    let program = directory.path().join(PROGRAM);
    toolchain.link_job(PROGRAM, &[], job, core, &program)?;
    let mut relit = Relit::default();
    let mut shots = Vec::new();
    for line in messages(core, &program, time_limit)? {
        let number = |text: &str| text.parse::<u64>().map_err(|_| unread(&line));
        match *line.split(' ').collect::<Vec<_>>().as_slice() {
            ["step", step, "instructions", count, "stack", deepest] => {
                match step {
                    "solve" => relit.solve = number(count)?,
                    "update" => relit.update = number(count)?,
                    _ => continue,
                }
                relit.stack = relit.stack.max(number(deepest)?);
            }
            ["shots", count, "unshot", _] => shots.push(number(count)? as u32),
            ["value", bits] => relit.values.push(number(bits)? as u32),
            ["end", "relight"] => {
                relit.shots = shots.try_into().map_err(|_| unread(&line))?;
                return Ok(relit);
            }
            _ => return Err(unread(&line)),
        }
    }
    Err(unread("that is missing at the end"))
}

/// Runs a linked program that logs on an emulated core; its messages, line by line.
///
/// # Errors
/// [`Error::Firmware`] where it does not end well, with what it said last.
pub fn messages(core: Core, program: &Path, time_limit: Duration) -> Result<Vec<String>, Error> {
    let output = emulator::run(core, program, time_limit)?;
    let (mut said, mut errors) = (Vec::new(), Vec::new());
    log::lines(&read(program)?, &output.console, |line| {
        match line {
            Line::Error(line) => errors.push(line),
            Line::Message(line) => said.push(line),
        }
        Ok(())
    })?;
    if output.status != Some(0) {
        errors.push(output.complaints);
        return Err(Error::Firmware {
            core: core.name(),
            status: output.status,
            said: errors.join("; "),
        });
    }
    Ok(said)
}

fn unread(line: &str) -> Error {
    Error::Log {
        what: format!("the line \"{line}\""),
    }
}
