//! Ramp-in onto a cam under limited jerk (`ramp_in`, manual 4.6.1).

use super::selection::StartMode;
use twin_profile::{AxisLimits, Profile, ProfileError, RampType, State};

/// Ramp-in: the slave's remaining distance to its cam, as a motion on top of the cam's. It takes the difference of
/// position, velocity and acceleration to zero with the axis's ramps. Nothing steps, and its jerk, in addition to the
/// cam's, never exceeds the axis's.
#[derive(Clone, Debug)]
pub struct Approach {
    profile: Profile,
    /// From the slave to its cam at the beginning, u.
    distance: f64,
}

/// Start of an approach, and its permitted direction.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    /// From the slave to its cam, u.
    pub distance: f64,
    /// The slave's velocity relative to the cam's, u/s.
    pub velocity: f64,
    /// The slave's acceleration relative to the cam's, u/s².
    pub acceleration: f64,
    /// Of a rotary slave, u.
    pub period: Option<f64>,
    /// Direction in which a rotary slave may go.
    pub mode: StartMode,
}

impl Approach {
    /// The approach over a gap, and the number of periods of a rotary slave to subtract from the cam's positions.
    ///
    /// # Errors
    ///
    /// As [`Profile::to_position`].
    pub fn new(gap: Gap, limits: AxisLimits, ramp: RampType) -> Result<(Self, f64), ProfileError> {
        let Gap { distance, velocity, acceleration, period, mode } = gap;
        let from = State { position: 0.0, velocity, acceleration };
        let mut turned = 0.0;
        if let Some(period) = period.filter(|period| *period > 0.0) {
            let stop = Profile::halt(from, limits, ramp)?.end().position;
            let turns = match mode {
                // As far ahead as a slave that is too fast needs to stop, and less than a turn further.
                StartMode::RampInPositive => ((distance - stop.max(0.0)) / period).floor(),
                StartMode::RampInNegative => ((distance - stop.min(0.0)) / period).ceil(),
                _ => (distance / period).round(),
            };
            turned = turns * period;
        }
        let distance = distance - turned;
        let profile = Profile::to_position(from, distance, 0.0, limits, ramp)?;
        Ok((Self { profile, distance }, turned))
    }

    /// The motion on top of the cam's.
    pub fn profile(&self) -> &Profile {
        &self.profile
    }

    /// Motion of the slave `time` s after the beginning, for this motion of the cam; none once it is in sync.
    pub fn at(&self, time: f64, cam: State) -> Option<State> {
        (time < self.profile.duration()).then(|| {
            let State { position, velocity, acceleration } = self.profile.at(time);
            State {
                position: cam.position - self.distance + position,
                velocity: cam.velocity + velocity,
                acceleration: cam.acceleration + acceleration,
            }
        })
    }
}
