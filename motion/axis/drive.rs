//! Drive interface: feedback and command of every cycle, and a virtual drive that follows exactly.

/// Feedback of the drive at the beginning of a cycle. Positions are the drive's, without `fOffsetPosition`.
#[expect(clippy::struct_excessive_bools, reason = "each is a signal of its own")]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Feedback {
    /// Actual position, u.
    pub position: f64,
    /// Actual velocity, u/s.
    pub velocity: f64,
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
    /// A position the drive has captured for [`Command::capture`], u.
    pub captured: Option<f64>,
    /// State of the drive's homing.
    pub homing: Homing,
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

/// Command to the drive at the end of a cycle. Positions are the drive's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Set position, u; of a rotary axis within its period.
    pub position: f64,
    /// Set velocity, u/s.
    pub velocity: f64,
    /// Set acceleration, u/s².
    pub acceleration: f64,
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
/// Its own homing takes one cycle: the reference is its position.
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
        if it.regulator_on && it.brake_released {
            it.position = command.position;
            it.velocity = command.velocity;
        } else {
            it.velocity = 0.0;
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
    }
}
