//! A machine as feed limiting sees it.

use crate::machine::{DirectionRule, Machine};
use twin_kinematics::{AxisSource, AxisVector, KinematicsError, Pose, ToolJerk, ToolMotion};
use twin_motion::limit::course::{CourseElement, CoursePoint};
use twin_motion::limit::{AxisLimits, AxisPath, AxisPoint, Rates, axis_point};
use twin_motion::path::ExtraPoint;

/// What can be limited at the axes; everything unless something is switched off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisRules {
    /// Their velocities.
    pub velocity: bool,
    /// Their accelerations.
    pub acceleration: bool,
    /// Their jerks.
    pub jerk: bool,
}

impl Default for AxisRules {
    fn default() -> Self {
        Self { velocity: true, acceleration: true, jerk: true }
    }
}

/// Why feed limiting is not for a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MachinePathError {
    /// The direction of the tool follows the path, so that it would have to jump at corners.
    #[error(
        "feed limiting does not know machines yet whose tool turns with the path (`direction` in [kinematics]); \
         it is for tools that do not turn, keep their direction, or are turned by an additional axis"
    )]
    TurnsWithPath,
}

/// A machine as feed limiting sees it: from the program's frame to the axes, and their limits.
#[derive(Debug)]
pub struct MachinePath<'m> {
    machine: &'m Machine,
    limits: Vec<AxisLimits>,
}

impl<'m> MachinePath<'m> {
    /// The machine with those of its limits that `rules` names, the override headroom taken off.
    ///
    /// # Errors
    /// [`MachinePathError`].
    pub fn new(machine: &'m Machine, rules: AxisRules) -> Result<Self, MachinePathError> {
        if let DirectionRule::Path(..) = machine.direction {
            return Err(MachinePathError::TurnsWithPath);
        }
        let limits = machine.axis_limits().into_iter().map(|limit| AxisLimits {
            velocity: if rules.velocity { limit.velocity.value } else { f64::INFINITY },
            acceleration: if rules.acceleration { limit.acceleration } else { f64::INFINITY },
            jerk: limit.jerk.filter(|_| rules.jerk),
        });
        Ok(Self { machine, limits: limits.collect() })
    }

    /// The direction of the tool with three derivatives, rad in the work frame.
    fn direction(&self, extra: Option<&ExtraPoint>) -> [f64; 4] {
        match (self.machine.direction, extra) {
            (DirectionRule::Additional(number, angle), Some(extra)) => {
                let mut direction = of(extra, number).map(f64::to_radians);
                direction[0] += angle;
                direction
            }
            (DirectionRule::Fixed(angle) | DirectionRule::Additional(_, angle), _) => {
                [angle, 0.0, 0.0, 0.0]
            }
            (DirectionRule::Path(..), _) => [self.machine.direction.at_start(), 0.0, 0.0, 0.0],
        }
    }

    /// The additional axes go where the program says, in their technical unit: degrees or mm.
    fn add_additional(&self, extra: &ExtraPoint, point: &mut AxisPoint) {
        let sources = self.machine.kinematics.sources().iter().zip(&self.machine.axes);
        for (index, (source, axis)) in sources.enumerate() {
            let AxisSource::Additional(number) = *source else { continue };
            let Rates { first, second, third } = &mut point.rates;
            let slots = [&mut point.position, first, second, third];
            for (slot, value) in slots.into_iter().zip(of(extra, number)) {
                if let Some(slot) = slot.get_mut(index) {
                    *slot = axis.to_si(value);
                }
            }
        }
    }
}

/// One extra axis with three derivatives, u.
fn of(extra: &ExtraPoint, number: u8) -> [f64; 4] {
    [&extra.position, &extra.first, &extra.second, &extra.third]
        .map(|values| values.get(usize::from(number)).copied().unwrap_or_default())
}

impl AxisPath for MachinePath<'_> {
    fn limits(&self) -> &[AxisLimits] {
        &self.limits
    }

    fn home(&self) -> AxisVector {
        self.machine.middle()
    }

    fn axes(
        &self,
        element: &CourseElement,
        s: f64,
        near: &AxisVector,
    ) -> Result<AxisPoint, KinematicsError> {
        let CoursePoint { position, first, second, third, extra } = element.at(s);
        let [direction, direction_velocity, direction_acceleration, direction_jerk] =
            self.direction(extra.as_ref());
        // The parameter in the place of time.
        let work = ToolMotion {
            pose: Pose { position, direction },
            velocity: first,
            acceleration: second,
            direction_velocity,
            direction_acceleration,
        };
        let work_jerk = ToolJerk { linear: third, direction: direction_jerk };
        let frame = &self.machine.frame;
        let jerk = frame.jerk_to_machine(&work, &work_jerk);
        let motion = frame.motion_to_machine(&work);
        let mut point = axis_point(&self.machine.kinematics, &motion, &jerk, near)?;
        if let Some(extra) = &extra {
            self.add_additional(extra, &mut point);
        }
        Ok(point)
    }
}
