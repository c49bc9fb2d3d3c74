//! Profile of a program as the controller plans it, without axis limits (`SMC_CheckVelocities`,
//! `SMC_LimitCircularVelocities`, `SMC_Interpolator`), for comparison.

use super::gaps::Gaps;
use super::machine_path::{AxisRules, MachinePath, efforts, overloaded};
use super::watch::Watch;
use super::{Binding, LimitFailure, ProfileItem, ProfileSample};
use crate::m_function::Acknowledgement;
use crate::program::{ProgramFile, ProgramItem, Setpoints};
use crate::setpoint::Transformer;
use crate::tolerance::is_hidden;
use twin_kinematics::{AxisMotion, AxisVector};
use twin_machine::{DirectionRule, Machine};
use twin_number::seconds;
use twin_planner::controller::{Status, ToolSetpoint};
use twin_planner::planned_motion::PlannedPiece;

/// The part of the programmed velocity from which on it counts as reached.
const AT_FEED: f64 = 0.98;

/// A program on a machine as the controller itself plans it: one sample per cycle. Jerks are differences of accelerations
/// from one cycle to the next.
#[derive(Debug)]
pub struct ControllerProfile<'m> {
    setpoints: Setpoints,
    transformer: Transformer<'m>,
    /// What the motors have to give.
    axes: MachinePath<'m>,
    /// Override.
    factor: f64,
    before: Option<ProfileSample>,
    /// Velocities of the axes then, without those that only differences of positions show.
    given: AxisVector,
    machine: &'m Machine,
    watch: Watch<'m>,
    gaps: Gaps<'m>,
    cycle: f64,
}

impl<'m> ControllerProfile<'m> {
    /// The program `program` on `machine`. An M function takes a cycle.
    ///
    /// # Errors
    /// If it cannot be opened, or the masses of the machine make no sense.
    pub fn new(program: &ProgramFile, machine: &'m Machine) -> Result<Self, LimitFailure> {
        let mut setpoints = program.open(machine, Acknowledgement::default())?;
        setpoints.record(matches!(machine.direction, DirectionRule::Path(..)));
        Ok(Self {
            setpoints,
            transformer: Transformer::new(machine),
            axes: MachinePath::new(machine, AxisRules::default())?,
            factor: program.settings().inputs.override_factor.factor(),
            before: None,
            given: AxisVector::zeros(machine.axes.len()),
            machine,
            watch: Watch::new(machine),
            gaps: Gaps::new(machine),
            cycle: seconds(machine.cycle_ns),
        })
    }

    /// Bytes of the file read so far.
    pub fn bytes_read(&self) -> u64 {
        self.setpoints.bytes_read()
    }

    /// The next piece of the plan that is over.
    pub(crate) fn next_piece(&mut self) -> Option<PlannedPiece> {
        self.setpoints.next_piece()
    }

    /// `None` if the machine cannot go there.
    fn sample(&mut self, tool: &ToolSetpoint) -> Option<ProfileSample> {
        let setpoint = match self.transformer.axes(tool, None) {
            Ok(setpoint) => setpoint,
            Err(error) => {
                self.watch.refused(tool.place, &error);
                self.before = None;
                return None;
            }
        };
        let axes = setpoint.axes;
        if self.gaps.opens(&self.axes, tool, &axes.position) {
            self.before = None;
        }
        self.watch.positions(tool.place, &axes.position);
        // Time in the place of the path's parameter.
        let torque = self.axes.torque(&axes.position, &axes.velocity, &axes.acceleration);
        if let Some(torque) = &torque {
            self.watch.motors(tool.place, overloaded(torque));
        }
        let effort = torque.map(|torque| efforts(&torque, [0.0, 1.0], &axes.velocity));
        let along = tool.velocity.try_normalize(0.0).unwrap_or_default();
        let path_acceleration = tool.acceleration.dot(&along);
        // At first nothing moves.
        let (jerk, path_jerk) = match &self.before {
            Some(before) => {
                let pairs = axes.acceleration.iter().zip(before.acceleration.iter());
                let jerk = pairs.map(|(now, before)| (now - before) / self.cycle);
                let path_jerk = (path_acceleration - before.path_acceleration) / self.cycle;
                (AxisVector::from_values(jerk), path_jerk)
            }
            None => (AxisVector::zeros(axes.position.len()), 0.0),
        };
        let sample = ProfileSample {
            time_ns: tool.time_ns,
            place: tool.place,
            way: tool.way,
            feed: if tool.status == Status::Waiting { 0.0 } else { tool.feed },
            path_velocity: tool.path_velocity,
            path_acceleration,
            path_jerk,
            position: axes.position,
            velocity: self.velocity(tool, &axes),
            acceleration: axes.acceleration,
            jerk,
            effort,
            binding: self.binding(tool),
        };
        self.before = Some(sample);
        self.given = axes.velocity;
        Some(sample)
    }

    /// Of the axes, with what only the difference between cycles shows, as in `twin check`.
    fn velocity(&self, tool: &ToolSetpoint, axes: &AxisMotion) -> AxisVector {
        let Some(before) = &self.before else { return axes.velocity };
        let at_rest = tool.path_velocity <= 0.0 && before.path_velocity <= 0.0;
        let positions = axes.position.iter().zip(before.position.iter());
        let velocities = axes.velocity.iter().zip(self.given.iter());
        let moved = positions.zip(velocities).zip(&self.machine.axes);
        AxisVector::from_values(moved.map(|(((to, from), (now, before)), axis)| {
            let stepped = (to - from) / self.cycle;
            let hidden = is_hidden(stepped, [*now, *before], at_rest, axis.max_velocity);
            if hidden { stepped } else { *now }
        }))
    }

    /// What the controller holds the path back for.
    fn binding(&self, tool: &ToolSetpoint) -> Option<Binding> {
        if tool.status == Status::Waiting {
            return Some(Binding::Stop);
        }
        if tool.path_velocity >= AT_FEED * tool.feed * self.factor {
            return Some(Binding::Feed);
        }
        match tool.status {
            Status::Accelerating => Some(Binding::PathAcceleration),
            Status::Decelerating => Some(Binding::PathDeceleration),
            _ => None,
        }
    }
}

impl Iterator for ControllerProfile<'_> {
    type Item = ProfileItem;

    fn next(&mut self) -> Option<ProfileItem> {
        loop {
            if let Some(finding) = self.watch.take() {
                return Some(ProfileItem::Finding(finding));
            }
            if let Some(item) = self.gaps.cross(&self.axes) {
                return Some(item);
            }
            let Some(next) = self.setpoints.next() else {
                self.watch.finish();
                return self.watch.take().map(ProfileItem::Finding);
            };
            match next {
                ProgramItem::Setpoint(tool) => {
                    if let Some(sample) = self.sample(&tool) {
                        return Some(self.gaps.pass(sample));
                    }
                }
                ProgramItem::Diagnostic(finding) => return Some(ProfileItem::Finding(finding)),
                ProgramItem::Io(error) => return Some(ProfileItem::Io(error)),
            }
        }
    }
}
