//! One drive of a bus.

use super::super::consent::Consent;
use super::super::session::{BRAKING, RestPosition, Session, Stopping, no_clock};
use std::sync::Arc;
use twin_drives::{Action as Doing, DriveError, Exchange};
use twin_smartdrive::{DriveState, Fault, Mode, SmartDrive};

/// One drive of a bus, with what the command line says about it.
#[derive(Debug)]
pub(in crate::command::drive) struct Axis {
    pub(super) session: Session,
    pub(super) unit: Unit,
    pub(super) consent: Consent,
}

/// One drive of a bus.
#[derive(Debug)]
pub(super) struct Unit {
    pub(super) bus: SmartDrive,
    pub(super) port: Arc<str>,
    pub(super) address: u8,
}

impl Unit {
    pub(super) fn at(&self) -> Exchange {
        Exchange { port: Arc::clone(&self.port), address: self.address, action: Doing::ReadState }
    }

    pub(super) async fn state(&mut self) -> Result<DriveState, DriveError> {
        self.bus.state(self.address, &no_clock).await.map(|(state, _)| state)
    }
}

impl Stopping for Unit {
    async fn soft_stop(&mut self) -> Result<(), DriveError> {
        match self.bus.stop(self.address, 0).await {
            // A drive that is off or in alarm refuses; then it does not move.
            Err(error) if !matches!(error.fault(), Some(Fault::Rejected(_))) => Err(error),
            _ => self.bus.rested(self.address, BRAKING).await.map(|_| ()),
        }
    }

    async fn hard_stop(&mut self) -> Result<(), DriveError> {
        self.bus.set_mode(self.address, Some(Mode::Off)).await
    }

    async fn rest_position(&mut self) -> Result<RestPosition, DriveError> {
        let state = self.state().await?;
        let obeys = state.mode == Mode::Remote.number();
        Ok(if !obeys && state.alarms.is_empty() && state.position == 0 {
            RestPosition::Lost("the drive does not obey the bus, and its position is 0")
        } else {
            RestPosition::Known(state.position.to_string())
        })
    }
}
