//! One cycle of the simulated machine, in steps.

use twin_kinematics::{AxisMotion, AxisVector, MAX_AXES};

use crate::drive::{AxisDrive, DriveInput, EffortFeedForward, FieldSetpoint, MotorAtWork};
use crate::error::{PhysicsError, Result};
use crate::event::{EventKind, PhysicsEvent};
use crate::joint::{JointVector, axis_vector, joint_vector};
use crate::machine::{AxisState, PhysicsMachine};
use crate::setpoint::Setpoint;
use crate::side::Side;
use crate::state::{JointState, MachineState, Motors, Stage};
use crate::{checked, integrate};

impl PhysicsMachine {
    /// Advances one cycle towards `setpoint` and returns the state at its end.
    ///
    /// Drives interpolate to this set-point within the cycle, so compare `setpoint` with the returned position.
    ///
    /// # Errors
    /// [`PhysicsError::AxisCount`], [`PhysicsError::Input`] if `setpoint` is not finite, and
    /// [`PhysicsError::Diverged`].
    pub fn step(&mut self, setpoint: &AxisMotion) -> Result<AxisState> {
        let [from, to] = [&self.setpoint, setpoint]
            .map(|motion| Setpoint::new(motion, self.drives.len(), self.state.time_ns));
        let course = Course { from: from?, to: to?, cycle: self.cycle, steps: self.steps };
        let mut joints = self.joints;
        let mut mean_effort = JointVector::zeros();
        let mut mean_power = JointVector::zeros();
        let mut saturated = [false; MAX_AXES];
        let noise = joint_vector(self.drives.iter_mut().map(|drive| drive.noise.effort()));
        self.begin_contacts();
        let dt = self.cycle / f64::from(self.steps);
        let diverged = PhysicsError::Diverged(self.state.time_ns);
        for step in 0..self.steps {
            self.control(&joints, &course, step, &mut saturated)?;
            for (axis, drive) in self.drives.iter_mut().enumerate() {
                drive.begin_step(&course, step, axis, self.homed[axis], dt);
            }
            let disturbance = noise + self.contact.push + self.contact.by_rapier[0];
            let (next, effort) = integrate::advance(
                &mut self.equation,
                &self.trains,
                &joints,
                (self.drives.as_slice(), &disturbance),
                dt,
            )
            .filter(|(state, _)| state.is_finite())
            .ok_or(diverged)?;
            let next = self.with_contacts(&joints, &next, dt)?;
            let velocity = (next.motors.position - joints.motors.position) / dt;
            joints = next;
            mean_effort += effort / f64::from(self.steps);
            mean_power += effort.component_mul(&velocity) / f64::from(self.steps);
            self.record(&joints, &effort, &velocity, dt);
        }
        let joints = self.with_rapier(&joints)?;
        self.setpoint = *setpoint;
        self.finish_cycle(&joints, [&mean_effort, &mean_power], saturated)
    }

    /// Advances one cycle with the given motor efforts (N or Nm), the drives switched off; limits are not applied.
    ///
    /// # Errors
    /// Those of [`Self::step`].
    pub fn step_with_efforts(&mut self, effort: &AxisVector) -> Result<AxisState> {
        let effort = checked(effort, self.drives.len(), self.state.time_ns)?;
        let mut joints = self.joints;
        let diverged = PhysicsError::Diverged(self.state.time_ns);
        self.begin_contacts();
        for _ in 0..self.steps {
            let dt = self.cycle / f64::from(self.steps);
            let Self { equation, trains, contact, .. } = self;
            let push = contact.push + contact.by_rapier[0];
            let motors = (&ConstantEfforts(effort), &push);
            let (next, _) = integrate::advance(equation, trains, &joints, motors, dt)
                .filter(|(state, _)| state.is_finite())
                .ok_or(diverged)?;
            joints = self.with_contacts(&joints, &next, dt)?;
        }
        let joints = self.with_rapier(&joints)?;
        let velocity = (joints.motors.position - self.joints.motors.position) / self.cycle;
        let power = effort.component_mul(&velocity);
        self.finish_cycle(&joints, [&effort, &power], [false; MAX_AXES])
    }

    /// The passes of all loops that are due at the beginning of `step`.
    fn control(
        &mut self,
        joints: &MachineState,
        course: &Course,
        step: u32,
        saturated: &mut [bool; MAX_AXES],
    ) -> Result<()> {
        let now = course.at(f64::from(step));
        // What is fed forward, by the loops' periods in steps.
        let mut whole_machine: Option<(u32, JointVector)> = None;
        for (axis, (drive, saturated)) in self.drives.iter_mut().zip(saturated).enumerate() {
            let MotorAtWork::Servo(servo) = &mut drive.motor else { continue };
            let [every, positions_every] =
                [servo.parameters.velocity_passes, servo.parameters.position_passes]
                    .map(|passes| (course.steps / u32::from(passes)).max(1));
            if !step.is_multiple_of(every) {
                continue;
            }
            // What is fed forward is held for the period: take it from its middle.
            let ahead = course.at(f64::from(step) + 0.5 * f64::from(every));
            let effort = match servo.parameters.effort_feed_forward {
                EffortFeedForward::None => 0.0,
                EffortFeedForward::Inertia(inertia) => inertia * ahead.acceleration[axis],
                EffortFeedForward::Dynamics(part) => {
                    let known = whole_machine.filter(|(period, _)| *period == every);
                    let efforts = if let Some((_, efforts)) = known {
                        efforts
                    } else {
                        let Setpoint { position, velocity, acceleration } = &ahead;
                        let efforts =
                            self.equation.inverse_dynamics(position, velocity, acceleration);
                        efforts.ok_or(PhysicsError::Apart)?
                    };
                    whole_machine = Some((every, efforts));
                    part * efforts[axis]
                }
            };
            let noise = drive.noise.position();
            let input = DriveInput {
                position_setpoint: now.position[axis],
                velocity_setpoint: now.velocity[axis],
                effort,
                position: joints.axes.position[axis] + noise,
                motor_position: joints.motors.position[axis] - self.homed[axis] + noise,
                motor_velocity: joints.motors.velocity[axis],
            };
            let period = course.cycle * f64::from(every) / f64::from(course.steps);
            *saturated |= servo.control(&input, step.is_multiple_of(positions_every), period);
        }
        Ok(())
    }
}

impl PhysicsMachine {
    /// Notes what the motors did in a step of `dt` s that ended at `joints`.
    fn record(
        &mut self,
        joints: &MachineState,
        effort: &JointVector,
        velocity: &JointVector,
        dt: f64,
    ) {
        let time_ns = self.state.time_ns.saturating_add(self.cycle_ns);
        let trains = self.trains.iter_mut().zip(&mut self.loads);
        for (axis, (drive, (train, load))) in self.drives.iter_mut().zip(trains).enumerate() {
            let effort = effort[axis];
            load.add(effort, velocity[axis], dt);
            let mut happens = |kind| self.events.push(PhysicsEvent { time_ns, axis, kind });
            if let Some(overload) = &mut drive.overload {
                if overload.advance(effort, dt) {
                    happens(EventKind::Overload);
                }
                load.observe_warmth(overload.warmth());
            }
            if let MotorAtWork::Stepper(stepper) = &mut drive.motor {
                let lost = stepper.lost(joints.motors.position[axis]);
                if lost != 0 && drive.dead_for.is_none() {
                    happens(EventKind::LostSteps(lost));
                }
            }
            if drive.advance_brake(dt) {
                train.brake(drive.braking());
                happens(EventKind::BrakeClosed);
            }
        }
    }

    /// The end of a cycle: the machine is at `next`.
    fn finish_cycle(
        &mut self,
        next: &MachineState,
        [effort, power]: [&JointVector; 2],
        saturated: [bool; MAX_AXES],
    ) -> Result<AxisState> {
        self.joints = *next;
        if !self.joints.is_finite() {
            return Err(PhysicsError::Diverged(self.state.time_ns));
        }
        let position = self.joints.axes.position;
        self.world.follow(&position)?;
        let axes = self.drives.len();
        let time_ns = self.state.time_ns.saturating_add(self.cycle_ns);
        for (axis, (drive, position)) in self.drives.iter_mut().zip(&position).enumerate() {
            let now = drive.switches.at(*position);
            let before = std::mem::replace(&mut drive.switched, now);
            for (side, before, now) in
                [(Side::Lower, before.lower, now.lower), (Side::Upper, before.upper, now.upper)]
            {
                if now && !before {
                    let kind = EventKind::LimitSwitch(side);
                    self.events.push(PhysicsEvent { time_ns, axis, kind });
                }
            }
        }
        self.state = AxisState {
            time_ns,
            position: axis_vector(&self.joints.axes.position, axes),
            velocity: axis_vector(&self.joints.axes.velocity, axes),
            effort: axis_vector(effort, axes),
            power: axis_vector(power, axes),
            saturated,
        };
        Ok(self.state)
    }
}

/// The way of the set-points through a cycle.
struct Course {
    from: Setpoint,
    to: Setpoint,
    /// s.
    cycle: f64,
    steps: u32,
}

impl Course {
    /// After `steps` steps.
    fn at(&self, steps: f64) -> Setpoint {
        self.from.towards(&self.to, steps / f64::from(self.steps), self.cycle)
    }

    /// The field of a step motor that was `homed` ahead of its axis.
    fn field(&self, steps: f64, axis: usize, homed: f64) -> FieldSetpoint {
        let setpoint = self.at(steps);
        FieldSetpoint {
            position: setpoint.position[axis] + homed,
            velocity: setpoint.velocity[axis],
        }
    }
}

impl AxisDrive {
    /// Prepares the motor for the next step of `dt` s, the `step`th of the course.
    fn begin_step(&mut self, course: &Course, step: u32, axis: usize, homed: f64, dt: f64) {
        match &mut self.motor {
            MotorAtWork::Servo(servo) => servo.begin_step(dt),
            MotorAtWork::Stepper(stepper) => {
                let step = f64::from(step);
                let field = [step, step + 0.5, step + 1.0];
                stepper.begin_step(field.map(|steps| course.field(steps, axis, homed)), dt);
            }
        }
    }

    /// Without power for `dt` s more. True when the brake closes.
    fn advance_brake(&mut self, dt: f64) -> bool {
        let before = self.braking();
        if let Some(dead_for) = &mut self.dead_for {
            *dead_for += dt;
        }
        before <= 0.0 && self.braking() > 0.0
    }
}

/// Motors with constant efforts.
struct ConstantEfforts(JointVector);

impl Motors for ConstantEfforts {
    fn efforts(&self, _stage: Stage, _motors: &JointState) -> JointVector {
        self.0
    }
}
