//! Session with a device: runs the driver's calls, and stops the axes on Ctrl-C or failure.

use crate::command::Failure;
use crate::command::run::Interrupt;
use std::time::Duration;
use tokio::runtime::{Builder, Runtime};
use twin_drives::DriveError;
pub(super) use twin_drives::no_clock;

/// Interval of looking for Ctrl-C.
const LOOK: Duration = Duration::from_millis(20);
/// How long axes may take to come to rest on their ramps before they are stopped at once.
pub(super) const BRAKING: Duration = Duration::from_secs(10);

/// Positions of the axes after a stop.
pub(super) enum RestPosition {
    /// Known, in words.
    Known(String),
    /// Lost: the device shows itself as after a restart, in these words.
    Lost(&'static str),
}

impl RestPosition {
    /// Message after a stop.
    fn after(self, stopped: &str) -> String {
        match self {
            Self::Known(place) => format!("{stopped}, at {place}"),
            Self::Lost(shown) => format!(
                "{stopped}, and the device shows itself as after a restart ({shown}): the positions of the axes are not known; `unlock`, then \
                 `home` again"
            ),
        }
    }
}

/// A drive whose axes can be brought to rest.
pub(super) trait Stopping {
    /// To rest on the ramps; returns when nothing moves any more.
    async fn soft_stop(&mut self) -> Result<(), DriveError>;

    /// To rest at once; returns when that is confirmed.
    async fn hard_stop(&mut self) -> Result<(), DriveError>;

    /// Positions of the axes.
    async fn rest_position(&mut self) -> Result<RestPosition, DriveError>;
}

/// A runtime for the calls of one command.
#[derive(Debug)]
pub(super) struct Session {
    runtime: Runtime,
}

impl Session {
    pub(super) fn start() -> Result<Self, Failure> {
        let runtime = Builder::new_current_thread().enable_all().build();
        Ok(Self { runtime: runtime.map_err(Failure::Stdio)? })
    }

    /// Opens a port within the runtime.
    pub(super) fn inside<T>(
        &self,
        open: impl FnOnce() -> Result<T, DriveError>,
    ) -> Result<T, Failure> {
        let _inside = self.runtime.enter();
        Ok(open()?)
    }

    /// Runs a request that moves nothing.
    pub(super) fn ask<T>(
        &self,
        request: impl Future<Output = Result<T, DriveError>>,
    ) -> Result<T, Failure> {
        Ok(self.runtime.block_on(request)?)
    }

    /// Runs a motion. On Ctrl-C and on any failure the axes are brought to rest before this returns.
    pub(super) fn motion<D: Stopping, T>(
        &self,
        drive: &mut D,
        motion: impl AsyncFnOnce(&mut D) -> Result<T, DriveError>,
    ) -> Result<T, Failure> {
        let interrupt = Interrupt::catch_for_drives()?;
        self.interruptible(drive, motion, || pressed(&interrupt))
    }

    /// The same with `pressed` in the place of Ctrl-C.
    fn interruptible<D: Stopping, T, F: Future<Output = &'static str>>(
        &self,
        drive: &mut D,
        motion: impl AsyncFnOnce(&mut D) -> Result<T, DriveError>,
        pressed: impl Fn() -> F,
    ) -> Result<T, Failure> {
        let ended = self.runtime.block_on(async {
            tokio::select! {
                ended = motion(drive) => Ok(ended),
                name = pressed() => Err(name),
            }
        });
        let why = match ended {
            Ok(Ok(value)) => return Ok(value),
            Ok(Err(error)) => Ok(error),
            Err(name) => {
                say_in_background(format!("{name}: stopping"));
                Err(name)
            }
        };
        let failed = |why: Result<DriveError, &str>, at_rest: String| match why {
            Ok(source) => Failure::Motion { source: Box::new(source), at_rest },
            Err(name) => Failure::Usage(format!("stopped by {name}; {at_rest}")),
        };
        let at_rest = match self.stop(drive, pressed()) {
            Ok(at_rest) => at_rest,
            Err(unknown) => return Err(failed(why, unknown)),
        };
        // Without an answer the stop is reported all the same.
        let position = self.runtime.block_on(drive.rest_position());
        let at_rest = match position {
            Ok(position) => position.after(at_rest),
            Err(_) => at_rest.to_owned(),
        };
        Err(failed(why, at_rest))
    }

    /// Stops on the ramps, and at once if that is not confirmed or `impatient` ends before; says which, or that neither is
    /// confirmed.
    fn stop<D: Stopping>(
        &self,
        drive: &mut D,
        impatient: impl Future<Output = &'static str>,
    ) -> Result<&'static str, String> {
        let soft = self.runtime.block_on(async {
            tokio::select! {
                biased;
                stopped = drive.soft_stop() => stopped.map_err(|error| error.to_string()),
                name = impatient => Err(format!("{name} again")),
            }
        });
        let Err(why) = soft else { return Ok("the axes are at rest") };
        say_in_background(format!("{why}: stopping at once"));
        match self.runtime.block_on(drive.hard_stop()) {
            Ok(()) => Ok("the axes were stopped at once"),
            Err(hard) => Err(format!(
                "{hard}: whether the axes are at rest is not known, use the emergency stop"
            )),
        }
    }
}

/// Prints on a thread of its own: a terminal that is held (Ctrl-S) must not delay a stop.
fn say_in_background(words: String) {
    let thread = std::thread::Builder::new().name("words".to_owned());
    drop(thread.spawn(move || stderr!("{words}")));
}

/// Returns on the next signal that ends the command, with its name.
async fn pressed(interrupt: &Interrupt) -> &'static str {
    let before = interrupt.count();
    while interrupt.count() == before {
        tokio::time::sleep(LOOK).await;
    }
    interrupt.latest()
}

#[cfg(test)]
mod tests {
    use super::{RestPosition, Session, Stopping};
    use std::future::{pending, ready};
    use std::time::Duration;
    use twin_drives::{Action, DriveError, Exchange};

    /// A drive that confirms its stops or not, and its calls.
    struct Drive {
        confirms: [bool; 2],
        calls: Vec<&'static str>,
        restarted: bool,
    }

    impl Drive {
        fn new(confirms: [bool; 2]) -> Self {
            Self { confirms, calls: Vec::new(), restarted: false }
        }
    }

    fn confirmed(confirmed: bool) -> Result<(), DriveError> {
        if confirmed {
            return Ok(());
        }
        let at = Exchange { port: "p".into(), address: 7, action: Action::ReadState };
        Err(DriveError::Timeout { at, deadline: Duration::from_millis(1) })
    }

    impl Stopping for Drive {
        async fn soft_stop(&mut self) -> Result<(), DriveError> {
            self.calls.push("soft");
            tokio::task::yield_now().await;
            confirmed(self.confirms[0])
        }

        async fn hard_stop(&mut self) -> Result<(), DriveError> {
            self.calls.push("hard");
            confirmed(self.confirms[1])
        }

        async fn rest_position(&mut self) -> Result<RestPosition, DriveError> {
            let at = || RestPosition::Known("17".to_owned());
            Ok(if self.restarted { RestPosition::Lost("off, at 0") } else { at() })
        }
    }

    #[test]
    fn an_unconfirmed_stop_is_followed_by_a_hard_stop() {
        let session = Session::start().expect("a runtime");
        let stop = |confirms| {
            let mut drive = Drive::new(confirms);
            let said = session.stop(&mut drive, pending());
            (said, drive.calls)
        };
        assert_eq!(stop([true, true]), (Ok("the axes are at rest"), vec!["soft"]));
        let (said, calls) = stop([false, true]);
        assert_eq!((said, calls), (Ok("the axes were stopped at once"), vec!["soft", "hard"]));
        let (said, calls) = stop([false, false]);
        let said = said.expect_err("nothing is confirmed");
        assert!(said.contains("p, address 7") && said.contains("emergency stop"), "{said}");
        assert_eq!(calls, ["soft", "hard"]);
    }

    #[test]
    fn a_failure_reports_the_positions_after_the_stop() {
        let session = Session::start().expect("a runtime");
        let mut drive = Drive::new([true, true]);
        let failed = session.motion(&mut drive, async |_| confirmed(false));
        let said = failed.expect_err("it fails").to_string();
        assert!(said.ends_with("no answer within 1 ms; the axes are at rest, at 17"), "{said}");
        assert_eq!(drive.calls, ["soft"]);
    }

    #[test]
    fn positions_after_a_restart_are_unknown() {
        let session = Session::start().expect("a runtime");
        let mut drive = Drive { restarted: true, ..Drive::new([true, true]) };
        let failed = session.motion(&mut drive, async |_| confirmed(false));
        let said = failed.expect_err("it fails").to_string();
        assert!(
            said.contains(
                "as after a restart (off, at 0): the positions of the axes are not known"
            )
        );
        assert!(said.ends_with("`unlock`, then `home` again") && !said.contains("17"), "{said}");
    }

    #[test]
    fn an_unconfirmed_stop_keeps_the_first_error() {
        let session = Session::start().expect("a runtime");
        let mut drive = Drive::new([false, false]);
        let moved = async |_: &mut Drive| {
            let at = Exchange { port: "p".into(), address: 7, action: Action::ReadState };
            Err::<(), _>(DriveError::Stalled { at })
        };
        let said = session.interruptible(&mut drive, moved, pending::<&str>);
        let said = said.expect_err("it fails").to_string();
        assert!(
            said.contains("the motor has stalled") && said.contains("emergency stop"),
            "{said}"
        );
    }

    #[test]
    fn a_stop_names_its_signal() {
        let session = Session::start().expect("a runtime");
        let mut drive = Drive::new([true, true]);
        let moved = async |_: &mut Drive| pending::<Result<(), DriveError>>().await;
        let asked = std::cell::Cell::new(0);
        // The second call waits for the impatient second signal.
        let pressed = || {
            asked.set(asked.get() + 1);
            let first = asked.get() == 1;
            async move { if first { "SIGTERM" } else { pending().await } }
        };
        let said = session.interruptible(&mut drive, moved, pressed);
        let said = said.expect_err("it is stopped").to_string();
        assert_eq!(said, "stopped by SIGTERM; the axes are at rest, at 17");
    }

    #[test]
    fn a_second_signal_stops_at_once() {
        let session = Session::start().expect("a runtime");
        let mut drive = Drive::new([true, true]);
        let said = session.stop(&mut drive, ready("Ctrl-C"));
        assert_eq!(said.ok(), Some("the axes were stopped at once"));
        assert_eq!(drive.calls.last(), Some(&"hard"));
    }
}
