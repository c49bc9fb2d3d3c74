//! Plan pieces: hands the plan in parts to a separate executor, each with a way to rest.

use super::{Leg, LimitError, Planned, Planner};
use crate::blended_path::BlendedElement;
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::feeds::Feeds;
use crate::time_optimal::planner::backlog::rests;
use crate::time_optimal::smooth::Beginning;
use std::collections::VecDeque;
use std::sync::Arc;
use twin_path::prepare::CheckedElement;

/// Piece of a plan, handed over at once. Its items are numbered; they replace all earlier items from the number of the
/// first on.
#[derive(Clone, Debug)]
pub struct Piece<E> {
    /// Number of requests obeyed before.
    pub answers: u64,
    /// The number of the first item.
    pub first: u64,
    /// Motion, pauses and errors.
    pub items: Vec<Result<Planned, LimitError<E>>>,
    /// Way to rest behind them if nothing else comes in time; empty if the path rests anyway.
    pub rest: Vec<Leg>,
    /// Continuation after them.
    pub behind: Behind,
}

/// Continuation behind a piece.
#[derive(Clone, Debug, Default)]
pub enum Behind {
    /// Another one.
    #[default]
    More,
    /// Nothing until another override: the path is held, and would go on here.
    Hold {
        /// The element that is next.
        element: Arc<BlendedElement>,
        /// Its place on it, m.
        at: f64,
    },
    /// Nothing.
    End,
}

/// Asks for another plan from some place on.
#[derive(Clone, Debug)]
pub struct Request<E> {
    /// Number of the request, from 1.
    pub number: u64,
    /// The override, as for [`Planner::set_override`].
    pub factor: f64,
    /// The number of the first item that is not in both plans, that which is executed and that which was made last.
    pub fork: u64,
    /// Items executed from there on until the new plan begins.
    pub passed: Vec<Result<Planned, LimitError<E>>>,
    /// Way to rest from there.
    pub old: Vec<Leg>,
}

impl<E> Request<E> {
    /// The number of the first item of the new plan.
    pub fn from(&self) -> u64 {
        self.fork.saturating_add(self.passed.len() as u64)
    }
}

/// A [`Planner`] that hands out its plan in pieces, each with a way to rest: the executor always has a plan that ends
/// at rest, and keeps the old one until a new one arrives ([`PlanExecutor`](crate::time_optimal::PlanExecutor)).
#[derive(Debug)]
pub struct Pieces<I, E, A> {
    planner: Planner<I, E, A>,
    /// What was handed out and may have to be taken back, from the number `oldest` on.
    record: VecDeque<Result<Planned, LimitError<E>>>,
    oldest: u64,
    answers: u64,
    /// Nothing is planned until a request.
    resting: bool,
}

impl<I, E, A> Pieces<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    E: Clone,
    A: AxisPath,
{
    /// Of the plan of `planner`, of which nothing was handed out yet.
    pub fn new(planner: Planner<I, E, A>) -> Self {
        Self { planner, record: VecDeque::new(), oldest: 0, answers: 0, resting: false }
    }

    /// The planner.
    pub fn planner(&self) -> &Planner<I, E, A> {
        &self.planner
    }

    /// True if there is nothing to plan until the next request.
    pub fn is_resting(&self) -> bool {
        self.resting
    }

    /// Items below this number will not be asked back: [`PlanExecutor::needs`](crate::time_optimal::PlanExecutor::needs).
    pub fn forget(&mut self, number: u64) {
        while self.oldest < number && self.record.pop_front().is_some() {
            self.oldest += 1;
        }
    }

    /// Plans the next piece.
    pub fn next_piece(&mut self) -> Piece<E> {
        let mut items = Vec::new();
        let behind = match self.planner.next() {
            Some(Ok(Planned::Hold { element, at })) => Behind::Hold { element, at },
            Some(item) => {
                items.push(item);
                items.extend(self.planner.ready.drain(..));
                Behind::More
            }
            None => Behind::End,
        };
        self.resting = !matches!(behind, Behind::More);
        let first = self.oldest.saturating_add(self.record.len() as u64);
        self.record.extend(items.iter().cloned());
        let moving = self.planner.beginning != Beginning::Rest;
        let rest = if moving { self.planner.tail.clone() } else { Vec::new() };
        Piece { answers: self.answers, first, items, rest, behind }
    }

    /// The next piece is the new plan.
    pub fn obey(&mut self, request: Request<E>) {
        let Request { number, factor, fork, passed, old } = request;
        self.answers = number;
        self.resting = false;
        let kept = usize::try_from(fork.saturating_sub(self.oldest)).unwrap_or(usize::MAX);
        let back = self.record.split_off(kept.min(self.record.len()));
        self.planner.take_back(back);
        self.planner.pass(&passed);
        if !passed.is_empty() {
            // What the override was when that was planned nobody knows any more.
            self.planner.sampler.feeds = Feeds::new(f64::INFINITY);
        }
        self.planner.begin_with(old);
        self.record.extend(passed);
        self.planner.set_override(factor);
    }
}

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Leaves out what was executed of a plan that is given up.
    fn pass(&mut self, passed: &[Result<Planned, LimitError<E>>]) {
        for item in passed {
            if let Ok(Planned::Leg(leg)) = item {
                self.skip_to(&leg.element, leg.from + leg.stretch.length());
            } else {
                self.skip_pause();
            }
        }
    }

    /// Goes on from where `old` begins, which is the plan so far from there to rest.
    fn begin_with(&mut self, old: Vec<Leg>) {
        self.beginning = match old.first() {
            Some(first) => {
                self.near = first.start;
                match first.stretch.at_position(0.0) {
                    (b, _) if rests(b) => Beginning::Rest,
                    (b, a) => Beginning::Moving { b, a },
                }
            }
            None => Beginning::Rest,
        };
        self.tail = old;
    }
}
