//! `twin drive`: one drive by hand, on the driver that runs use.
//!
//! The actions are the same for all families ([`action::Action`]). A family is a folder with a type that implements
//! [`family::Family`], and one entry of `families!` below.

/// A line on standard output; if that has gone (`| head`) the command ends.
macro_rules! say {
    ($($line:tt)*) => {{
        use std::io::Write;
        writeln!(std::io::stdout(), $($line)*).map_err(crate::command::Failure::Stdio)?;
    }};
}

mod action;
mod bim2ax;
mod by_switch;
pub(super) mod consent;
mod family;
mod interpcnc;
mod on_file;
mod session;
mod smartdrive;
mod words;

use super::{Failure, Status};
use action::Command;

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
    device: Device,
}

/// Makes the list of families the subcommands.
macro_rules! families {
    ($($(#[$attribute:meta])* $name:ident($family:ty),)*) => {
        #[derive(Debug, clap::Subcommand)]
        enum Device {
            $($(#[$attribute])* $name(Command<$family>),)*
        }

        pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
            match &arguments.device {
                $(Device::$name(command) => command.run(),)*
            }
        }
    };
}

families! {
    /// SOPROLEC InterpCNC V2.1: five step axes X Y Z A B on Modbus RTU; positions in steps
    ///
    /// For instance, with `twin emulate interpcnc --link /tmp/board` in another window:
    ///   twin drive interpcnc --port /tmp/board status
    ///   twin drive interpcnc --port /tmp/board unlock
    ///   twin drive interpcnc --port /tmp/board move X 4000 --speed 2000
    #[command(verbatim_doc_comment)]
    Interpcnc(interpcnc::HandBoard),
    /// SmartDRIVE v1.2: up to 31 step motor drives on one RS485 bus, protocol ATB; positions in µsteps, speeds in rpm
    ///
    /// For instance, with `twin emulate smartdrive --link /tmp/bus` in another window:
    ///   twin drive smartdrive --port /tmp/bus scan
    ///   twin drive smartdrive --port /tmp/bus unlock
    ///   twin drive smartdrive --port /tmp/bus jog 3200 --speed 60
    #[command(verbatim_doc_comment)]
    Smartdrive(smartdrive::Axis),
    /// BIBOX BIM2AX-BOCM: two step axes behind a dual-port RAM; positions in µsteps, speeds as the axis's drive mode has them
    ///
    /// For instance, with `twin emulate bim2ax --link /tmp/module` in another window:
    ///   twin drive bim2ax --port /tmp/module status
    ///   twin drive bim2ax --port /tmp/module unlock 1
    ///   twin drive bim2ax --port /tmp/module move 1 4000 --speed 250
    ///
    /// The module has no outputs of its own to switch, and keeps parameters in its EEPROM as soon as they are set.
    #[command(verbatim_doc_comment)]
    Bim2ax(bim2ax::Module),
}
