//! What must be known of drives before they move, in the order of an axis group's start-up: connected, who they are, their
//! parameters against the machine file, their limits, that they may be enabled, and that they are homed.

mod homing;
mod parameters;

use crate::clock::Clock;
use crate::hardware::Attached;
use crate::machine::{Axis, DeviceEntry, Machine};
pub use homing::{HomingError, home, home_by_hand, longest_way, way_in_all};
use parameters::{Must, wanted};
use std::fmt;
use twin_drives::{
    Drive, DriveError, IncrementMotion, Increments, MAX_DRIVE_AXES, ParameterInfo, SetpointStream,
};

/// What is said of an axis that is homed by the user's word alone and counts 0: its device may have lost its position since.
const ZERO: &str = "; it counts 0, as after it was switched on, reset, saved or unlocked: if it was, home it again";

/// What was looked at, and whether it is as it must be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Check {
    /// Whether it is.
    pub passed: bool,
    /// What was found; if it is not as it must be, also of which device, station, axis and parameter, and what is wanted.
    pub told: String,
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", if self.passed { '✓' } else { '✗' }, self.told)
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
    let axes: Vec<_> = machine.axes_of(attached.device).collect();
    let mut looker = Looker { entry, axes, needs, looked: Looked::default() };
    let drive = &mut *attached.drive;
    // A deadline that is missed is the last word of a device.
    if let Err(error) = looker.all(machine, (attached.device, drive)) {
        looker.failed(&error);
    }
    looker.looked
}

struct Looker<'a> {
    entry: &'a DeviceEntry,
    /// With their places in the machine file.
    axes: Vec<(usize, &'a Axis)>,
    needs: &'a [Needs],
    looked: Looked,
}

impl Looker<'_> {
    fn add(&mut self, passed: bool, told: String) {
        let told = if passed { told } else { format!("device `{}`: {told}", self.entry.name) };
        self.looked.checks.push(Check { passed, told });
    }

    fn failed(&mut self, error: &DriveError) {
        self.add(false, error.to_string());
    }

    fn all(
        &mut self,
        machine: &Machine,
        (index, drive): (usize, &mut dyn Drive),
    ) -> Result<(), DriveError> {
        let stream = Still(Clock::start());
        self.identity(drive)?;
        self.parameters(machine, (index, drive))?;
        self.limits(drive)?;
        self.signals(drive, stream)?;
        match drive.probe(&stream) {
            Ok(sample) => {
                self.looked.position = Some(sample.position);
                if sample.moving {
                    self.add(false, format!("{}: an axis moves already", drive.describe()));
                }
                self.homed(machine, drive, stream)?;
                self.stands(&sample.position);
                Ok(())
            }
            // Each of them is told already, with all others that are wrong.
            Err(DriveError::Parameter { .. } | DriveError::EnableOpen { .. })
                if self.looked.checks.iter().any(|check| !check.passed) =>
            {
                self.homed(machine, drive, stream)
            }
            Err(error) => Err(error),
        }
    }

    fn identity(&mut self, drive: &mut dyn Drive) -> Result<(), DriveError> {
        let identity = drive.identity()?;
        self.add(true, format!("connected: {identity}"));
        let Some(wanted) = &self.entry.firmware else { return Ok(()) };
        for unit in &identity.units {
            if unit.firmware.as_ref() == Some(wanted) {
                continue;
            }
            let found = unit.firmware.as_deref().unwrap_or("not told by the device");
            let station = if unit.station == 0 {
                String::new()
            } else {
                format!("station {}: ", unit.station)
            };
            self.add(false, format!("{station}the firmware is {found}; {wanted} is wanted"));
        }
        Ok(())
    }

    /// Against what the machine file says.
    fn parameters(
        &mut self,
        machine: &Machine,
        (index, drive): (usize, &mut dyn Drive),
    ) -> Result<(), DriveError> {
        let wanted = wanted(machine, index);
        if wanted.is_empty() {
            return Ok(());
        }
        let known = drive.parameters()?;
        let mut right = 0;
        for one in &wanted {
            let found = drive.parameter(one.id)?;
            if one.must.allows(found) {
                right += 1;
                continue;
            }
            let info = known.iter().find(|info| info.id == one.id);
            let name = info.map_or("", |info| &info.name);
            let unit = info.map_or("", |ParameterInfo { unit, .. }| unit);
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            let whose = one.axis.as_ref().map_or(String::new(), |axis| format!("axis {axis}: "));
            let value = match one.must {
                Must::Be(value) => format!("{value}{unit} is wanted"),
                Must::BeAtLeast(value) | Must::BeAtLeastOrZero(value) => {
                    format!("at least {value}{unit} is wanted")
                }
            };
            self.add(false, format!("{whose}{} ({name}) is {found}{unit}; {value}", one.id));
        }
        if right == wanted.len() {
            self.add(true, format!("parameters: {right} of {right} as the machine file has them"));
        }
        Ok(())
    }

    /// Software limits of the device: no wider than those of the machine file, and no tighter than the program.
    fn limits(&mut self, drive: &mut dyn Drive) -> Result<(), DriveError> {
        let limits = drive.limits()?;
        let mut has_limits = false;
        for ((index, axis), limits) in self.axes.clone().into_iter().zip(limits) {
            let name = &axis.name;
            let (Some(low), Some(high)) = (limits.lowest, limits.highest) else { continue };
            has_limits = true;
            let unit = axis.unit();
            let [lowest, highest] = in_units(axis, [low, high]);
            let found = format!(
                "axis {name}: the device's software limits are {lowest:.4} … {highest:.4} {unit}"
            );
            // What rounding to increments makes, and one that lets an axis stand on its limit.
            let slack = 2.5 / axis.increments_per_si().abs();
            let [lowest, highest] = [lowest, highest].map(|limit| axis.to_si(limit));
            let [least, most] = axis.position_limits;
            let too_wide = axis.limited && (lowest < least - slack || highest > most + slack);
            let range = self.needs.get(index).and_then(|needs| needs.range);
            let too_tight =
                range.filter(|[from, to]| lowest > from + slack || highest < to - slack);
            if too_wide {
                let [least, most] = axis.position_limits.map(|limit| axis.from_si(limit));
                let wanted =
                    format!("at least as tight as {least:.4} … {most:.4} {unit} is wanted");
                self.add(false, format!("{found}; {wanted}"));
            } else if let Some(range) = too_tight {
                let [from, to] = range.map(|position| axis.from_si(position));
                self.add(
                    false,
                    format!("{found}; the program goes from {from:.4} to {to:.4} {unit}"),
                );
            } else {
                self.add(true, found);
            }
        }
        if !has_limits {
            self.add(
                true,
                "software limits: those of the machine file, the device has none".to_owned(),
            );
        }
        Ok(())
    }

    fn signals(&mut self, drive: &mut dyn Drive, stream: Still) -> Result<(), DriveError> {
        let signals = drive.signals(&|| stream.now_ns())?;
        match signals.enable {
            Some(true) => self.add(true, "the ENABLE input is closed".to_owned()),
            Some(false) => {
                let message =
                    format!("{}: the ENABLE input is open; closed is wanted", drive.describe());
                self.add(false, message);
            }
            None => {}
        }
        for ((_, axis), of_axis) in self.axes.clone().into_iter().zip(signals.axes) {
            for (on, side) in [(of_axis.positive_limit, '+'), (of_axis.negative_limit, '-')] {
                if on == Some(true) {
                    let message = format!("axis {}: on its {side} limit switch", axis.name);
                    self.add(false, message);
                }
            }
        }
        Ok(())
    }

    /// Axes that are home stand within their limits; where others stand says nothing yet.
    fn stands(&mut self, found: &Increments) {
        for (slot, (index, axis)) in self.axes.clone().into_iter().enumerate() {
            let who = self.needs.get(index).map_or(Homed::Unknown, |needs| needs.homed);
            let home = !matches!(who, Homed::First | Homed::Emulated);
            let Some(at) = position(axis, slot, found).filter(|_| axis.limited && home) else {
                continue;
            };
            let slack = axis.from_si(2.5 / axis.increments_per_si().abs());
            let [least, most] = axis.position_limits.map(|limit| axis.from_si(limit));
            if at < least - slack || at > most + slack {
                let (name, unit) = (&axis.name, axis.unit());
                let wanted = format!("{least:.4} … {most:.4} {unit} is wanted; is it homed?");
                self.add(false, format!("axis {name}: it stands at {at:.4} {unit}; {wanted}"));
            }
        }
    }

    fn homed(
        &mut self,
        machine: &Machine,
        drive: &mut dyn Drive,
        stream: Still,
    ) -> Result<(), DriveError> {
        let known = drive.homed()?;
        // A device that has been off or locked has lost its home; whether it has is known to devices that keep that.
        let (obeys, counts) = match drive.sample(&stream) {
            Err(
                DriveError::Locked { .. } | DriveError::Mode { .. } | DriveError::EnableOpen { .. },
            ) => (false, None),
            Err(DriveError::AxisMessages { .. }) => (true, None),
            Ok(sample) => (true, Some(sample.position)),
            Err(error) => return Err(error),
        };
        for (slot, ((index, axis), known)) in self.axes.clone().into_iter().zip(known).enumerate() {
            let who = self.needs.get(index).map_or(Homed::Unknown, |needs| needs.homed);
            let name = &axis.name;
            let told = match (who, known) {
                (Homed::Emulated, _) => continue,
                (Homed::First, _) => format!("axis {name}: will be homed first"),
                (_, Some(true)) => format!("axis {name}: homed"),
                (Homed::Said, None) if obeys => {
                    let counts = counts.and_then(|counts| counts.get(slot).copied());
                    let zero = if counts == Some(0) { ZERO } else { "" };
                    format!(
                        "axis {name}: homed, as --homed says: by your word, the device cannot tell{zero}"
                    )
                }
                (_, known) => {
                    let why = match (known, obeys) {
                        (Some(_), _) => "not homed",
                        (None, false) => "not homed: its device has been locked or off",
                        (None, true) => {
                            "not known to be homed: its device does not keep that; if it is, --homed says so"
                        }
                    };
                    let by_hand = home_by_hand(machine, axis).unwrap_or_default();
                    let message = format!("axis {name}: {why}; `{by_hand}` homes it, or --home");
                    self.add(false, message);
                    continue;
                }
            };
            self.add(true, told);
        }
        Ok(())
    }
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
