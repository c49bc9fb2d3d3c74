//! The largest feed of an element: planned anew with lower feeds until an axis keeps its limits.

use super::pieces::{LITTLE, Open, PieceCheck, Quantity, SAME_TIME, Wrong};
use crate::limit::MachinePath;
use crate::tolerance::exceeds;
use twin_kinematics::MAX_AXES;
use twin_number::seconds;
use twin_planner::controller::trapezoid;
use twin_planner::extremes::{AxisExtremes, Examiner, Floor, Largest};

/// Feeds are distinguished to this part of them.
const SAME: f64 = 1e-12;
/// A feed below this part of the present one is none.
const LEAST_PART: f64 = 1e-3;
/// Parts of a feed with which a value is looked at again: lower feeds may be worse.
const PARTS: [f64; 6] = [1.0, 0.9, 0.7, 0.5, 0.25, 0.1];

/// The floor below which no extreme counts.
const UNLIMITED: Floor = Floor {
    position: [f64::NEG_INFINITY, f64::INFINITY],
    velocity: f64::INFINITY,
    acceleration: f64::INFINITY,
    deceleration: None,
    jerk: f64::INFINITY,
};

impl PieceCheck<'_> {
    /// The largest feed of an element below which a value stays within its limit, mm/s; none if no feed is small enough.
    pub(super) fn largest_feed(&self, open: &Open, wrong: &Wrong) -> Option<f64> {
        if matches!(wrong.quantity, Quantity::Step) {
            return None;
        }
        let holds = |feed: f64| {
            self.value(open, wrong, feed).is_some_and(|value| !exceeds(value, wrong.limit))
        };
        // Lower feeds may be worse: none counts below which it does not hold.
        let fails = |feed: f64| {
            let lower = PARTS.into_iter().map(|part| part * feed);
            lower.into_iter().find(|feed| !holds(*feed))
        };
        let (mut below, mut top) = (open.fastest, open.fastest);
        while let Some(failing) = fails(below) {
            (below, top) = (0.5 * failing, failing);
            if below < LEAST_PART * open.fastest {
                return None;
            }
        }
        while top > below * (1.0 + SAME) {
            let middle = below.midpoint(top);
            match fails(middle) {
                None => below = middle,
                Some(_) => top = middle,
            }
        }
        Some(below * 1e3)
    }

    /// The value with a `feed` (m/s) on the element.
    fn value(&self, open: &Open, wrong: &Wrong, feed: f64) -> Option<f64> {
        let Wrong { axis, quantity, limit, .. } = *wrong;
        let little = LITTLE * limit;
        let mut floor = self.unlimited(axis)?;
        match quantity {
            Quantity::Velocity => floor.velocity = little,
            Quantity::Acceleration => floor.acceleration = little,
            Quantity::Deceleration => floor.deceleration = Some(little),
            Quantity::Step => {}
        }
        let found = self.extremes(&self.path, open, (axis, floor), [feed, 1.0])?;
        Some(match quantity {
            Quantity::Velocity => found.velocity.value,
            Quantity::Acceleration => found.acceleration.value,
            Quantity::Deceleration => found.deceleration.value,
            Quantity::Step => found.step.value,
        })
    }

    /// The floor of an axis whose extremes do not count.
    pub(super) fn unlimited(&self, axis: usize) -> Option<Floor> {
        let axis = self.machine.axes.get(axis)?;
        let deceleration = axis.own_deceleration().map(|_| f64::INFINITY);
        // What is 0 is known from the largest velocity.
        Some(Floor { deceleration, velocity: axis.max_velocity, ..UNLIMITED })
    }

    /// Extremes of one axis above its floor, with a `feed` (m/s) on the element and a `part` of its accelerations; `position` is the
    /// first beyond the floor.
    pub(super) fn extremes(
        &self,
        path: &MachinePath<'_>,
        open: &Open,
        (axis, floor): (usize, Floor),
        [feed, part]: [f64; 2],
    ) -> Option<AxisExtremes> {
        let element = &open.element;
        let rates = [element.acceleration(), element.deceleration()].map(|rate| part * rate);
        let pieces = trapezoid(element.length(), open.ends, feed, rates);
        let mut floors = [UNLIMITED; MAX_AXES];
        *floors.get_mut(axis)? = floor;
        let examiner = Examiner::new(path, seconds(self.machine.cycle_ns));
        let mut largest = AxisExtremes::default();
        let mut near = open.near;
        // Velocity at the end of the piece before; where it is not known, nothing steps.
        let mut before = (open.ends[0] <= 0.0).then_some(0.0);
        for piece in pieces.iter().filter(|piece| piece.duration >= SAME_TIME) {
            let found = examiner.examine(element, piece, &near, &floors, None).ok()?;
            let [start, end] = &found.ends;
            near = end.position;
            let step = before
                .map_or(0.0, |before| start.rates[0].get(axis).map_or(0.0, |v| (v - before).abs()));
            before = end.rates[0].get(axis).copied();
            let found = found.axes.get(axis)?;
            largest.position = largest.position.or(found.position);
            for (most, one) in [
                (&mut largest.velocity, found.velocity),
                (&mut largest.acceleration, found.acceleration),
                (&mut largest.deceleration, found.deceleration),
                (&mut largest.step, Largest { value: found.step.value.max(step), ..found.step }),
            ] {
                if one.value > most.value {
                    *most = one;
                }
            }
        }
        if let Some(last) = before.filter(|_| open.ends[1] <= 0.0) {
            largest.step.value = largest.step.value.max(last.abs());
        }
        Some(largest)
    }
}
