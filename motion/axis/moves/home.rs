//! The drive's own homing, and the zero.

use crate::axis::ownership::{Refusal, Start};
use crate::axis::profile::State;
use crate::axis::{Axis, AxisState, Homing, Motion, Progress, SmcError, Stage};

/// How long a drive may take to answer, s; the manual names no time.
pub(super) const ANSWER_S: f64 = 1.0;

/// Homing by the drive itself (`MC_Home`, manual 5.3).
///
/// 170 unless the axis stands still, 171 if the drive does not begin, 172 if it stops answering, 173 if it cannot stop.
///
/// The set position follows the drive meanwhile. When the drive is done, its positions count from the reference, and a
/// shift of the zero is gone.
#[doc(alias = "MC_Home")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Home {
    /// Position of the reference, u.
    pub position: f64,
}

impl Motion for Home {
    type With = ();
    /// Time without an answer of the drive, s.
    type Run = f64;
    const STATE: AxisState = AxisState::Homing;

    fn admitted(&self, axis: &Axis) -> Result<(), Refusal> {
        axis.admits(AxisState::DiscreteMotion)?;
        match axis.state() {
            AxisState::Standstill => Ok(()),
            _ => Err(SmcError::HAxisWasntStandstill.into()),
        }
    }

    fn plan(&self, _start: Start, _axis: &Axis, (): ()) -> Result<f64, SmcError> {
        Ok(0.0)
    }

    fn lost(axis: &Axis, error: SmcError) -> SmcError {
        if axis.values.communication { error } else { SmcError::HAxisDidntAnswer }
    }

    fn step(&self, waited: &mut f64, axis: &mut Axis, (): ()) -> Result<Progress, SmcError> {
        axis.home = Some(self.position);
        axis.values.start_reference = true;
        axis.values.reference = self.position;
        let drive = axis.drive;
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
                Stage::Done
            }
        };
        let velocity = if stage == Stage::Done { 0.0 } else { drive.velocity };
        let setpoint = State { position: drive.position, velocity, acceleration: 0.0 };
        Ok(Progress { setpoint, stage })
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
    /// [`SmcError::WpParamInvalid`] (140) for a position that is no finite number; the manual has no error for it.
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
        self.values.mark_position = self.wrapped(self.values.mark_position + shift);
        self.values.aim_position = self.wrapped(self.values.aim_position + shift);
        // A window is one of the program's positions.
        if let Some(window) = self.capture.as_mut().and_then(|capture| capture.window.as_mut()) {
            *window = window.map(|position| position - shift);
        }
        self.show_set_values();
    }
}
