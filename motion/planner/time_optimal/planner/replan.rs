//! Replanning after an override, a feed hold or its end, from the present motion of the path.

use super::budget::Budget;
use super::{Leg, NoWindow, Planned, Planner};
use crate::planned_motion::ProfileSegment;
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::feeds::Feeds;
use crate::time_optimal::planner::minimum_speed::{Look, Room, Slowest};
use crate::time_optimal::smooth::Beginning;
use std::sync::Arc;
use twin_path::prepare::CheckedElement;

/// Room of the plan around the slowest profile, to keep the limits between the nodes as well. The second is for plans
/// so far that brake about as hard as they can, into a corner or a stop.
const ROOMS: [Room; 3] = [
    Room { tight: [1.005, 1.01], faster: 0.02, behind: 2e-3 },
    Room { tight: [1.0, 1.0], faster: 0.05, behind: 0.01 },
    Room { tight: [0.98, 0.96], faster: 0.15, behind: 0.05 },
];
/// Where no other is found a plan that is hardly faster than the slowest is gone on with, for at least this time, s: less is not
/// worth the work of another attempt.
const HARDLY: f64 = 0.02;
/// The first window of a new plan is no longer than this, s: what follows has time.
const HORIZON: f64 = 0.3;
/// An override below this is come to by way of rest: braking to next to nothing and no further leaves little to choose.
const NEARLY_REST: f64 = 0.03;
/// A profile may begin with a b that is smaller by this part.
const SLOWER: f64 = 1e-5;
/// A plan that comes to rest within this time, s, is not worth another.
const SOON: f64 = 0.02;
/// Nor is one of fewer legs.
const FEW: usize = 4;
/// Where no plan was found the path goes on as it was planned for about this time, s, and twice as long after every other such
/// attempt, up to the second.
const GO_ON: [f64; 2] = [0.1, 1.6];

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// The work after which an attempt to plan anew is given up, in cells times iterations of the solver (what else there is to do
    /// is counted as some): at the end of the pass over the window that is under way, which is less than as much again.
    pub const MOST_WORK: u64 = 60_000;

    /// The largest override.
    pub const LARGEST_OVERRIDE: f64 = 2.0;

    /// Multiplies all programmed velocities, those of rapids included, by `factor` in all that has not been handed out yet, or
    /// has been taken back ([`Self::take_back`]): 0 to [`Self::LARGEST_OVERRIDE`], what is beyond counts as these, and no number
    /// as 0. The limits of the axes stay as they are. Where programmed velocities do not count
    /// ([`LimitOptions::feed`](crate::time_optimal::LimitOptions::feed)) only 0 makes a difference.
    ///
    /// 0 is a feed hold: the path comes to rest as early as it can, after what is handed out, and then there is
    /// [`Planned::Hold`] until another factor.
    ///
    /// Where the path is faster than the override allows it brakes along the slowest profile that the limits of the axes and
    /// the programmed deceleration leave, and is faster than that by 1 % (up to 7 % where it bends) until it is slow enough.
    /// To less than 3 % it brakes to rest, and goes on from there.
    ///
    /// # How long it takes
    /// This call itself plans nothing; the next item does, with less than twice [`Self::MOST_WORK`], however much is known of the
    /// path. Where that is not enough, nothing but the plan so far is handed out for 0.1 s of the path (twice
    /// as much after every other attempt, up to 1.6 s), and tried again from there
    /// ([`Effort::not_replanned`](crate::time_optimal::Effort)). A unit of work is 1 to 3 µs of a core of 2024 that other programs want
    /// as well. Measured over 920 changes on three machines (`cargo bench -p twin-planner --bench replan`) with both cores
    /// overbooked: half of them within 31 ms, 19 of 20 within 0.12 s and all within 0.2 s; 27 were tried again later.
    ///
    /// Who cannot wait for that executes the plan by [`Pieces`](crate::time_optimal::Pieces) and
    /// [`PlanExecutor`](crate::time_optimal::PlanExecutor): what is executed then ends at rest at any time, and a new plan takes its place only if
    /// it is there in time.
    pub fn set_override(&mut self, factor: f64) {
        self.misses = 0;
        self.asked = if factor.is_nan() { 0.0 } else { factor.clamp(0.0, Self::LARGEST_OVERRIDE) };
        self.take_back([]);
    }

    /// The override asked for.
    pub fn override_factor(&self) -> f64 {
        self.asked
    }

    /// True if the path rests, or will behind what was handed out, until an override lets it go on.
    pub fn is_held(&self) -> bool {
        self.held
    }

    /// Gives up all that was not handed out: nothing follows.
    pub fn abandon(&mut self) {
        self.unplan();
        self.returned.clear();
        self.ready.clear();
        self.tail.clear();
        self.held = false;
        self.changed = false;
        self.over = true;
    }

    /// Plans a window under the override asked for.
    pub(super) fn replan(&mut self) {
        if self.beginning != Beginning::Rest && self.rests_soon() {
            self.go_on(usize::MAX);
        }
        if self.beginning == Beginning::Rest {
            // The plan so far is that under the last override.
            self.tail.clear();
            if self.asked > 0.0 {
                self.sampler.feeds = Feeds::new(self.asked);
            } else {
                self.held = true;
            }
            return;
        }
        self.effort.replanned += 1;
        self.budget = Budget::of(Self::MOST_WORK);
        let asked = self.asked;
        let first = self.sampler.feeds.raised(asked).is_none();
        if first && asked < NEARLY_REST {
            self.asked = 0.0;
        }
        self.replan_moving();
        self.asked = asked;
        if asked > 0.0 && std::mem::take(&mut self.held) {
            self.sampler.feeds = Feeds::new(asked);
        }
        let spent = std::mem::take(&mut self.budget).spent();
        self.effort.replanning += spent;
        self.effort.most_replanning = self.effort.most_replanning.max(spent);
    }

    fn replan_moving(&mut self) {
        let before = (self.sampler.feeds.clone(), self.effort.failed);
        // What was slow enough is slow enough.
        if let Some(raised) = before.0.raised(self.asked) {
            self.sampler.feeds = raised;
            if self.plan_on().is_ok() {
                self.misses = 0;
                self.pass_stop();
                return;
            }
            self.unplan();
            (self.sampler.feeds, self.effort.failed) = before.clone();
        }
        // Where the whole of the plan so far is not needed to find one, that is soon found.
        let tries = [Look::Short, Look::Long].into_iter();
        for (look, room) in tries.flat_map(|look| ROOMS.map(|room| (look, room))) {
            if self.budget.is_spent() {
                break;
            }
            let Ok(slowest) = self.slowest(room.tight, look) else { continue };
            if self.plan_above(&slowest, room).is_ok() {
                self.misses = 0;
                self.pass_stop();
                return;
            }
            self.unplan();
            (self.sampler.feeds, self.effort.failed) = before.clone();
            let near = slowest.near(&self.tail);
            let legs = self.tail.iter().take(near);
            if legs.map(|leg| leg.stretch.duration()).sum::<f64>() >= HARDLY {
                self.changed = true;
                self.go_on(near);
                return;
            }
        }
        self.effort.failed = before.1;
        self.effort.not_replanned += 1;
        self.changed = true;
        let [least, most] = GO_ON;
        let mut left = (least * f64::from(1_u32 << self.misses.min(8))).min(most);
        self.misses += 1;
        let now = self.tail.iter().position(|leg| {
            left -= leg.stretch.duration();
            left <= 0.0
        });
        self.go_on(now.map_or(usize::MAX, |last| last + 1));
    }

    /// A window no slower than `slowest`.
    fn plan_above(&mut self, slowest: &Slowest, room: Room) -> Result<(), NoWindow> {
        if self.asked <= 0.0
            && let Some((element, s)) = slowest.rest(room)
        {
            let element = Arc::clone(element);
            self.hold_at(&element, s);
        }
        self.sampler.feeds = slowest.feeds(self.asked, room);
        for (element, s) in self.sampler.feeds.kinks() {
            self.split_at(&element, s);
        }
        self.plan_on()
    }

    /// A window from where the path is.
    fn plan_on(&mut self) -> Result<(), NoWindow> {
        self.smooth.positive = true;
        // To rest it is no further than braking takes.
        let moving = self.asked > 0.0;
        let horizon = if moving { self.options.horizon.min(HORIZON) } else { f64::INFINITY };
        let planned = self.plan_window(horizon, true);
        self.smooth.positive = false;
        planned
    }

    /// True if a profile begins as fast as the path is: without jerk limits the solver may lower the first velocity.
    pub(super) fn begins_with(&self, stretches: &[ProfileSegment]) -> bool {
        let Beginning::Moving { b, .. } = self.beginning else { return true };
        stretches.first().is_some_and(|first| first.at_position(0.0).0 >= b * (1.0 - SLOWER))
    }

    /// True if the plan so far comes to rest so soon that nothing is gained by another.
    fn rests_soon(&self) -> bool {
        let left: f64 = self.tail.iter().map(|leg| leg.stretch.duration()).sum();
        left < SOON || self.tail.len() < FEW
    }

    /// Hands out the first `legs` of the plan so far.
    fn go_on(&mut self, legs: usize) {
        let mut now = std::mem::take(&mut self.tail);
        self.tail = now.split_off(legs.min(now.len()));
        self.unplan();
        if let Some(last) = now.last() {
            self.skip_to(&last.element, last.from + last.stretch.length());
        }
        self.beginning = match self.tail.first() {
            Some(Leg { stretch, start, .. }) => {
                self.near = *start;
                let (b, a) = stretch.at_position(0.0);
                Beginning::Moving { b, a }
            }
            None => Beginning::Rest,
        };
        self.ready.extend(now.into_iter().map(|leg| Ok(Planned::Leg(leg))));
    }
}
