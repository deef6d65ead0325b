//! Why a command ended without an answer, and the exit code that says so.

use crate::scene::diagnostic::Diagnostic;
use std::io::{IsTerminal, Write, stderr};
use std::process::ExitCode;

/// A command's unhappy end.
#[derive(Debug)]
pub(super) enum Failure {
    /// Exit 1: a stated limit cannot be met, this build lacks a feature, or a
    /// comparison failed.
    Limit {
        /// What could not be done.
        message: String,
        /// What to do about it.
        remedy: String,
    },
    /// Exit 2: an input is wrong, with its place.
    Input(Diagnostic),
    /// Exit 2: the command line is wrong, or a file cannot be written.
    Usage {
        /// What is wrong.
        message: String,
        /// What to do about it.
        remedy: String,
    },
    /// Exit 0: whoever read stdout has gone away.
    Reader,
}

impl Failure {
    pub(super) fn limit(message: impl ToString, remedy: impl ToString) -> Self {
        Self::Limit {
            message: message.to_string(),
            remedy: remedy.to_string(),
        }
    }

    pub(super) fn usage(message: impl ToString, remedy: impl ToString) -> Self {
        Self::Usage {
            message: message.to_string(),
            remedy: remedy.to_string(),
        }
    }

    /// Says it on stderr and gives the exit code.
    pub(super) fn tell(self) -> ExitCode {
        let (text, code) = match self {
            Self::Limit { message, remedy } => (in_words(&message, &remedy), 1),
            Self::Usage { message, remedy } => (in_words(&message, &remedy), 2),
            Self::Input(diagnostic) => (diagnostic.render(stderr().is_terminal()), 2),
            Self::Reader => return ExitCode::SUCCESS,
        };
        // A closed stderr leaves nobody to tell.
        let _ = writeln!(stderr(), "{text}");
        ExitCode::from(code)
    }
}

fn in_words(message: &str, remedy: &str) -> String {
    if remedy.is_empty() {
        format!("error: {message}")
    } else {
        format!("error: {message}\n  help: {remedy}")
    }
}

impl From<Diagnostic> for Failure {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::Input(diagnostic)
    }
}

impl From<std::io::Error> for Failure {
    /// Of writing to stdout: nothing else does its own input and output here.
    fn from(error: std::io::Error) -> Self {
        if error.kind() == std::io::ErrorKind::BrokenPipe {
            Self::Reader
        } else {
            Self::usage(format!("cannot write the answer: {error}"), "")
        }
    }
}
