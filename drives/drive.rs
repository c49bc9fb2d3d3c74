//! The trait `Drive`, which every drive family implements for the twin, and its set-points and samples.

use std::time::Duration;

use crate::{
    Action, Clock, DeviceLimits, DriveError, Exchange, Identity, Losses, MAX_DRIVE_AXES,
    ParameterId, ParameterInfo, Signals,
};

/// Whole increments (steps) per axis of one device.
pub type Increments = [i64; MAX_DRIVE_AXES];

/// Commanded position of each axis of a device, increments; `None` where it is not known.
pub type Commanded = [Option<i64>; MAX_DRIVE_AXES];

/// Set-point of the axes of one device at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IncrementMotion {
    /// Increments; fractions are what the planner asks for, the device rounds.
    pub position: [f64; MAX_DRIVE_AXES],
    /// Increments per second.
    pub velocity: [f64; MAX_DRIVE_AXES],
}

impl IncrementMotion {
    /// Of axes with these positions and velocities.
    pub fn of(axes: impl Iterator<Item = (f64, f64)>) -> Self {
        let mut motion = Self::default();
        let slots = motion.position.iter_mut().zip(&mut motion.velocity);
        for ((position, velocity), axis) in slots.zip(axes) {
            (*position, *velocity) = axis;
        }
        motion
    }

    /// On the straight way from here to `to`, of which it has gone `part` (0 to 1).
    #[must_use]
    pub fn towards(&self, to: &Self, part: f64) -> Self {
        let mut motion = *self;
        let positions = motion.position.iter_mut().zip(to.position);
        let velocities = motion.velocity.iter_mut().zip(to.velocity);
        for (value, to) in positions.chain(velocities) {
            *value += (to - *value) * part;
        }
        motion
    }
}

/// State that a device reported at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Middle of the exchange on the session's clock, ns.
    pub time_ns: i64,
    /// Position counters.
    pub position: Increments,
    /// True if any axis moves.
    pub moving: bool,
}

/// The planned motion around now, as the session hands it to a device.
pub trait SetpointStream: Sync {
    /// The session's clock, ns since the start of the program; negative before it.
    fn now_ns(&self) -> i64;

    /// The set-point at `time_ns`, interpolated. Before the first and after the last planned instant the axes rest
    /// at the first and last position (velocity 0). Instants up to [`Self::horizon_ns`] ahead of now are planned.
    fn at(&self, time_ns: i64) -> IncrementMotion;

    /// Length of the plan ahead of now, ns.
    fn horizon_ns(&self) -> i64;
}

/// Longest way of each axis to its home switch, increments; `None` for axes that are not to be homed.
pub type HomingWays = [Option<u32>; MAX_DRIVE_AXES];

/// A device with one or more axes. Calls block until the exchange with the device is over or its deadline has
/// passed; each device has a thread of its own.
///
/// Nothing moves before [`Drive::enable`] and one of the moving calls.
///
/// What not every device has (homing, inputs, parameters) has a body here that says so.
pub trait Drive: Send {
    /// Family, port and address, for messages.
    fn describe(&self) -> String;

    /// Number of axes in use; the first this many entries of every array count.
    fn axis_count(&self) -> usize;

    /// Identity of the device, for messages and start-up checks. Moves nothing, changes nothing.
    ///
    /// # Errors
    /// If the device does not answer.
    fn identity(&mut self) -> Result<Identity, DriveError>;

    /// Asks the device whether it is what it should be, and how it is; moves nothing and changes nothing.
    ///
    /// # Errors
    /// If the device does not answer or is in a state from which it cannot be enabled, with the reason.
    fn probe(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError>;

    /// Unlocks the device so that it obeys motion commands.
    ///
    /// # Errors
    /// If it stays locked (enable input open, alarm).
    fn enable(&mut self) -> Result<(), DriveError>;

    /// Locks the device, whose axes must be at rest: it obeys no motion command until [`Self::enable`]. The motors may
    /// lose their current, and the device its positions.
    ///
    /// # Errors
    /// If an axis moves or the device did not confirm; [`DriveError::Unsupported`] if it cannot be locked.
    fn disable(&mut self) -> Result<(), DriveError> {
        Err(unsupported(&self.describe(), "lock"))
    }

    /// Starts the device's own homing of the axes that have a way, with the parameters the device has, and returns.
    /// [`Self::sample`] shows by `moving` when it is over and [`Self::homed`] how it has ended.
    ///
    /// Boards that take the longest way are given it; other devices stop by their own limit switches or time.
    ///
    /// # Errors
    /// If the device refuses; [`DriveError::Unsupported`] if an axis has no homing of its own.
    fn begin_homing(&mut self, _ways: &HomingWays) -> Result<(), DriveError> {
        Err(unsupported(&self.describe(), "homing"))
    }

    /// Homed axes; `None` where neither the device nor the client knows: the device does not keep it, and the
    /// driver has not homed the axis.
    ///
    /// # Errors
    /// If the device does not answer.
    fn homed(&mut self) -> Result<[Option<bool>; MAX_DRIVE_AXES], DriveError> {
        Ok([None; MAX_DRIVE_AXES])
    }

    /// Inputs and outputs, now. A device without any shows none.
    ///
    /// # Errors
    /// If the device does not answer.
    fn signals(&mut self, clock: &dyn Clock) -> Result<Signals, DriveError> {
        Ok(Signals { time_ns: clock.now_ns(), ..Signals::default() })
    }

    /// Switches digital output `output`, from 1, and returns when the device has confirmed it.
    ///
    /// # Errors
    /// If the output does not exist, or the device refuses or is locked.
    fn set_output(&mut self, output: u8, on: bool) -> Result<(), DriveError>;

    /// Declares the present position of the axes, which must be at rest, to be `position`.
    ///
    /// # Errors
    /// If the device refuses or an axis moves.
    fn set_position(&mut self, position: &Increments) -> Result<(), DriveError>;

    /// Starts every axis towards `target` at no more than `speed` increments/s each, independently, and returns. An axis
    /// whose speed is 0 gets no command.
    ///
    /// # Errors
    /// If the device refuses or a value does not fit its registers.
    fn move_to(
        &mut self,
        target: &Increments,
        speed: &[f64; MAX_DRIVE_AXES],
    ) -> Result<(), DriveError>;

    /// Whether a move to another target may be given while an axis moves. Of a device that refuses one the axis has to come to
    /// rest first.
    fn retargets(&self) -> bool {
        true
    }

    /// Position and state, now.
    ///
    /// # Errors
    /// If the device does not answer, or reports that it has stopped obeying (alarm, lock, limit switch).
    fn sample(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError>;

    /// Looks whether the device shows what it shows after it has been off for a moment, or reset: it obeys no motion command and
    /// its positions are 0. [`Self::enable`] and a hard stop make some devices show the same ([`Self::hard_stop_keeps_position`]).
    /// Changes nothing.
    ///
    /// # Errors
    /// If the device does not answer, or not yet.
    fn shows_restart(&mut self) -> Result<bool, DriveError> {
        Ok(false)
    }

    /// Whether the device still knows its positions after a [`Self::hard_stop`].
    fn hard_stop_keeps_position(&self) -> bool {
        false
    }

    /// One cycle of following the stream: at most one round of commands for the axes that need one, then a sample.
    /// The session calls it again as soon as it returns.
    ///
    /// # Errors
    /// As [`Self::sample`] and [`Self::move_to`].
    fn follow(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError>;

    /// Answers that were lost since it was opened; nothing is asked.
    fn losses(&self) -> Losses {
        Losses::default()
    }

    /// Time of a round on the wire, in which every axis gets a command and is seen, by the shortest turnaround so far; nothing is
    /// asked. `None` where the wire sets no limit, or nothing is measured yet.
    fn round(&self) -> Option<Duration> {
        None
    }

    /// Targets of the last commands that the device has confirmed, as the client remembers them; the device is
    /// asked nothing. `None` for an axis of which it is not known: it has been sent nowhere, a command was not confirmed,
    /// or something else (a stop, homing, another zero) has come since.
    fn commanded(&self) -> Commanded {
        [None; MAX_DRIVE_AXES]
    }

    /// Brings every axis to rest on its ramp.
    ///
    /// # Errors
    /// If the device did not confirm; the caller then tries [`Self::hard_stop`].
    fn soft_stop(&mut self) -> Result<(), DriveError>;

    /// Stops at once what moves and locks the device; how each family does is in its page of the manual and in
    /// `docs/src/encoders_homing_stops.md`. Of several devices behind one interface (SmartDRIVE) those that have
    /// confirmed the [`Self::soft_stop`] before are left as they stand.
    ///
    /// # Errors
    /// If the device did not confirm.
    fn hard_stop(&mut self) -> Result<(), DriveError>;

    /// Limits of the axes as the device has them in its parameters, also where a new value waits for a restart.
    ///
    /// # Errors
    /// If the device does not answer.
    fn limits(&mut self) -> Result<[DeviceLimits; MAX_DRIVE_AXES], DriveError> {
        Ok([DeviceLimits::default(); MAX_DRIVE_AXES])
    }

    /// The parameters the device has, read-only ones included, in the order of their numbers.
    ///
    /// # Errors
    /// If what they take depends on the device and it does not answer.
    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, DriveError> {
        Ok(Vec::new())
    }

    /// The value of a parameter.
    ///
    /// # Errors
    /// [`DriveError::NoParameter`]; or if the device does not answer.
    fn parameter(&mut self, id: ParameterId) -> Result<i64, DriveError> {
        Err(DriveError::NoParameter { at: nowhere(&self.describe()), id })
    }

    /// The values of parameters, in this order; devices that tell many at a time are asked for them so.
    ///
    /// # Errors
    /// As [`Self::parameter`].
    fn parameter_values(&mut self, ids: &[ParameterId]) -> Result<Vec<i64>, DriveError> {
        ids.iter().map(|id| self.parameter(*id)).collect()
    }

    /// Sets a parameter, the axes being at rest, and reads it back. Whether it survives a restart without
    /// [`Self::save_parameters`] depends on the family, and when it acts is in [`ParameterInfo::needs_restart`].
    ///
    /// # Errors
    /// [`DriveError::NoParameter`], [`DriveError::ReadOnly`], [`DriveError::ParameterValue`]; or if the device refuses,
    /// does not keep the value or does not answer.
    fn set_parameter(&mut self, id: ParameterId, _value: i64) -> Result<(), DriveError> {
        Err(DriveError::NoParameter { at: nowhere(&self.describe()), id })
    }

    /// Those of these parameters that the device would have otherwise after it was switched off and on. None of devices that
    /// keep every value as soon as it is set.
    ///
    /// # Errors
    /// As [`Self::parameter`].
    fn unsaved_parameters(&mut self, _ids: &[ParameterId]) -> Result<Vec<ParameterId>, DriveError> {
        Ok(Vec::new())
    }

    /// Makes the device keep its parameters when it is switched off; nothing to do for devices that always do. The
    /// axes must be at rest; a device may lose its positions.
    ///
    /// # Errors
    /// If the device refuses or does not answer.
    fn save_parameters(&mut self) -> Result<(), DriveError> {
        Ok(())
    }
}

/// A device that has said nothing but its name.
fn nowhere(device: &str) -> Exchange {
    Exchange { port: device.into(), address: 0, action: Action::Nothing }
}

fn unsupported(device: &str, what: &'static str) -> DriveError {
    DriveError::Unsupported { at: nowhere(device), what }
}

/// True for the speed of an axis that gets no command.
pub fn is_zero(speed: f64) -> bool {
    // −0 is 0, too.
    speed.abs().to_bits() == 0
}
