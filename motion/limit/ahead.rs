//! Override, feed hold and acknowledgements while set-points are made.
//!
//! ```text
//!   now          now + lead                          now + lookahead
//!    │ executed as planned │ taken back, planned anew │ planned later
//! ```

use super::axis_path::AxisPath;
use super::follow::{Current, Follower};
use super::planner::{LimitError, Planned, Planner};
use crate::prepare::CheckedElement;

/// A plan that can be made anew from where it is executed next.
///
/// [`Planner`] is one that plans when its next item is asked for. A session with a thread for planning has one of its own that
/// hands items and calls to and fro; its [`Self::is_ready`] tells whether the next item is there.
pub trait Replan<E> {
    /// Takes back what was handed out last and will not be executed: [`Planner::take_back`].
    fn take_back(&mut self, planned: Vec<Result<Planned, LimitError<E>>>);

    /// [`Planner::set_override`], for what follows.
    fn set_override(&mut self, factor: f64);

    /// [`Planner::abandon`].
    fn abandon(&mut self);

    /// Whether the next item can be had without waiting longer than is good.
    fn is_ready(&self) -> bool {
        true
    }
}

impl<I, E, A> Replan<E> for Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    fn take_back(&mut self, planned: Vec<Result<Planned, LimitError<E>>>) {
        Planner::take_back(self, planned);
    }

    fn set_override(&mut self, factor: f64) {
        Planner::set_override(self, factor);
    }

    fn abandon(&mut self) {
        Planner::abandon(self);
    }
}

/// How far ahead of the set-points the plan is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ahead {
    /// What begins within this time, ns, is executed as it was planned: time for planning anew. 0 where planning takes no
    /// time, as in a simulation.
    pub lead_ns: i64,
    /// So much is planned ahead, ns, if it is ready: no less than what planning a window takes beyond the lead.
    pub lookahead_ns: i64,
}

impl Ahead {
    /// For planning beside the set-points: 0.2 s, and 0.5 s.
    pub const PLANNING_BESIDE: Self = Self { lead_ns: 200_000_000, lookahead_ns: 500_000_000 };
}

impl<P, E> Follower<P>
where
    P: Iterator<Item = Result<Planned, LimitError<E>>> + Replan<E>,
{
    /// With a plan that is so far ahead; else it is asked for one item at a time.
    #[must_use]
    pub fn with_ahead(mut self, ahead: Ahead) -> Self {
        self.ahead = ahead;
        self
    }

    /// With M functions that last until [`Self::acknowledge`], whatever [`Self::with_m_times`] says.
    #[must_use]
    pub fn with_acknowledgement(mut self) -> Self {
        self.acknowledging = true;
        self
    }

    /// The M function that was shown for at least a cycle is done: the path goes on at the next set-point. Nothing else is
    /// acknowledged in advance.
    pub fn acknowledge(&mut self) {
        if let Some(Current::Still { from_ns, until_ns, .. }) = &mut self.current
            && *until_ns == i64::MAX
            && self.now_ns > *from_ns
        {
            *until_ns = self.now_ns;
        }
    }

    /// Multiplies programmed velocities by `factor`: [`Planner::set_override`]. What begins within the lead goes on as planned;
    /// from there the path brakes, or is faster, as fast as the limits of the axes allow. 0 is a feed hold: the path comes to
    /// rest as early as it can, on the path, and its set-points stay until another factor lets it go on.
    ///
    /// The next set-point asks for the new plan where there is no lead; else one of those before the lead is over does.
    pub fn set_override(&mut self, factor: f64) {
        let keep = self.within_lead();
        let back = self.queue.split_off(keep.min(self.queue.len()));
        self.stopping = false;
        self.plan.take_back(back.into());
        self.plan.set_override(factor);
        if matches!(self.current, Some(Current::Held { .. })) {
            // The path need not wait for the end of the cycle.
            self.current = Some(Current::Held { until_ns: self.now_ns });
        }
    }

    /// As an override of 0, and then the path ends where it rests. A pause that is under way ends at the next set-point.
    pub fn stop(&mut self) {
        self.set_override(0.0);
        self.stopping = true;
        if let Some(Current::Still { until_ns, .. }) = &mut self.current {
            *until_ns = (*until_ns).min(self.now_ns);
        }
    }

    /// Whether the path is held.
    pub fn is_held(&self) -> bool {
        matches!(self.current, Some(Current::Held { .. }))
    }

    /// Asks for as much of the plan as is wanted ahead and ready. Every set-point that takes over the next item does as well.
    pub fn plan_ahead(&mut self) {
        let Some(mut ahead) = self.until_queue().map(|until| until.saturating_sub(self.now_ns))
        else {
            return;
        };
        for item in &self.queue {
            let Some(takes) = self.takes_ns(item) else { return };
            ahead = ahead.saturating_add(takes);
        }
        while ahead < self.ahead.lookahead_ns && self.plan.is_ready() {
            let Some(item) = self.plan.next() else { return };
            let takes = self.takes_ns(&item);
            self.queue.push_back(item);
            let Some(takes) = takes else { return };
            ahead = ahead.saturating_add(takes);
        }
    }

    /// When the first item of the queue begins, ns; `None`: nobody knows.
    fn until_queue(&self) -> Option<i64> {
        match &self.current {
            Some(Current::Along { start, leg, .. }) => {
                Some(start.after(leg.stretch.duration()).ceil_ns())
            }
            Some(Current::Still { until_ns: i64::MAX, .. }) => None,
            Some(Current::Still { until_ns, .. } | Current::Held { until_ns }) => Some(*until_ns),
            None => Some(self.now_ns),
        }
    }

    /// How long an item takes, ns; `None`: nobody knows.
    fn takes_ns(&self, item: &Result<Planned, LimitError<E>>) -> Option<i64> {
        match item {
            Ok(Planned::Leg(leg)) => Some(nanoseconds(leg.stretch.duration())),
            Ok(Planned::Pause(element)) => self.pause_ns(element),
            Ok(Planned::Hold { .. }) => None,
            Err(_) => Some(0),
        }
    }

    /// How many items of the queue begin before the lead is over.
    fn within_lead(&self) -> usize {
        let end = self.now_ns.saturating_add(self.ahead.lead_ns);
        let mut begins = self.until_queue();
        let within = self.queue.iter().take_while(|item| {
            let Some(here) = begins.filter(|here| *here < end) else { return false };
            begins = self.takes_ns(item).map(|takes| here.saturating_add(takes));
            !matches!(item, Ok(Planned::Hold { .. }))
        });
        within.count()
    }
}

/// Of a time in s.
#[expect(clippy::cast_possible_truncation, reason = "the cast saturates")]
fn nanoseconds(seconds: f64) -> i64 {
    (seconds * 1e9) as i64
}
