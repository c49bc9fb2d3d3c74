//! Limit switches and homing settings of devices, checked against the machine file.
//!
//! Emulated devices are not checked here: they have no switches by default.

use super::Homed;
use super::limits::what_is_left;
use crate::repair_commands;
use crate::startup::device_check::DeviceCheck;
use twin_bim2ax::ModuleAxis;
use twin_bim2ax::protocol::bits::coefficient::{HOME_PLUS, IGNORE_SWITCHES};
use twin_bim2ax::protocol::parameter::{AxisParameter, Parameter};
use twin_drives::{Drive, DriveError, ParameterId};
use twin_interpcnc::BoardAxis;
use twin_interpcnc::protocol::parameters::{
    HOME_SLOW_SPEED, home_direction, home_input, home_speed, limit_input,
};
use twin_machine::{Axis, DriveFamily, Machine, Switches};
use twin_smartdrive::protocol::parameters::POSITION_OFFSET;

/// The sign of a direction.
fn sign(positive: bool) -> char {
    if positive { '+' } else { '-' }
}

/// The key of the machine file that would say what a device has of limit switches, towards smaller positions and larger ones.
fn ends(limits: [bool; 2]) -> &'static str {
    match limits {
        [false, false] => "none",
        [true, false] => "negative",
        [false, true] => "positive",
        [true, true] => "both",
    }
}

/// What the machine file says of an axis.
fn said(axis: &Axis) -> (Switches, bool) {
    axis.drive
        .as_ref()
        .map_or((Switches::default(), false), |drive| (drive.switches, drive.reversed()))
}

impl DeviceCheck<'_> {
    /// Limit switches and homing, axis by axis.
    pub(super) fn switches(
        &mut self,
        machine: &Machine,
        (device, drive): (usize, &mut dyn Drive),
    ) -> Result<(), DriveError> {
        let Some(entry) = machine.drives.get(device) else { return Ok(()) };
        for (index, axis) in self.axes.clone() {
            let who = self.who_homes(index);
            let Some(place) = axis.drive.as_ref().filter(|_| who != Homed::Emulated) else {
                continue;
            };
            match entry.family() {
                DriveFamily::InterpCnc(_) => {
                    let Some(on_board) = BoardAxis::ALL.get(place.index) else { continue };
                    let at = (machine, device, *on_board);
                    self.board_limits(axis, at, drive)?;
                    self.board_homing(axis, at, (drive, who == Homed::First))?;
                }
                DriveFamily::SmartDrive(_) => {
                    let address = u8::try_from(place.index).unwrap_or(0);
                    self.drive_origin(axis, (machine, device, address), drive)?;
                }
                DriveFamily::Bim2Ax(_) => {
                    let Some(on_module) = ModuleAxis::ALL.get(place.index) else { continue };
                    self.module_switches(axis, (machine, device, *on_module), drive)?;
                }
                DriveFamily::Other => {}
            }
        }
        Ok(())
    }

    /// Parameters 104 to 123: input 0 means none.
    fn board_limits(
        &mut self,
        axis: &Axis,
        (machine, device, on_board): (&Machine, usize, BoardAxis),
        drive: &mut dyn Drive,
    ) -> Result<(), DriveError> {
        let (switches, reversed) = said(axis);
        let name = &axis.name;
        let mut inputs = [0; 2];
        let mut known = Vec::new();
        for (positive, input) in [false, true].into_iter().zip(&mut inputs) {
            // Which of the board's ends that is.
            let number = limit_input(on_board, positive != reversed);
            let mut value = |number| drive.parameter(ParameterId { address: 0, number });
            *input = value(number)?;
            if *input != 0 {
                let contact = if value(number + 1)? == 0 { "NO" } else { "NC" };
                known.push(format!("{} at IN{input}, {contact}", sign(positive)));
            }
        }
        let found = inputs.map(|input| input != 0);
        let mut has = format!("axis {name}: limit switches {}", known.join(" and "));
        if known.is_empty() {
            has = format!("axis {name}: the board knows no limit switch for it");
        }
        if let Some(wanted) = switches.limits.filter(|wanted| *wanted != found) {
            let message = format!("{has}; `limit_switches` is \"{}\"", ends(wanted));
            let mut help = Vec::new();
            for (positive, (wanted, found)) in
                [false, true].into_iter().zip(wanted.into_iter().zip(found))
            {
                let number = limit_input(on_board, positive != reversed);
                let id = ParameterId { address: 0, number };
                if wanted && !found {
                    let command = repair_commands::set_to(machine, device, id, "N");
                    help.extend(command.map(|set| format!("{set}, where N is its input")));
                } else if found && !wanted {
                    help.extend(repair_commands::set(machine, device, id, 0));
                }
            }
            let file = machine.path.display();
            help.push(format!(
                "or `limit_switches = \"{}\"` of axis {name} in {file}",
                ends(found)
            ));
            self.add_with(false, message, help);
            return Ok(());
        }
        if found == [true, true] {
            self.add(true, format!("{has}; no software limits in the board"));
        } else if axis.limited {
            let left = what_is_left(axis);
            self.note(format!("{has}, and it has no software limits: {left}"), Vec::new());
        } else {
            self.add(true, format!("{has}; no software limits, as in the machine file"));
        }
        Ok(())
    }

    /// Direction and speeds of command 71, of an axis that is homed by it or of which the machine file says how.
    fn board_homing(
        &mut self,
        axis: &Axis,
        (machine, device, on_board): (&Machine, usize, BoardAxis),
        (drive, first): (&mut dyn Drive, bool),
    ) -> Result<(), DriveError> {
        let (switches, reversed) = said(axis);
        let id = |number| ParameterId { address: 0, number };
        let mut value = |number| drive.parameter(id(number));
        let input = value(home_input(on_board))?;
        if input == 0 && !first && switches.home_positive.is_none() {
            return Ok(());
        }
        let (name, unit) = (&axis.name, axis.unit());
        let positive = (value(home_direction(on_board))? == 1) != reversed;
        let speeds = [home_speed(on_board), HOME_SLOW_SPEED];
        let [fast, slow] = [value(home_speed(on_board))?, value(HOME_SLOW_SPEED)?];
        #[expect(clippy::cast_precision_loss, reason = "parameters have 32 bits")]
        let per_s = |steps: i64| axis.from_si(steps as f64 / axis.increments_per_si().abs());
        let before = self.looked.checks.len();
        if let Some(wanted) = switches.home_positive.filter(|wanted| *wanted != positive) {
            let message = format!(
                "axis {name}: the board homes it towards {}; `home_direction` says {}",
                sign(positive),
                sign(wanted)
            );
            let value = i64::from(wanted != reversed);
            let mut help =
                repair_commands::set(machine, device, id(home_direction(on_board)), value);
            let found = if positive { "positive" } else { "negative" };
            let file = machine.path.display();
            help.push(format!("or `home_direction = \"{found}\"` of axis {name} in {file}"));
            self.add_with(false, message, help);
        }
        // What the axis can do at most, whatever it is for.
        let most = axis.from_si(axis.max_velocity);
        for ((number, steps), what) in speeds
            .into_iter()
            .zip([fast, slow])
            .zip(["towards its home switch", "off its home switch"])
        {
            let speed = per_s(steps);
            #[expect(clippy::cast_possible_truncation, reason = "at most 200 kHz")]
            let possible = (axis.max_velocity * axis.increments_per_si()).abs().floor() as i64;
            if speed > most * (1.0 + 1e-9) {
                let message = format!(
                    "axis {name}: the board moves it {what} at {speed:.3} {unit}/s ({steps} steps/s); its max_velocity is {most:.3} {unit}/s"
                );
                self.add_with(
                    false,
                    message,
                    repair_commands::set(machine, device, id(number), possible),
                );
            } else if steps == 0 && first {
                let message =
                    format!("axis {name} needs homing, and the board's speed {what} is 0 steps/s");
                let command = repair_commands::set_to(machine, device, id(number), "N");
                let help =
                    command.map(|set| format!("{set}, where N is its speed, {possible} at most"));
                self.add_with(false, message, help.into_iter().collect());
            }
        }
        if self.looked.checks.len() == before && input != 0 {
            let (sign, fast, slow) = (sign(positive), per_s(fast), per_s(slow));
            let message = format!(
                "axis {name}: homes towards {sign} at {fast:.3} {unit}/s, to its switch at IN{input}, and off it at {slow:.3} {unit}/s"
            );
            self.add(true, message);
        }
        Ok(())
    }

    /// `App_PosOffset`: what the drive counts where homing has found its switch. The machine file has no key for it: it says what
    /// is wanted of the axis by its limits.
    fn drive_origin(
        &mut self,
        axis: &Axis,
        (machine, device, address): (&Machine, usize, u8),
        drive: &mut dyn Drive,
    ) -> Result<(), DriveError> {
        let id = ParameterId { address, number: POSITION_OFFSET };
        let (name, unit) = (&axis.name, axis.unit());
        let (switches, _) = said(axis);
        if switches != Switches::default() {
            let message = format!(
                "axis {name}: its drive does not report which switches it has and where it homes to (CfgHome, which the manual does not \
                 explain): `limit_switches` and `home_direction` cannot be checked"
            );
            self.note(message, Vec::new());
        }
        let offset = drive.parameter(id)?;
        if offset == 0 {
            return Ok(());
        }
        #[expect(clippy::cast_precision_loss, reason = "parameters have 32 bits")]
        let home = axis.counting().map_or(0.0, |counting| counting.si(offset as f64));
        let [least, most] = axis.position_limits;
        let message = format!(
            "axis {name}: App_PosOffset is {offset} µsteps: where its home switch opens it counts {:.4} {unit}, not 0",
            axis.from_si(home)
        );
        let help = repair_commands::set(machine, device, id, 0);
        if axis.limited && !(least..=most).contains(&home) {
            let [least, most] = [least, most].map(|limit| axis.from_si(limit));
            let wanted = format!("its limits are {least:.4} … {most:.4} {unit}");
            self.add_with(false, format!("{message}; {wanted}"), help);
        } else {
            self.note(message, help);
        }
        Ok(())
    }

    /// Bits 1 and 4 of the coefficient.
    fn module_switches(
        &mut self,
        axis: &Axis,
        (machine, device, on_module): (&Machine, usize, ModuleAxis),
        drive: &mut dyn Drive,
    ) -> Result<(), DriveError> {
        let parameter = Parameter::Axis(AxisParameter::Coefficient, on_module);
        let Some(number) = parameter.number() else { return Ok(()) };
        let id = ParameterId { address: 0, number };
        let bits = drive.parameter(id)?;
        let (switches, reversed) = said(axis);
        let (name, file) = (&axis.name, machine.path.display());
        let has = |bit: u16| bits & i64::from(bit) != 0;
        // One command after the other, each with what those before it have set.
        let mut set_to = bits;
        let mut flipped = |bit: u16| {
            set_to ^= i64::from(bit);
            repair_commands::set(machine, device, id, set_to)
        };
        let positive = has(HOME_PLUS) != reversed;
        if let Some(wanted) = switches.home_positive.filter(|wanted| *wanted != positive) {
            let message = format!(
                "axis {name}: the module homes it towards {} (coefficient bit 1); `home_direction` says {}",
                sign(positive),
                sign(wanted)
            );
            let mut help = flipped(HOME_PLUS);
            let found = if positive { "positive" } else { "negative" };
            help.push(format!("or `home_direction = \"{found}\"` of axis {name} in {file}"));
            self.add_with(false, message, help);
        }
        let wanted = switches.limits.map(|limits| limits.contains(&true));
        match (wanted, has(IGNORE_SWITCHES)) {
            (Some(true), true) => {
                let message = format!(
                    "axis {name}: the module ignores its end switches (coefficient bit 4); `limit_switches` says that it has them"
                );
                let mut help = flipped(IGNORE_SWITCHES);
                help.push(format!("or `limit_switches = \"none\"` of axis {name} in {file}"));
                self.add_with(false, message, help);
            }
            (Some(false), false) => {
                // An input without a switch says "on it" or nothing, by coefficient bit 14: what it says is looked at later.
                let message = format!(
                    "axis {name}: the module looks at end switches (coefficient bit 4 is 0), which `limit_switches` says it has not"
                );
                self.note(message, flipped(IGNORE_SWITCHES));
            }
            (_, true) => {
                let message = format!(
                    "axis {name}: the module ignores its end switches (coefficient bit 4); beyond its software limits, which count once it is homed, nothing stops it"
                );
                self.note(message, Vec::new());
            }
            (_, false) => {}
        }
        Ok(())
    }
}
