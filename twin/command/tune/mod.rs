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

use super::cam::number;
use super::{Failure, Status};
use clap::Subcommand;

/// Find parameters offline: from recorded runs, limits and tolerances. Nothing is written without --write
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    Cam(Box<cam::Arguments>),
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    match &arguments.action {
        Action::Cam(arguments) => cam::run(arguments),
    }
}

/// Numbers with commas between: `least` of them at least, the others 0.
fn list<const N: usize>(text: &str, least: usize) -> Result<[f64; N], String> {
    let mut numbers = [0.0; N];
    let mut count = 0;
    for part in text.split(',') {
        let slot = numbers.get_mut(count).ok_or_else(|| format!("more than {N} numbers"))?;
        *slot = number(part)?;
        count += 1;
    }
    if count < least { Err(format!("fewer than {least} numbers")) } else { Ok(numbers) }
}
