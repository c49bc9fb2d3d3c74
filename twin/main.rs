//! The `twin` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    twin::command::main()
}
