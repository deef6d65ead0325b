//! What a person or a program is told: tables of errors, progress, files.
//!
//! stdout carries the answer alone, so tables are returned as text for the
//! caller to print, [`Progress`] draws on stderr, and files appear whole or
//! not at all ([`write_file`]).

mod file;
mod number;
mod progress;
mod table;

pub use file::{WriteError, write_file};
pub use number::{percent, quantity};
pub use progress::{Progress, silence};
pub use table::{ErrorRow, error_table, error_table_markdown};

/// Tells a person on stderr what an answer on stdout is worth less by.
pub fn warn(message: &str) {
    eprintln!("warning: {message}");
}
