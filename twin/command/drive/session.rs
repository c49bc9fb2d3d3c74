//! What runs the drivers' calls, and stops what they have set in motion.

use crate::command::Failure;
use crate::command::run::Interrupt;
use std::time::Duration;
use tokio::runtime::{Builder, Runtime};
use twin_drives::DriveError;

/// Time between two looks for Ctrl-C.
const LOOK: Duration = Duration::from_millis(20);
/// How long axes may take to come to rest on their ramps before they are stopped at once.
pub(super) const BRAKING: Duration = Duration::from_secs(10);

/// The clock of exchanges whose time matters to nobody.
pub(super) fn no_clock() -> i64 {
    0
}

/// A drive whose axes can be brought to rest.
pub(super) trait Stopping {
    /// To rest on the ramps; returns when nothing moves any more.
    async fn soft_stop(&mut self) -> Result<(), DriveError>;

    /// To rest at once; returns when that is confirmed.
    async fn hard_stop(&mut self) -> Result<(), DriveError>;
}

/// A runtime for the calls of one command.
pub(super) struct Session {
    runtime: Runtime,
}

impl Session {
    pub(super) fn start() -> Result<Self, Failure> {
        let runtime = Builder::new_current_thread().enable_all().build();
        Ok(Self { runtime: runtime.map_err(Failure::Stdio)? })
    }

    /// What opens a port has to be done within the runtime.
    pub(super) fn inside<T>(
        &self,
        open: impl FnOnce() -> Result<T, DriveError>,
    ) -> Result<T, Failure> {
        let _inside = self.runtime.enter();
        Ok(open()?)
    }

    /// What moves nothing.
    pub(super) fn ask<T>(
        &self,
        request: impl Future<Output = Result<T, DriveError>>,
    ) -> Result<T, Failure> {
        Ok(self.runtime.block_on(request)?)
    }

    /// What moves axes. On Ctrl-C, and if it fails in any way, they are brought to rest before this returns.
    pub(super) fn motion<D: Stopping, T>(
        &self,
        drive: &mut D,
        motion: impl AsyncFnOnce(&mut D) -> Result<T, DriveError>,
    ) -> Result<T, Failure> {
        let interrupt = Interrupt::catch()?;
        let ended = self.runtime.block_on(async {
            tokio::select! {
                ended = motion(drive) => Some(ended),
                () = pressed(&interrupt) => None,
            }
        });
        let why = match ended {
            Some(Ok(value)) => return Ok(value),
            Some(Err(error)) => error.to_string(),
            None => {
                eprintln!("Ctrl-C: stopping");
                "stopped by Ctrl-C".to_owned()
            }
        };
        let at_rest = self.stop(drive)?;
        Err(Failure::Usage(format!("{why}; {at_rest}")))
    }

    /// Stops on the ramps, and at once if that is not confirmed; says which.
    fn stop<D: Stopping>(&self, drive: &mut D) -> Result<&'static str, Failure> {
        let Err(soft) = self.runtime.block_on(drive.soft_stop()) else {
            return Ok("the axes are at rest");
        };
        eprintln!("{soft}: stopping at once");
        match self.runtime.block_on(drive.hard_stop()) {
            Ok(()) => Ok("the axes were stopped at once"),
            Err(hard) => Err(Failure::Usage(format!(
                "{hard}: whether the axes are at rest is not known, use the emergency stop"
            ))),
        }
    }
}

/// Returns on the next Ctrl-C.
async fn pressed(interrupt: &Interrupt) {
    let before = interrupt.count();
    while interrupt.count() == before {
        tokio::time::sleep(LOOK).await;
    }
}
