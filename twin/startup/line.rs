//! Stored serial-line settings of a board, checked against the machine file.
//!
//! The stored settings take effect at the next power-up, even if the present connection works with others.

use super::device_check::DeviceCheck;
use crate::repair_commands;
use crate::setpoint::HORIZON_NS;
use twin_drives::{Drive, DriveError, ParameterId};
use twin_interpcnc::{Parity, protocol::parameters};
use twin_machine::{DeviceEntry, DriveFamily, Machine};
use twin_number::seconds;

impl DeviceCheck<'_> {
    /// Checks that the wire carries the cycle, by the turnaround measured in the checks before: every axis must get its next
    /// command before the plan that it knows has ended.
    pub(super) fn round(&mut self, drive: &dyn Drive) {
        let Some(round) = drive.round() else { return };
        let (round_s, longest_s) = (round.as_secs_f64(), seconds(HORIZON_NS));
        if round_s <= longest_s {
            return;
        }
        let message = format!(
            "a round of its {} axes takes {:.0} ms on its wire: it carries {:.1} commands per second for each axis; \
             at least {:.1} are necessary",
            drive.axis_count(),
            1e3 * round_s,
            1.0 / round_s,
            1.0 / longest_s
        );
        let help = "help: a higher baud rate, a faster adapter, or fewer axes on this device";
        self.add_with(false, message, vec![help.to_owned()]);
    }

    /// Checks the stored line settings of a board against the machine file.
    pub(super) fn stored_line(
        &mut self,
        (machine, index): (&Machine, usize),
        drive: &mut dyn Drive,
    ) -> Result<(), DriveError> {
        let Some(DriveFamily::InterpCnc(board)) =
            machine.drives.get(index).map(DeviceEntry::family)
        else {
            return Ok(());
        };
        let mut other = Vec::new();
        let mut help = Vec::new();
        for number in
            [parameters::MODBUS_SPEED, parameters::MODBUS_PARITY, parameters::MODBUS_ADDRESS]
        {
            let id = ParameterId { address: 0, number };
            let stored = drive.parameter(id)?;
            let Ok(code) = u32::try_from(stored) else { continue };
            // (Whether it is the same, what is wanted.) A code that says nothing is none.
            let (same, wanted) = match number {
                parameters::MODBUS_SPEED => {
                    let codes = board.assumptions.baud_code;
                    let same = codes.decode(code).is_none_or(|baud| baud == board.baud);
                    (same, codes.encode(board.baud))
                }
                parameters::MODBUS_PARITY => {
                    let parity = board.parity;
                    let same = Parity::from_code(code).is_none_or(|stored| stored == parity);
                    (same, Some(parity.code()))
                }
                _ => (code == u32::from(board.address), Some(board.address.into())),
            };
            if !same {
                let name = parameters::name(number).unwrap_or(number.to_string());
                other.push(format!("parameter {number} ({name}) is {stored}"));
                let set =
                    wanted.map(|wanted| repair_commands::set(machine, index, id, wanted.into()));
                help.extend(set.unwrap_or_default());
            }
        }
        if !other.is_empty() {
            let message = format!(
                "{}: from the next power-up on it has another line than the machine file",
                other.join(", ")
            );
            self.note(message, help);
        }
        Ok(())
    }
}
