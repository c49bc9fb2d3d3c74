//! Smallest distance of a program from the edge of the reach.

use crate::limit::MachinePath;
use std::f64::consts::TAU;
use twin_kinematics::{Kinematics, Pose};
use twin_machine::Machine;
use twin_path::Place;
use twin_planner::blended_path::BlendedElement;

/// Error of the distance, and the shortest part of a path that is looked into, m.
const EXACT: f64 = 1e-5;

/// The point of a path that is nearest to the edge of the reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeDistance {
    /// How far the tool, or the wrist of a SCARA with three arms, is from the edge, or the platform of a tripod below the plane
    /// in which the mechanism loses its stiffness, m; 0 at the edge.
    pub distance: f64,
    /// The block.
    pub place: Place,
}

/// Search for it, element by element.
#[derive(Debug)]
pub(super) struct EdgeSearch<'m> {
    machine: &'m Machine,
    pub(super) nearest: Option<EdgeDistance>,
}

impl<'m> EdgeSearch<'m> {
    /// None if the machine has no such edge.
    pub(super) fn new(machine: &'m Machine) -> Option<Self> {
        let pose = machine.kinematics.forward(&machine.middle());
        let margins = pose.and_then(|pose| machine.kinematics.margins(&pose));
        let is_open = margins.is_ok_and(|one| one.boundary.min(one.branch) == f64::INFINITY);
        (!is_open).then_some(Self { machine, nearest: None })
    }

    /// Takes an element. On a way of length w the distance changes by no more than w, and by what the last arm swings where
    /// the tool turns: a part in which it cannot fall below the smallest so far is not looked into. The height of a tripod's
    /// plane, which usual tripods reach only beyond the edge, is looked at in the same places.
    pub(super) fn take(&mut self, path: &MachinePath<'_>, element: &BlendedElement) {
        let distance = |s: f64| {
            let pose = path.pose(element, s);
            let margins = self.machine.kinematics.margins(&pose);
            (margins.map_or(f64::INFINITY, |margins| margins.boundary.min(margins.branch)), pose)
        };
        let swing = |one: &Pose, other: &Pose| {
            let turn = (one.direction - other.direction).rem_euclid(TAU);
            turn.min(TAU - turn) * self.machine.kinematics.characteristic_length()
        };
        let place = element.place();
        let length = element.length();
        let mut nearest = self.nearest.map_or(f64::INFINITY, |nearest| nearest.distance);
        let mut left = vec![[0.0, length]];
        while let Some([from, to]) = left.pop() {
            let ((one, start), (other, end)) = (distance(from), distance(to));
            if one.min(other) == f64::INFINITY {
                // The machine does not come here.
                return;
            }
            let least = one.min(other).max(0.0);
            if least < nearest {
                nearest = least;
                self.nearest = Some(EdgeDistance { distance: least, place });
            }
            let bound = 0.5 * (one + other - (to - from) - swing(&start, &end));
            if bound < nearest - EXACT && nearest > 0.0 && to - from > EXACT {
                let middle = from.midpoint(to);
                left.extend([[middle, to], [from, middle]]);
            }
        }
    }
}
