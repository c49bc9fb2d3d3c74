//! Search for the binding limit at a sample of the time-optimal plan.

use super::plan::{LimitRules, Profile};
use super::{Binding, ProfileSample, Quantity};
use twin_kinematics::AxisVector;
use twin_machine::{Machine, PathLimits, VelocitySource};
use twin_number::seconds;
use twin_physics::TorqueAlongPath;
use twin_planner::blended_path::BlendedElement;
use twin_planner::time_optimal::{
    AxisPath, Cap, CapSource, Constraint, DragRow, FIRST_FURTHER_ROW, Followed, MOST_FURTHER_ROWS,
};

use twin_path::ElementKind;
use twin_path::prepare::CircularLimits;

/// A value counts as at its limit from this part of it on.
const AT_LIMIT: f64 = 0.98;

impl LimitRules {
    /// Limits on curves, as far as they count.
    pub(super) fn centripetal(self, machine: &Machine) -> CircularLimits {
        let PathLimits { centripetal_acceleration, centripetal_jump, .. } = machine.path_limits;
        let of = |limit: Option<f64>| limit.filter(|_| self.centripetal).unwrap_or(0.0);
        CircularLimits {
            acceleration: of(centripetal_acceleration),
            acceleration_jump: of(centripetal_jump),
        }
    }
}

impl Profile<'_> {
    /// The largest velocity along the path that the curve allows at `s`, m/s.
    pub(super) fn speed_on_curve(&self, element: &BlendedElement, s: f64) -> f64 {
        let CircularLimits { acceleration, .. } = self.rules.centripetal(self.machine);
        if acceleration > 0.0 && element.element().kind == ElementKind::Cut {
            (acceleration / element.curvature(s)).sqrt()
        } else {
            f64::INFINITY
        }
    }

    /// A limit of an axis; a velocity is that of its drive where that is the smaller one.
    pub(super) fn of_axis(&self, axis: usize, quantity: Quantity) -> Binding {
        let source = self.machine.axes.get(axis).map(|axis| axis.velocity_limit().source);
        let of_drive = source.is_some_and(|source| source != VelocitySource::Axis);
        let quantity = match quantity {
            Quantity::Velocity if of_drive => Quantity::DriveSpeed,
            quantity => quantity,
        };
        Binding::Axis { axis, quantity }
    }

    /// A constraint of the planner as people know it; none of what no machine file and no program says.
    pub(super) fn binding_of(&self, constraint: Constraint) -> Option<Binding> {
        let of_axis = |axis: u8, quantity| Binding::Axis { axis: usize::from(axis), quantity };
        Some(match constraint {
            Constraint::Velocity(CapSource::Feed) => Binding::Feed,
            Constraint::Velocity(CapSource::Centripetal) => Binding::Centripetal,
            Constraint::Velocity(CapSource::EndVelocity) => Binding::EndVelocity,
            Constraint::Velocity(CapSource::AxisVelocity(axis)) => {
                self.of_axis(usize::from(axis), Quantity::Velocity)
            }
            Constraint::Velocity(CapSource::Stop | CapSource::Joint | CapSource::Unconstrained) => {
                return None;
            }
            Constraint::AxisAcceleration(axis) => of_axis(axis, Quantity::Acceleration),
            Constraint::AxisJerk(axis) => of_axis(axis, Quantity::Jerk),
            Constraint::Velocity(CapSource::Motor(axis)) => of_axis(axis, Quantity::Effort),
            Constraint::Further(0) => Binding::PathAcceleration,
            Constraint::Further(row) => match row.checked_sub(FIRST_FURTHER_ROW) {
                Some(row) => Binding::Axis {
                    axis: self.axes.motor(usize::from(row))?,
                    quantity: Quantity::Effort,
                },
                None => Binding::PathDeceleration,
            },
            Constraint::ToolAcceleration => Binding::ToolAcceleration,
        })
    }

    /// The limit that the motion is nearest to, if it is at one; `torque` is what the motors have to give by the parameter of
    /// the path.
    pub(super) fn binding(
        &self,
        sample: &ProfileSample,
        torque: Option<&TorqueAlongPath>,
        followed: &Followed,
    ) -> Option<Binding> {
        let element = &followed.element;
        if !element.element().kind.is_motion() {
            return Some(Binding::Stop);
        }
        let mut most = (AT_LIMIT, None);
        let mut consider = |part: f64, binding: Binding| {
            if part > most.0 {
                most = (part, Some(binding));
            }
        };
        let axes = self.axes.limits().iter().enumerate();
        for (axis, limits) in axes {
            let of = |vector: &AxisVector| vector.get(axis).copied().unwrap_or_default();
            let (velocity, acceleration) = (of(&sample.velocity), of(&sample.acceleration));
            let jerk = limits.jerk.unwrap_or(f64::INFINITY);
            let parts = [
                (velocity.abs() / limits.velocity, Quantity::Velocity),
                (
                    acceleration.abs() / limits.acceleration_at(velocity, acceleration),
                    Quantity::Acceleration,
                ),
                (of(&sample.jerk).abs() / jerk, Quantity::Jerk),
            ];
            for (part, quantity) in parts {
                consider(part, self.of_axis(axis, quantity));
            }
        }
        let (v, a) = (followed.progress.velocity, followed.progress.acceleration);
        let s = followed.progress.position;
        consider(v / self.speed_on_curve(element, s), Binding::Centripetal);
        let reach = v * seconds(self.machine.cycle_ns);
        for (transition, to) in element.transitions().into_iter().zip([s, element.length() - s]) {
            if to <= reach {
                let jump = self.rules.centripetal(self.machine).acceleration_jump;
                if jump > 0.0 {
                    let part = v * (transition.curvature_jump / jump).sqrt();
                    consider(part, Binding::Centripetal);
                }
                if self.rules.feed {
                    let factor = self.follower.plan().planner().override_factor();
                    consider(v / (factor * transition.velocity), Binding::EndVelocity);
                }
            }
        }
        let wanted = self.follower.plan().planner().override_factor() * element.feed();
        let mut rows = [DragRow::default(); MOST_FURTHER_ROWS];
        let cap = torque.map_or(Cap::NONE, |torque| self.axes.rows(torque, &mut rows));
        for (index, row) in rows.iter().take(self.axes.further_rows()).enumerate() {
            let Some(axis) = self.axes.motor(index) else { continue };
            let effort = Binding::Axis { axis, quantity: Quantity::Effort };
            consider(row.part(a, v), effort);
        }
        if let CapSource::Motor(axis) = cap.source {
            let effort = Binding::Axis { axis: usize::from(axis), quantity: Quantity::Effort };
            consider(v / cap.v2.sqrt(), effort);
        }
        if self.rules.feed {
            consider(sample.path_velocity / wanted, Binding::Feed);
        }
        if self.rules.path_acceleration {
            let along = sample.path_acceleration;
            consider(along / element.acceleration(), Binding::PathAcceleration);
            consider(-along / element.deceleration(), Binding::PathDeceleration);
        }
        most.1
    }
}
