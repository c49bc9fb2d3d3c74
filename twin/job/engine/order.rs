//! Execution order of axes: a master before its slaves, so that a slave sees its master's position of the same cycle.
//!
//! Couplings come and go, so an axis may become the master of an axis that it followed before. The order is therefore
//! computed anew whenever a block begins, from the couplings that hold then. The coupling of an axis is that of the
//! block that moves it last. Where a block takes over an axis, or waits for the end of a cam, the other coupling counts
//! too in that cycle if both can hold.

use super::super::{Begins, ON_TOP};
use super::{Engine, Running};
use crate::finding::{Finding, Rule};
use twin_machine::coupling_cycle;
use twin_path::Place;

/// A master and its slave.
pub(super) type Pair = (usize, usize);

/// The axes, masters first.
///
/// # Errors
/// A ring of axes that follow each other, from master to slave.
pub(super) fn masters_first(pairs: &[Pair], axes: usize) -> Result<Vec<usize>, Vec<usize>> {
    // Length of the chain of masters of an axis; in a ring it grows beyond the number of axes.
    let mut depths = vec![0usize; axes];
    for _ in 0..=axes {
        for (master, slave) in pairs {
            let above = depths.get(*master).copied().unwrap_or_default() + 1;
            if let Some(depth) = depths.get_mut(*slave) {
                *depth = above.max(*depth);
            }
        }
    }
    if depths.iter().any(|depth| *depth > axes) {
        return Err(coupling_cycle::find(pairs).unwrap_or_default());
    }
    let mut sorted: Vec<_> = depths.into_iter().zip(0..).collect();
    sorted.sort_unstable();
    Ok(sorted.into_iter().map(|(_, axis)| axis).collect())
}

impl Engine {
    /// Makes the order anew, if a block has begun since it was made.
    ///
    /// # Errors
    /// If axes would follow each other in a ring, at the block that closes it.
    pub(super) fn reorder(&mut self) -> Result<(), Box<Finding>> {
        if self.began.is_empty() {
            return Ok(());
        }
        let mut began = std::mem::take(&mut self.began);
        began.sort_unstable();
        let (holding, others) = self.couplings(&began);
        let all: Vec<_> = holding.iter().chain(&others).copied().collect();
        let count = self.axes.len();
        let order = masters_first(&all, count).or_else(|_ring| masters_first(&holding, count));
        self.order = order.map_err(|ring| self.ring(&ring, &began))?;
        Ok(())
    }

    /// Couplings that hold from this cycle on, in which these blocks begin, and others that may hold in this cycle.
    fn couplings(&self, began: &[usize]) -> (Vec<Pair>, Vec<Pair>) {
        let pair = |index: usize| {
            let call = &self.calls.get(index)?.call;
            Some((call.master?, call.axis))
        };
        let (mut holding, mut others) = (Vec::new(), Vec::new());
        for (axis, (moved, active)) in self.axes.iter().zip(&self.active).enumerate() {
            let takes = |index: &usize| {
                let running = self.calls.get(*index);
                running.is_some_and(|Running { call, .. }| {
                    call.axis == axis && !ON_TOP.contains(&call.name)
                })
            };
            let mut movers: Vec<_> = moved.taken_by.into_iter().collect();
            movers.extend(began.iter().filter(|index| takes(index)));
            let last = movers.pop();
            holding.extend(last.and_then(pair));
            others.extend(movers.into_iter().filter_map(pair));
            let waits = |index: &usize| {
                let running = self.calls.get(*index);
                running.is_some_and(|Running { call, begun_ns, .. }| {
                    call.begins == Begins::EndOfProfile && begun_ns.is_none()
                })
            };
            others.extend(active.iter().copied().filter(waits).filter_map(pair));
        }
        (holding, others)
    }

    fn ring(&self, ring: &[usize], began: &[usize]) -> Box<Finding> {
        let name = |axis: usize| self.name(axis);
        let closes = |index: &&usize| {
            let call = self.calls.get(**index).map(|running| &running.call);
            call.is_some_and(|call| {
                ring.windows(2).any(|pair| {
                    pair.first() == call.master.as_ref() && pair.get(1) == Some(&call.axis)
                })
            })
        };
        let closing = began.iter().rev().find(closes).and_then(|index| self.calls.get(*index));
        let line = closing.map_or(self.line, |running| running.call.line);
        let follows = closing.map_or(ring.first().copied(), |running| Some(running.call.axis));
        let follows = follows.map_or("", name);
        let message = format!(
            "axis {follows} would follow itself, by way of its masters: {}",
            coupling_cycle::message(ring, name)
        );
        let mut finding = Finding::error(Rule::Coupling, Place::at(line), message);
        finding.axis = Some(follows.to_owned());
        finding.hint = Some(
            "release one of the couplings before this block: with MC_CamOut, MC_GearOut, or a block that moves the slave on its own"
                .to_owned(),
        );
        finding.into()
    }
}
