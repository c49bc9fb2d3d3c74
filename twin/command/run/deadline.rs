//! Deadline of what follows a run: the process ends even if nobody reads its outputs.

use crate::command::{Failure, Status};
use std::sync::mpsc::{RecvTimeoutError, SyncSender, sync_channel};
use std::time::Duration;

/// The deadline is this many slices after the end of the run. A computer that stood still costs one.
const SLICES: u32 = 38;
const SLICE: Duration = Duration::from_millis(50);

/// Ends the process with [`Status::Failed`] 1.9 s after it was set, unless it is dropped before.
pub(super) struct Deadline {
    _set: SyncSender<()>,
}

impl Deadline {
    pub(super) fn set() -> Result<Self, Failure> {
        let (sender, dropped) = sync_channel::<()>(0);
        let end = move || {
            let runs_out = |_| dropped.recv_timeout(SLICE) == Err(RecvTimeoutError::Timeout);
            if (0..SLICES).all(runs_out) {
                // Nobody reads a message either.
                std::process::exit(Status::Failed as i32);
            }
        };
        let thread = std::thread::Builder::new().name("deadline".to_owned()).spawn(end);
        thread.map(|_| Self { _set: sender }).map_err(Failure::Interrupt)
    }
}
