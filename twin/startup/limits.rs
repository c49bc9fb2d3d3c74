//! Software limits of devices, checked against the machine file and the program.

use super::device_check::DeviceCheck;
use super::in_units;
use crate::repair_commands;
use twin_drives::{DeviceLimits, Drive, DriveError};
use twin_machine::{Axis, DeviceEntry, DriveFamily, Machine};

/// End of a message about a device that does not limit the way of an axis: the limits that remain.
pub(super) fn what_is_left(axis: &Axis) -> String {
    let [least, most] = axis.position_limits.map(|limit| axis.from_si(limit));
    let unit = axis.unit();
    format!(
        "only twin's own limits, {least:.4} … {most:.4} {unit}, keep it from its ends, and no longer than twin runs: a move that was \
         sent goes to its target"
    )
}

impl DeviceCheck<'_> {
    /// Software limits of the device: no wider than those of the machine file, and no tighter than the program.
    pub(super) fn limits(
        &mut self,
        machine: &Machine,
        (device, drive): (usize, &mut dyn Drive),
    ) -> Result<(), DriveError> {
        let limits = drive.limits()?;
        let family = machine.drives.get(device).map(DeviceEntry::family);
        for ((index, axis), limits) in self.axes.clone().into_iter().zip(limits) {
            self.maxima(axis, &limits);
            let name = &axis.name;
            let (Some(low), Some(high)) = (limits.lowest, limits.highest) else {
                // What a board has instead is looked at with its switches.
                if matches!(family, Some(DriveFamily::SmartDrive(_))) {
                    self.without_limits(machine, device, axis);
                }
                continue;
            };
            let unit = axis.unit();
            let [lowest, highest] = in_units(axis, [low, high]);
            let found = format!(
                "axis {name}: the device's software limits are {lowest:.4} … {highest:.4} {unit}"
            );
            // What rounding to increments makes, and one for an axis on its limit.
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
                let help = repair_commands::set_limits(machine, device, axis);
                self.add_with(false, format!("{found}; {wanted}"), help);
            } else if let Some(range) = too_tight {
                let [from, to] = range.map(|position| axis.from_si(position));
                let message = format!("{found}; the program goes from {from:.4} to {to:.4} {unit}");
                self.add_with(false, message, repair_commands::set_limits(machine, device, axis));
            } else {
                self.add(true, found);
            }
        }
        Ok(())
    }

    /// Ramps that are gentler than what a plan may ask for: the axis falls behind it there. Speeds are checked as parameters.
    fn maxima(&mut self, axis: &Axis, limits: &DeviceLimits) {
        let per_unit = axis.increments_per_si() * axis.to_si(1.0);
        let unit = axis.unit();
        let key = axis.own_deceleration().map_or("max_acceleration", |_| "max_deceleration");
        let pairs = [
            ("acceleration", limits.acceleration, "max_acceleration", axis.max_acceleration),
            ("deceleration", limits.deceleration, key, axis.max_deceleration),
        ];
        for (what, device, key, wanted) in pairs {
            let wanted = axis.from_si(wanted);
            let device = device.map(|increments| (increments / per_unit).abs());
            // Ratios are rounded; a limit that is met is not exceeded.
            if let Some(device) = device.filter(|most| wanted > most * (1.0 + 1e-12)) {
                let message = format!(
                    "axis {}: the device's {what} is {device:.1} {unit}/s² at most, and plans use up to {wanted:.1} {unit}/s² ({key}): there the axis lags behind",
                    axis.name
                );
                self.note(message, Vec::new());
            }
        }
    }

    /// Of a drive whose limits are switched off, `Trj_PosMin` not being below `Trj_PosMax`.
    fn without_limits(&mut self, machine: &Machine, device: usize, axis: &Axis) {
        let name = &axis.name;
        if !axis.limited {
            self.add(true, format!("axis {name}: no software limits, as in the machine file"));
            return;
        }
        let left = what_is_left(axis);
        let message = format!(
            "axis {name}: the software limits of its drive are off (Trj_PosMin is not below Trj_PosMax); {left}, or to a limit \
             switch if one is wired to LIMP or LIMN, which the drive does not report"
        );
        let mut help = repair_commands::set_limits(machine, device, axis);
        // The machine file has its limits: those of the drive are to follow, not the other way round.
        help.pop();
        self.note(message, help);
    }
}
