//! The `halfshade` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    halfshade::main(std::env::args_os())
}
