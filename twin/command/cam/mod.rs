//! `twin cam`: check, sample, convert and plot cams.

mod check;
mod convert;
mod options;
mod plot;
mod reduced;
mod sample;

pub(super) use check::Format;
pub(super) use options::{LimitOptions, MasterOptions, UseOptions, load, number, positive};

use super::{Failure, Status, run as command_run};
use crate::finding::{Finding, Severity};
use std::fmt;

/// Check cams against the limits of their slaves, sample them, write them in other forms, draw them
///
/// Cams are read from .toml (examples/cams are commented as documentation of the format), .csv (master, slave, or with
/// velocity and acceleration) and .asc files (ASCII tables of SoftMotion, a line `master;slave` per point).
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    action: Action,
}

subcommands!(Action {
    Check(check),
    Sample(sample),
    Convert(convert),
    Plot(plot),
    /// Run a job, in which axes follow cams and gears, on the simulated machine and on drives, as `twin run` runs programs
    ///
    /// A job (examples/jobs, commented as documentation of the format) calls `MC_MoveAbsolute`, `MC_CamIn` and other blocks (moves,
    /// profiles over time, zeros, gears and cams; docs/src/jobs.md lists them) with the axes of a machine file and with virtual
    /// masters. The report says what the tappets of its cams switch. The job is checked first, and nothing moves if it is not fit for the
    /// machine. `twin check` and `twin run` take jobs, too.
    Run(command_run),
});

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    arguments.action.run()
}

/// Shows findings on standard error, the worst first.
pub(super) fn show_findings(findings: &[Finding]) {
    for finding in findings {
        stderr!("{:?}", miette::Report::new(Shown(finding.clone())));
    }
}

#[derive(Debug)]
struct Shown(Finding);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.message)
    }
}

impl std::error::Error for Shown {}

impl miette::Diagnostic for Shown {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.0.rule.name()))
    }

    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.0.severity {
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
            Severity::Note => miette::Severity::Advice,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.0.hint.as_ref().map(|hint| Box::new(hint) as Box<dyn fmt::Display>)
    }
}
