//! What a bench answers: printed, and written where that is asked for.

use isolux_host::report::write_file;
use std::path::Path;
use std::process::ExitCode;

/// Prints a text, and with `--write` among the arguments writes it to `path`, whole or not
/// at all.
pub(crate) fn answer(text: &str, path: &str) -> ExitCode {
    print!("{text}");
    if std::env::args().any(|argument| argument == "--write") {
        if let Err(error) = write_file(Path::new(path), text.as_bytes()) {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
        eprintln!("wrote {path}");
    }
    ExitCode::SUCCESS
}
