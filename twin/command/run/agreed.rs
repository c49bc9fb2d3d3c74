//! Confirmation before real drives move: start and target positions, speeds, and the effect of one lost answer.

use crate::attached::Attached;
use crate::check::Outcome;
use crate::command::show;
use crate::emulated::CATCH_UP;
use crate::startup;
use crate::startup::way_in_all;
use comfy_table::{Cell, CellAlignment};
use twin_bim2ax::ModuleAxis;
use twin_bim2ax::protocol::parameter::{AxisParameter, Parameter};
use twin_drives::{Increments, ParameterId};
use twin_interpcnc::protocol::parameters as interpcnc;
use twin_interpcnc::protocol::registers::BoardAxis;
use twin_kinematics::AxisVector;
use twin_machine::{Axis, DriveFamily, Machine};
use twin_number::fixed;
use twin_smartdrive::protocol::parameters::VELOCITY_ENTER_HOME;

/// Facts that the user is asked to confirm.
pub(super) struct Asked<'a> {
    pub(super) outcome: &'a Outcome,
    pub(super) start: &'a AxisVector,
    /// Part of its largest velocity that an axis has on its way to the start.
    pub(super) approach: f64,
    /// Homing speed of each axis that is homed, m/s or rad/s, if its device reports one.
    pub(super) homing: Vec<Option<f64>>,
}

/// Homing speeds of the devices, by their own parameters, m/s or rad/s.
pub(super) fn homing_speeds(
    machine: &Machine,
    drives: &mut [Attached],
    to_home: &[usize],
) -> Vec<Option<f64>> {
    let speed = |(index, axis): (usize, &Axis)| {
        let place = axis.drive.as_ref().filter(|_| to_home.contains(&index))?;
        let attached = drives.iter_mut().find(|attached| attached.device == place.device)?;
        let (id, increments) = homing_parameter(machine, axis)?;
        // What cannot be read is shown as not known: homing itself fails then.
        let read = attached.drive.parameter(id).ok()?;
        #[expect(clippy::cast_precision_loss, reason = "parameters have 32 bits")]
        Some(read as f64 * increments / axis.increments_per_si().abs())
    };
    machine.axes.iter().enumerate().map(speed).collect()
}

/// The parameter with the speed of homing, and how many increments/s its unit is.
fn homing_parameter(machine: &Machine, axis: &Axis) -> Option<(ParameterId, f64)> {
    let place = axis.drive.as_ref()?;
    Some(match machine.drives.get(place.device)?.family() {
        DriveFamily::InterpCnc(_) => {
            // The only board of its driver.
            let number = interpcnc::home_speed(*BoardAxis::ALL.get(place.index)?);
            (ParameterId { address: 0, number }, 1.0)
        }
        DriveFamily::SmartDrive(bus) => {
            let address = u8::try_from(place.index).ok()?;
            (ParameterId { address, number: VELOCITY_ENTER_HOME }, bus.turn.steps(1.0))
        }
        DriveFamily::Bim2Ax(module) => {
            // All of it goes at the start-stop speed (5.1).
            let speed = AxisParameter::StartStopSpeed;
            let number = Parameter::Axis(speed, *ModuleAxis::ALL.get(place.index)?).number()?;
            (ParameterId { address: 0, number }, module.mode.speed_unit())
        }
        DriveFamily::Other => return None,
    })
}

/// Table of the axes that will move, with their targets and speeds.
pub(super) fn moves(
    machine: &Machine,
    positions: &[(usize, Option<Increments>)],
    to_home: &[usize],
    asked: &Asked<'_>,
) -> comfy_table::Table {
    let mut table = show::table();
    let header = [
        "axis",
        "device",
        "port",
        "stands at",
        "homing",
        "program starts at",
        "on the way there",
        "program",
    ];
    let homes = !to_home.is_empty();
    table.set_header(header.into_iter().filter(|name| homes || *name != "homing"));
    for (device, found) in positions {
        let Some(entry) = machine.drives.get(*device) else { continue };
        for (slot, (index, axis)) in machine.axes_of(*device).enumerate() {
            let unit = axis.unit();
            let stands = found.and_then(|found| startup::position(axis, slot, &found));
            let mut stands = stands.map_or("?".to_owned(), |at| format!("{} {unit}", fixed(at, 3)));
            if to_home.contains(&index) {
                let way = way_in_all(axis) / axis.increments_per_si().abs();
                stands = format!("{stands}, homes first: {:.1} {unit} at most", axis.from_si(way));
            }
            let begins = asked.start.get(index).copied().unwrap_or_default();
            let speed = |speed: f64| format!("{:.1} {unit}/s", axis.from_si(speed));
            let homing = match asked.homing.get(index) {
                Some(Some(of_device)) => speed(*of_device),
                _ if to_home.contains(&index) => "unknown".to_owned(),
                _ => String::new(),
            };
            let peak = asked.outcome.peaks.get(index).map_or(0.0, |peak| peak.velocity.value);
            let place = axis.drive.as_ref().map_or(0, |drive| drive.index);
            let row = [
                axis.name.clone(),
                format!("{} {}", entry.name, entry.axis_name(place)),
                entry.port.clone().unwrap_or_default(),
                stands,
                homing,
                format!("{} {unit}", fixed(axis.from_si(begins), 3)),
                speed(axis.max_velocity * asked.approach),
                speed(peak),
            ];
            let row = row.into_iter().enumerate().filter(|(column, _)| homes || *column != 4);
            table.add_row(row.map(|(column, text)| {
                let side = if column < 3 { CellAlignment::Left } else { CellAlignment::Right };
                Cell::new(text).set_alignment(side)
            }));
        }
    }
    table
}

/// Largest speed of an axis relative to its plan, in words.
pub(super) fn allowance() -> String {
    format!(
        "an axis that lags behind its set-points may go faster than the program, up to {:.0} % of its largest velocity",
        100.0 * CATCH_UP
    )
}
