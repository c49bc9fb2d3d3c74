//! Device check: the start-up steps of one device.

use super::parameters::{Must, wanted};
use super::{Check, Homed, Looked, Needs, Still, Verdict, home_by_hand, position};
use crate::clock::Clock;
use crate::repair_commands;
use crate::troubleshooting::{RELEASE, advice_in_run};
use std::time::Duration;
use twin_bim2ax::Fault;
use twin_drives::{Drive, DriveError, Increments, ParameterInfo, SetpointStream};
use twin_machine::{Axis, DriveFamily, Machine};

/// What is said of an axis that is homed by the user's word alone and counts 0: its device may have lost its position since.
const ZERO: &str = "; it counts 0, as after it was switched on, reset, saved or unlocked: if it was, home it again";

/// Time between two looks at axes that move.
const MOVING_LOOK: Duration = Duration::from_millis(50);

pub(super) struct DeviceCheck<'a> {
    name: &'a str,
    /// Wanted.
    firmware: Option<&'a str>,
    /// An InterpCNC: of homing it keeps that it has failed.
    is_board: bool,
    /// With their places in the machine file.
    pub(super) axes: Vec<(usize, &'a Axis)>,
    pub(super) needs: &'a [Needs],
    pub(super) looked: Looked,
}

impl<'a> DeviceCheck<'a> {
    pub(super) fn new(machine: &'a Machine, device: usize, needs: &'a [Needs]) -> Self {
        let entry = machine.drives.get(device);
        let axes = machine.axes_of(device).collect();
        let name = entry.map_or("", |entry| &entry.name);
        let firmware = entry.and_then(|entry| entry.firmware.as_deref());
        let is_board =
            entry.is_some_and(|entry| matches!(entry.family(), DriveFamily::InterpCnc(_)));
        Self { name, firmware, is_board, axes, needs, looked: Looked::default() }
    }

    pub(super) fn add(&mut self, passed: bool, message: String) {
        self.add_with(passed, message, Vec::new());
    }

    /// Adds a note about a missing ability of the device, or about facts that only the user can judge.
    pub(super) fn note(&mut self, message: String, help: Vec<String>) {
        self.looked.checks.push(Check { verdict: Verdict::Note, message, help });
    }

    /// Homing state of an axis, by its place in the machine file, as given by the user or the program.
    pub(super) fn who_homes(&self, index: usize) -> Homed {
        self.needs.get(index).map_or(Homed::Unknown, |needs| needs.homed)
    }

    /// With what can be done about it.
    pub(super) fn add_with(&mut self, passed: bool, message: String, help: Vec<String>) {
        let verdict = if passed { Verdict::Passed } else { Verdict::Failed };
        let message = if passed { message } else { format!("device `{}`: {message}", self.name) };
        self.looked.checks.push(Check { verdict, message, help });
    }

    pub(super) fn failed(&mut self, error: &DriveError) {
        let help = advice_in_run(error).map(|advice| format!("help: {advice}"));
        self.add_with(false, error.to_string(), help.into_iter().collect());
    }

    /// All steps of the start-up: identity, parameters, limits, whether it may be enabled, whether it is homed.
    ///
    /// # Errors
    /// If the device does not answer as it should; the later steps are left out then. A value that is not as it must be is
    /// a failed check.
    pub(super) fn look(
        &mut self,
        machine: &Machine,
        index: usize,
        drive: &mut dyn Drive,
    ) -> Result<(), DriveError> {
        let stream = Still(Clock::start());
        self.identity(machine, drive)?;
        self.parameters(machine, (index, drive))?;
        self.stored_line((machine, index), drive)?;
        self.limits(machine, (index, drive))?;
        self.switches(machine, (index, drive))?;
        self.may_be_enabled((machine, index), drive, stream)?;
        self.homed(machine, drive, stream)?;
        if let Some(position) = self.looked.position {
            self.positions(&position);
        }
        self.round(drive);
        Ok(())
    }

    /// Checks that the device can be enabled, and the positions of its axes.
    fn may_be_enabled(
        &mut self,
        (machine, device): (&Machine, usize),
        drive: &mut dyn Drive,
        stream: Still,
    ) -> Result<(), DriveError> {
        self.signals(drive, stream)?;
        match drive.probe(&stream) {
            Ok(sample) => {
                self.looked.position = Some(sample.position);
                if sample.moving {
                    self.moves_already(machine, device, (drive, stream), &sample.position);
                }
                Ok(())
            }
            // Each of them has been reported with all other faults.
            Err(
                DriveError::Parameter { .. }
                | DriveError::EnableOpen { .. }
                | DriveError::Setting { .. },
            ) if self.looked.checks.iter().any(Check::has_failed) => Ok(()),
            Err(error) => Err(error),
        }
    }

    /// Which axes move by themselves: those whose position differs a moment later.
    fn moves_already(
        &mut self,
        machine: &Machine,
        device: usize,
        (drive, stream): (&mut dyn Drive, Still),
        before: &Increments,
    ) {
        std::thread::sleep(MOVING_LOOK);
        let after = drive.probe(&stream).map_or(*before, |sample| sample.position);
        let slots = self.axes.clone().into_iter().zip(before.iter().zip(&after)).enumerate();
        let mut moving: Vec<_> = slots
            .filter(|(_, (_, (before, after)))| before != after)
            .filter_map(|(slot, ((_, axis), _))| {
                let at = position(axis, slot, &after)?;
                Some(format!("axis {} moves already, at {at:.3} {}", axis.name, axis.unit()))
            })
            .collect();
        if moving.is_empty() {
            moving.push("an axis moves already".to_owned());
        }
        let command = repair_commands::command(machine, device, self.first_address());
        let stop = command.map(|command| format!("stop it: {command} stop"));
        let message = format!("{}: {}", drive.describe(), moving.join("; "));
        self.add_with(false, message, stop.into_iter().collect());
    }

    /// The address of the first axis's drive, where each has its own.
    fn first_address(&self) -> usize {
        self.axes.first().and_then(|(_, axis)| axis.drive.as_ref()).map_or(0, |place| place.index)
    }

    fn identity(&mut self, machine: &Machine, drive: &mut dyn Drive) -> Result<(), DriveError> {
        let identity = drive.identity()?;
        self.add(true, format!("connected: {identity}"));
        let Some(wanted) = self.firmware else { return Ok(()) };
        for unit in &identity.units {
            if unit.firmware.as_deref() == Some(wanted) {
                continue;
            }
            let found = unit.firmware.as_deref().unwrap_or("not reported by the device");
            let station = if unit.address == 0 {
                String::new()
            } else {
                format!("address {}: ", unit.address)
            };
            let message = format!("{station}the firmware is {found}; {wanted} is wanted");
            let (name, file) = (self.name, machine.path.display());
            let key = unit.firmware.as_ref().map(|found| {
                format!("or `firmware = \"{found}\"` of [[drives]] \"{name}\" in {file}")
            });
            self.add_with(false, message, key.into_iter().collect());
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
            let unit = match unit.chars().next() {
                None => String::new(),
                Some(first) if first.is_ascii_digit() => format!(" × {unit}"),
                Some(_) => format!(" {unit}"),
            };
            let whose = one.axis.as_ref().map_or(String::new(), |axis| format!("axis {axis}: "));
            let value = match one.must {
                Must::Be(value) => format!("{value}{unit} is wanted"),
                Must::BeAtLeast(value) | Must::BeAtLeastOrZero(value) => {
                    format!("at least {value}{unit} is wanted")
                }
                Must::Have(bits) => format!("a number with the bits {bits:04X}h is wanted"),
            };
            let message = format!("{whose}{} ({name}) is {found}{unit}; {value}", one.id);
            self.add_with(false, message, one.help(machine, index, found));
        }
        if right == wanted.len() {
            self.add(true, format!("parameters: {right} of {right} as the machine file has them"));
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
                self.add_with(false, message, vec![format!("help: {RELEASE}")]);
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

    /// Checks that homed axes are within their limits; positions of others mean nothing yet.
    fn positions(&mut self, found: &Increments) {
        for (slot, (index, axis)) in self.axes.clone().into_iter().enumerate() {
            let who = self.who_homes(index);
            let home = !matches!(who, Homed::First | Homed::Emulated);
            let Some(at) = position(axis, slot, found).filter(|_| axis.limited && home) else {
                continue;
            };
            let slack = axis.from_si(2.5 / axis.increments_per_si().abs());
            let [least, most] = axis.position_limits.map(|limit| axis.from_si(limit));
            if at < least - slack || at > most + slack {
                let (name, unit) = (&axis.name, axis.unit());
                let wanted = format!(
                    "its software limits are {least:.4} … {most:.4} {unit}; home it, or `jog` it back inside"
                );
                self.add(false, format!("axis {name}: it is at {at:.4} {unit}; {wanted}"));
            }
        }
    }

    /// A board that is to home an axis and does not know where its switch is.
    fn no_home_switch(&mut self, machine: &Machine, axis: &Axis) {
        let name = &axis.name;
        let message = format!("axis {name} needs homing, and the board has no home switch for it");
        let help = axis.drive.as_ref().and_then(|place| {
            let command = repair_commands::command(machine, place.device, place.index)?;
            let device = machine.drives.get(place.device)?;
            let of_board = device.axis_name(place.index).to_lowercase();
            Some(format!("set it: {command} set home-input-{of_board} N, where N is its input"))
        });
        self.add_with(false, message, help.into_iter().collect());
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
            Err(error) if matches!(error.fault(), Some(Fault::AxisMessages { .. })) => (true, None),
            Ok(sample) => (true, Some(sample.position)),
            Err(error) => return Err(error),
        };
        let switches = drive.signals(&|| stream.now_ns())?.axes.map(|axis| axis.home);
        for (slot, ((index, axis), known)) in self.axes.clone().into_iter().zip(known).enumerate() {
            let who = self.who_homes(index);
            let name = &axis.name;
            if who == Homed::First && self.is_board && switches.get(slot) == Some(&None) {
                self.no_home_switch(machine, axis);
                continue;
            }
            let message = match (who, known) {
                (Homed::Emulated, _) => continue,
                (Homed::First, _) => format!("axis {name}: will be homed first"),
                (_, Some(true)) => format!("axis {name}: homed"),
                (Homed::Said, None) if obeys => {
                    let counts = counts.and_then(|counts| counts.get(slot).copied());
                    let message = format!(
                        "axis {name}: homed according to --homed; the device cannot report it"
                    );
                    if counts == Some(0) {
                        self.looked.doubtful.push(name.clone());
                        self.note(message + ZERO, Vec::new());
                        continue;
                    }
                    message
                }
                (_, known) => {
                    let why = match (known, obeys) {
                        (Some(_), _) if self.is_board => {
                            "not homed: the board says that homing has failed"
                        }
                        (Some(_), _) => "not homed",
                        (None, false) => "not homed: its device has been locked or off",
                        (None, true) => {
                            "whether it is homed is unknown, as its device does not store that; if it is, add --homed"
                        }
                    };
                    let by_hand = home_by_hand(machine, axis).unwrap_or_default();
                    let message = format!("axis {name}: {why}; `{by_hand}` homes it, or --home");
                    self.add(false, message);
                    continue;
                }
            };
            self.add(true, message);
        }
        Ok(())
    }
}
