//! Planning of the parts between stops on several cores.
//!
//! The plan behind a stop depends on the motion before it only through the turns of rotary axes, which the samples of the path
//! give. So the path is sampled in its order, and workers plan its parts. The plan is the same with any number of cores.

use super::{After, Effort, LimitError, Planned, Planner};
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::bound::Constraint;
use crate::time_optimal::cell::Cell;
use crate::time_optimal::follow::Replan;
use crate::time_optimal::smooth::Beginning;
use std::collections::BTreeMap;
use std::iter::Empty;
use std::sync::{Mutex, PoisonError};
use std::thread;
use twin_path::prepare::CheckedElement;

/// Cells that are sampled before they are planned.
const BATCH: usize = 1024;
/// A part with more cells is planned without the workers, window by window, which bounds the memory.
const LONGEST: usize = 1024;

type Item<E> = Result<Planned, LimitError<E>>;
type Worker<E, A> = Planner<Empty<Result<CheckedElement, E>>, E, A>;

/// A part of the path between two stops.
#[derive(Debug)]
struct Part<E> {
    cells: Vec<Cell>,
    after: After<E>,
}

/// The plan of a part.
#[derive(Debug)]
struct Done<E> {
    items: Vec<Item<E>>,
    effort: Effort,
    costs: BTreeMap<Constraint, f64>,
}

/// A [`Planner`] that plans the parts between stops on several cores: for plans that no override changes on the way. If one does,
/// it plans on its own from then on.
#[derive(Debug)]
pub struct ParallelPlanner<I, E, A> {
    planner: Planner<I, E, A>,
    workers: Vec<Worker<E, A>>,
}

impl<I, E, A> ParallelPlanner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Plans as `planner` does, on one core for each of `machines`: copies of its machine.
    pub fn new(planner: Planner<I, E, A>, machines: impl IntoIterator<Item = A>) -> Self {
        let worker = |axes| Planner::new(std::iter::empty(), axes, planner.options);
        let workers = machines.into_iter().map(worker).collect();
        Self { planner, workers }
    }

    /// The planner, with the effort and costs of all workers.
    pub fn planner(&self) -> &Planner<I, E, A> {
        &self.planner
    }
}

impl<I, E, A> ParallelPlanner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    E: Send,
    A: AxisPath + Send,
{
    /// Plans what comes next.
    fn plan(&mut self) {
        let Self { planner, workers } = self;
        let rests = planner.beginning == Beginning::Rest && planner.along_line.is_none();
        if workers.is_empty() || planner.changed || !rests {
            planner.plan();
            return;
        }
        let parts = planner.take_parts();
        if parts.is_empty() {
            planner.plan();
            return;
        }
        planner.over = parts.last().is_some_and(|part| matches!(part.after, After::End));
        for worker in &mut *workers {
            worker.sampler.feeds = planner.sampler.feeds.clone();
        }
        for done in plan_all(workers, parts) {
            planner.ready.extend(done.items);
            planner.effort.add(&done.effort);
            for (constraint, time) in done.costs {
                *planner.costs.entry(constraint).or_default() += time;
            }
        }
    }
}

/// The plans of `parts` in their order, by all of the workers.
fn plan_all<E, A>(workers: &mut [Worker<E, A>], parts: Vec<Part<E>>) -> Vec<Done<E>>
where
    E: Send,
    A: AxisPath + Send,
{
    let others = workers.len().min(parts.len()).saturating_sub(1);
    let done: Vec<_> = parts.iter().map(|_| Mutex::new(None)).collect();
    let left = Mutex::new(parts.into_iter().zip(&done));
    let work = |worker: &mut Worker<E, A>| {
        loop {
            let next = left.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some((part, slot)) = next else { break };
            let plan = worker.plan_part(part);
            *slot.lock().unwrap_or_else(PoisonError::into_inner) = Some(plan);
        }
    };
    thread::scope(|scope| {
        let Some((first, workers)) = workers.split_first_mut() else { return };
        for worker in workers.iter_mut().take(others) {
            let thread = thread::Builder::new().name("part planner".to_owned());
            // If the system refuses a thread, the others plan its parts.
            drop(thread.spawn_scoped(scope, || work(worker)));
        }
        work(first);
    });
    let done =
        done.into_iter().map(|slot| slot.into_inner().unwrap_or_else(PoisonError::into_inner));
    done.flatten().collect()
}

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// Samples the parts up to the next stops; empty if the next stop is too far away.
    fn take_parts(&mut self) -> Vec<Part<E>> {
        let mut parts = Vec::new();
        let mut known = 0;
        while known < BATCH {
            while self.after.is_none() && self.cells.len() < LONGEST {
                self.pull();
            }
            let Some(after) = self.after.take() else { break };
            let cells = std::mem::take(&mut self.cells);
            known += cells.len().max(1);
            let ends = matches!(after, After::End);
            parts.push(Part { cells, after });
            if ends {
                break;
            }
        }
        parts
    }

    /// Plans a part from rest to rest.
    fn plan_part(&mut self, Part { cells, after }: Part<E>) -> Done<E> {
        if let Some(last) = cells.last() {
            self.near = last.end.position;
        }
        (self.cells, self.after, self.beginning) = (cells, Some(after), Beginning::Rest);
        loop {
            let has_none = self.cells.is_empty() && self.after.is_none();
            if self.over || (has_none && self.returned.is_empty()) {
                break;
            }
            self.plan();
        }
        self.over = false;
        let items = self.ready.drain(..).collect();
        let (effort, costs) = (std::mem::take(&mut self.effort), std::mem::take(&mut self.costs));
        Done { items, effort, costs }
    }
}

impl<I, E, A> Iterator for ParallelPlanner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    E: Send,
    A: AxisPath + Send,
{
    type Item = Item<E>;

    fn next(&mut self) -> Option<Item<E>> {
        while self.planner.ready.is_empty() && !self.planner.over && !self.planner.held {
            self.plan();
        }
        self.planner.next()
    }
}

impl<I, E, A> Replan for ParallelPlanner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    fn set_override(&mut self, factor: f64) {
        self.workers.clear();
        self.planner.set_override(factor);
    }

    fn abandon(&mut self) {
        self.planner.abandon();
    }
}
