//! `MC_GearIn`, `MC_GearOut` and `MC_CamOut`: velocity gear, and the end of a coupling.

use super::follower::Follower;
use crate::moves::Planned;
use crate::ownership::Start;
use crate::{Axis, AxisState, Master, Motion, Progress, SmcError, Stage};

/// The slave's velocity is a multiple of the master's (`MC_GearIn`, manual 5.4). `done` is `InGear`.
#[doc(alias = "MC_GearIn")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearIn {
    /// `RatioNumerator`.
    pub ratio_numerator: i32,
    /// `RatioDenominator`, not 0.
    pub ratio_denominator: u32,
    /// Acceleration of the slave until it is in gear, u/s².
    pub acceleration: f64,
    /// Deceleration of the slave until it is in gear, u/s².
    pub deceleration: f64,
}

impl GearIn {
    fn ratio(&self) -> f64 {
        f64::from(self.ratio_numerator) / f64::from(self.ratio_denominator)
    }
}

impl Motion for GearIn {
    type With = Master;
    type Run = Follower;
    const STATE: AxisState = AxisState::SynchronizedMotion;
    const GOES_ON: bool = true;

    fn plan(&self, _start: Start, axis: &Axis, master: Master) -> Result<Follower, SmcError> {
        let valid = |value: f64| value > 0.0 && value.is_finite();
        if self.ratio_denominator == 0 {
            Err(SmcError::GiRatioDenom)
        } else if !valid(self.acceleration) {
            Err(SmcError::GiInvalidAcc)
        } else if !valid(self.deceleration) {
            Err(SmcError::GiInvalidDec)
        } else {
            let limits = axis.limits(1.0, self.acceleration, self.deceleration);
            Ok(Follower::new(master, limits))
        }
    }

    fn step(
        &self,
        run: &mut Follower,
        axis: &mut Axis,
        master: Master,
    ) -> Result<Progress, SmcError> {
        let setpoint = run.step(axis.saved_base, master, self.ratio(), axis);
        let setpoint = setpoint.map_err(|_invalid| SmcError::GiInvalidAcc)?;
        let stage = if run.is_coupled() { Stage::Reached } else { Stage::Busy };
        Ok(Progress { setpoint, stage })
    }
}

/// Decouples the slave from its master; it keeps its velocity (`MC_GearOut`, `MC_CamOut`, manual 5.4).
///
/// Done at once; it has to be called until something else moves the slave.
#[doc(alias = "MC_GearOut")]
#[doc(alias = "MC_CamOut")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Decouple;

impl Motion for Decouple {
    type With = ();
    type Run = Planned;
    const STATE: AxisState = AxisState::ContinuousMotion;

    fn plan(&self, start: Start, axis: &Axis, (): ()) -> Result<Planned, SmcError> {
        let velocity = start.state.velocity;
        let own = axis.implicit_limits();
        let limit = velocity.abs().max(f64::MIN_POSITIVE);
        let limits = axis.limits(limit, own.acceleration, own.deceleration);
        Planned::to_velocity(velocity, limits, start, axis)
            .map_err(|_invalid| SmcError::MvInvalidAccdecValues)
    }

    fn step(&self, run: &mut Planned, axis: &mut Axis, (): ()) -> Result<Progress, SmcError> {
        let Progress { setpoint, .. } = run.step(axis, Stage::Reached);
        Ok(Progress { setpoint, stage: Stage::Reached })
    }
}
