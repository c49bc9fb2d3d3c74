//! The module, and how it is stopped.

use super::super::session::{BRAKING, Stopping, no_clock};
use super::Arguments;
use crate::command::Failure;
use std::sync::Arc;
use twin_drives::DriveError;
use twin_drives::bim2ax::zone::Positions;
use twin_drives::bim2ax::{Bim2Ax, ModuleAxis};

/// Position and messages of an axis.
pub(super) fn of(seen: &Positions, axis: ModuleAxis) -> (i32, u16) {
    let index = axis.index();
    let position = seen.positions.get(index).copied().unwrap_or(0);
    (position, seen.messages.get(index).copied().unwrap_or(0))
}

/// The module and its name.
pub(super) struct Module {
    pub(super) driver: Bim2Ax,
    pub(super) port: Arc<str>,
}

impl Module {
    pub(super) fn open(arguments: &Arguments) -> Result<Self, Failure> {
        let (port, memory, options) = arguments.memory()?;
        let driver = Bim2Ax::new(&port, memory, &options);
        Ok(Self { driver, port })
    }

    /// Stops both axes: whatever else is wrong with the module, the order goes out first.
    ///
    /// Read in the other byte order, that to brake says nothing, but that for a hard stop would begin homing: so the first
    /// stop is on the ramps, and a hard one comes after the module has told how it writes its numbers. True if that is
    /// otherwise than it was thought to be.
    pub(super) async fn stop(&mut self, hard: bool) -> Result<bool, DriveError> {
        let braked = self.driver.abandon(&no_clock).await;
        let other = self.driver.adopt_byte_order(&no_clock).await?;
        if other {
            self.driver.abandon(&no_clock).await?;
        } else {
            braked?;
        }
        if hard {
            self.driver.stop_hard(&no_clock).await?;
        }
        self.driver.rested(BRAKING, &no_clock).await?;
        Ok(other)
    }
}

impl Stopping for Module {
    async fn soft_stop(&mut self) -> Result<(), DriveError> {
        self.driver.abandon(&no_clock).await?;
        self.driver.rested(BRAKING, &no_clock).await.map(|_| ())
    }

    async fn hard_stop(&mut self) -> Result<(), DriveError> {
        self.driver.stop_hard(&no_clock).await?;
        self.driver.rested(BRAKING, &no_clock).await.map(|_| ())
    }

    async fn stands(&mut self) -> Result<String, DriveError> {
        let (seen, _) = self.driver.positions(&no_clock).await?;
        let [one, two] = seen.positions;
        Ok(format!("1: {one}, 2: {two}"))
    }
}
