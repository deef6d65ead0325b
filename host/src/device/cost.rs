//! What single operations of the kernel cost on the device.
//!
//! [`costs`] builds the firmware's program `cost` and runs it on a core. It
//! measures every call by itself, less an empty one, and logs one line an
//! operation:
//!
//! `cost WORD WORD WORD WORD NUMBER calls N instructions N largest N stack N answers BITS`

use std::time::Duration;

use super::emulator::{self, Core};
use super::error::Error;
use super::firmware::{Build, Toolchain};
use super::log::{self, Line};

/// The program of the firmware's package.
pub(super) const PROGRAM: &str = "cost";

/// What calls of one operation cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// The operation: `form-factor`, `ready-sum`, `outline` or `delta-form-factors`.
    pub operation: String,
    /// The rung of arithmetic; `-` where there is none.
    pub rung: String,
    /// Whose square root: `fpu` or `libm`; `-` where there is none.
    pub root: String,
    /// How the emitter is seen; `-` where that says nothing.
    pub case: String,
    /// Vertices of the emitter, or its samples in the classical method.
    pub size: usize,
    /// Calls measured, one a receiver.
    pub calls: u32,
    /// Instructions of all calls.
    pub instructions: u64,
    /// Instructions of the dearest call.
    pub largest: u64,
    /// Deepest stack in bytes.
    pub stack: u64,
    /// Bits of the sum of all answers in `f32`, in the order of the receivers.
    pub answers: u32,
}

impl Cost {
    /// Instructions of a call on the average.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.instructions as f64 / f64::from(self.calls.max(1))
    }

    /// Reads a line of the program.
    fn of(line: &str) -> Option<Self> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [
            "cost",
            operation,
            rung,
            root,
            case,
            size,
            "calls",
            calls,
            "instructions",
            instructions,
            "largest",
            largest,
            "stack",
            stack,
            "answers",
            answers,
        ] = *words.as_slice()
        else {
            return None;
        };
        Some(Self {
            operation: operation.to_owned(),
            rung: rung.to_owned(),
            root: root.to_owned(),
            case: case.to_owned(),
            size: size.parse().ok()?,
            calls: calls.parse().ok()?,
            instructions: instructions.parse().ok()?,
            largest: largest.parse().ok()?,
            stack: stack.parse().ok()?,
            answers: answers.parse().ok()?,
        })
    }
}

/// Measures the kernel's operations on each core.
///
/// # Errors
/// See [`Error`]: what is missing, a program that does not build or end.
pub fn costs(cores: &[Core], time_limit: Duration) -> Result<Vec<Vec<Cost>>, Error> {
    let toolchain = Toolchain::find()?;
    let directory = tempfile::tempdir().map_err(Error::io("creating a temporary directory"))?;
    let program = directory.path().join(PROGRAM);
    let mut found = Vec::new();
    for &core in cores {
        toolchain.require(core)?;
        toolchain.link(core, &Build::of(PROGRAM), &program)?;
        let output = emulator::run(core, &program, time_limit)?;
        let (costs, errors) = read(&super::read(&program)?, &output.console)?;
        if output.status != Some(0) {
            return Err(Error::Firmware {
                core: core.name(),
                status: output.status,
                said: errors.join("; "),
            });
        }
        found.push(costs);
    }
    Ok(found)
}

/// The costs and the errors in a console.
pub(super) fn read(program: &[u8], console: &[u8]) -> Result<(Vec<Cost>, Vec<String>), Error> {
    let (mut costs, mut errors) = (Vec::new(), Vec::new());
    let mut announced = None;
    log::lines(program, console, |line| {
        match line {
            Line::Error(line) => errors.push(line),
            Line::Message(line) => match Cost::of(&line) {
                Some(cost) => costs.push(cost),
                None => match line.strip_prefix("end costs ") {
                    Some(count) => announced = count.parse::<usize>().ok(),
                    None => log::clocks(&line)?,
                },
            },
        }
        Ok(())
    })?;
    if errors.is_empty() && announced != Some(costs.len()) {
        return Err(Error::Log {
            what: format!(
                "it holds {} costs, and its end speaks of {announced:?}",
                costs.len()
            ),
        });
    }
    Ok((costs, errors))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_read() {
        let cost = Cost::of(
            "cost form-factor best fpu large-clipped 4 calls 36 instructions 7200 largest 250 stack 88 answers 1065353216",
        )
        .expect("a cost");
        assert_eq!(
            (cost.size, cost.calls, cost.largest, cost.stack),
            (4, 36, 250, 88)
        );
        assert_eq!(cost.mean(), 200.0);
        assert_eq!(f32::from_bits(cost.answers), 1.0);
    }

    #[test]
    fn other_lines_are_no_costs() {
        for line in [
            "",
            "cost",
            "cost a b c d 4 calls -1 instructions 1 largest 1 stack 1 answers 1",
        ] {
            assert_eq!(Cost::of(line), None, "{line}");
        }
    }
}
