//! `twin tune`: parameters found offline, from recorded runs and limits.

#![allow(clippy::indexing_slicing, reason = "fixed arrays of the four values")]

mod cam;
mod constrained;
mod find;
mod least;
mod outcome;
mod ramp;
mod report;
mod run;
mod start;
mod tappets;
mod words;

use super::{Failure, Status};

/// Find parameters offline: from recorded runs, limits and tolerances. Nothing is written without --write
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    action: Action,
}

subcommands!(Action {
    Cam(cam),
});

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    arguments.action.run()
}
