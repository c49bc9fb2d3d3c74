//! Options: words and lists of numbers, and what they say.

use super::list;
use crate::cam::tune::{PointTolerance, ShapeGoal};
use crate::command::cam::{magnitude, number, positive};
use clap::ValueEnum;
use twin_cam::Quantity;
use twin_cam::tune::Tolerance;
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Goal {
    Speed,
    Acceleration,
    Jerk,
}

impl From<Goal> for ShapeGoal {
    fn from(goal: Goal) -> Self {
        match goal {
            Goal::Speed => Self::Speed,
            Goal::Acceleration => Self::Peak(Quantity::Acceleration),
            Goal::Jerk => Self::Peak(Quantity::Jerk),
        }
    }
}

pub(super) fn part(text: &str) -> Result<f64, String> {
    let part = positive(text)?;
    if part < 1.0 { Ok(part) } else { Err(format!("{part} is not less than 1")) }
}

pub(super) fn point(text: &str) -> Result<PointTolerance, String> {
    let (master, tolerances) = text
        .split_once(':')
        .ok_or("expected MASTER:SLAVE[,VELOCITY[,ACCELERATION]], like 120:2,0.5")?;
    let master = if master.trim() == "all" { None } else { Some(number(master)?) };
    let [slave, velocity, acceleration] = list::<3>(tolerances, 1)?;
    for value in [slave, velocity, acceleration] {
        magnitude(&value.to_string())?;
    }
    Ok(PointTolerance { master, tolerance: Tolerance { slave, velocity, acceleration } })
}

pub(super) fn start(text: &str) -> Result<[f64; 3], String> {
    list(text, 2)
}
