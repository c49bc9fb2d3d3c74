//! Homing by the drive (`MC_Home`), and the zero of the axis (`MC_SetPosition`).

use super::Planned;
use crate::ownership::{Refusal, Start};
use crate::{Axis, AxisState, Homing, Motion, Progress, SmcError, Stage};
use twin_profile::State;

/// Longest answering time of a drive, s; the manual names no time.
pub(super) const ANSWER_S: f64 = 1.0;

/// Homing by the drive itself (`MC_Home`, manual 5.3).
///
/// 170 if the axis moves, 140 for a position that is not finite (the manual has no error for it), 171 if the drive does not
/// begin, 172 if it stops answering, 173 if it cannot stop.
///
/// The set position follows the drive meanwhile. When the drive is done, its positions count from the reference, and a
/// shift of the zero is gone.
///
/// `Deceleration` is in the block's diagram (manual 5.3) but not in its list of inputs; the manual only names it for error
/// 173 (9.3) and has the axis at rest when the block is done. So it brakes a drive that still moves at its reference, on
/// the ramps of the axis, before the block is done; a drive at rest needs none.
#[doc(alias = "MC_Home")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Home {
    /// Position of the reference, u.
    pub position: f64,
    /// Brings the axis to rest where the drive has not, u/s²; 0, the block's own initial value, if it need not.
    pub deceleration: f64,
}

/// Homing by the drive on its way.
#[expect(clippy::large_enum_variant, reason = "a box would be allocated in a cycle")]
#[derive(Clone, Debug)]
pub enum HomeRun {
    /// Time since the request without an answer, s.
    Asked(f64),
    /// The reference is found, and the axis comes to rest.
    Braking(Planned),
}

impl Motion for Home {
    type With = ();
    type Run = HomeRun;
    const STATE: AxisState = AxisState::Homing;

    fn admitted(&self, axis: &Axis) -> Result<(), Refusal> {
        axis.admits(AxisState::DiscreteMotion)?;
        match axis.state() {
            AxisState::Standstill => Ok(()),
            _ => Err(SmcError::HAxisWasntStandstill.into()),
        }
    }

    fn plan(&self, _start: Start, _axis: &Axis, (): ()) -> Result<HomeRun, SmcError> {
        if !self.position.is_finite() {
            return Err(SmcError::WpParamInvalid);
        }
        Ok(HomeRun::Asked(0.0))
    }

    fn lost(axis: &Axis, error: SmcError) -> SmcError {
        if axis.values.communication { error } else { SmcError::HAxisDidntAnswer }
    }

    fn step(&self, run: &mut HomeRun, axis: &mut Axis, (): ()) -> Result<Progress, SmcError> {
        let waited = match run {
            HomeRun::Asked(waited) => waited,
            HomeRun::Braking(planned) => return Ok(planned.step(axis, Stage::Done)),
        };
        axis.home = Some(self.position);
        let drive = axis.drive;
        let state = State { position: drive.position, velocity: drive.velocity, acceleration: 0.0 };
        let stage = match drive.homing {
            Homing::Idle if *waited > ANSWER_S => {
                return Err(SmcError::HAxisDidntStartHoming);
            }
            Homing::Idle => {
                *waited += axis.cycle();
                Stage::Busy
            }
            Homing::Busy => Stage::Busy,
            Homing::StopFailed => return Err(SmcError::HErrorWhenStopping),
            Homing::Done => {
                axis.stop_homing();
                axis.set_offset(0.0);
                if state.velocity != 0.0 {
                    return self.brake(run, state, axis);
                }
                Stage::Done
            }
        };
        Ok(Progress { setpoint: state, stage })
    }
}

impl Home {
    /// The first cycle of the way to rest from where the drive is, as it moves.
    fn brake(&self, run: &mut HomeRun, state: State, axis: &Axis) -> Result<Progress, SmcError> {
        let start = Start { state, lead: 0.0, aim: None };
        let planned = Planned::halt(self.deceleration, start, axis);
        let mut planned = planned.map_err(|_without| SmcError::HErrorWhenStopping)?;
        let progress = planned.step(axis, Stage::Done);
        *run = HomeRun::Braking(planned);
        Ok(progress)
    }
}

impl Axis {
    /// Moves the zero, not the axis (`MC_SetPosition`, manual 5.3): the set position becomes `position` u, or, with
    /// `relative` (its `Mode`), shifts by it.
    ///
    /// Motion goes on unchanged; its target moves with the zero. Direct set-points of a program jump. Slaves in gear and
    /// with a phase shift do not notice; one on a cam with `MasterAbsolute` goes to where the new position has it.
    ///
    /// # Errors
    ///
    /// [`SmcError::WpParamInvalid`] (140) for a position that is not finite; the manual has no error for it.
    #[doc(alias = "MC_SetPosition")]
    pub fn shift_zero(&mut self, position: f64, relative: bool) -> Result<(), SmcError> {
        if !position.is_finite() {
            return Err(SmcError::WpParamInvalid);
        }
        let shift = if relative { position } else { position - self.values.set_position };
        self.set_offset(self.values.offset_position + shift);
        Ok(())
    }

    /// Sets `fOffsetPosition`, and every position with it.
    pub(crate) fn set_offset(&mut self, offset: f64) {
        let shift = offset - self.values.offset_position;
        self.values.offset_position = offset;
        self.zero += shift;
        self.values.act_position = self.in_program(self.drive.position);
        self.values.save_position = self.wrapped(self.values.save_position + shift);
        // A window is one of the program's positions.
        if let Some(window) = self.capture.as_mut().and_then(|capture| capture.window.as_mut()) {
            *window = window.map(|position| position - shift);
        }
        self.show_set_values();
    }
}
