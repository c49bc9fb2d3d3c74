//! Checks of the drives before they move, in the order in which SoftMotion starts an axis group (2.2.2): identity,
//! parameters against the machine file, limits, whether the device may be enabled, whether it is homed.
//!
//! Each device is checked on its own, and all failed checks are reported together. Only a device that does not answer ends
//! its checks early.

mod device_check;
mod homing;
mod limits;
mod line;
mod parameters;
mod switches;
mod way;

use crate::attached::Attached;
use crate::clock::Clock;
use crate::repair_commands;
use device_check::DeviceCheck;
pub use homing::{HomingError, home, home_by_hand, longest_way, way_in_all};
use std::fmt;
use twin_drives::{DriveError, IncrementMotion, Increments, MAX_DRIVE_AXES, SetpointStream};
use twin_kinematics::AxisVector;
use twin_machine::{Axis, Machine};
pub use way::{describe_way, homing_way, plan_way};

/// Verdict of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It is as it must be.
    Passed,
    /// Nothing is wrong, but the device does not do what others do: the user has to know.
    Note,
    /// It is not as it must be: nothing moves.
    Failed,
}

/// Result of a check.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Check {
    /// The verdict.
    pub verdict: Verdict,
    /// The finding; for a failed check also the device, address, axis and parameter concerned, and the required value.
    pub message: String,
    /// Remedies: commands to copy, keys of the machine file, places to look.
    pub help: Vec<String>,
}

impl Check {
    /// True if the check failed, so that nothing may move.
    pub fn has_failed(&self) -> bool {
        self.verdict == Verdict::Failed
    }

    /// Of a device that cannot be spoken to.
    pub fn failed(message: String, help: Option<String>) -> Self {
        Self { verdict: Verdict::Failed, message, help: help.into_iter().collect() }
    }
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mark = match self.verdict {
            Verdict::Passed => '✓',
            Verdict::Note => '!',
            Verdict::Failed => '✗',
        };
        write!(f, "{mark} {}", self.message)?;
        self.help.iter().try_for_each(|line| write!(f, "\n      {line}"))
    }
}

/// Source of the homing state of an axis whose device does not know it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Homed {
    /// Nobody.
    Unknown,
    /// The user.
    Said,
    /// It will be homed before anything else.
    First,
    /// It is emulated: where it has been switched on is its home.
    Emulated,
}

/// Requirements of a program on an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Needs {
    /// Smallest and largest position of the program, m or rad; `None` if it moves nothing.
    pub range: Option<[f64; 2]>,
    /// Source of its homing state.
    pub homed: Homed,
}

/// Results of the start-up checks of one device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Looked {
    /// In the order of the start-up.
    pub checks: Vec<Check>,
    /// Counters of its axes, if they could be read.
    pub position: Option<Increments>,
    /// Axes that are homed only according to the user and count 0, as after their drive was switched on, by name.
    pub doubtful: Vec<String>,
}

/// Set-point stream without a plan, for checks of drives at rest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Still(Clock);

impl Still {
    pub(crate) fn new(clock: Clock) -> Self {
        Self(clock)
    }
}

impl SetpointStream for Still {
    fn now_ns(&self) -> i64 {
        self.0.now_ns()
    }

    fn at(&self, _time_ns: i64) -> IncrementMotion {
        IncrementMotion::default()
    }

    fn horizon_ns(&self) -> i64 {
        0
    }
}

/// Checks a device. Nothing moves and nothing is changed. `needs` are in machine-file order. A device that does not
/// answer is not asked any further.
pub fn look(machine: &Machine, attached: &mut Attached, needs: &[Needs]) -> Looked {
    if machine.drives.get(attached.device).is_none() {
        return Looked::default();
    }
    let mut looker = DeviceCheck::new(machine, attached.device, needs);
    if let Err(error) = looker.look(machine, attached.device, &mut *attached.drive) {
        looker.failed(&error);
    }
    let mut looked = looker.looked;
    say_once(&mut looked.checks);
    looked
}

/// What makes parameters count (a save, a reset) is said once for a device, after all that are to be set.
fn say_once(checks: &mut [Check]) {
    let mut said = Vec::new();
    for check in checks.iter_mut().rev() {
        let mut kept: Vec<String> = check.help.drain(..).rev().collect();
        kept.retain(|line| {
            !line.starts_with(repair_commands::THEN) || {
                let first = !said.contains(line);
                said.push(line.clone());
                first
            }
        });
        check.help.extend(kept.into_iter().rev());
    }
}

/// Counts as positions in the axis's unit, the smaller one first.
fn in_units(axis: &Axis, counts: [i64; 2]) -> [f64; 2] {
    #[expect(clippy::cast_precision_loss, reason = "counters have 32 bits")]
    let [one, other] = counts.map(|count| {
        let counting = axis.counting();
        counting.map_or(0.0, |counting| axis.from_si(counting.si(count as f64)))
    });
    [one.min(other), one.max(other)]
}

/// Positions of all axes of the machine as their devices count them now, m or rad.
///
/// # Errors
/// If a device does not answer.
pub fn positions(machine: &Machine, drives: &mut [Attached]) -> Result<AxisVector, DriveError> {
    let mut positions = AxisVector::zeros(machine.axes.len());
    for attached in drives {
        let found = attached.drive.probe(&Still(Clock::start()))?.position;
        include(machine, attached.device, &found, &mut positions);
    }
    Ok(positions)
}

/// Takes the counters of a device into the positions of the axes of the machine, m or rad.
pub fn include(machine: &Machine, device: usize, found: &Increments, positions: &mut AxisVector) {
    for (slot, (index, axis)) in machine.axes_of(device).enumerate() {
        let counted = position(axis, slot, found).map(|position| axis.to_si(position));
        if let (Some(counted), Some(place)) = (counted, positions.get_mut(index)) {
            *place = counted;
        }
    }
}

/// Position of an axis on a device, by its place among the device's axes, in the axis's unit.
pub fn position(axis: &Axis, slot: usize, found: &Increments) -> Option<f64> {
    let count = *found.get(slot).filter(|_| slot < MAX_DRIVE_AXES)?;
    let [position, _] = in_units(axis, [count, count]);
    Some(position)
}

#[cfg(test)]
mod tests {
    use super::{Check, say_once};

    #[test]
    fn a_device_is_saved_once_after_all_that_is_set() {
        let check = |lines: &[&str]| {
            let mut check = Check::failed(String::new(), None);
            check.help = lines.iter().map(|line| (*line).to_owned()).collect();
            check
        };
        let (save, other) = ("then:   twin --address 1 save", "then:   twin --address 2 save");
        let mut checks = [
            check(&["set it: a 1", save, "or `a`"]),
            check(&["set it: b 2", other]),
            check(&["set it: c 3", "set it: d 4", save]),
            check(&[]),
        ];
        say_once(&mut checks);
        let left: Vec<_> = checks.iter().map(|check| check.help.clone()).collect();
        assert_eq!(left[0], ["set it: a 1", "or `a`"]);
        assert_eq!(left[1], ["set it: b 2", other]);
        assert_eq!(left[2], ["set it: c 3", "set it: d 4", save]);
    }
}
