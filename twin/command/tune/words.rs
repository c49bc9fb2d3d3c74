//! Options: words and lists of numbers, and what they say.

use super::list;
use crate::command::cam::positive;
use clap::ValueEnum;
use twin_profile::RampType;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum SlaveColumn {
    Measured,
    Wanted,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Ramp {
    Trapezoid,
    Sigmoid,
    Parabolic,
}

impl From<Ramp> for RampType {
    fn from(ramp: Ramp) -> Self {
        match ramp {
            Ramp::Trapezoid => Self::Trapezoid,
            Ramp::Sigmoid => Self::Sigmoid,
            Ramp::Parabolic => Self::Parabolic,
        }
    }
}

pub(super) fn part(text: &str) -> Result<f64, String> {
    let part = positive(text)?;
    if part < 1.0 { Ok(part) } else { Err(format!("{part} is not less than 1")) }
}

pub(super) fn start(text: &str) -> Result<[f64; 3], String> {
    list(text, 2)
}
