//! The drives follow an approach, watched as in a run.

use super::Approach;
use crate::attached::Attached;
use crate::clock::Clock;
use crate::hardware::{Hardware, HardwareError};
use crate::plant::Plant;
use crate::setpoint::HORIZON_NS;
use std::time::Duration;
use twin_machine::Machine;

/// How long drives follow before the first motion.
const LEAD: Duration = Duration::from_millis(100);

/// Time between two looks at user and drives, ns.
const ROUND_NS: i64 = 1_000_000;

/// Why an approach has ended early. The drives have been asked to stop.
#[derive(Debug, thiserror::Error)]
pub enum FollowError {
    /// The user asked for it.
    #[error("stopped by the user on the way to the start of the program")]
    Interrupted,
    /// The drives failed.
    #[error(transparent)]
    Drives(#[from] HardwareError),
}

/// Lets drives that are ready at the start of `approach` follow it to its end, and gives them back at rest there.
///
/// # Errors
/// [`FollowError`]; the drives are stopped then, and `hardware` knows which did not confirm it.
pub fn follow(
    hardware: &mut Hardware,
    machine: &Machine,
    approach: &Approach,
    stopped: &dyn Fn() -> bool,
) -> Result<Vec<Attached>, FollowError> {
    let done = at_rest_there(hardware, machine, approach, stopped);
    if done.is_err() {
        hardware.abandon();
    }
    done.map(|()| hardware.take_drives())
}

fn at_rest_there(
    hardware: &mut Hardware,
    machine: &Machine,
    approach: &Approach,
    stopped: &dyn Fn() -> bool,
) -> Result<(), FollowError> {
    let mut planned = approach.setpoints(machine).peekable();
    let mut plan = |hardware: &mut Hardware, until_ns: i64| {
        while let Some(setpoint) = planned.next_if(|next| next.time_ns <= until_ns) {
            hardware.command(&setpoint)?;
        }
        let is_complete = planned.peek().is_none();
        if is_complete {
            hardware.finish(false);
        }
        Ok::<_, HardwareError>(is_complete)
    };
    let mut is_complete = plan(hardware, HORIZON_NS)?;
    let clock = Clock::in_future(LEAD);
    hardware.follow(clock);
    loop {
        if stopped() {
            return Err(FollowError::Interrupted);
        }
        let now_ns = clock.now_ns();
        // Overdue set-points would be a jump. Emulated drives jump, as in a run.
        if !is_complete && let Some(late) = hardware.starved(now_ns) {
            return Err(late.into());
        }
        is_complete = plan(hardware, now_ns + HORIZON_NS)?;
        // First whether they run, then what they have said: what they say last is said before they end.
        let running = hardware.is_running();
        while hardware.feedback()?.is_some() {}
        if !running {
            return Ok(());
        }
        clock.sleep_until((now_ns.div_euclid(ROUND_NS) + 1) * ROUND_NS);
    }
}
