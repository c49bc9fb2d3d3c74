//! Set-point stream in increments, shared between session and device.

use crate::clock::Clock;
use crate::setpoint::HORIZON_NS;
use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};
use twin_drives::{IncrementMotion, MAX_DRIVE_AXES, SetpointStream};

/// How far back the stream remembers, ns: longer than any exchange.
const MEMORY_NS: i64 = 1_000_000_000;

/// The planned motion in increments, shared between session and device.
#[derive(Debug)]
pub(super) struct Stream {
    plan: Mutex<Plan>,
    cycle_ns: i64,
}

#[derive(Debug)]
struct Plan {
    /// Read once the program runs; before that it is time 0 minus something.
    clock: Option<Clock>,
    /// Where the axes rest as long as nothing is planned.
    start: [f64; MAX_DRIVE_AXES],
    /// Cycle number of the first kept set-point.
    first: i64,
    setpoints: VecDeque<IncrementMotion>,
}

impl Stream {
    /// For axes that rest at `start` (increments) until a motion is planned.
    pub(super) fn new(start: [f64; MAX_DRIVE_AXES], cycle_ns: i64) -> Self {
        let plan = Plan { clock: None, start, first: 0, setpoints: VecDeque::new() };
        Self { plan: Mutex::new(plan), cycle_ns }
    }

    /// Takes the time from `clock` from now on.
    pub(super) fn start(&self, clock: Clock) {
        self.plan().clock = Some(clock);
    }

    /// Plans one cycle more, at `time_ns`, and forgets what no exchange can ask for any more.
    pub(super) fn push(&self, time_ns: i64, motion: IncrementMotion) {
        let mut plan = self.plan();
        plan.setpoints.push_back(motion);
        let oldest = (time_ns - MEMORY_NS - HORIZON_NS).div_euclid(self.cycle_ns);
        while plan.first < oldest {
            plan.setpoints.pop_front();
            plan.first += 1;
        }
    }

    /// Replaces the plan after `time_ns` by `motions`, a cycle each.
    pub(super) fn replace(&self, time_ns: i64, motions: impl Iterator<Item = IncrementMotion>) {
        let mut plan = self.plan();
        let kept = time_ns.div_euclid(self.cycle_ns) + 1 - plan.first;
        plan.setpoints.truncate(usize::try_from(kept).unwrap_or(0));
        plan.setpoints.extend(motions);
    }

    /// The last planned instant, ns.
    pub(super) fn end_ns(&self) -> i64 {
        let plan = self.plan();
        let planned = i64::try_from(plan.setpoints.len()).unwrap_or(i64::MAX);
        (plan.first + planned - 1).max(0) * self.cycle_ns
    }

    /// Whether the plan leads any of the first `axes` axes an increment or more from `origin` in the time from `from_ns` to
    /// `to_ns`, also if it leads back.
    pub(super) fn strays(
        &self,
        origin: &[f64; MAX_DRIVE_AXES],
        (from_ns, to_ns): (i64, i64),
        axes: usize,
    ) -> bool {
        let away = |motion: &IncrementMotion| {
            let axes = motion.position.iter().zip(origin).take(axes);
            axes.into_iter().any(|(position, origin)| (position - origin).abs() >= 1.0)
        };
        if [from_ns, to_ns].iter().any(|time_ns| away(&self.at(*time_ns))) {
            return true;
        }
        // Between set-points it goes straight on.
        let plan = self.plan();
        let after = |time_ns: i64| {
            usize::try_from(time_ns.div_euclid(self.cycle_ns) + 1 - plan.first).unwrap_or(0)
        };
        plan.setpoints.iter().take(after(to_ns)).skip(after(from_ns)).any(away)
    }

    fn plan(&self) -> MutexGuard<'_, Plan> {
        // A plan is valid between any two statements that change it.
        self.plan.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl SetpointStream for Stream {
    fn now_ns(&self) -> i64 {
        self.plan().clock.map_or(-1, |clock| clock.now_ns())
    }

    #[expect(clippy::cast_precision_loss, reason = "a fraction of a cycle")]
    fn at(&self, time_ns: i64) -> IncrementMotion {
        let plan = self.plan();
        let cycle = time_ns.div_euclid(self.cycle_ns) - plan.first;
        let fraction = time_ns.rem_euclid(self.cycle_ns) as f64 / self.cycle_ns as f64;
        let at_rest = |motion: Option<&IncrementMotion>| IncrementMotion {
            position: motion.map_or(plan.start, |motion| motion.position),
            velocity: [0.0; MAX_DRIVE_AXES],
        };
        let Ok(index) = usize::try_from(cycle) else { return at_rest(plan.setpoints.front()) };
        let (Some(from), Some(to)) = (plan.setpoints.get(index), plan.setpoints.get(index + 1))
        else {
            return at_rest(plan.setpoints.back());
        };
        from.towards(to, fraction)
    }

    fn horizon_ns(&self) -> i64 {
        HORIZON_NS
    }
}
