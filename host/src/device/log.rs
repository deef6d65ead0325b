//! Reads the firmware's log: defmt frames, as the firmware's sources word them.
//!
//! | line | holds |
//! | --- | --- |
//! | `step NAME instructions N stack N` | cost of one step; a name may recur, instructions then add |
//! | `memory ram N flash N` | bytes between the linker's marks |
//! | `solved shots N form-factors N unshot F` | how shooting ended |
//! | `values [..]` | bits of the next values, four bytes each, little-endian |
//! | `end values N` | the last line: how many values there were |
//! | `cross-check timer N systick N` | instructions of one span on two clocks |
//!
//! Lines of level `error` are kept as what the firmware said.

use std::collections::BTreeMap;

use defmt_decoder::{DecodeError, Table};

use super::error::Error;
use super::measured::Memory;

/// The two clocks of the firmware's cross-check begin and end one inside the
/// other: so many instructions apart at most.
const CLOCKS_APART: u64 = 64;

/// What a run of the firmware logged.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Log {
    /// Cost of each step.
    pub(crate) steps: BTreeMap<String, Step>,
    /// Bits of every sample's irradiance and every resampled value, in order.
    pub(crate) values: Vec<u32>,
    /// What the program found of itself.
    pub(crate) memory: Memory,
    /// Shots taken.
    pub(crate) shots: u32,
    /// Form factors evaluated while solving.
    pub(crate) form_factors: u32,
    /// Unshot power as a fraction of the emitted power.
    pub(crate) unshot: f32,
    /// Errors the firmware reported.
    pub(crate) errors: Vec<String>,
    /// How many values the firmware says it logged; `None` before its end.
    pub(crate) ended: Option<usize>,
}

/// The cost of one step of the firmware.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Step {
    /// Instructions executed.
    pub(crate) instructions: u64,
    /// Deepest painted stack below the caller, in bytes.
    pub(crate) stack: u64,
}

/// Decodes a console with the string table of the program that wrote it.
pub(crate) fn read(program: &[u8], console: &[u8]) -> Result<Log, Error> {
    let mut log = Log::default();
    lines(program, console, |line| match line {
        Line::Error(line) => {
            log.errors.push(line);
            Ok(())
        }
        Line::Message(line) => log.take(&line),
    })?;
    Ok(log)
}

/// One line of a console.
pub(crate) enum Line {
    /// Of level `error`.
    Error(String),
    /// Of any other level.
    Message(String),
}

/// Hands over the lines of a console, up to a frame that is cut short: the
/// firmware died in it, and its last line is missing.
pub(crate) fn lines(
    program: &[u8],
    console: &[u8],
    mut take: impl FnMut(Line) -> Result<(), Error>,
) -> Result<(), Error> {
    let broken = |what: String| Error::Log { what };
    let table = Table::parse(program)
        .map_err(|error| broken(error.to_string()))?
        .ok_or_else(|| broken("the program has no .defmt section".to_owned()))?;
    let mut rest = console;
    loop {
        match table.decode(rest) {
            Ok((frame, consumed)) => {
                let line = frame.display_message().to_string();
                let error = frame.level().is_some_and(|level| level.as_str() == "error");
                take(if error {
                    Line::Error(line)
                } else {
                    Line::Message(line)
                })?;
                rest = rest.get(consumed..).unwrap_or_default();
            }
            Err(DecodeError::UnexpectedEof) => return Ok(()),
            Err(DecodeError::Malformed) => {
                return Err(broken("a malformed frame".to_owned()));
            }
        }
    }
}

impl Log {
    /// Takes one line in.
    fn take(&mut self, line: &str) -> Result<(), Error> {
        let unread = || Error::Log {
            what: format!("the line \"{line}\""),
        };
        let words: Vec<&str> = line.split_whitespace().collect();
        match *words.as_slice() {
            ["values", ..] => {
                let bytes = line.trim_start_matches("values").trim();
                self.values.extend(words_of(bytes).ok_or_else(unread)?);
            }
            ["step", name, "instructions", instructions, "stack", stack] => {
                let step = self.steps.entry(name.to_owned()).or_default();
                step.instructions += instructions.parse::<u64>().map_err(|_| unread())?;
                step.stack = step.stack.max(stack.parse().map_err(|_| unread())?);
            }
            [
                "solved",
                "shots",
                shots,
                "form-factors",
                form_factors,
                "unshot",
                unshot,
            ] => {
                self.shots = shots.parse().map_err(|_| unread())?;
                self.form_factors = form_factors.parse().map_err(|_| unread())?;
                self.unshot = unshot.parse().map_err(|_| unread())?;
            }
            ["memory", "ram", ram, "flash", flash] => {
                self.memory = Memory {
                    ram_bytes: ram.parse().map_err(|_| unread())?,
                    flash_bytes: flash.parse().map_err(|_| unread())?,
                };
            }
            ["end", "values", count] => self.ended = Some(count.parse().map_err(|_| unread())?),
            ["cross-check", ..] => clocks(line)?,
            _ => return Err(unread()),
        }
        Ok(())
    }
}

/// Takes the line in which the firmware's two clocks speak of one span.
pub(crate) fn clocks(line: &str) -> Result<(), Error> {
    let unread = || Error::Log {
        what: format!("the line \"{line}\""),
    };
    let words: Vec<&str> = line.split_whitespace().collect();
    let ["cross-check", "timer", timer, "systick", systick] = *words.as_slice() else {
        return Err(unread());
    };
    let timer: u64 = timer.parse().map_err(|_| unread())?;
    let systick: u64 = systick.parse().map_err(|_| unread())?;
    if timer.abs_diff(systick) > CLOCKS_APART {
        return Err(Error::Log {
            what: format!(
                "its two clocks disagree, {timer} and {systick} instructions of one span"
            ),
        });
    }
    Ok(())
}

/// The 32-bit words in a printed list of bytes.
fn words_of(list: &str) -> Option<Vec<u32>> {
    let inner = list.strip_prefix('[')?.strip_suffix(']')?;
    let bytes: Vec<u8> = match inner {
        "" => Vec::new(),
        _ => inner
            .split(", ")
            .map(|byte| byte.parse().ok())
            .collect::<Option<_>>()?,
    };
    let words = bytes.chunks_exact(4);
    if !words.remainder().is_empty() {
        return None;
    }
    Some(
        words
            .map(|word| {
                word.iter()
                    .rev()
                    .fold(0, |bits, &byte| bits << 8 | u32::from(byte))
            })
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_add_up() {
        let mut log = Log::default();
        for line in [
            "cross-check timer 300025 systick 300022",
            "step shoot instructions 10 stack 96",
            "step shoot instructions 5 stack 80",
            "values [1, 0, 128, 63]",
            "values []",
            "end values 1",
        ] {
            log.take(line).expect("a line of the firmware");
        }
        let shoot = Step {
            instructions: 15,
            stack: 96,
        };
        assert_eq!(log.steps.get("shoot"), Some(&shoot));
        assert_eq!(log.values, [0x3f80_0001]);
        assert_eq!(log.ended, Some(1));
    }

    #[test]
    fn other_lines_are_refused() {
        for line in [
            "",
            "hello",
            "values [1, 2, 3]",
            "values [1, 2, 3, 256]",
            "values 1, 2, 3, 4",
            "step shoot instructions -1 stack 0",
            "end values",
            "cross-check timer 1000 systick 2000",
        ] {
            assert!(Log::default().take(line).is_err(), "{line}");
        }
    }
}
