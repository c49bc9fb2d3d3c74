//! `MC_Phasing`: shifts a slave by a constant distance from its master.

use super::follower::Follower;
use crate::moves::Planned;
use crate::ownership::Start;
use crate::{Axis, AxisState, Master, Motion, Progress, SmcError, Stage};
use twin_profile::{AxisLimits, State};

/// A slave at a constant distance from its master (`MC_Phasing`, manual 5.4).
///
/// It takes up the master's velocity; then the distance they have changes by `phase_shift`, as a motion on top. `done`
/// when it has; the block goes on until another one moves the slave. The names of the inputs are PLCopen's: the picture
/// in the manual is lost.
#[doc(alias = "MC_Phasing")]
#[doc(alias = "MC_Phase")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phasing {
    /// `PhaseShift`, u, with its sign: how much the slave's lead grows.
    pub phase_shift: f64,
    /// Largest velocity of the shift relative to the master, u/s.
    pub velocity: f64,
    /// Acceleration, u/s².
    pub acceleration: f64,
    /// Deceleration, u/s².
    pub deceleration: f64,
}

/// Phasing on its way.
#[derive(Clone, Debug)]
pub struct PhasingRun {
    follower: Follower,
    /// The slave without the shift.
    slave: State,
    shift: Option<Planned>,
    /// How long the shift takes, s.
    shift_takes: f64,
}

impl Phasing {
    fn limits(&self, axis: &Axis) -> AxisLimits {
        axis.limits(self.velocity, self.acceleration, self.deceleration)
    }

    /// The shift, from rest to rest.
    fn shift(&self, axis: &Axis) -> Result<Planned, SmcError> {
        let rest = Start { state: State::default(), lead: axis.cycle(), aim: None };
        Planned::to(self.phase_shift, self.limits(axis), rest, axis)
            .map_err(|_invalid| SmcError::PhInvalidVelaccdec)
    }
}

impl Motion for Phasing {
    type With = Master;
    type Run = PhasingRun;
    const STATE: AxisState = AxisState::SynchronizedMotion;
    const GOES_ON: bool = true;

    fn plan(&self, start: Start, axis: &Axis, master: Master) -> Result<PhasingRun, SmcError> {
        let rotary_without_period = |period: Option<f64>| period.is_some_and(|it| it <= 0.0);
        if rotary_without_period(axis.period()) || rotary_without_period(master.period) {
            return Err(SmcError::PhRotaryaxisPeriod0);
        }
        // The shift has to be possible before anything moves.
        let shift_takes = self.shift(axis)?.duration();
        let follower = Follower::new(master, self.limits(axis));
        Ok(PhasingRun { follower, slave: start.state, shift: None, shift_takes })
    }

    /// At least: the shift comes when the velocities are the same.
    fn duration(run: &PhasingRun) -> Option<f64> {
        Some(run.shift_takes)
    }

    fn step(
        &self,
        run: &mut PhasingRun,
        axis: &mut Axis,
        master: Master,
    ) -> Result<Progress, SmcError> {
        let slave = run.follower.step(run.slave, master, 1.0, axis);
        run.slave = slave.map_err(|_invalid| SmcError::PhInvalidVelaccdec)?;
        let progress = match &mut run.shift {
            Some(shift) => shift.step(axis, Stage::Reached),
            None => Progress { setpoint: State::default(), stage: Stage::Busy },
        };
        if run.follower.is_coupled() && run.shift.is_none() {
            run.shift = Some(self.shift(axis)?);
        }
        let Progress { setpoint: shift, stage } = progress;
        let setpoint = State {
            position: run.slave.position + shift.position,
            velocity: run.slave.velocity + shift.velocity,
            acceleration: run.slave.acceleration + shift.acceleration,
        };
        Ok(Progress { setpoint, stage })
    }
}
