//! Motion along one profile, planned at the rising edge of Execute.

use crate::ownership::{Refusal, Start};
use crate::{Axis, AxisState, Motion, Progress, SmcError, Stage};
use twin_profile::{AxisLimits, Profile, ProfileError};

/// A profile and how far it has come.
#[derive(Clone, Debug)]
pub struct Planned {
    profile: Profile,
    /// Time of this cycle's set-point after the beginning, s.
    time: f64,
}

impl Planned {
    /// Begins a profile; its first set-point is that of this cycle.
    pub(crate) fn new(profile: &Profile, start: Start, axis: &Axis) -> Self {
        // The time is moved on before it is used.
        Self { profile: *profile, time: start.lead - axis.cycle() }
    }

    /// From `start` to `target` u (the drive's coordinates), to rest there.
    pub(crate) fn to(
        target: f64,
        limits: AxisLimits,
        start: Start,
        axis: &Axis,
    ) -> Result<Self, ProfileError> {
        let profile = Profile::to_position(start.state, target, 0.0, limits, axis.ramp())?;
        Ok(Self::new(&profile, start, axis))
    }

    /// From `start` to rest, wherever that is.
    pub(crate) fn halt(deceleration: f64, start: Start, axis: &Axis) -> Result<Self, ProfileError> {
        let velocity = start.state.velocity.abs().max(f64::MIN_POSITIVE);
        let limits = axis.limits(velocity, deceleration, deceleration);
        let profile = Profile::halt(start.state, limits, axis.ramp())?;
        Ok(Self::new(&profile, start, axis))
    }

    /// From `start` to a velocity u/s with its sign, and on with it.
    pub(crate) fn to_velocity(
        velocity: f64,
        limits: AxisLimits,
        start: Start,
        axis: &Axis,
    ) -> Result<Self, ProfileError> {
        let profile = Profile::to_velocity(start.state, velocity, limits, axis.ramp())?;
        Ok(Self::new(&profile, start, axis))
    }

    /// Duration from its beginning, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.profile.duration()
    }

    /// End position, u (the drive's coordinates).
    pub(crate) fn target(&self) -> f64 {
        self.profile.end().position
    }

    /// Goes on by a cycle; `end` says what comes at the end of the profile.
    pub(crate) fn step(&mut self, axis: &Axis, end: Stage) -> Progress {
        self.time += axis.cycle();
        // A cycle that rounds to just before the end is the end.
        let ended = self.time >= self.profile.duration() - 1e-9 * axis.cycle();
        let setpoint = if ended && end == Stage::Done {
            self.profile.end()
        } else {
            self.profile.at(self.time)
        };
        Progress { setpoint, stage: if ended { end } else { Stage::Busy } }
    }
}

/// A [`Motion`] along one profile, planned at the rising edge of Execute.
pub trait PlannedMotion {
    /// State of the axis meanwhile. In `discrete_motion` the profile's end is the axis's target; in `stopping` the block keeps
    /// the axis until Execute falls.
    const STATE: AxisState = AxisState::DiscreteMotion;
    /// The end of the profile: [`Stage::Done`] gives the axis back, with [`Stage::Reached`] the block goes on.
    const END: Stage = Stage::Done;

    /// As [`Motion::admitted`].
    ///
    /// # Errors
    ///
    /// A [`Refusal`].
    fn admitted(&self, axis: &Axis) -> Result<(), Refusal> {
        axis.admits(Self::STATE)
    }

    /// As [`Motion::plan`].
    ///
    /// # Errors
    ///
    /// The manual's error for inputs that are not valid.
    fn plan(&self, start: Start, axis: &Axis) -> Result<Planned, SmcError>;
}

impl<M: PlannedMotion> Motion for M {
    type With = ();
    type Run = Planned;
    const STATE: AxisState = M::STATE;
    const LOCKS: bool = matches!(M::STATE, AxisState::Stopping);

    fn admitted(&self, axis: &Axis) -> Result<(), Refusal> {
        PlannedMotion::admitted(self, axis)
    }

    fn plan(&self, start: Start, axis: &Axis, (): ()) -> Result<Planned, SmcError> {
        PlannedMotion::plan(self, start, axis)
    }

    fn aim(run: &Planned) -> Option<f64> {
        (M::STATE == AxisState::DiscreteMotion).then(|| run.target())
    }

    fn duration(run: &Planned) -> Option<f64> {
        Some(run.duration())
    }

    fn step(&self, run: &mut Planned, axis: &mut Axis, (): ()) -> Result<Progress, SmcError> {
        Ok(run.step(axis, M::END))
    }
}
