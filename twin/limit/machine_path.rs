//! Machine model for time-optimal planning: transform from the program's frame to the axes, and their limits.

use super::slaves::Slaves;
use nalgebra::{Point3, Vector3};
use std::cell::RefCell;
use twin_kinematics::{
    AxisDisc, AxisMotion, AxisSource, AxisVector, Kinematics, KinematicsError, Pose, ToolDisc,
    ToolJerk, ToolMotion,
};
use twin_machine::{DirectionRule, Machine, SimulationError};
use twin_path::ExtraPoint;
use twin_physics::{AxisEffort, EffortRow, PathDynamics, TorqueAlongPath};
use twin_planner::blended_path::{Bearing, BlendedElement, BlendedPoint};
use twin_planner::time_optimal::{
    AxisLimits, AxisPath, AxisPoint, Cap, CapSource, DragRow, Rates, Row, axis_point, within,
};

/// Limits of the axes that count; all unless some are switched off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub struct AxisRules {
    /// Their velocities.
    pub velocity: bool,
    /// Their accelerations.
    pub acceleration: bool,
    /// Their jerks.
    pub jerk: bool,
    /// Torques and forces of their motors.
    pub effort: bool,
}

impl Default for AxisRules {
    fn default() -> Self {
        Self { velocity: true, acceleration: true, jerk: true, effort: true }
    }
}

/// Errors of a machine that cannot be planned for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MachinePathError {
    /// Motors are limited, but the masses they move make no sense.
    #[error("the torques of the motors cannot be computed: {0}")]
    Physics(#[from] SimulationError),
}

/// A motor counts as overloaded by weight and dry friction if these leave less than this part of its effort.
const LEAST_SPARE: f64 = 1e-6;

/// A machine as feed limiting sees it: from the program's frame to the axes, and their limits.
#[derive(Debug)]
pub struct MachinePath<'m> {
    machine: &'m Machine,
    limits: Vec<AxisLimits>,
    /// What the motors have to give; none if the machine file limits none of them.
    dynamics: Option<RefCell<PathDynamics>>,
    /// The axes whose motors may limit a motion that keeps the limits of the axes.
    motors: Vec<usize>,
    slaves: Slaves,
    trial: Trial,
}

/// A trial of what would be if the part or the machine were different.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Trial {
    /// As they are.
    #[default]
    None,
    /// The part moved by this, machine frame, m.
    Moved(Vector3<f64>),
    /// A SCARA with its other elbow: its axes are as fast as those of this one on the path mirrored about x.
    Mirrored,
}

impl Trial {
    fn vector(self, vector: Vector3<f64>) -> Vector3<f64> {
        if self == Self::Mirrored { Vector3::new(vector.x, -vector.y, vector.z) } else { vector }
    }

    fn angle(self, angle: f64) -> f64 {
        if self == Self::Mirrored { -angle } else { angle }
    }

    fn pose(self, pose: Pose) -> Pose {
        let moved = if let Self::Moved(by) = self { by } else { Vector3::zeros() };
        let position = Point3::from(self.vector(pose.position.coords) + moved);
        Pose { position, direction: self.angle(pose.direction) }
    }
}

impl<'m> MachinePath<'m> {
    /// The machine with those of its limits that `rules` names, the override headroom taken off.
    ///
    /// # Errors
    /// [`MachinePathError`].
    pub fn new(machine: &'m Machine, rules: AxisRules) -> Result<Self, MachinePathError> {
        let given = |counts: bool, limit: f64| if counts { limit } else { f64::INFINITY };
        let limits = machine.axis_limits().into_iter().map(|limit| AxisLimits {
            velocity: given(rules.velocity, limit.velocity.value),
            acceleration: given(rules.acceleration, limit.acceleration),
            deceleration: given(rules.acceleration, limit.deceleration),
            jerk: limit.jerk.filter(|_| rules.jerk),
        });
        let limits: Vec<AxisLimits> = limits.collect();
        let dynamics = machine.path_dynamics()?;
        let largest = limits
            .iter()
            .map(|limits| [limits.velocity, limits.acceleration.max(limits.deceleration)]);
        let enough = match &dynamics {
            Some(dynamics) if rules.effort => dynamics.always_enough(&largest.collect::<Vec<_>>()),
            _ => Vec::new(),
        };
        let counts = |(axis, enough): (usize, bool)| (!enough).then_some(axis);
        let limited = |axis: &usize| {
            machine.axes.get(*axis).is_some_and(|axis| axis.simulated.effort_limit.is_finite())
        };
        let motors = enough.into_iter().enumerate().filter_map(counts).filter(limited).collect();
        Ok(Self {
            machine,
            limits,
            dynamics: dynamics.map(RefCell::new),
            motors,
            slaves: Slaves::of(machine),
            trial: Trial::None,
        })
    }

    /// The machine as a way from the path to the axes, whose motors do not count.
    pub(crate) fn without_motors(machine: &'m Machine) -> Self {
        Self {
            machine,
            limits: Vec::new(),
            dynamics: None,
            motors: Vec::new(),
            slaves: Slaves::of(machine),
            trial: Trial::None,
        }
    }

    /// The same under a trial.
    pub(crate) fn under(self, trial: Trial) -> Self {
        Self { trial, ..self }
    }

    /// The tool at `s` of `element`, machine frame.
    pub(crate) fn pose(&self, element: &BlendedElement, s: f64) -> Pose {
        let point = element.at(s);
        let [direction, ..] = self.direction(element, s, &point);
        self.pose_of(&point, direction)
    }

    fn pose_of(&self, point: &BlendedPoint, direction: f64) -> Pose {
        let pose = Pose { position: point.position, direction };
        self.trial.pose(self.machine.frame.pose_to_machine(&pose))
    }

    /// Positions of the axes without the slaves of gears and cams.
    pub(super) fn without_slaves(&self, position: &AxisVector) -> AxisVector {
        self.slaves.without(position)
    }

    /// A motion of the axes with the slaves of gears and cams.
    pub(super) fn with_slaves(&self, motion: &AxisMotion) -> AxisMotion {
        // Time in the place of the path's parameter.
        let AxisMotion { position, velocity: first, acceleration: second } = *motion;
        let rates = Rates { first, second, third: AxisVector::zeros(position.len()) };
        let mut point = AxisPoint { position, rates };
        self.slaves.lead(&mut point);
        let AxisPoint { position, rates: Rates { first, second, .. } } = point;
        AxisMotion { position, velocity: first, acceleration: second }
    }

    /// The axis that a row of [`AxisPath::further`] is about.
    pub(super) fn motor(&self, row: usize) -> Option<usize> {
        self.motors.get(row / 2).copied()
    }

    /// Efforts of the motors at `position` with the derivatives `first` and `second` by a path parameter, or by time;
    /// `None` where they are not known.
    pub(super) fn torque(
        &self,
        position: &AxisVector,
        first: &AxisVector,
        second: &AxisVector,
    ) -> Option<TorqueAlongPath> {
        // Numbers that are none have been refused by the kinematics.
        self.dynamics.as_ref()?.borrow_mut().at(position, first, second).ok()
    }

    /// As [`AxisPath::further`], where `torque` is known.
    pub(super) fn rows(&self, torque: &TorqueAlongPath, rows: &mut [DragRow]) -> Cap {
        let mut cap = Cap::NONE;
        for (axis, slots) in self.motors.iter().copied().zip(rows.chunks_mut(2)) {
            let Some(effort) = torque.axes().get(axis).filter(|effort| holds(effort)) else {
                continue;
            };
            for (slot, row) in slots.iter_mut().zip(effort.rows(axis)) {
                *slot = drag_row(&row);
            }
            let source = CapSource::Motor(u8::try_from(axis).unwrap_or(u8::MAX));
            cap = cap.min(Cap { v2: effort.largest_speed().powi(2), source });
        }
        cap
    }

    /// The largest constant speed along the path that the motors keep, as a velocity of the parameter, and the axis of the
    /// weakest of them.
    pub(super) fn largest_speed(&self, torque: &TorqueAlongPath) -> (f64, usize) {
        let holding = torque.limited().filter(|(_, axis)| !self.motors.is_empty() && holds(axis));
        let speeds = holding.map(|(axis, effort)| (effort.largest_constant_speed(), axis));
        speeds.fold((f64::INFINITY, 0), |least, one| if one.0 < least.0 { one } else { least })
    }

    /// The direction of the tool with three derivatives at `s` of `element`, where the blended path is at `point`, rad in the
    /// work frame.
    fn direction(&self, element: &BlendedElement, s: f64, point: &BlendedPoint) -> [f64; 4] {
        match (self.machine.direction, &point.extra) {
            (DirectionRule::Path(to_path, angle), _) => {
                let bearing = element.bearing(s, point).unwrap_or_default();
                let Bearing { along, first, second, third } = bearing;
                [along + to_path.offset() + angle, first, second, third]
            }
            (DirectionRule::Additional(number, angle), Some(extra)) => {
                let mut direction = of(extra, number).map(f64::to_radians);
                direction[0] += angle;
                direction
            }
            (DirectionRule::Fixed(angle) | DirectionRule::Additional(_, angle), _) => {
                [angle, 0.0, 0.0, 0.0]
            }
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

/// Forces and torques of the motors at an acceleration and a speed of the parameter and these velocities of the axes, dry
/// friction against the motion.
pub(super) fn efforts(
    torque: &TorqueAlongPath,
    [acceleration, speed]: [f64; 2],
    velocity: &AxisVector,
) -> AxisVector {
    let axes = torque.axes().iter().zip(velocity.iter());
    AxisVector::from_values(axes.map(|(axis, velocity)| {
        let dry = if *velocity == 0.0 { 0.0 } else { axis.dry.copysign(*velocity) };
        axis.effort(acceleration, speed) + dry
    }))
}

/// The axes whose motors cannot hold them, with what holding takes.
pub(super) fn overloaded(torque: &TorqueAlongPath) -> impl Iterator<Item = (usize, f64)> {
    let overloaded = torque.limited().filter(|(_, axis)| !holds(axis));
    overloaded.map(|(axis, effort)| (axis, effort.weight.abs() + effort.dry))
}

/// A bound of a motor's effort as the planner takes it.
fn drag_row(row: &EffortRow) -> DragRow {
    let [a, b, drag] = row.per_limit();
    DragRow { row: Row { a, b }, drag }
}

/// Whether the motor holds the axis and has something left to move it.
fn holds(effort: &AxisEffort) -> bool {
    effort.limit - effort.weight.abs() - effort.dry >= LEAST_SPARE * effort.limit
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
        self.slaves.with(&self.machine.middle())
    }

    fn axes(
        &self,
        element: &BlendedElement,
        s: f64,
        near: &AxisVector,
    ) -> Result<AxisPoint, KinematicsError> {
        let point = element.at(s);
        let [direction, direction_velocity, direction_acceleration, direction_jerk] =
            self.direction(element, s, &point);
        let BlendedPoint { position, first, second, third, extra } = point;
        // The parameter in the place of time.
        let work = ToolMotion {
            pose: Pose { position, direction },
            velocity: first,
            acceleration: second,
            direction_velocity,
            direction_acceleration,
        };
        let work_jerk = ToolJerk { linear: third, direction: direction_jerk };
        let (frame, trial) = (&self.machine.frame, self.trial);
        let jerk = frame.jerk_to_machine(&work, &work_jerk);
        let jerk =
            ToolJerk { linear: trial.vector(jerk.linear), direction: trial.angle(jerk.direction) };
        let motion = frame.motion_to_machine(&work);
        let motion = ToolMotion {
            pose: trial.pose(motion.pose),
            velocity: trial.vector(motion.velocity),
            acceleration: trial.vector(motion.acceleration),
            direction_velocity: trial.angle(motion.direction_velocity),
            direction_acceleration: trial.angle(motion.direction_acceleration),
        };
        let near = self.slaves.without(near);
        let mut point = axis_point(&*self.machine.kinematics, &motion, &jerk, &near)?;
        if let Some(extra) = &extra {
            self.add_additional(extra, &mut point);
        }
        self.slaves.lead(&mut point);
        Ok(point)
    }

    fn position(
        &self,
        element: &BlendedElement,
        s: f64,
        near: &AxisVector,
    ) -> Result<AxisVector, KinematicsError> {
        if element.element().extra().is_some() || !self.slaves.is_empty() {
            return Ok(self.axes(element, s, near)?.position);
        }
        self.machine.kinematics.inverse(&self.pose(element, s), near)
    }

    /// That of additional axes counts; what slaves on cams do is not known.
    fn disc(&self, element: &BlendedElement, s: f64, _point: &AxisPoint) -> Option<AxisDisc> {
        let (point, path) = (element.at(s), element.disc(s));
        let [direction, turn_rate, ..] = self.direction(element, s, &point);
        let mut radius = within(path.radius, element);
        let turn_bend = match self.machine.direction {
            DirectionRule::Fixed(_) => 0.0,
            DirectionRule::Additional(number, _) => {
                path.extra_bend.get(usize::from(number)).copied().unwrap_or_default().to_radians()
            }
            DirectionRule::Path(..) => {
                let bearing = element.bearing_disc(s, &point);
                radius = radius.min(bearing.radius);
                bearing.bend
            }
        };
        let frame = &self.machine.frame;
        let turned = frame.machine_from_work().rotation.to_rotation_matrix();
        let disc = self.machine.kinematics.disc(&ToolDisc {
            pose: self.pose_of(&point, direction),
            rate: self.trial.vector(frame.vector_to_machine(&point.first)),
            bend: turned.matrix().abs() * path.bend,
            turn_rate: self.trial.angle(turn_rate),
            turn_bend,
            radius,
        });
        let AxisDisc { radius, mut change, mut is_even } = disc?;
        is_even = is_even && self.slaves.is_empty();
        let sources = self.machine.kinematics.sources().iter().zip(&self.machine.axes);
        for (slot, (source, axis)) in change.iter_mut().zip(sources) {
            if let (AxisSource::Additional(number), Some(extra)) = (*source, &point.extra) {
                let [_, first, _, _] = of(extra, number);
                let bend = path.extra_bend.get(usize::from(number)).copied().unwrap_or_default();
                *slot = axis.to_si((first.abs() + 0.5 * bend * radius) * radius);
                is_even = is_even && bend <= 0.0;
            }
        }
        Some(AxisDisc { radius, change, is_even })
    }

    fn further_rows(&self) -> usize {
        2 * self.motors.len()
    }

    /// The limits of the motors. A motor that cannot even hold its axis limits nothing: no plan would help it.
    fn further(&self, point: &AxisPoint, rows: &mut [DragRow]) -> Cap {
        if self.motors.is_empty() {
            return Cap::NONE;
        }
        let Rates { first, second, .. } = &point.rates;
        let torque = self.torque(&point.position, first, second);
        torque.map_or(Cap::NONE, |torque| self.rows(&torque, rows))
    }
}
