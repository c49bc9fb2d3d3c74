//! Following a plan point to point.
//!
//! The module takes no target while an axis moves and queues none, so a plan is followed in legs: both axes are
//! started by one order towards where the plan will be, with speeds such that they arrive together, stand, are seen
//! to rest, and get the next order. Between two legs both rest for the dead time: a look at the module and the
//! latency of an order.
//!
//! # How long a leg
//!
//! With a plan of constant speed v, legs of duration T and dead times D, an axis has to move v·(T + D) in T. It is
//! ahead of or behind the plan by a saw tooth of v·D from top to bottom, whatever T is; laid evenly around the plan
//! the error is at most v·D/2, plus what the ramps cost. A ramp from the start-stop speed u to w with acceleration a
//! lags (w − u)²/(2a) behind a start at full speed, which short legs do not even reach. Where the plan bends, an axis
//! moves on the chord: with a plan of acceleration c the error is c·T²/8. Long legs lose by the one, short legs by
//! the other, so legs of many durations are moved by the module's own profiles, and the one with the smallest mean
//! square of the error up to the next leg is taken.
//!
//! # When the program dies
//!
//! Nothing in the module watches its host: the leg under way goes on to its end, where both axes rest. A leg ends where
//! the plan is within its horizon, so they go on for at most horizon × speed. Only manual moves,
//! with which no plan is followed, run until 0 is written (`kill` in `tests/fault_matrix`).
//!
//! # Turning points
//!
//! No leg passes a point at which the plan of an axis turns round: it may end there, so that corners are reached.

#[cfg(test)]
mod tests;

use crate::{AXES, AxisSettings, MOST_POSITION, emulator::axis::whole};
use twin_drives::{
    SetpointStream,
    ramp::{Motion, State, nanoseconds, seconds},
};

/// Positions nearer to the plan than this are left alone, µsteps: what rounding makes.
const TOLERANCE: f64 = 0.6;
/// Slower than this the plan rests, µsteps/s.
const RESTING: f64 = 1.0;
/// Shortest duration of a leg looked at, s.
const SHORTEST_S: f64 = 0.005;
/// Ratio of the durations looked at.
const GROWTH: f64 = 1.4;
/// Points at which a leg is compared with the plan.
const COMPARED: i64 = 24;
/// Places at which the plan is searched for turning points.
const SEARCHED: i64 = 128;
/// How far ahead targets lie of where the plan is at the end of a leg, in dead times.
const LEADS: [f64; 4] = [0.0, 0.4, 0.5, 0.6];

/// Durations of exchanges with the module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Timing {
    /// From the decision for an order to the begin of its motion, ns.
    pub(crate) order_ns: i64,
    /// Duration of a look at the module, ns.
    pub(crate) look_ns: i64,
}

impl Timing {
    /// How long the axes rest between two legs, ns.
    fn dead_ns(&self) -> i64 {
        self.order_ns + self.look_ns
    }
}

/// One order for both axes and what is expected of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leg {
    /// Absolute targets, µsteps; an axis that is on its target gets no order.
    pub(crate) targets: [i32; AXES],
    /// Programmed speeds, unit of the drive mode.
    pub(crate) speeds: [u16; AXES],
    /// Expected begin of the motion, ns.
    pub(crate) start_ns: i64,
    /// Expected end of the motion, ns.
    pub(crate) end_ns: i64,
    /// Expected error up to the next leg, both axes together, µsteps: root of the mean square.
    pub(crate) error: f64,
}

/// Chooses legs; speaks to nobody.
#[derive(Clone, Debug)]
pub(crate) struct Follower {
    axes: Vec<AxisSettings>,
    timing: Timing,
}

impl Follower {
    pub(crate) fn new(axes: &[AxisSettings], timing: Timing) -> Self {
        Self { axes: axes.to_vec(), timing }
    }

    /// Exchanges take so long from now on.
    pub(crate) fn set_timing(&mut self, timing: Timing) {
        self.timing = timing;
    }

    /// The next leg for axes that rest at `position` now; none if the plan stays where they are.
    pub(crate) fn leg(&self, plan: &dyn SetpointStream, position: [i32; AXES]) -> Option<Leg> {
        let now_ns = plan.now_ns();
        let start_ns = now_ns + self.timing.order_ns;
        let last_ns = now_ns.saturating_add(plan.horizon_ns()).max(start_ns);
        if self.stays(plan, position, start_ns, last_ns) {
            return None;
        }
        let (mut ends, turn_ns) = self.breaks(plan, start_ns, last_ns);
        let mut duration = SHORTEST_S;
        while start_ns + nanoseconds(duration) < last_ns {
            ends.push(start_ns + nanoseconds(duration));
            duration *= GROWTH;
        }
        ends.push(last_ns);
        ends.retain(|end_ns| *end_ns <= turn_ns);
        let mut best: Option<Leg> = None;
        for end_ns in ends {
            for lead in LEADS {
                let ahead_ns = end_ns + nanoseconds(lead * seconds(self.timing.dead_ns()));
                let leg = self.towards(plan, position, start_ns, end_ns, ahead_ns.min(turn_ns));
                if leg.targets != position && best.is_none_or(|best| leg.error < best.error) {
                    best = Some(leg);
                }
            }
        }
        best
    }

    /// True if the plan stays where the axes are for as long as an order decided now could make a difference.
    fn stays(
        &self,
        plan: &dyn SetpointStream,
        position: [i32; AXES],
        start_ns: i64,
        last_ns: i64,
    ) -> bool {
        let end_ns = (start_ns + 2 * self.timing.dead_ns()).min(last_ns);
        (0..=4).all(|part| {
            let planned = plan.at(start_ns + (end_ns - start_ns) * part / 4).position;
            let near =
                |(planned, stands): (&f64, &i32)| (planned - f64::from(*stands)).abs() <= TOLERANCE;
            planned.iter().zip(&position).take(self.axes.len()).all(near)
        })
    }

    /// Instants at which the plan of an axis begins to move, comes to rest or turns round, and the first turn.
    fn breaks(&self, plan: &dyn SetpointStream, start_ns: i64, last_ns: i64) -> (Vec<i64>, i64) {
        let mut found = Vec::new();
        let mut turn_ns = last_ns;
        for axis in 0..self.axes.len() {
            let sense = |time_ns: i64| {
                let velocity = plan.at(time_ns).velocity.get(axis).copied().unwrap_or(0.0);
                if velocity.abs() < RESTING {
                    0_i8
                } else if velocity > 0.0 {
                    1
                } else {
                    -1
                }
            };
            let mut before = (start_ns, sense(start_ns));
            let mut moving = before.1;
            for part in 1..=SEARCHED {
                let time_ns = start_ns + (last_ns - start_ns) * part / SEARCHED;
                let now = sense(time_ns);
                if now != before.1 {
                    let (mut low, mut high) = (before.0, time_ns);
                    while high - low > 1000 {
                        let middle = low + (high - low) / 2;
                        if sense(middle) == before.1 { low = middle } else { high = middle }
                    }
                    found.push(high);
                    if now * moving < 0 {
                        turn_ns = turn_ns.min(high);
                    }
                }
                if now != 0 {
                    moving = now;
                }
                before = (time_ns, now);
            }
        }
        (found, turn_ns)
    }

    /// The leg towards where the plan is at `ahead_ns`, to arrive at `end_ns` or as soon as the axes can.
    fn towards(
        &self,
        plan: &dyn SetpointStream,
        position: [i32; AXES],
        start_ns: i64,
        end_ns: i64,
        ahead_ns: i64,
    ) -> Leg {
        let mut targets = position;
        for (target, planned) in
            targets.iter_mut().zip(plan.at(ahead_ns).position).take(self.axes.len())
        {
            let most = i64::from(MOST_POSITION);
            *target = i32::try_from(whole(planned).clamp(-most, most)).unwrap_or(*target);
        }
        let ways = || self.axes.iter().zip(position.iter().zip(&targets));
        let fastest = ways()
            .map(|(axis, (from, to))| {
                motion(axis, start_ns, *from, *to, axis.fast_speed).end_ns() - start_ns
            })
            .max();
        let duration = seconds((end_ns - start_ns).max(fastest.unwrap_or(0)));
        let mut speeds = [1; AXES];
        for (speed, (axis, (from, to))) in speeds.iter_mut().zip(ways()) {
            *speed = speed_for(axis, f64::from(*from) - f64::from(*to), duration);
        }
        let motions: Vec<Motion> = ways()
            .zip(speeds)
            .map(|((axis, (from, to)), speed)| motion(axis, start_ns, *from, *to, speed))
            .collect();
        let end_ns = motions.iter().map(Motion::end_ns).max().unwrap_or(start_ns);
        let until_ns = end_ns + self.timing.dead_ns();
        let square = (0..COMPARED)
            .map(|part| {
                let time_ns = start_ns + (until_ns - start_ns) * (2 * part + 1) / (2 * COMPARED);
                let planned = plan.at(time_ns).position;
                let of_axis = |(motion, planned): (&Motion, &f64)| {
                    (motion.at(time_ns).position - planned).powi(2)
                };
                motions.iter().zip(&planned).map(of_axis).sum::<f64>()
            })
            .sum::<f64>();
        #[expect(clippy::cast_precision_loss, reason = "a small constant")]
        let error = (square / COMPARED as f64).sqrt();
        Leg { targets, speeds, start_ns, end_ns, error }
    }
}

/// The motion of an axis from rest.
fn motion(axis: &AxisSettings, start_ns: i64, from: i32, to: i32, speed: u16) -> Motion {
    let state = State { position: f64::from(from), velocity: 0.0 };
    Motion::plan(start_ns, state, &axis.ramp(axis.speed(speed), f64::from(to)))
}

/// The programmed speed with which a way of `distance` µsteps takes `duration` seconds, or the fast speed if it
/// cannot be done in that time.
///
/// With start-stop speed u and acceleration a, a way d at the speed v > u takes d/v + (v − u)²/(a·v) (two ramps of
/// (v − u)/a over (v² − u²)/(2a) each, the rest at v); the slower root of that equation in v is the speed.
pub(crate) fn speed_for(axis: &AxisSettings, distance: f64, duration: f64) -> u16 {
    let (distance, unit) = (distance.abs(), axis.mode.speed_unit());
    let (start_stop, rate) = (axis.start_stop(), axis.rate());
    let level = distance / duration.max(1e-9);
    let speed = if level <= start_stop {
        level
    } else {
        let half = start_stop + 0.5 * rate * duration;
        let under = half * half - start_stop * start_stop - rate * distance;
        if under < 0.0 { f64::INFINITY } else { half - under.sqrt() }
    };
    let units = (speed / unit).round().clamp(1.0, f64::from(axis.fast_speed.max(1)));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "within 1 to 65535"
    )]
    let units = units as u16;
    units
}
