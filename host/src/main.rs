//! The `isolux` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    isolux_host::cli::main()
}
