//! The legs of a plan that is followed.

use super::{AXES, Bim2AxDrive, DriveError, Following, SetpointStream, Start};
use twin_drives::ramp::{nanoseconds, seconds};

/// Weight of an exchange in the running means.
const MEAN_GAIN: f64 = 0.2;

impl Bim2AxDrive {
    /// Decides for the next leg and gives its order; true if there was one.
    pub(super) fn next_leg(
        &mut self,
        stream: &dyn SetpointStream,
        rest: [i32; AXES],
    ) -> Result<bool, DriveError> {
        let clock = || stream.now_ns();
        let decided_ns = stream.now_ns();
        let Some(leg) = self.follower.leg(stream, rest) else { return Ok(false) };
        let start = |((target, speed), stands): ((i32, u16), i32)| {
            let to = Start { to: target, speed: Some(speed), directly: true };
            (target != stands).then_some(to)
        };
        let starts: Vec<_> = leg.targets.into_iter().zip(leg.speeds).zip(rest).map(start).collect();
        let starts = self.by_axis(&starts);
        // Whether a lost order is carried out is unknown: the next look shows.
        self.forget();
        let stamp = match self.runtime.block_on(self.module.start(starts, &clock)) {
            Err(error) if error.is_lost() => {
                let begun = self.module.exchanges().begin();
                let (repeats, lost) = self.vain.unanswered.get_or_insert((begun, 0));
                *lost += 1;
                return if repeats.allow(*lost) { Ok(false) } else { Err(error) };
            }
            started => started?,
        };
        (self.vain.unanswered, self.vain.from) = (None, rest);
        self.sent = Some(leg.targets);
        let executed_ns = stamp.middle_ns();
        self.following = Following::Leg(leg.end_ns + executed_ns - leg.start_ns);
        self.timing.order_ns = mean(self.timing.order_ns, executed_ns - decided_ns);
        self.follower.set_timing(self.timing);
        Ok(true)
    }
}

/// A running mean of durations, ns.
pub(super) fn mean(so_far_ns: i64, new_ns: i64) -> i64 {
    // One exchange that something else delayed says little.
    let new_ns = new_ns.clamp(0, so_far_ns.saturating_mul(2));
    so_far_ns + nanoseconds(MEAN_GAIN * seconds(new_ns - so_far_ns))
}
