//! Faults at set-points of a plan, each reported once per line.

use crate::finding::{Finding, Rule};
use crate::messages::{beyond_position, no_axes};
use std::collections::VecDeque;
use twin_kinematics::AxisVector;
use twin_machine::axis_couplings::AxesError;
use twin_machine::{Axis, Machine};
use twin_path::{LineKey, Place};

/// Watcher of set-points. Every fault is reported once per line.
#[derive(Debug)]
pub(super) struct Watch<'m> {
    axes: &'m [Axis],
    /// The place, on the line at hand, that takes each axis farthest beyond its software limits; the line on which …
    beyond: Vec<Option<(Place, f64)>>,
    /// … each motor was last found too weak to hold its axis, …
    overloaded: Vec<Option<LineKey>>,
    /// … and on which the tool was last found out of reach.
    unreached: Option<LineKey>,
    found: VecDeque<Finding>,
}

impl<'m> Watch<'m> {
    /// Nothing found yet.
    pub(super) fn new(machine: &'m Machine) -> Self {
        let none = vec![None; machine.axes.len()];
        Self {
            axes: &machine.axes,
            beyond: vec![None; machine.axes.len()],
            overloaded: none,
            unreached: None,
            found: VecDeque::new(),
        }
    }

    /// The next thing found.
    pub(super) fn take(&mut self) -> Option<Finding> {
        self.found.pop_front()
    }

    /// Something else that was found.
    pub(super) fn tell(&mut self, finding: Finding) {
        self.found.push_back(finding);
    }

    /// Checks the axes against their software limits.
    pub(super) fn positions(&mut self, place: Place, positions: &AxisVector) {
        for ((axis, position), worst) in
            self.axes.iter().zip(positions.iter()).zip(&mut self.beyond)
        {
            let [low, high] = axis.position_limits;
            let far = |position: f64| (position - position.clamp(low, high)).abs();
            if let Some((at, _)) = worst
                && at.key() != place.key()
                && let Some((at, position)) = worst.take()
            {
                self.found.extend(beyond_position(axis, at, position));
            }
            if low <= high && far(*position) > worst.map_or(0.0, |(_, position)| far(position)) {
                *worst = Some((place, *position));
            }
        }
    }

    /// Nothing follows.
    pub(super) fn finish(&mut self) {
        for (axis, worst) in self.axes.iter().zip(&mut self.beyond) {
            if let Some((at, position)) = worst.take() {
                self.found.extend(beyond_position(axis, at, position));
            }
        }
    }

    /// Motors that cannot hold their axes, with what that would take.
    pub(super) fn motors(&mut self, place: Place, overloaded: impl Iterator<Item = (usize, f64)>) {
        for (index, effort) in overloaded {
            let reported = self.overloaded.get_mut(index);
            if let (Some(axis), Some(reported)) = (self.axes.get(index), reported)
                && *reported != Some(place.key())
            {
                *reported = Some(place.key());
                self.found.push_back(overload(axis, place, effort));
            }
        }
    }

    /// The machine cannot go there.
    pub(super) fn refused(&mut self, place: Place, error: &AxesError) {
        if self.unreached.replace(place.key()) != Some(place.key()) {
            self.found.push_back(no_axes(place, error));
        }
    }
}

/// A motor that cannot hold its axis, which would take `effort`, N or Nm.
fn overload(axis: &Axis, place: Place, effort: f64) -> Finding {
    let limit = axis.effort_limit().unwrap_or(f64::INFINITY);
    let (name, unit) = (axis.kind.effort_name(), axis.kind.effort_unit());
    let message = format!(
        "axis {}: weight and dry friction take a {name} of {effort:.4} {unit}, above the limit {limit:.4} {unit} of its motor; \
         reduce the load, or use a stronger motor",
        axis.name
    );
    let finding = Finding::error(Rule::AxisEffort, place, message);
    Finding { axis: Some(axis.name.clone()), ..finding.with_value(effort, limit, unit) }
}
