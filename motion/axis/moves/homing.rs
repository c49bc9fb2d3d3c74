//! Homing onto a switch (`SMC_Homing`, manual 2.2.7).

use super::Planned;
use crate::ownership::Start;
use crate::{Axis, AxisState, Direction, Motion, Progress, SmcError, Stage};
use std::collections::VecDeque;
use twin_profile::State;

/// Homing mode: the order of setting the reference and stopping, and the direction off the switch (`SMC_HOMING_MODE`).
#[doc(alias = "SMC_HOMING_MODE")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum HomingMode {
    /// 0 `FAST_BSLOW_S_STOP`: back off the switch slowly, set the reference, stop.
    #[default]
    FastBackSlowSetStop,
    /// 1 `FAST_BSLOW_STOP_S`: stop, then set.
    FastBackSlowStopSet,
    /// 2 `FAST_BSLOW_I_S_STOP`: wait for the index pulse, set, stop.
    FastBackSlowIndexSetStop,
    /// 4 `FAST_SLOW_S_STOP`: slowly across the switch, in the same direction; set, stop.
    FastSlowSetStop,
    /// 5 `FAST_SLOW_STOP_S`.
    FastSlowStopSet,
    /// 6 `FAST_SLOW_I_S_STOP`.
    FastSlowIndexSetStop,
}

impl HomingMode {
    fn turns(self) -> bool {
        use HomingMode::{FastBackSlowIndexSetStop, FastBackSlowSetStop, FastBackSlowStopSet};
        matches!(self, FastBackSlowSetStop | FastBackSlowStopSet | FastBackSlowIndexSetStop)
    }

    fn stops_first(self) -> bool {
        matches!(self, Self::FastBackSlowStopSet | Self::FastSlowStopSet)
    }

    fn waits_for_index(self) -> bool {
        matches!(self, Self::FastBackSlowIndexSetStop | Self::FastSlowIndexSetStop)
    }
}

/// Homing onto a switch that the program reads (`SMC_Homing`, manual 2.2.7).
///
/// Fast in `direction` until the switch closes, then slowly until it opens again: there is the reference. The inputs of
/// the switch and the index pulse count every cycle, the others are taken over at the rising edge.
#[doc(alias = "SMC_Homing")]
#[expect(clippy::struct_excessive_bools, reason = "each is a signal of its own")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomingBySwitch {
    /// `fHomePosition`: position of the reference, u.
    pub home_position: f64,
    /// `fVelocitySlow`, u/s.
    pub velocity_slow: f64,
    /// `fVelocityFast`, u/s.
    pub velocity_fast: f64,
    /// `fAcceleration`, u/s².
    pub acceleration: f64,
    /// `fDeceleration`, u/s².
    pub deceleration: f64,
    /// `nDirection`: negative (the manual's default) or positive.
    pub direction: Direction,
    /// `bEndSwitch`: TRUE is open, FALSE closed.
    pub end_switch: bool,
    /// `fSignalDelay`, s: the reference is the position of the axis this time before the switch signal.
    pub signal_delay: f64,
    /// `nHomingMode`.
    pub mode: HomingMode,
    /// `bReturnToZero`: go to 0 afterwards.
    pub return_to_zero: bool,
    /// `bIndexOccured`.
    pub index_occurred: bool,
    /// `fIndexPosition`: where the index pulse was, u.
    pub index_position: f64,
    /// `bIgnoreHWLimit`: the limit switch is not watched meanwhile; in the modes that turn back only.
    pub ignore_hw_limit: bool,
}

/// Homing on its way.
#[derive(Clone, Debug)]
pub struct HomingRun {
    /// As taken over.
    inputs: HomingBySwitch,
    phase: Phase,
    motion: Planned,
    /// Where the drive was, the latest first, u.
    was_at: VecDeque<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Onto the switch.
    Fast,
    /// Off the switch.
    Slow,
    /// On to the index pulse.
    Index,
    /// To rest; whether the reference is yet to be set.
    Brake(bool),
    /// To zero.
    Return,
}

impl HomingBySwitch {
    fn sign(&self) -> Option<f64> {
        match self.direction {
            Direction::Negative => Some(-1.0),
            Direction::Positive => Some(1.0),
            _ => None,
        }
    }

    /// A motion with a velocity and its sign.
    fn at_velocity(&self, velocity: f64, start: Start, axis: &Axis) -> Result<Planned, SmcError> {
        let limits = axis.limits(velocity.abs(), self.acceleration, self.deceleration);
        Planned::to_velocity(velocity, limits, start, axis)
            .map_err(|_invalid| SmcError::HomingInvalidVelaccValues)
    }

    /// Velocity off the switch, with its sign.
    fn slow(&self) -> f64 {
        let turn = if self.mode.turns() { -1.0 } else { 1.0 };
        turn * self.sign().unwrap_or(-1.0) * self.velocity_slow
    }
}

impl HomingRun {
    /// Another motion from the axis's last set-point.
    fn go(
        &mut self,
        phase: Phase,
        axis: &Axis,
        plan: impl FnOnce(&HomingBySwitch, Start) -> Result<Planned, SmcError>,
    ) -> Result<(), SmcError> {
        let start = Start { state: axis.saved, lead: axis.cycle(), aim: None };
        self.motion = plan(&self.inputs, start)?;
        self.phase = phase;
        Ok(())
    }

    fn brake(&mut self, set_afterwards: bool, axis: &Axis) -> Result<(), SmcError> {
        self.go(Phase::Brake(set_afterwards), axis, |inputs, start| {
            Planned::halt(inputs.deceleration, start, axis)
                .map_err(|_invalid| SmcError::HomingInvalidVelaccValues)
        })
    }

    /// Position of the drive at the time of the signal, its delay ago, u.
    fn was_at(&self, axis: &Axis) -> f64 {
        let cycles = self.inputs.signal_delay.max(0.0) / axis.cycle();
        let mut positions = self.was_at.iter().copied();
        let mut behind = cycles;
        let mut after = positions.next().unwrap_or(axis.drive.position);
        for before in positions {
            if behind < 1.0 {
                return after + behind * (before - after);
            }
            behind -= 1.0;
            after = before;
        }
        after
    }

    /// Zero so that `place` u (the drive's) is the home position.
    fn set_reference(&self, place: f64, axis: &mut Axis) {
        axis.set_offset(self.inputs.home_position - place);
    }

    fn remember(&mut self, axis: &Axis) {
        // One more than needed, for interpolation; limited for invalid delays.
        const LONGEST: f64 = 100_000.0;
        let cycles = (self.inputs.signal_delay.max(0.0) / axis.cycle()).min(LONGEST);
        self.was_at.push_front(axis.drive.position);
        while f64::from(u32::try_from(self.was_at.len()).unwrap_or(u32::MAX)) > cycles + 2.0 {
            self.was_at.pop_back();
        }
    }

    /// Plans the way to 0 from rest; this cycle it still rests.
    fn go_to_zero(&mut self, rest: State, axis: &Axis) -> Result<State, SmcError> {
        let inputs = self.inputs;
        let limits = axis.limits(inputs.velocity_fast, inputs.acceleration, inputs.deceleration);
        let start = Start { state: rest, lead: axis.cycle(), aim: None };
        let target = axis.to_drive(0.0);
        let target = Direction::Shortest.unwound(axis, rest, target, limits, 0.0);
        self.motion = Planned::to(target, limits, start, axis)
            .map_err(|_invalid| SmcError::HomingInvalidVelaccValues)?;
        self.phase = Phase::Return;
        Ok(rest)
    }
}

impl Motion for HomingBySwitch {
    type With = ();
    type Run = HomingRun;
    const STATE: AxisState = AxisState::Homing;
    const LIVE: bool = true;

    fn plan(&self, start: Start, axis: &Axis, (): ()) -> Result<HomingRun, SmcError> {
        let sign = self.sign().ok_or(SmcError::HomingInvalidVelaccValues)?;
        if !self.mode.turns() && self.ignore_hw_limit {
            return Err(SmcError::HomingModeNeedsHwlimit);
        }
        let finite = [self.home_position, self.signal_delay].iter().all(|value| value.is_finite());
        let slow = self.at_velocity(self.slow(), start, axis)?;
        let fast = self.at_velocity(sign * self.velocity_fast, start, axis)?;
        if !finite {
            return Err(SmcError::HomingInvalidVelaccValues);
        }
        // On the switch already: off it.
        let (phase, motion) =
            if self.end_switch { (Phase::Fast, fast) } else { (Phase::Slow, slow) };
        Ok(HomingRun { inputs: *self, phase, motion, was_at: VecDeque::new() })
    }

    fn step(&self, run: &mut HomingRun, axis: &mut Axis, (): ()) -> Result<Progress, SmcError> {
        axis.ignores_limit_switch = run.inputs.ignore_hw_limit;
        run.remember(axis);
        match run.phase {
            Phase::Fast if !self.end_switch => {
                run.go(Phase::Slow, axis, |inputs, start| {
                    inputs.at_velocity(inputs.slow(), start, axis)
                })?;
            }
            // While it still runs onto the switch, an open switch does not count.
            Phase::Slow if self.end_switch && axis.saved.velocity * run.inputs.slow() > 0.0 => {
                if run.inputs.mode.waits_for_index() {
                    run.phase = Phase::Index;
                } else if run.inputs.mode.stops_first() {
                    run.brake(true, axis)?;
                } else {
                    run.set_reference(run.was_at(axis), axis);
                    run.brake(false, axis)?;
                }
            }
            Phase::Index if self.index_occurred && self.index_position.is_finite() => {
                let place = axis.to_drive(self.index_position);
                run.set_reference(place, axis);
                run.brake(false, axis)?;
            }
            _ => {}
        }
        let end = if matches!(run.phase, Phase::Brake(_) | Phase::Return) {
            Stage::Done
        } else {
            Stage::Busy
        };
        let Progress { setpoint, stage } = run.motion.step(axis, end);
        let at_rest = stage == Stage::Done;
        if let Phase::Brake(set) = run.phase
            && at_rest
        {
            if set {
                run.set_reference(setpoint.position, axis);
            }
            if run.inputs.return_to_zero {
                return Ok(Progress {
                    setpoint: run.go_to_zero(setpoint, axis)?,
                    stage: Stage::Busy,
                });
            }
        }
        Ok(Progress { setpoint, stage })
    }
}
