//! Command line: one module per command, and the exit status of each.

/// Defines an enum of subcommands, a variant per module, which has `Arguments` and `run`.
macro_rules! subcommands {
    ($list:ident { $($(#[$attribute:meta])* $name:ident($module:ident),)* }) => {
        #[derive(Debug, clap::Subcommand)]
        enum $list {
            $($(#[$attribute])* $name(Box<$module::Arguments>),)*
        }

        impl $list {
            fn run(&self) -> Result<Status, Failure> {
                match self {
                    $(Self::$name(arguments) => $module::run(arguments),)*
                }
            }
        }
    };
}

mod assume;
mod atomic_file;
mod axes;
mod cam;
mod causes;
mod check;
mod drive;
mod emulate;
mod explain;
mod findings;
mod following;
mod limit;
mod machine;
mod options;
mod path;
mod progress;
mod run;
mod show;
mod switch_points;
mod tappets;
mod tune;
mod underline;
mod view;

use crate::check::CheckFailure;
use crate::program::ProgramFile;
use crate::troubleshooting::{advice, advice_in_run};
use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches, Parser};
use miette::MietteDiagnostic;
use std::io::{self, Write};
use std::process::ExitCode;
use tokio::signal::unix::{SignalKind, signal};
use twin_machine::cam_file::CamFileError;
use twin_machine::section::MachineFileError;

/// Result of a command, in the order of the exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Status {
    /// 0: done, nothing wrong.
    Fit,
    /// 1: it ran; the program is not fit for the machine, or a tolerance was exceeded.
    Unfit,
    /// 2: it could not be carried out.
    Failed,
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> Self {
        match status {
            Status::Fit => Self::SUCCESS,
            Status::Unfit => Self::from(1),
            Status::Failed => Self::from(2),
        }
    }
}

/// A physics-backed digital twin for CNC machines.
///
/// Checks CNC programs on a virtual SCARA or gantry before anything moves, then runs them on a simulated machine and
/// on the drives in parallel and shows how far apart they are.
#[derive(Debug, Parser)]
#[command(name = "twin", version, arg_required_else_help = true, after_help = AFTER_HELP)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

const AFTER_HELP: &str = "\
Exit status:
  0  nothing wrong
  1  the program is not fit for the machine, or a tolerance was exceeded
  2  the command could not be carried out

Start with:
  twin check examples/plate.cnc --machine machines/scara2.toml
  twin run   examples/plate.cnc --machine machines/scara2.toml --serve
  twin limit examples/plate.cnc --machine machines/scara2.toml -o profile.svg";

subcommands!(Command {
    Run(run),
    Check(check),
    Path(path),
    Limit(limit),
    Axes(axes),
    Emulate(emulate),
    Drive(drive),
    View(view),
    Machine(machine),
    Explain(explain),
    Cam(cam),
    Tune(tune),
});

/// The command line: all commands with their arguments, options and help.
pub fn definition() -> clap::Command {
    Arguments::command()
}

/// What the command line says. Numbers below 0 are values wherever one is wanted, so that they are reported as such where there can
/// be none; and what [`assume`] lists is help like any other.
fn parse() -> Result<Arguments, ExitCode> {
    fn signed(command: clap::Command) -> clap::Command {
        let value = |argument: clap::Arg| {
            let takes = argument.get_action().takes_values();
            argument.allow_negative_numbers(takes)
        };
        command.mut_args(value).mut_subcommands(signed)
    }
    let matches = signed(definition()).try_get_matches();
    match matches.and_then(|matches| Arguments::from_arg_matches(&matches)) {
        Ok(arguments) => Ok(arguments),
        Err(error) => {
            // A list that an argument asks for is not an error, although clap calls it one.
            let text = error.to_string();
            let list = text.strip_prefix("error: ");
            let (printed, status) = match list.filter(|_| error.kind() == ErrorKind::DisplayHelp) {
                None => (error.print(), u8::try_from(error.exit_code()).unwrap_or(u8::MAX)),
                Some(list) => (writeln!(std::io::stdout(), "{}", list.trim_end()), 0),
            };
            match printed {
                // Whoever reads our output may have gone.
                Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
                    Failure::Stdio(error).show();
                    Err(Status::Failed.into())
                }
                _ => Err(status.into()),
            }
        }
    }
}

/// The signal of a write beyond the file-size limit (`ulimit -f`), by its number on Linux and macOS.
const SIGXFSZ: i32 = 25;

/// Lets a write beyond the file-size limit fail (`EFBIG`) instead of ending the program.
fn catch_file_size_limit() -> io::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build()?;
    let _inside = runtime.enter();
    // The handler stays when nobody waits for the signal.
    signal(SignalKind::from_raw(SIGXFSZ)).map(drop)
}

/// Carries out the command line.
pub fn main() -> ExitCode {
    if let Err(source) = catch_file_size_limit() {
        Failure::Interrupt(source).show();
        return Status::Failed.into();
    }
    let arguments = match parse() {
        Ok(arguments) => arguments,
        Err(status) => return status,
    };
    match arguments.command.run() {
        Ok(status) => status.into(),
        Err(failure) => {
            failure.show();
            Status::Failed.into()
        }
    }
}

/// Errors that make a command fail.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// The machine file.
    #[error(transparent)]
    Machine(#[from] MachineFileError),
    /// The program file.
    #[error("cannot read program {path}: {source}")]
    Program {
        /// The file.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// Which dialect the program is written in is not known, or not read yet.
    #[error(transparent)]
    Dialect(#[from] crate::program::DialectError),
    /// The program's variables.
    #[error(transparent)]
    Variables(#[from] crate::program::settings::VariablesError),
    /// The simulated machine.
    #[error("the simulated machine cannot be built: {0}")]
    Physics(#[from] twin_machine::SimulationError),
    /// Emulated drives.
    #[error(transparent)]
    Connect(#[from] crate::emulated::ConnectError),
    /// Homing before a run.
    #[error(transparent)]
    Homing(#[from] crate::startup::HomingError),
    /// An emulator on its own.
    #[error(transparent)]
    Emulator(#[from] twin_drives::EmulatorError),
    /// The drives.
    #[error(transparent)]
    Hardware(#[from] crate::hardware::HardwareError),
    /// A drive that is talked to by hand.
    #[error(transparent)]
    Drive(#[from] twin_drives::DriveError),
    /// A motion by hand that went wrong, after which the axes were stopped.
    #[error("{source}; {at_rest}")]
    Motion {
        /// What went wrong.
        source: Box<twin_drives::DriveError>,
        /// How the axes came to rest, and where.
        at_rest: String,
    },
    /// Parameters of a drive on file.
    #[error(transparent)]
    Backup(Box<twin_drives::backup::BackupError>),
    /// Parameters that are given back to a drive.
    #[error(transparent)]
    Restore(Box<twin_drives::backup::RestoreError>),
    /// The file of a cam.
    #[error(transparent)]
    Cam(#[from] Box<twin_machine::cam_file::CamFileError>),
    /// The view.
    #[error(transparent)]
    View(#[from] twin_viz::VizError),
    /// The view of a run.
    #[error(transparent)]
    Picture(#[from] crate::live_view::PictureError),
    /// The machine as URDF.
    #[error(transparent)]
    Urdf(#[from] twin_urdf::UrdfError),
    /// The workspace of a machine.
    #[error(transparent)]
    Workspace(#[from] crate::workspace::WorkspaceError),
    /// A file that was to be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// The file.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// Standard input or output.
    #[error("standard input or output: {0}")]
    Stdio(std::io::Error),
    /// The user stopped the drives before the program began.
    #[error("stopped by the user on the way to the start of the program")]
    StoppedOnTheWay,
    /// What listens for Ctrl-C and its like.
    #[error("Ctrl-C cannot be caught: {0}")]
    Interrupt(#[source] std::io::Error),
    /// A combination of options that makes no sense.
    #[error("{0}")]
    Usage(String),
}

impl From<twin_drives::backup::BackupError> for Failure {
    fn from(error: twin_drives::backup::BackupError) -> Self {
        Self::Backup(Box::new(error))
    }
}

impl From<twin_drives::backup::RestoreError> for Failure {
    fn from(error: twin_drives::backup::RestoreError) -> Self {
        Self::Restore(Box::new(error))
    }
}

impl Failure {
    fn check(program: &ProgramFile, failure: CheckFailure) -> Self {
        match failure {
            CheckFailure::Read(source) => options::unreadable(program.path(), source),
            CheckFailure::Physics(error) => Self::Physics(error),
            CheckFailure::Limits(error) => Self::Usage(error.to_string()),
        }
    }

    fn show(self) {
        match self {
            Self::Machine(error) => {
                for report in error.reports() {
                    stderr!("{report:?}");
                }
            }
            Self::Cam(error) => match *error {
                CamFileError::Toml(error) => {
                    for report in error.reports() {
                        stderr!("{report:?}");
                    }
                }
                other => stderr!("{:?}", miette::Report::msg(other.to_string())),
            },
            // Whoever reads our output has gone: not worth a message.
            Self::Stdio(error) if error.kind() == std::io::ErrorKind::BrokenPipe => {}
            other => {
                let mut diagnostic = MietteDiagnostic::new(other.to_string());
                diagnostic.help = other.advice().map(str::to_owned);
                stderr!("{:?}", miette::Report::new(diagnostic));
            }
        }
    }

    /// What to look at or to do next.
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Drive(error) => advice(error),
            Self::Motion { source, .. } => advice(source),
            Self::Hardware(error) => error.advice(),
            Self::Homing(error) => error.of_drive().and_then(advice_in_run),
            _ => None,
        }
    }
}
