//! Homing with a device: looks at its switch and position as often as the wire lets it, and does what the sequence says.
//!
//! Nobody but this watches the switch. So the axis is never sent farther than it goes in a few looks: a way is made of
//! legs ([`Legs`]), and where looks end the axis does, at the end of the leg it has.

use std::fmt;

use super::legs::Legs;
use super::{Homing, HomingFault, HomingOptions, Order, Seen};
use crate::{Bits, Drive, DriveError, Increments, MAX_DRIVE_AXES, SetpointStream, Signals};

/// Signal of a device that is a switch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Switch {
    /// An input, from 1, which has this level while the switch is pressed.
    Input {
        /// Number of the input.
        number: u8,
        /// Its level on the switch.
        pressed: bool,
    },
    /// The home switch, which the device knows.
    Home,
    /// The limit switch towards larger positions.
    PositiveLimit,
    /// The limit switch towards smaller positions.
    NegativeLimit,
}

impl fmt::Display for Switch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input { number, .. } => write!(f, "input {number}"),
            Self::Home => f.write_str("which input its home switch is at"),
            Self::PositiveLimit => f.write_str("its limit switch towards larger positions"),
            Self::NegativeLimit => f.write_str("its limit switch towards smaller positions"),
        }
    }
}

impl Switch {
    /// Whether the switch of an axis is pressed; `None` if the device does not show it.
    pub fn pressed(self, signals: &Signals, axis: usize) -> Option<bool> {
        let inputs: &Bits = &signals.inputs;
        let of_axis = signals.axes.get(axis).copied().unwrap_or_default();
        match self {
            Self::Input { number, pressed } => inputs.get(number).map(|level| level == pressed),
            Self::Home => of_axis.home,
            Self::PositiveLimit => of_axis.positive_limit,
            Self::NegativeLimit => of_axis.negative_limit,
        }
    }
}

/// Axis of a device to be homed, and its settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomingRun {
    /// Index of the arrays of [`Drive`].
    pub axis: usize,
    /// Its home switch.
    pub switch: Switch,
    /// In increments.
    pub options: HomingOptions,
}

/// Result of homing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomingReport {
    /// Reference in the count from before, increments.
    pub reference: f64,
    /// Shift of positions, increments.
    pub shift: i64,
    /// Longest time from one look at the switch to the next, ns: of this depends how exact the reference is
    /// ([`HomingOptions::uncertainty`]).
    pub longest_look_ns: i64,
}

/// Error of homing. The axis has been stopped, unless the error says that it has not.
#[derive(Debug, thiserror::Error)]
pub enum HomingError {
    /// Fault of the axis.
    #[error("homing of axis {}: {error}", axis + 1)]
    Axis {
        /// Index of the arrays.
        axis: usize,
        /// The fault.
        error: HomingFault,
    },
    /// Error of the device.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// The device does not show the switch.
    #[error("homing of axis {}: the device does not show {switch}", axis + 1)]
    NoSwitch {
        /// Index of the arrays.
        axis: usize,
        /// The switch.
        switch: Switch,
    },
    /// The axis moves already.
    #[error("homing of axis {}: an axis of the device moves", axis + 1)]
    Moving {
        /// Index of the arrays.
        axis: usize,
    },
    /// Homing has failed, and the device has confirmed neither stop: whether the axis is at rest is not known.
    #[error("{why}; and the axis could not be stopped: {source}; use the emergency stop")]
    NotStopped {
        /// Error of homing.
        why: Box<HomingError>,
        /// Error of the stop.
        source: Box<DriveError>,
    },
    /// It was asked to stop.
    #[error("homing of axis {}: stopped on request", axis + 1)]
    Aborted {
        /// Index of the arrays.
        axis: usize,
    },
}

/// Homes an axis of an enabled device by a switch. The other axes of the device must be at rest, too; they stay.
///
/// `stream` is for its clock. `index` is asked after every look once the switch has opened, with the signals and the
/// position of the axis, and gives the position of the index pulse when there has been one; devices do not latch it.
/// `abort` is asked before every look.
///
/// The axis is sent a leg at a time, no farther than it goes in half a second
/// ([`HomingOptions::longest_leg`]): if nobody looks any more, it stops there. A device that takes no other target while it moves
/// ([`Drive::retargets`]) stops between two legs.
///
/// Device and driver keep watching limit switches; where [`HomingOptions::ignore_hardware_limit`] is set, what they tell of
/// them does not end homing.
///
/// # Errors
/// See [`HomingError`]. The axis has been stopped on its ramp, or hard if that failed; [`HomingError::NotStopped`] if
/// that failed, too.
pub fn home_by_switch(
    drive: &mut dyn Drive,
    run: &HomingRun,
    stream: &dyn SetpointStream,
    index: &mut dyn FnMut(&Signals, f64) -> Option<f64>,
    abort: &dyn Fn() -> bool,
) -> Result<HomingReport, HomingError> {
    let wrong = |error| HomingError::Axis { axis: run.axis, error };
    let sequence = Homing::new(&run.options).map_err(wrong)?;
    let mut runner = Runner {
        drive,
        run,
        stream,
        sequence,
        legs: Legs::default(),
        longest_look_ns: 0,
        last_look_ns: None,
    };
    let outcome = runner.run(index, abort);
    outcome.map_err(|why| match runner.drive.soft_stop().or_else(|_| runner.drive.hard_stop()) {
        Ok(()) => why,
        Err(source) => HomingError::NotStopped { why: Box::new(why), source: Box::new(source) },
    })
}

struct Runner<'a> {
    drive: &'a mut dyn Drive,
    run: &'a HomingRun,
    stream: &'a dyn SetpointStream,
    sequence: Homing,
    legs: Legs,
    longest_look_ns: i64,
    last_look_ns: Option<i64>,
}

/// Signals and positions of one look.
struct Look {
    seen: Seen,
    signals: Signals,
    positions: Increments,
}

impl Runner<'_> {
    fn run(
        &mut self,
        index: &mut dyn FnMut(&Signals, f64) -> Option<f64>,
        abort: &dyn Fn() -> bool,
    ) -> Result<HomingReport, HomingError> {
        let axis = self.run.axis;
        let mut look = self.look()?;
        if look.seen.moving {
            return Err(HomingError::Moving { axis });
        }
        let mut shift = 0;
        loop {
            if abort() {
                return Err(HomingError::Aborted { axis });
            }
            if self.sequence.awaits_index() {
                look.seen.index = index(&look.signals, look.seen.position);
            }
            let order = self.sequence.step(&self.legs.seen(&look.seen));
            match order.map_err(|error| HomingError::Axis { axis, error })? {
                Order::Wait => {
                    let retargets = self.drive.retargets();
                    if let Some((target, velocity)) = self.legs.next(&look.seen, retargets) {
                        let ignore = self.run.options.ignore_hardware_limit;
                        match self.send(&look.positions, target, velocity) {
                            // It has come to its switch since the look: the next one shows that.
                            Err(HomingError::Drive(error)) if ignore && error.is_limit_switch() => {
                            }
                            sent => sent?,
                        }
                    }
                }
                Order::Go { target, velocity } => {
                    // The axis rests: braking does not count as time between looks.
                    self.last_look_ns = Some(self.stream.now_ns());
                    let first = self.legs.begin(look.seen.position, target, velocity);
                    self.send(&look.positions, first, velocity)?;
                }
                Order::Stop => {
                    self.legs = Legs::default();
                    self.drive.soft_stop()?;
                }
                Order::Declare { position } => shift = self.declare(position)?,
                Order::Done => {
                    let reference = self.sequence.reference().unwrap_or(look.seen.position);
                    let longest_look_ns = self.longest_look_ns;
                    return Ok(HomingReport { reference, shift, longest_look_ns });
                }
            }
            look = self.look()?;
        }
    }

    /// Looks at the switch, then at the position, so that this is known on both sides of that.
    fn look(&mut self) -> Result<Look, HomingError> {
        let (axis, switch) = (self.run.axis, self.run.switch);
        let stream = self.stream;
        let signals = self.drive.signals(&|| stream.now_ns())?;
        let pressed =
            switch.pressed(&signals, axis).ok_or(HomingError::NoSwitch { axis, switch })?;
        let ignore = self.run.options.ignore_hardware_limit;
        let sample = match self.drive.sample(stream) {
            // The device reports positions also while it does not obey.
            Err(error) if ignore && error.is_limit_switch() => self.drive.probe(stream)?,
            sample => sample?,
        };
        let since = self.last_look_ns.replace(signals.time_ns);
        let interval = since.map_or(0, |since| signals.time_ns.saturating_sub(since));
        self.longest_look_ns = self.longest_look_ns.max(interval);
        let of_axis = signals.axes.get(axis).copied().unwrap_or_default();
        let limit = match (of_axis.positive_limit, of_axis.negative_limit) {
            (Some(true), _) => Some(true),
            (_, Some(true)) => Some(false),
            _ => None,
        };
        #[expect(clippy::cast_precision_loss, reason = "counters have far less than 53 bits")]
        let position = sample.position.get(axis).copied().unwrap_or(0) as f64;
        let seen = Seen {
            time_ns: sample.time_ns,
            position,
            moving: sample.moving,
            switch_ns: signals.time_ns,
            open: !pressed,
            index: None,
            limit,
        };
        Ok(Look { seen, signals, positions: sample.position })
    }

    /// Sends the axis of these positions to one of its own.
    fn send(
        &mut self,
        positions: &Increments,
        target: f64,
        velocity: f64,
    ) -> Result<(), HomingError> {
        let mut targets = *positions;
        let mut speeds = [0.0; MAX_DRIVE_AXES];
        let axis = self.run.axis;
        if let (Some(place), Some(speed)) = (targets.get_mut(axis), speeds.get_mut(axis)) {
            *place = whole(target);
            *speed = velocity;
        }
        Ok(self.drive.move_to(&targets, &speeds)?)
    }

    /// Declares a position of an axis at rest; what positions have become more by.
    fn declare(&mut self, position: f64) -> Result<i64, HomingError> {
        let mut positions = self.look()?.positions;
        let mut shift = 0;
        if let Some(place) = positions.get_mut(self.run.axis) {
            let declared = whole(position);
            shift = declared.saturating_sub(*place);
            *place = declared;
        }
        self.drive.set_position(&positions)?;
        Ok(shift)
    }
}

/// The nearest whole increment.
fn whole(position: f64) -> i64 {
    #[expect(clippy::cast_possible_truncation, reason = "saturates; drivers check what they send")]
    let whole = position.round() as i64;
    whole
}
