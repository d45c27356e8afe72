//! The command as tests run it. Cargo builds the programs of the package under test only, so this package has its own.

use std::process::ExitCode;

fn main() -> ExitCode {
    halfshade::main(std::env::args_os())
}
