//! One move of one drive from its start to its end.

use std::time::Duration;

use tokio::time::{sleep, timeout};

use super::requests::LOOK;
use crate::{Command, DriveState, Fault, SmartDrive, TrajectoryFlags};
use twin_drives::{Action, Axes, DriveError};

impl SmartDrive {
    /// Waits until a drive does not move any more; its state then.
    ///
    /// # Errors
    /// As [`SmartDrive::send`]; [`DriveError::Unfinished`] if it still moves after `patience`.
    pub async fn rested(
        &mut self,
        address: u8,
        patience: Duration,
    ) -> Result<DriveState, DriveError> {
        let resting = async {
            loop {
                let (state, _) = self.state(address, &|| 0).await?;
                if !state.moving() && self.witness(address, &Command::Ping).await? {
                    return Ok(state);
                }
                sleep(LOOK).await;
            }
        };
        let outcome = timeout(patience, resting).await;
        outcome.unwrap_or_else(|_| {
            Err(DriveError::Unfinished { at: self.at(address, Action::ReadState), patience })
        })
    }

    /// GOTO, and waits until the drive rests there. Speed and rate are as for [`SmartDrive::go_to`].
    ///
    /// # Errors
    /// As [`SmartDrive::go_to`] and [`SmartDrive::rested`]; [`Fault::Alarm`], [`DriveError::Stalled`] or
    /// [`DriveError::NotArrived`] if it does not get there.
    pub async fn travel(
        &mut self,
        address: u8,
        target: i32,
        profile: Option<(u16, u16)>,
        patience: Duration,
    ) -> Result<(), DriveError> {
        self.go_to(address, target, profile).await?;
        let state = self.rested(address, patience).await?;
        let at = self.at(address, Command::GoTo { target, profile }.action());
        if !state.alarms.is_empty() {
            return Err(Fault::Alarm(state.alarms).at(at));
        }
        if state.flags.contains(TrajectoryFlags::STALLED) {
            return Err(DriveError::Stalled { at });
        }
        if state.position == target {
            return Ok(());
        }
        let (target, found) = (target.into(), state.position.into());
        Err(DriveError::NotArrived { at, axis: Axes::Only, target, found })
    }
}
