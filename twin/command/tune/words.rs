//! Options: words and lists of numbers, and what they say.

use crate::command::cam::number;
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

/// Places of master and slave with a comma between, and the slave's velocity, or 0.
pub(super) fn start(text: &str) -> Result<[f64; 3], String> {
    let numbers = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    match numbers[..] {
        [master, slave] => Ok([master, slave, 0.0]),
        [master, slave, velocity] => Ok([master, slave, velocity]),
        _ => Err(format!("{} numbers; expected MASTER,SLAVE[,VELOCITY]", numbers.len())),
    }
}
