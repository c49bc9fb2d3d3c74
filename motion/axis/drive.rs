//! Drive interface: feedback and command of every cycle, and a virtual drive that follows exactly.

/// Feedback of the drive at the beginning of a cycle. Positions are the drive's, without `fOffsetPosition`.
#[expect(clippy::struct_excessive_bools, reason = "each is a signal of its own")]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Feedback {
    /// Actual position, u.
    pub position: f64,
    /// Actual velocity, u/s.
    pub velocity: f64,
    /// Actual torque, Nm, or force, N.
    pub torque: f64,
    /// Actual current, A.
    pub current: f64,
    /// Power is on.
    pub regulator_on: bool,
    /// The brake is released.
    pub brake_released: bool,
    /// The drive answers.
    pub communicating: bool,
    /// Number of the drive's own error, by its maker.
    pub error: Option<u16>,
    /// A reset clears that error; otherwise the drive has to be switched off or repaired.
    pub resettable: bool,
    /// A limit switch is open.
    pub limit_switch: bool,
    /// Controller mode at work.
    pub mode: ControllerMode,
    /// A position the drive has captured for [`Command::capture`], u.
    pub captured: Option<f64>,
    /// State of the drive's homing.
    pub homing: Homing,
    /// Answer to the [`Command::transfer`] of the cycle before, once it is known.
    pub answer: Option<Answer>,
}

/// Transfer of a parameter of the drive: to read or to write it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transfer {
    /// Its number, by the drive's maker.
    pub number: u32,
    /// Value to write; none to read it.
    pub write: Option<f64>,
}

/// A drive's answer to a [`Transfer`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// The parameter's value, after writing the one that was written.
    Value(f64),
    /// Unknown parameter or unsuitable value.
    Refused,
}

/// State of a drive's own homing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Homing {
    /// Not asked for or not begun.
    #[default]
    Idle,
    /// On the way.
    Busy,
    /// Finished; positions count from the reference now.
    Done,
    /// The drive could not stop behind the reference.
    StopFailed,
}

/// Controller mode (`SMC_CONTROLLER_MODE`, manual 2.2.4).
#[doc(alias = "SMC_CONTROLLER_MODE")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ControllerMode {
    /// 1 `SMC_torque`.
    #[doc(alias = "SMC_torque")]
    Torque = 1,
    /// 2 `SMC_velocity`.
    #[doc(alias = "SMC_velocity")]
    Velocity,
    /// 3 `SMC_position`.
    #[doc(alias = "SMC_position")]
    #[default]
    Position,
    /// 4 `SMC_current`.
    #[doc(alias = "SMC_current")]
    Current,
}

impl ControllerMode {
    /// Its number.
    #[must_use]
    pub const fn number(self) -> i64 {
        self as i64
    }

    /// The mode of a number.
    #[must_use]
    pub fn from_number(number: i64) -> Option<Self> {
        let modes = [Self::Torque, Self::Velocity, Self::Position, Self::Current];
        modes.into_iter().find(|mode| mode.number() == number)
    }
}

/// Command to the drive at the end of a cycle. Positions are the drive's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Set position, u; of a rotary axis within its period.
    pub position: f64,
    /// Set velocity, u/s.
    pub velocity: f64,
    /// Set acceleration, u/s².
    pub acceleration: f64,
    /// Set torque, Nm, or force, N; counts in [`ControllerMode::Torque`].
    pub torque: f64,
    /// Controller mode wanted.
    pub mode: ControllerMode,
    /// Power wanted.
    pub regulator_on: bool,
    /// Release of the brake wanted.
    pub release_brake: bool,
    /// Capture asked for: at this trigger.
    pub capture: Option<Capture>,
    /// Homing asked for: the position the reference is to have, u.
    pub home: Option<f64>,
    /// Reset of the drive's error asked for.
    pub reset: bool,
    /// Parameter of the drive asked for, until it answers.
    pub transfer: Option<Transfer>,
}

/// A capture by the drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capture {
    /// Trigger of the drive.
    pub trigger: i64,
    /// Window of positions of the drive, u; on a rotary axis it may reach over the end of the period.
    pub window: Option<[f64; 2]>,
}

/// Virtual drive: it reaches its set-point one cycle later (a bus of kind Dummy, manual 2.1.3).
///
/// Its own homing takes one cycle: the reference is its position. It has no parameters.
#[derive(Clone, Copy, Debug)]
pub struct VirtualDrive {
    feedback: Feedback,
}

impl VirtualDrive {
    /// At rest at `position` u, without power.
    #[must_use]
    pub fn new(position: f64) -> Self {
        let (communicating, resettable) = (true, true);
        Self { feedback: Feedback { position, communicating, resettable, ..Feedback::default() } }
    }

    /// Its present feedback.
    #[must_use]
    pub fn feedback(&self) -> Feedback {
        self.feedback
    }

    /// Its feedback, to be changed by tests that make it fail.
    #[cfg(test)]
    pub(crate) fn feedback_mut(&mut self) -> &mut Feedback {
        &mut self.feedback
    }

    /// Executes a command exactly.
    pub fn follow(&mut self, command: &Command) {
        let it = &mut self.feedback;
        it.regulator_on = command.regulator_on;
        it.brake_released = command.release_brake;
        it.mode = command.mode;
        if it.regulator_on && it.brake_released {
            it.position = command.position;
            it.velocity = command.velocity;
            it.torque = command.torque;
        } else {
            it.velocity = 0.0;
            it.torque = 0.0;
        }
        it.homing = match command.home {
            Some(reference) => {
                it.position = reference;
                Homing::Done
            }
            None => Homing::Idle,
        };
        if command.reset && it.resettable {
            it.error = None;
        }
        it.answer = command.transfer.map(|_| Answer::Refused);
    }
}
