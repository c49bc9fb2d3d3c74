//! What every drive family offers the twin.

use crate::DriveError;

/// The largest number of axes one device has (InterpCNC: X Y Z A B).
pub const MAX_DRIVE_AXES: usize = 5;

/// Whole increments (steps) per axis of one device.
pub type Increments = [i64; MAX_DRIVE_AXES];

/// Where the axes of one device shall be at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IncrementMotion {
    /// Increments; fractions are what the planner asks for, the device rounds.
    pub position: [f64; MAX_DRIVE_AXES],
    /// Increments per second.
    pub velocity: [f64; MAX_DRIVE_AXES],
}

impl IncrementMotion {
    /// Of axes with these positions and velocities.
    pub(crate) fn of(axes: impl Iterator<Item = (f64, f64)>) -> Self {
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

/// What a device said about itself at one instant.
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

    /// How far ahead of now the plan reaches, ns.
    fn horizon_ns(&self) -> i64;
}

/// A device with one or more axes. Calls block until the exchange with the device is over or its deadline has
/// passed; each device has a thread of its own.
///
/// Nothing moves before [`Drive::enable`] and one of the moving calls.
pub trait Drive: Send {
    /// Family, port and station, for messages.
    fn describe(&self) -> String;

    /// Number of axes in use; the first this many entries of every array count.
    fn axis_count(&self) -> usize;

    /// Asks the device who and how it is; moves nothing and changes nothing.
    ///
    /// # Errors
    /// If the device does not answer or is in a state from which it cannot be enabled, with the reason.
    fn probe(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError>;

    /// Unlocks the device so that it obeys motion commands.
    ///
    /// # Errors
    /// If it stays locked (enable input open, alarm).
    fn enable(&mut self) -> Result<(), DriveError>;

    /// Switches digital output `output`, from 1, and returns when the device has confirmed it.
    ///
    /// # Errors
    /// If there is no such output, or the device refuses or is locked.
    fn set_output(&mut self, output: u8, on: bool) -> Result<(), DriveError>;

    /// Declares the present position of the axes, which must be at rest, to be `position`.
    ///
    /// # Errors
    /// If the device refuses or an axis moves.
    fn set_position(&mut self, position: &Increments) -> Result<(), DriveError>;

    /// Starts every axis towards `target` at no more than `speed` increments/s each, independently, and returns.
    ///
    /// # Errors
    /// If the device refuses or a value does not fit its registers.
    fn move_to(
        &mut self,
        target: &Increments,
        speed: &[f64; MAX_DRIVE_AXES],
    ) -> Result<(), DriveError>;

    /// Position and state, now.
    ///
    /// # Errors
    /// If the device does not answer, or reports that it has stopped obeying (alarm, lock, limit switch).
    fn sample(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError>;

    /// One cycle of following the stream: at most one round of commands for the axes that need one, then a sample.
    /// The session calls it again as soon as it returns.
    ///
    /// # Errors
    /// As [`Self::sample`] and [`Self::move_to`].
    fn follow(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError>;

    /// Brings every axis to rest on its ramp.
    ///
    /// # Errors
    /// If the device did not confirm; the caller then tries [`Self::hard_stop`].
    fn soft_stop(&mut self) -> Result<(), DriveError>;

    /// Stops every axis at once and locks the device.
    ///
    /// # Errors
    /// If the device did not confirm.
    fn hard_stop(&mut self) -> Result<(), DriveError>;
}
