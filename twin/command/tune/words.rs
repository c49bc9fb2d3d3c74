//! Options: words and lists of numbers, and what they say.

use super::list;
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

pub(super) fn start(text: &str) -> Result<[f64; 3], String> {
    list(text, 2)
}
