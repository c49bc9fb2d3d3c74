//! `twin drive`: one drive by hand, on the driver that runs use.

/// A line on standard output; if that has gone (`| head`) the command ends.
macro_rules! say {
    ($($line:tt)*) => {{
        use std::io::Write;
        writeln!(std::io::stdout(), $($line)*).map_err(crate::command::Failure::Stdio)?;
    }};
}

mod bim2ax;
mod by_switch;
pub(super) mod consent;
mod interpcnc;
mod on_file;
mod session;
mod smartdrive;
mod words;

use super::{Failure, Status};

/// Talk to a drive: look for it, see how it is, set it up, move it by hand
///
/// Positions and distances are increments as the drive counts them (steps, µsteps), speeds in the drive's own unit: no
/// machine file is read, and nothing knows where the machine's limits are.
///
/// Nothing moves without being asked for: what moves axes says which, from where, to where and how fast, and wants a
/// `y` at the terminal, or --yes. Ctrl-C brings the axes to rest on their ramps, and at once if that is not confirmed.
///
/// Exit status: 0 done, 1 nothing found (scan), 2 it could not be carried out.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    family: Family,
}

#[derive(Debug, clap::Subcommand)]
enum Family {
    Interpcnc(interpcnc::Arguments),
    Smartdrive(smartdrive::Arguments),
    Bim2ax(bim2ax::Arguments),
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    match &arguments.family {
        Family::Interpcnc(arguments) => interpcnc::run(arguments),
        Family::Smartdrive(arguments) => smartdrive::run(arguments),
        Family::Bim2ax(arguments) => bim2ax::run(arguments),
    }
}
