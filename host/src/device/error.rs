//! Why a scene could not be run on the emulated device.

use std::fmt;
use std::io;
use std::path::PathBuf;
use std::time::Duration;

/// What went wrong, and what to do about it.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The sources of the firmware are not where this program was built.
    Sources {
        /// Where they were.
        workspace: PathBuf,
    },
    /// A tool of the machine is missing.
    Missing {
        /// What is missing.
        what: String,
        /// The command or the step that installs it.
        remedy: String,
    },
    /// The firmware does not build: a fault of the sources, or the scene does
    /// not fit into the device.
    Build {
        /// What was built.
        what: String,
        /// What cargo said.
        output: String,
    },
    /// A file or a program of the machine could not be used.
    Io {
        /// What was attempted.
        doing: String,
        /// What the system said.
        source: io::Error,
    },
    /// The emulator was stopped because it did not end by itself.
    TimeLimit {
        /// The core it emulated.
        core: &'static str,
        /// How long it was given.
        limit: Duration,
    },
    /// The firmware ended with an exit status other than 0.
    Firmware {
        /// The core it ran on.
        core: &'static str,
        /// Its exit status; `None` where a signal ended the emulator.
        status: Option<i32>,
        /// What the firmware or the emulator said.
        said: String,
    },
    /// The firmware's log is not what this program reads.
    Log {
        /// What is wrong with it.
        what: String,
    },
    /// The linked program is not what this program can analyse.
    Program {
        /// What is wrong with it.
        what: String,
    },
    /// No bound of the stack follows from the linked program.
    Unbounded {
        /// The function that has none.
        function: String,
        /// Why.
        why: &'static str,
    },
}

impl Error {
    /// An [`Error::Io`] for what was attempted.
    pub(crate) fn io(doing: impl Into<String>) -> impl FnOnce(io::Error) -> Self {
        let doing = doing.into();
        move |source| Self::Io { doing, source }
    }

    /// Whether a missing tool or missing sources, and not a failure, stopped
    /// the run: what a test may skip for.
    pub fn is_missing(&self) -> bool {
        matches!(self, Self::Missing { .. } | Self::Sources { .. })
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sources { workspace } => write!(
                f,
                "the firmware is built from source, and {} holds no isolux any more; run this command from a checkout with `cargo run -p isolux-host -- device SCENE`",
                workspace.display()
            ),
            Self::Missing { what, remedy } => write!(f, "{what} is missing; {remedy}"),
            Self::Build { what, output } => write!(f, "{what} does not build:\n{output}"),
            Self::Io { doing, source } => write!(f, "{doing}: {source}"),
            Self::TimeLimit { core, limit } => write!(
                f,
                "the emulated {core} did not end within {} s and was stopped",
                limit.as_secs_f64()
            ),
            Self::Firmware { core, status, said } => {
                write!(f, "the firmware failed on the emulated {core} ")?;
                match status {
                    Some(status) => write!(f, "(exit {status})")?,
                    None => f.write_str("(ended by a signal)")?,
                }
                if said.is_empty() {
                    f.write_str(" and said nothing")
                } else {
                    write!(f, ": {said}")
                }
            }
            Self::Log { what } => write!(f, "the firmware's log cannot be read: {what}"),
            Self::Program { what } => write!(f, "the linked firmware cannot be analysed: {what}"),
            Self::Unbounded { function, why } => {
                write!(f, "no bound of the stack follows for {function}: {why}")
            }
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}
