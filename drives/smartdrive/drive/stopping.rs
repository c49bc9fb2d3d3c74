//! Soft and hard stop of all drives of a line, by broadcast.

use tokio::time::sleep;

use super::{SmartDriveBus, no_clock};
use crate::{Command, Mode};
use twin_drives::DriveError;

impl SmartDriveBus {
    /// Sends what stops to all drives of the line, as often as is set: nobody confirms it.
    fn broadcast_stop(&mut self, stop: &Command) -> Result<(), DriveError> {
        for _ in 0..self.bus.options().stop_broadcasts {
            self.runtime.block_on(self.bus.broadcast(stop))?;
        }
        Ok(())
    }

    /// STOP: all drives brake as fast as they may and hold their positions.
    pub(super) fn stop_softly(&mut self) -> Result<(), DriveError> {
        self.restart();
        let stop = Command::Stop { rate: 0 };
        let late = self.bus.is_late();
        self.broadcast_stop(&stop)?;
        if late {
            // A move that was sent before the stop may arrive after it.
            let worst_latency = self.bus.options().worst_latency;
            self.runtime.block_on(async { sleep(worst_latency).await });
            self.broadcast_stop(&stop)?;
        }
        self.wait_for_rest(stop.action())
    }

    /// After a [`twin_drives::Drive::soft_stop`] that some drives have confirmed: MODE 0 to those in use that have not, and the others
    /// keep their current, for what hangs on them would fall. Else MODE 0 to all drives of the line, also those not in use.
    /// Then asks until those are off.
    pub(super) fn stop_hard(&mut self) -> Result<(), DriveError> {
        let standing = std::mem::take(&mut self.standing);
        self.restart();
        let off = Command::Mode(Some(Mode::Off));
        let addresses: Vec<u8> =
            self.axes().filter(|address| !standing.contains(address)).collect();
        if standing.is_empty() || addresses.is_empty() {
            self.broadcast_stop(&off)?;
        } else {
            for address in &addresses {
                // Whether it has been heard is asked below.
                drop(self.runtime.block_on(self.bus.send(*address, &off, &no_clock)));
            }
        }
        let addresses = if addresses.is_empty() { standing } else { addresses };
        let mut failed = None;
        for address in addresses {
            // Every drive is tried, whatever the others say.
            if let Err(error) = self.switched_off(address, &off) {
                failed.get_or_insert(error);
            }
        }
        failed.map_or(Ok(()), Err)
    }
}
