//! One step of an approach: a straight line of the axes or of the tool tip, from rest to rest.

use super::ApproachError;
use std::fmt;
use twin_kinematics::{
    AxisMotion, AxisSource, AxisVector, Kinematics, KinematicsError, MachineAxes, Pose, ToolMotion,
};
use twin_machine::Machine;
use twin_profile::{AxisLimits, Profile, RampType, State};

/// Instants of a line of the tool tip at which the axes are asked for their rates.
const SAMPLES: u32 = 200;

/// Part of the limits that each of two effects may take where axes bend: acceleration along the line, and bend.
const SHARE: f64 = 0.5;

/// Motion up to this counts as rest, m or rad.
const REST: f64 = 1e-9;

/// Part of the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leg {
    /// Along the tool axis, away from the work.
    Up,
    /// Across, at one height.
    Across,
    /// Along the tool axis, to the start.
    Down,
    /// All axes that move, straight to the start.
    Straight,
    /// To the zero of an axis.
    Home,
}

impl fmt::Display for Leg {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Up => "on the way up",
            Self::Across => "on the way across",
            Self::Down => "on the way down",
            Self::Straight => "on the way",
            Self::Home => "on the way to zero",
        })
    }
}

/// A straight line, by the part of it that is behind: 0 to 1.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) leg: Leg,
    pub(super) from: AxisVector,
    pub(super) to: AxisVector,
    /// Ends of the line of the tool tip, machine frame, if that is the straight one.
    pub(super) tip: Option<[Pose; 2]>,
}

impl Line {
    /// Straight in the positions of the axes.
    pub(super) fn of_axes(leg: Leg, from: AxisVector, to: AxisVector) -> Self {
        Self { leg, from, to, tip: None }
    }

    /// True if nothing moves.
    pub(super) fn is_empty(&self) -> bool {
        self.from.iter().zip(self.to.iter()).all(|(from, to)| (to - from).abs() <= REST)
    }

    /// Axes at `state` along the line (of 1).
    fn at(&self, kinematics: &MachineAxes, state: &State) -> Result<AxisMotion, KinematicsError> {
        let State { position, velocity, acceleration } = *state;
        let ways = || self.from.iter().zip(self.to.iter()).map(|(from, to)| (*from, to - from));
        let straight = AxisMotion {
            position: AxisVector::from_values(ways().map(|(from, way)| from + way * position)),
            velocity: AxisVector::from_values(ways().map(|(_, way)| way * velocity)),
            acceleration: AxisVector::from_values(ways().map(|(_, way)| way * acceleration)),
        };
        let Some([from, to]) = &self.tip else { return Ok(straight) };
        let (way, turn) = (to.position - from.position, to.direction - from.direction);
        let tool = ToolMotion {
            pose: Pose {
                position: from.position + way * position,
                direction: from.direction + turn * position,
            },
            velocity: way * velocity,
            acceleration: way * acceleration,
            direction_velocity: turn * velocity,
            direction_acceleration: turn * acceleration,
        };
        let mut axes = kinematics.inverse_motion(&tool, &straight.position)?;
        // Axes that do not move the tool go straight.
        for (place, source) in kinematics.sources().iter().enumerate() {
            let additional = matches!(source, AxisSource::Additional(_));
            let copy = |values: &mut AxisVector, straight: &AxisVector| {
                if let (true, Some(slot), Some(value)) =
                    (additional, values.get_mut(place), straight.get(place))
                {
                    *slot = *value;
                }
            };
            copy(&mut axes.position, &straight.position);
            copy(&mut axes.velocity, &straight.velocity);
            copy(&mut axes.acceleration, &straight.acceleration);
        }
        Ok(axes)
    }

    /// Largest rates of the axes along the line: limits of a motion from 0 to 1, with velocities of `factor` times those
    /// of the machine.
    fn limits(
        &self,
        machine: &Machine,
        factor: f64,
    ) -> Result<(AxisLimits, RampType), ApproachError> {
        let samples = if self.tip.is_some() { SAMPLES } else { 0 };
        let share = if self.tip.is_some() { SHARE } else { 1.0 };
        let mut limits = AxisLimits {
            velocity: f64::INFINITY,
            acceleration: f64::INFINITY,
            deceleration: f64::INFINITY,
            jerk: f64::INFINITY,
        };
        for sample in 0..=samples {
            // With unit velocity the velocity is the rate, and the acceleration the bend.
            let position = f64::from(sample) / f64::from(samples.max(1));
            let state = State { position, velocity: 1.0, acceleration: 0.0 };
            let axes = self.at(&machine.kinematics, &state);
            let axes = axes.map_err(|source| ApproachError::Reach { leg: self.leg, source })?;
            let rates = axes.velocity.iter().zip(axes.acceleration.iter());
            for (axis, (rate, bend)) in machine.axes.iter().zip(rates) {
                let (rate, bend) = (rate.abs(), bend.abs());
                let slowest = axis.max_acceleration.min(axis.max_deceleration);
                let AxisLimits { velocity, acceleration, deceleration, jerk } = &mut limits;
                *velocity = velocity.min(factor * axis.max_velocity / rate);
                if self.tip.is_some() {
                    *velocity = velocity.min((share * slowest / bend).sqrt());
                }
                *acceleration = acceleration.min(share * axis.max_acceleration / rate);
                *deceleration = deceleration.min(share * axis.max_deceleration / rate);
                if let Some(most) = axis.max_jerk {
                    *jerk = jerk.min(share * most / rate);
                }
            }
        }
        let ramp = if limits.jerk.is_finite() { RampType::Parabolic } else { RampType::Trapezoid };
        if ramp == RampType::Trapezoid {
            limits.jerk = limits.acceleration;
        }
        Ok((limits, ramp))
    }
}

/// A line with its motion over time.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) line: Line,
    profile: Profile,
}

impl Step {
    /// Motion along `line` within the limits of the machine, with velocities of at most `factor` times the largest ones.
    pub(super) fn new(machine: &Machine, line: Line, factor: f64) -> Result<Self, ApproachError> {
        let (limits, ramp) = line.limits(machine, factor)?;
        let profile = Profile::to_position(State::resting(0.0), 1.0, 0.0, limits, ramp);
        let leg = line.leg;
        let profile = profile.map_err(|source| ApproachError::Profile { leg, source })?;
        Ok(Self { line, profile })
    }

    /// Duration, s.
    pub(super) fn duration(&self) -> f64 {
        self.profile.duration()
    }

    /// Axes `time` s after its begin.
    pub(super) fn at(
        &self,
        kinematics: &MachineAxes,
        time: f64,
    ) -> Result<AxisMotion, ApproachError> {
        let leg = self.line.leg;
        let axes = self.line.at(kinematics, &self.profile.at(time));
        axes.map_err(|source| ApproachError::Reach { leg, source })
    }
}
