//! Waiting for what a command has begun: a normal answer only means that the board has accepted it.

use std::{pin::Pin, time::Duration};

use tokio::time::{Sleep, sleep, timeout};

use super::{BoardState, InterpCnc};
use crate::protocol::registers::AxisMask;
use twin_drives::{Action, Clock, DriveError};

/// How long something may take.
pub(super) struct Patience {
    all: Duration,
    left: Pin<Box<Sleep>>,
}

impl Patience {
    pub(super) fn new(all: Duration) -> Self {
        Self { all, left: Box::pin(sleep(all)) }
    }

    /// True once it has taken so long.
    pub(super) async fn is_over(&mut self) -> bool {
        timeout(Duration::ZERO, &mut self.left).await.is_ok()
    }
}

impl InterpCnc {
    /// Reads status and positions until `done` says something of them.
    ///
    /// # Errors
    /// What `done` says, if no proper answer comes, or if it does not come to an end in time.
    pub(super) async fn wait<T>(
        &mut self,
        action: Action,
        patience: Duration,
        clock: &dyn Clock,
        mut done: impl FnMut(&Self, &BoardState) -> Option<Result<T, DriveError>>,
    ) -> Result<T, DriveError> {
        let mut left = Patience::new(patience);
        loop {
            let over = left.is_over().await;
            let (state, _) = self.state(clock).await?;
            if let Some(outcome) = done(self, &state) {
                return outcome;
            }
            // Asked once more after the end: the board may have been ready just before.
            if over {
                return Err(DriveError::Unfinished { at: self.at(action), patience: left.all });
            }
        }
    }

    /// Waits until axes rest, whatever made them move.
    ///
    /// # Errors
    /// If they still move after `patience`, or no proper answer comes.
    pub async fn wait_for_rest(
        &mut self,
        axes: AxisMask,
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<BoardState, DriveError> {
        self.wait(Action::ReadState, patience, clock, |_, state| {
            state.status.moving().intersection(axes).is_empty().then_some(Ok(*state))
        })
        .await
    }
}
