//! Override, feed hold and their end: planning anew from where the path is.

use super::slowest::Slowest;
use super::{Leg, NoWindow, Planned, Planner};
use crate::limit::axis_path::AxisPath;
use crate::limit::feeds::Feeds;
use crate::limit::smooth::Beginning;
use crate::prepare::CheckedElement;
use std::sync::Arc;

/// By how much tighter acceleration and jerk are limited when the slowest profile is looked for: with what is left the plan about it
/// keeps the limits between the nodes as well.
const ROOM: [[f64; 2]; 3] = [[1.005, 1.01], [1.02, 1.05], [1.1, 1.15]];
/// A plan that comes to rest within this time, s, is not worth another.
const SOON: f64 = 0.02;
/// Nor is one of fewer legs.
const FEW: usize = 4;
/// Where no plan was found the path goes on as it was planned for about this time, s.
const GO_ON: f64 = 0.1;

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// The largest override.
    pub const LARGEST_OVERRIDE: f64 = 2.0;

    /// Multiplies all programmed velocities, those of rapids included, by `factor` in all that has not been handed out yet, or
    /// has been taken back ([`Self::take_back`]): 0 to [`Self::LARGEST_OVERRIDE`], what is beyond counts as these, and no number
    /// as 0. The limits of the axes stay as they are.
    pub fn set_override(&mut self, factor: f64) {
        // Also of what is no number.
        self.asked = factor.max(0.0).min(Self::LARGEST_OVERRIDE);
        self.take_back([]);
    }

    /// The override asked for.
    pub fn override_factor(&self) -> f64 {
        self.asked
    }

    /// Whether the path rests, or will behind what was handed out, until an override lets it go on.
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
            self.go_on(f64::INFINITY);
        }
        if self.beginning == Beginning::Rest {
            if self.asked > 0.0 {
                self.sampler.feeds = Feeds::new(self.asked);
            } else {
                self.held = true;
            }
            return;
        }
        self.effort.replanned += 1;
        let before = (self.sampler.feeds.clone(), self.effort.failed);
        for room in ROOM {
            if let Ok(slowest) = self.slowest(room)
                && self.plan_above(&slowest).is_ok()
            {
                self.pass_stop();
                return;
            }
            self.unplan();
            (self.sampler.feeds, self.effort.failed) = before.clone();
        }
        self.effort.not_replanned += 1;
        self.changed = true;
        self.go_on(GO_ON);
    }

    /// A window no slower than `slowest`.
    fn plan_above(&mut self, slowest: &Slowest) -> Result<(), NoWindow> {
        if self.asked <= 0.0
            && let Some((element, s)) = slowest.rest()
        {
            let element = Arc::clone(element);
            self.hold_at(&element, s);
        }
        self.sampler.feeds = slowest.feeds(self.asked);
        self.plan_window()
    }

    /// Whether the plan so far comes to rest so soon that nothing is gained by another.
    fn rests_soon(&self) -> bool {
        let left: f64 = self.tail.iter().map(|leg| leg.stretch.duration()).sum();
        left < SOON || self.tail.len() < FEW
    }

    /// Hands out what was planned so far, for about `time` s or to rest.
    fn go_on(&mut self, time: f64) {
        let mut left = time;
        let later = self.tail.iter().position(|leg| {
            let later = left <= 0.0;
            left -= leg.stretch.duration();
            later
        });
        let old = std::mem::take(&mut self.tail);
        self.unplan();
        if let Some(last) = old.get(later.unwrap_or(old.len()).saturating_sub(1)) {
            self.skip_to(&last.element, last.from + last.stretch.length());
        }
        let (now, tail) = old.split_at(later.unwrap_or(old.len()));
        self.beginning = match tail.first() {
            Some(Leg { stretch, start, .. }) => {
                self.near = *start;
                let (b, a) = stretch.at_position(0.0);
                Beginning::Moving { b, a }
            }
            None => Beginning::Rest,
        };
        self.tail = tail.to_vec();
        self.ready.extend(now.iter().map(|leg| Ok(Planned::Leg(leg.clone()))));
    }
}
