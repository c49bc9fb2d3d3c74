//! Homing before a run, axis by axis.

use super::{Still, position};
use crate::attached::Attached;
use crate::clock::Clock;
use crate::repair_commands;
use twin_drives::{Drive, DriveError, HomingWays, MAX_DRIVE_AXES, Sample};
use twin_machine::{Axis, DriveFamily, Machine};

/// A home switch may lie so much further away than the whole way between the software limits.
const FURTHER: f64 = 1.2;

/// And an axis may go so much further than that in all, out and back: not every device limits the way itself.
const IN_ALL: f64 = 1.5;

/// Homing is given up after the time that this way takes at this part of the axis's largest velocity …
const SLOWEST: f64 = 0.01;

/// … and so much for what takes no way, s.
const LONGEST_REST: f64 = 30.0;

/// Errors of homing. Axes that moved have been brought to rest.
#[derive(Debug, thiserror::Error)]
pub enum HomingError {
    /// The device or its wire.
    #[error("homing axis {axis}: {source}")]
    Drive {
        /// The axis.
        axis: String,
        /// Why.
        source: Box<DriveError>,
    },
    /// It has ended, and the axis is not home.
    #[error("homing axis {axis}: it has not found its home")]
    NotHome {
        /// The axis.
        axis: String,
    },
    /// It has gone farther than its home can be.
    #[error("homing axis {axis}: it has gone {way:.1} {unit} and not found its home")]
    TooFar {
        /// The axis.
        axis: String,
        /// How far it may go, in `unit`.
        way: f64,
        /// "mm" or "deg".
        unit: &'static str,
    },
    /// It takes longer than the way can take.
    #[error("homing axis {axis}: it has not ended after {patience_s:.0} s")]
    TooLong {
        /// The axis.
        axis: String,
        /// How long it may take, s.
        patience_s: f64,
    },
    /// The user does not want it any more.
    #[error("stopped by the user while homing axis {axis}")]
    Stopped {
        /// The axis.
        axis: String,
    },
    /// It has not come home, for a reason that leaves its position open.
    #[error("{why}; it is at {at:.3} {unit}")]
    AtRest {
        /// Why it is not home.
        why: Box<HomingError>,
        /// Where the device counts it, in `unit`.
        at: f64,
        /// "mm" or "deg".
        unit: &'static str,
    },
    /// The device could not be brought to rest.
    #[error(
        "homing axis {axis}: {why}; and it could not be stopped ({source}): use the emergency stop"
    )]
    NotStopped {
        /// The axis.
        axis: String,
        /// Why it had to be.
        why: String,
        /// Why it could not.
        source: Box<DriveError>,
    },
}

impl HomingError {
    /// Error of its drive.
    pub fn of_drive(&self) -> Option<&DriveError> {
        match self {
            Self::Drive { source, .. } | Self::NotStopped { source, .. } => Some(source),
            Self::AtRest { why, .. } => why.of_drive(),
            _ => None,
        }
    }
}

/// Lets the devices home these axes (by their places in the machine file), one after the other; `stopped` is asked meanwhile.
///
/// # Errors
/// [`HomingError`]; whatever moves is brought to rest first.
pub fn home(
    machine: &Machine,
    drives: &mut [Attached],
    axes: &[usize],
    stopped: &dyn Fn() -> bool,
) -> Result<(), HomingError> {
    for index in axes {
        let Some(axis) = machine.axes.get(*index) else { continue };
        let device = axis.drive.as_ref().map(|drive| drive.device);
        let attached = drives.iter_mut().find(|attached| Some(attached.device) == device);
        let Some(attached) = attached else { continue };
        let slot = machine.axes_of(attached.device).position(|(of, _)| of == *index);
        let Some(slot) = slot.filter(|slot| *slot < MAX_DRIVE_AXES) else { continue };
        let drive = &mut *attached.drive;
        let name = || axis.name.clone();
        let why = match one(drive, (axis, slot), stopped) {
            Ok(Ended::Home) => continue,
            Ok(Ended::NotHome) => HomingError::NotHome { axis: name() },
            Ok(Ended::Stopped) => HomingError::Stopped { axis: name() },
            Ok(Ended::TooFar) => {
                let way = axis.from_si(way_in_all(axis) / axis.increments_per_si().abs());
                HomingError::TooFar { axis: name(), way, unit: axis.unit() }
            }
            Ok(Ended::TooLong) => {
                HomingError::TooLong { axis: name(), patience_s: patience_s(axis) }
            }
            Err(source) => HomingError::Drive { axis: name(), source: Box::new(source) },
        };
        return Err(match drive.soft_stop().or_else(|_| drive.hard_stop()) {
            Ok(()) => {
                let found = drive.probe(&Still(Clock::start())).ok();
                match found.and_then(|sample| position(axis, slot, &sample.position)) {
                    Some(at) => HomingError::AtRest { why: Box::new(why), at, unit: axis.unit() },
                    None => why,
                }
            }
            Err(source) => {
                let (why, source) = (why.to_string(), Box::new(source));
                HomingError::NotStopped { axis: name(), why, source }
            }
        });
    }
    Ok(())
}

enum Ended {
    Home,
    NotHome,
    Stopped,
    TooFar,
    TooLong,
}

/// How far an axis has gone, out and back.
struct Way {
    last: i64,
    gone: f64,
    /// Between two looks; more than that is another zero, not a way.
    most: f64,
}

impl Way {
    fn seen(&mut self, position: i64) {
        #[expect(clippy::cast_precision_loss, reason = "counters have 32 bits")]
        let step = position.abs_diff(self.last) as f64;
        self.last = position;
        if step <= self.most {
            self.gone += step;
        }
    }
}

fn one(
    drive: &mut dyn Drive,
    (axis, slot): (&Axis, usize),
    stopped: &dyn Fn() -> bool,
) -> Result<Ended, DriveError> {
    let clock = Clock::start();
    let stream = Still(clock);
    let mut ways: HomingWays = [None; MAX_DRIVE_AXES];
    if let Some(way) = ways.get_mut(slot) {
        *way = Some(longest_way(axis));
    }
    drive.enable()?;
    let at = |sample: &Sample| sample.position.get(slot).copied().unwrap_or_default();
    let last = at(&drive.sample(&stream)?);
    let mut way = Way { last, gone: 0.0, most: f64::from(longest_way(axis)) };
    drive.begin_homing(&ways)?;
    #[expect(clippy::cast_possible_truncation, reason = "minutes")]
    let deadline_ns = clock.now_ns() + (1e9 * patience_s(axis)) as i64;
    loop {
        if stopped() {
            return Ok(Ended::Stopped);
        }
        let sample = drive.sample(&stream)?;
        way.seen(at(&sample));
        if sample.moving && way.gone > way_in_all(axis) {
            return Ok(Ended::TooFar);
        }
        if sample.moving && clock.now_ns() > deadline_ns {
            return Ok(Ended::TooLong);
        }
        if !sample.moving {
            let homed = drive.homed()?.get(slot).copied().flatten();
            return Ok(if homed == Some(true) { Ended::Home } else { Ended::NotHome });
        }
    }
}

/// Longest way of an axis to its home, increments.
pub fn longest_way(axis: &Axis) -> u32 {
    let [low, high] = axis.position_limits;
    let way = ((high - low) * axis.increments_per_si()).abs() * FURTHER;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
    let way = way.ceil().clamp(1.0, f64::from(i32::MAX)) as u32;
    way
}

/// Longest way of an axis during homing, out and back, increments.
pub fn way_in_all(axis: &Axis) -> f64 {
    IN_ALL * f64::from(longest_way(axis))
}

/// How long homing an axis may take, s.
fn patience_s(axis: &Axis) -> f64 {
    let slowest = (SLOWEST * axis.max_velocity * axis.increments_per_si()).abs();
    LONGEST_REST + way_in_all(axis) / slowest.max(1.0)
}

/// The command that homes an axis by hand; `None` if it has no drive.
pub fn home_by_hand(machine: &Machine, axis: &Axis) -> Option<String> {
    let place = axis.drive.as_ref()?;
    let device = machine.drives.get(place.device)?;
    let command = repair_commands::command(machine, place.device, place.index)?;
    Some(match device.family() {
        DriveFamily::InterpCnc(_) => {
            let (name, stroke) = (device.axis_name(place.index), longest_way(axis));
            format!("{command} home {name} --max-stroke {stroke}")
        }
        DriveFamily::SmartDrive(_) => format!("{command} home"),
        DriveFamily::Bim2Ax(_) => format!("{command} home {}", device.axis_name(place.index)),
        DriveFamily::Other => return None,
    })
}
