//! Velocity coupling of a slave to a multiple of its master's velocity.

use crate::{Axis, Master};
use twin_profile::{AxisLimits, Profile, ProfileError, RampType, State};

/// Coupling of a slave's velocity to its master.
#[derive(Clone, Copy, Debug)]
pub struct Follower {
    limits: AxisLimits,
    /// Master in the cycle before.
    master: Master,
    coupled: bool,
}

impl Follower {
    pub(super) fn new(master: Master, limits: AxisLimits) -> Self {
        Self { limits, master, coupled: false }
    }

    /// True if the velocities have met.
    pub(super) fn is_coupled(&self) -> bool {
        self.coupled
    }

    /// The slave's next state, from `from`, with `ratio` times the master's velocity.
    ///
    /// Until it has that velocity it goes towards it under its limits; then its way is `ratio` times the master's. With
    /// limited jerk it takes over a master's acceleration only without a step.
    pub(super) fn step(
        &mut self,
        from: State,
        master: Master,
        ratio: f64,
        axis: &Axis,
    ) -> Result<State, ProfileError> {
        let way = ratio * master.travel_since(&self.master);
        self.master = master;
        let [velocity, acceleration] = [ratio * master.velocity, ratio * master.acceleration];
        if self.coupled {
            return Ok(State { position: from.position + way, velocity, acceleration });
        }
        let limit = velocity.abs().max(f64::MIN_POSITIVE);
        let limits = AxisLimits { velocity: limit, ..self.limits };
        let profile = Profile::to_velocity(from, velocity, limits, axis.ramp())?;
        let state = profile.at(axis.cycle());
        let step = (acceleration - from.acceleration).abs();
        let smooth = axis.ramp() == RampType::Trapezoid || step <= self.limits.jerk * axis.cycle();
        self.coupled = smooth && profile.duration() <= axis.cycle() * (1.0 + 1e-9);
        let joined = if self.coupled { acceleration } else { state.acceleration };
        Ok(State { acceleration: joined, ..state })
    }
}
