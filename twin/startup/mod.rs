//! What must be known of drives before they move. Each device goes through the start-up of SoftMotion's axis groups
//! ([`AxisGroup`], 2.2.2): connected, who it is, its parameters against the machine file, its limits, that it may be enabled,
//! and that it is homed.
//!
//! A device is a group of its own: what is wrong with one keeps nobody from looking at the others, and a check that fails is
//! told with all others instead of ending the start-up. Only a device that does not answer ends that of its group.

mod homing;
mod looker;
mod parameters;

use crate::clock::Clock;
use crate::hardware::Attached;
use crate::machine::{Axis, Machine};
pub use homing::{HomingError, home, home_by_hand, longest_way, way_in_all};
use looker::Looker;
use std::fmt;
use twin_drives::axis::{AxisGroup, GroupTask};
use twin_drives::{IncrementMotion, Increments, MAX_DRIVE_AXES, SetpointStream};

/// What was looked at, and whether it is as it must be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Check {
    /// Whether it is.
    pub passed: bool,
    /// What was found; if it is not as it must be, also of which device, address, axis and parameter, and what is wanted.
    pub told: String,
    /// What can be done about it: commands to copy, keys of the machine file, where to look.
    pub help: Vec<String>,
}

impl Check {
    /// Of a device that cannot be spoken to.
    pub fn failed(told: String, help: Option<String>) -> Self {
        Self { passed: false, told, help: help.into_iter().collect() }
    }
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", if self.passed { '✓' } else { '✗' }, self.told)?;
        self.help.iter().try_for_each(|line| write!(f, "\n      {line}"))
    }
}

/// Who says that an axis is homed whose device does not know.
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

/// What a program asks of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Needs {
    /// Smallest and largest position of the program, m or rad; `None` if it moves nothing.
    pub range: Option<[f64; 2]>,
    /// Who says that it is homed.
    pub homed: Homed,
}

/// What was found out about one device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Looked {
    /// In the order of the start-up.
    pub checks: Vec<Check>,
    /// Counters of its axes, if they could be read.
    pub position: Option<Increments>,
}

/// A clock and no plan: for looks at drives that follow nothing.
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

/// Looks at a device. Nothing moves and nothing is changed. `needs` are in machine-file order. A device that does not answer is
/// not asked any further.
pub fn look(machine: &Machine, attached: &mut Attached, needs: &[Needs]) -> Looked {
    let Some(entry) = machine.drives.get(attached.device) else { return Looked::default() };
    let mut group = AxisGroup::new([entry.name.clone()]);
    let mut looker = Looker::new(machine, attached.device, needs);
    while let Some(GroupTask::Start { step, .. }) = group.task() {
        let done = looker.step(step, (machine, attached.device, &mut *attached.drive));
        // A deadline that is missed is the last word of a device.
        group.report(done.map_err(|error| {
            looker.failed(&error);
            error.to_string()
        }));
    }
    looker.looked
}

/// Counts as positions in the axis's unit, the smaller one first.
fn in_units(axis: &Axis, counts: [i64; 2]) -> [f64; 2] {
    #[expect(clippy::cast_precision_loss, reason = "counters have 32 bits")]
    let [one, other] = counts.map(|count| axis.from_si(count as f64 / axis.increments_per_si()));
    [one.min(other), one.max(other)]
}

/// Position of an axis on a device, by its place among the device's axes, in the axis's unit.
pub fn position(axis: &Axis, slot: usize, found: &Increments) -> Option<f64> {
    let count = *found.get(slot).filter(|_| slot < MAX_DRIVE_AXES)?;
    let [position, _] = in_units(axis, [count, count]);
    Some(position)
}
