//! Plan executor: executes a plan while it is made, and splices in a new plan while the old one runs.
//!
//! ```text
//!   now                now + lead
//!    │ executed as planned │ the old plan, to rest …
//!                          └▶ the new plan, if it is there before this place is reached
//! ```

use super::planner::{Behind, Leg, LimitError, Piece, Planned, Request};
use crate::blended_path::BlendedElement;
use std::collections::VecDeque;
use std::sync::Arc;

/// Lead of a new plan over the executed one, and the time planned ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lead {
    /// Items that begin within this time, s, are executed as planned: time for replanning.
    pub first: f64,
    /// With every new plan that comes too late the lead is doubled, up to this, s.
    pub most: f64,
    /// Time planned ahead, s.
    pub lookahead: f64,
}

impl Default for Lead {
    /// 0.1 s to 1.6 s, and 1 s.
    fn default() -> Self {
        Self { first: 0.1, most: 1.6, lookahead: 1.0 }
    }
}

/// Arrival of a piece: taken, outdated, or too late.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// It is executed when its turn comes.
    PlanExecutor,
    /// It belongs to a plan that was given up.
    Outdated,
    /// The place where it begins has been passed: another has to be asked for ([`PlanExecutor::ask_again`]).
    Late,
}

/// Plan executor: it has a plan that ends at rest at any time, whatever the planning side ([`Pieces`](super::Pieces))
/// does. A new plan replaces the old one only if it arrives before the place where they part.
///
/// So the axes are never without a plan within their limits. How long an override takes to count: the lead, at most twice the time
/// that planning takes. How long a feed hold takes at most, even if no plan ever comes again: to the end of what is planned,
/// [`Self::ahead`], which is where the path rests.
#[derive(Debug)]
pub struct PlanExecutor<E> {
    lead: Lead,
    /// What is used at present, s.
    current: f64,
    /// What was planned and begins with the item `next`.
    queue: VecDeque<Result<Planned, LimitError<E>>>,
    next: u64,
    /// How the path comes to rest behind it, and what then.
    rest: VecDeque<Leg>,
    behind: Behind,
    /// Where the path is behind the last item.
    last: Option<(Arc<BlendedElement>, f64)>,
    /// The first item that is not in the plan of the other side, perhaps, and what was executed from there on.
    fork: u64,
    passed: VecDeque<Result<Planned, LimitError<E>>>,
    factor: f64,
    requests: u64,
    /// Where the plan that was asked for last is to begin.
    asked: Option<u64>,
    /// Where the one began that came last.
    begins: u64,
    late: u64,
}

impl<E: Clone> PlanExecutor<E> {
    /// Before the first piece.
    pub fn new(lead: Lead) -> Self {
        Self {
            lead,
            current: lead.first,
            queue: VecDeque::new(),
            next: 0,
            rest: VecDeque::new(),
            behind: Behind::More,
            last: None,
            fork: 0,
            passed: VecDeque::new(),
            factor: 1.0,
            requests: 0,
            asked: None,
            begins: 0,
            late: 0,
        }
    }

    /// Asks for a plan with another override: [`Planner::set_override`](super::Planner::set_override). Until it is there the old
    /// one goes on.
    pub fn set_override(&mut self, factor: f64) -> Request<E> {
        self.factor = factor;
        self.current = self.lead.first;
        self.ask()
    }

    /// Asks again after a piece that was [`Arrival::Late`], or where the path goes to rest because none has come, with twice the
    /// lead.
    pub fn ask_again(&mut self) -> Request<E> {
        self.late += 1;
        self.current = (2.0 * self.current).min(self.lead.most);
        self.ask()
    }

    fn ask(&mut self) -> Request<E> {
        let mut left = self.current;
        let queued = self.queue.iter().take_while(|item| {
            let on = left > 0.0 && !self.waits_before(item);
            left -= takes(item);
            on
        });
        let queued = queued.count();
        let resting = self.rest.iter().take_while(|leg| {
            let on = queued == self.queue.len() && left > 0.0;
            left -= leg.stretch.duration();
            on
        });
        let resting = resting.count();
        let from = self.next + (queued + resting) as u64;
        // What is in both plans needs not be said.
        let known = usize::try_from(self.fork.saturating_sub(self.next)).unwrap_or(usize::MAX);
        let skip = known.min(queued);
        let kept = self.queue.iter().take(queued).skip(skip);
        let mut passed: Vec<_> = self.passed.iter().chain(kept).cloned().collect();
        passed.extend(self.rest.iter().take(resting).cloned().map(|leg| Ok(Planned::Leg(leg))));
        let fork = from - passed.len() as u64;
        self.fork = fork;
        self.requests += 1;
        self.asked = Some(from);
        Request {
            number: self.requests,
            factor: self.factor,
            fork,
            passed,
            old: self.old(queued, resting),
        }
    }

    /// The plan from this item on to where the path next rests.
    fn old(&self, queued: usize, resting: usize) -> Vec<Leg> {
        let mut old = Vec::new();
        for item in self.queue.iter().skip(queued) {
            match item {
                Ok(Planned::Leg(leg)) => old.push(leg.clone()),
                _ => return old,
            }
            if old.last().is_some_and(Leg::ends_at_rest) {
                return old;
            }
        }
        old.extend(self.rest.iter().skip(resting).cloned());
        old
    }

    /// Takes a piece over, if it is in time.
    pub fn receive(&mut self, piece: Piece<E>) -> Arrival {
        let Piece { answers, first, items, rest, behind } = piece;
        if answers != self.requests {
            return Arrival::Outdated;
        }
        if first < self.next {
            return Arrival::Late;
        }
        let keep = usize::try_from(first - self.next).unwrap_or(usize::MAX);
        self.queue.truncate(keep);
        let missing = keep - self.queue.len();
        let resting = self.rest.drain(..missing.min(self.rest.len()));
        self.queue.extend(resting.map(|leg| Ok(Planned::Leg(leg))));
        self.queue.extend(items);
        self.rest = rest.into();
        self.behind = behind;
        // From here on both sides have the same plan.
        self.fork = self.next + self.queue.len() as u64;
        self.passed.clear();
        if self.asked.take().is_some() {
            self.current = self.lead.first;
            self.begins = first;
        }
        Arrival::PlanExecutor
    }

    /// Takes the next item to execute; none at the end. If nothing further is planned and the path rests, it is
    /// [`Planned::Hold`].
    pub fn take(&mut self) -> Option<Result<Planned, LimitError<E>>> {
        let waits = self.queue.front().filter(|next| self.waits_before(next));
        if let Some(Ok(next)) = waits {
            let (element, at) = match next {
                Planned::Leg(leg) => (&leg.element, leg.from),
                Planned::Pause(element) | Planned::Hold { element, .. } => (element, 0.0),
            };
            return Some(Ok(Planned::Hold { element: Arc::clone(element), at }));
        }
        let item = match self.queue.pop_front() {
            Some(item) => item,
            None => match self.rest.pop_front() {
                Some(leg) => Ok(Planned::Leg(leg)),
                None => return self.at_rest(),
            },
        };
        if self.next >= self.fork {
            self.passed.push_back(item.clone());
        }
        self.next += 1;
        match &item {
            Ok(Planned::Leg(leg)) => {
                let to = leg.from + leg.stretch.length();
                self.last = Some((Arc::clone(&leg.element), to));
            }
            Ok(Planned::Pause(element)) => self.last = Some((Arc::clone(element), 0.0)),
            Ok(Planned::Hold { .. }) | Err(_) => {}
        }
        Some(item)
    }

    /// True if the path is held and rests before an item: it does not begin what it would have to brake from.
    fn waits_before(&self, item: &Result<Planned, LimitError<E>>) -> bool {
        self.factor <= 0.0
            && match item {
                Ok(Planned::Leg(leg)) => leg.begins_at_rest(),
                Ok(_) => true,
                Err(_) => false,
            }
    }

    fn at_rest(&self) -> Option<Result<Planned, LimitError<E>>> {
        let (element, at) = match &self.behind {
            Behind::End => return None,
            Behind::Hold { element, at } => (Arc::clone(element), *at),
            Behind::More => self.last.clone()?,
        };
        Some(Ok(Planned::Hold { element, at }))
    }

    /// True if the path goes to rest because nothing has come in time, and nothing was asked for that could change it.
    pub fn is_starving(&self) -> bool {
        self.asked.is_none() && self.next > self.fork && !self.rest.is_empty()
    }

    /// True if nothing is known of the plan yet.
    pub fn is_new(&self) -> bool {
        self.last.is_none() && self.queue.is_empty() && matches!(self.behind, Behind::More)
    }

    /// True if another piece is needed now: as an answer to a request, or because the end of the plan is near.
    pub fn wants_more(&self) -> bool {
        self.asked.is_some()
            || matches!(self.behind, Behind::More) && self.ahead() < self.lead.lookahead
    }

    /// Planned time left, s, before the path would go to rest without a new plan.
    pub fn ahead(&self) -> f64 {
        self.queue.iter().map(takes).sum()
    }

    /// Begin of the plan that was requested last, as long as it has not come.
    pub fn waits_for(&self) -> Option<u64> {
        self.asked
    }

    /// Items below this number will not be asked back.
    pub fn needs(&self) -> u64 {
        self.fork.min(self.next)
    }

    /// True if the executed items belong to the plan that was requested last.
    pub fn follows(&self) -> bool {
        let rests = self.queue.is_empty() && !matches!(self.behind, Behind::More);
        self.asked.is_none() && (self.next > self.begins || rests)
    }

    /// Number of plans that came too late.
    pub fn late(&self) -> u64 {
        self.late
    }
}

/// Minimum duration of an item, s.
fn takes<E>(item: &Result<Planned, LimitError<E>>) -> f64 {
    match item {
        Ok(Planned::Leg(leg)) => leg.stretch.duration(),
        _ => 0.0,
    }
}
