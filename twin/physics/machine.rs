//! Simulated machine: its parts and its state.

use nalgebra::{Isometry3, Vector3};
use twin_kinematics::{AxisMotion, AxisVector, MAX_AXES};
use twin_urdf::Model;

use crate::checked;
use crate::contact::ContactState;
use crate::drive::{
    AxisDrive, AxisDriveParameters, EffortFeedForward, Motor, MotorAtWork, SwitchStates,
};
use crate::equation::Equation;
use crate::error::{PhysicsError, Result};
use crate::event::{BodyEvent, PhysicsEvent};
use crate::joint::{JointVector, axis_vector, joint_vector};
use crate::load::{LoadSums, MotorLoad, MotorState};
use crate::state::{Elastic, JointState, MachineState, Train};
use crate::world::RapierWorld;

/// State of the axes at the end of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisState {
    /// Since the machine was made, ns.
    pub time_ns: i64,
    /// m or rad.
    pub position: AxisVector,
    /// m/s or rad/s.
    pub velocity: AxisVector,
    /// Motor force or torque, mean over the cycle, N or Nm.
    pub effort: AxisVector,
    /// Mechanical power of the motors, mean over the cycle, W.
    pub power: AxisVector,
    /// True where the drive was at its effort limit at some time in the cycle; in axis order.
    pub(crate) saturated: [bool; MAX_AXES],
}

/// A machine with its drives.
#[derive(Clone, Debug)]
pub struct PhysicsMachine {
    pub(super) equation: Equation,
    pub(super) trains: [Train; MAX_AXES],
    pub(super) world: RapierWorld,
    pub(super) drives: Vec<AxisDrive>,
    pub(super) joints: MachineState,
    /// Lead of the motors over their axes at homing.
    pub(super) homed: JointVector,
    pub(super) loads: [LoadSums; MAX_AXES],
    pub(super) events: Vec<PhysicsEvent>,
    pub(super) body_events: Vec<BodyEvent>,
    pub(super) contact: ContactState,
    /// At the end of the last cycle.
    pub(super) setpoint: AxisMotion,
    pub(super) state: AxisState,
    pub(super) cycle_ns: i64,
    /// s.
    pub(super) cycle: f64,
    /// Steps of the equation of motion in a cycle.
    pub(super) steps: u32,
}

impl PhysicsMachine {
    /// Machine of `model` at rest at `initial` (m or rad), drives enabled, under `gravity` (m/s²), in cycles of
    /// `cycle_ns`.
    ///
    /// Drives start with the effort that holds the machine against gravity, and are homed there: nothing sags.
    ///
    /// # Errors
    /// [`PhysicsError`] if the model is not a tree of links whose moving joints are the machine's axes, if an axis
    /// moves no inertia, or if a number is out of range.
    pub fn new(
        model: &Model,
        drives: &[AxisDriveParameters],
        gravity: Vector3<f64>,
        initial: &AxisVector,
        cycle_ns: i64,
    ) -> Result<Self> {
        let cycle_time = PhysicsError::CycleTime(cycle_ns);
        let cycle = u32::try_from(cycle_ns)
            .ok()
            .filter(|ns| (1_000..=1_000_000_000).contains(ns))
            .map(|ns| f64::from(ns) * 1e-9)
            .ok_or(cycle_time)?;
        for (axis, drive) in drives.iter().enumerate() {
            if let Some((parameter, value)) = drive.out_of_range() {
                return Err(PhysicsError::DriveParameter { axis, parameter, value });
            }
        }
        let is_rigid = |drive: &AxisDriveParameters| drive.transmission.is_none();
        let armature = joint_vector(
            drives.iter().map(|drive| if is_rigid(drive) { drive.armature } else { 0.0 }),
        );
        let mut equation = Equation::new(model, drives.len(), gravity, armature)?;
        let position = checked(initial, drives.len(), 0)?;

        let inertia = equation.inertia(&position).ok_or(PhysicsError::Apart)?.diagonal();
        if let Some((axis, inertia)) =
            inertia.iter().copied().take(drives.len()).enumerate().find(|(_, i)| *i <= 0.0)
        {
            return Err(PhysicsError::NoInertia { axis, inertia });
        }
        let zero = JointVector::zeros();
        let holding = equation.inverse_dynamics(&position, &zero, &zero);
        let holding = holding.ok_or(PhysicsError::Apart)?;
        let motor_inertia = joint_vector(
            drives
                .iter()
                .zip(&inertia)
                .map(|(drive, inertia)| if is_rigid(drive) { *inertia } else { drive.armature }),
        );
        let twist = drives.iter().zip(holding.iter()).map(|(drive, holding)| {
            drive.transmission.map_or(0.0, |elastic| elastic.twist(*holding))
        });
        let homed = joint_vector(twist);
        let motors = position + homed;
        let at_work =
            drives.iter().zip(&holding).zip(motor_inertia.iter().zip(&motors)).enumerate();
        let at_work = at_work.map(|(axis, ((parameters, holding), (inertia, position)))| {
            let fed_forward = match &parameters.motor {
                Motor::Servo(servo) => match servo.effort_feed_forward {
                    EffortFeedForward::Dynamics(part) => part * holding,
                    EffortFeedForward::None | EffortFeedForward::Inertia(_) => 0.0,
                },
                Motor::Stepper(_) => 0.0,
            };
            AxisDrive::enabled(parameters, *holding, fed_forward, *inertia, (axis, *position))
        });
        let mut at_work: Vec<_> = at_work.collect();
        for (drive, position) in at_work.iter_mut().zip(&position) {
            drive.switched = drive.switches.at(*position);
        }
        let mut trains = [Train::default(); MAX_AXES];
        for (train, drive) in trains.iter_mut().zip(drives) {
            *train = train_of(drive);
        }
        let state = AxisState {
            time_ns: 0,
            position: *initial,
            velocity: AxisMotion::at_rest(*initial).velocity,
            effort: axis_vector(&holding, drives.len()),
            power: axis_vector(&zero, drives.len()),
            saturated: [false; MAX_AXES],
        };
        let world = RapierWorld::new(model, &equation, (&armature, gravity), &position)?;
        let steps = steps_per_cycle(drives, &inertia, cycle);
        Ok(Self {
            trains,
            world,
            drives: at_work,
            equation,
            joints: MachineState {
                axes: JointState::at_rest(position),
                motors: JointState::at_rest(motors),
            },
            homed,
            loads: [LoadSums::default(); MAX_AXES],
            events: Vec::new(),
            body_events: Vec::new(),
            contact: ContactState::default(),
            setpoint: AxisMotion::at_rest(*initial),
            state,
            cycle_ns,
            cycle,
            steps,
        })
    }

    /// The machine with steps of the equation of motion of at most `longest` s, regardless of computing time.
    #[must_use]
    pub fn with_steps_of(mut self, longest: f64) -> Self {
        let mut factor = 1_u32;
        while self.cycle / f64::from(self.steps * factor) > longest * (1.0 + 1e-9)
            && factor < 1 << 20
        {
            factor += 1;
        }
        self.steps *= factor;
        self
    }

    /// The machine whose rapier world takes a step in every cycle. Otherwise it leaves out those in which nothing is
    /// loose and nothing can touch; the results have the same bits.
    #[must_use]
    pub fn with_every_step(mut self) -> Self {
        self.world.every_cycle = true;
        self
    }

    /// The machine with noise from another seed; the seed is 0 otherwise.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        for (axis, drive) in self.drives.iter_mut().enumerate() {
            drive.noise.reseed(seed, axis);
        }
        self
    }

    /// Length of a cycle, s.
    pub fn cycle(&self) -> f64 {
        self.cycle
    }

    /// The axes at the end of the last cycle.
    pub fn axis_state(&self) -> &AxisState {
        &self.state
    }

    /// The set-point at the end of the last cycle.
    pub fn setpoint(&self) -> &AxisMotion {
        &self.setpoint
    }

    /// Motor positions relative to homing, m or rad at the axes; the axis positions if the transmission is rigid.
    pub fn motor_position(&self) -> AxisVector {
        axis_vector(&(self.joints.motors.position - self.homed), self.drives.len())
    }

    /// Load of the motor of `axis` so far.
    pub fn motor_load(&self, axis: usize) -> MotorLoad {
        self.loads.get(axis).map(LoadSums::load).unwrap_or_default()
    }

    /// State of the motor of `axis` in the last cycle; the default if the machine lacks that axis.
    pub fn motor_state(&self, axis: usize) -> MotorState {
        let Some(drive) = self.drives.get(axis) else { return MotorState::default() };
        let of = |values: &AxisVector| values.get(axis).copied().unwrap_or_default();
        MotorState {
            effort: of(&self.state.effort),
            effort_limit: drive.effort_limit(self.joints.motors.velocity[axis]),
            power: of(&self.state.power),
            warmth: drive.warmth(),
            load_angle: self.load_angle(axis),
        }
    }

    /// Load angle of the step motor of `axis`: lead of the field over the rotor, in full steps; `None` of other motors.
    pub fn load_angle(&self, axis: usize) -> Option<f64> {
        match &self.drives.get(axis)?.motor {
            MotorAtWork::Stepper(stepper) => {
                Some(stepper.load_angle(self.joints.motors.position[axis]))
            }
            MotorAtWork::Servo(_) => None,
        }
    }

    /// The switches of `axis`.
    pub fn switches(&self, axis: usize) -> SwitchStates {
        self.drives.get(axis).map(|drive| drive.switched).unwrap_or_default()
    }

    /// Takes the events since the last call.
    pub fn take_events(&mut self) -> Vec<PhysicsEvent> {
        std::mem::take(&mut self.events)
    }

    /// Poses of the loose bodies in the machine frame, in the order of [`crate::Surroundings::bodies`].
    pub fn body_poses(&self) -> Vec<Isometry3<f64>> {
        self.world.body_poses()
    }

    /// Closes or opens the gripper of this place in [`crate::Surroundings::grippers`]. What comes of it is an event.
    pub fn grip(&mut self, gripper: usize, close: bool) {
        let time_ns = self.state.time_ns;
        let event = self.world.grip(gripper, close);
        self.body_events.extend(event.map(|kind| BodyEvent { time_ns, kind }));
    }

    /// The body that a gripper holds, by its place in [`crate::Surroundings::bodies`].
    pub fn held_by(&self, gripper: usize) -> Option<usize> {
        self.world.loose()?.held_by(gripper)
    }

    /// Force (N) and moment (Nm) at a gripper in the last cycle; 0 if it holds nothing.
    pub fn gripper_load(&self, gripper: usize) -> [f64; 2] {
        self.world.loose().map_or([0.0; 2], |loose| loose.load(gripper))
    }

    /// Takes what has happened to loose bodies since the last call.
    pub fn take_body_events(&mut self) -> Vec<BodyEvent> {
        std::mem::take(&mut self.body_events)
    }

    /// Poses of the links in the machine frame, in the order of [`Model::links`].
    pub fn link_poses(&self) -> Vec<Isometry3<f64>> {
        self.world.poses().to_vec()
    }
}

/// Transmission between a motor and its axis.
fn train_of(drive: &AxisDriveParameters) -> Train {
    match drive.transmission {
        None => Train { friction: drive.friction.and(&drive.motor_friction), elastic: None },
        Some(transmission) => Train {
            friction: drive.friction,
            elastic: Some(Elastic {
                transmission,
                inertia: drive.armature,
                friction: drive.motor_friction,
            }),
        },
    }
}

/// Longest step with springs, s.
const ELASTIC_STEP: f64 = 125e-6;

/// Part of a radian that the fastest spring may swing in a step.
const SWING: f64 = 0.25;

/// Most steps in a cycle that springs may ask for.
const MOST_STEPS: u32 = 256;

/// Steps of the equation of motion per cycle: each pass of a drive loop begins a step, and steps are short against
/// springs.
fn steps_per_cycle(drives: &[AxisDriveParameters], inertia: &JointVector, cycle: f64) -> u32 {
    let passes = drives.iter().map(|drive| match &drive.motor {
        Motor::Servo(servo) => u32::from(servo.velocity_passes),
        Motor::Stepper(_) => 1,
    });
    let passes = passes.fold(1, least_common_multiple);
    let longest = drives.iter().zip(inertia).filter_map(|(drive, inertia)| {
        let spring = drive.transmission.map(|elastic| elastic.resonance(drive.armature, *inertia));
        let field = match &drive.motor {
            Motor::Stepper(stepper) => {
                let moved = if drive.transmission.is_some() { drive.armature } else { *inertia };
                Some((stepper.stiffness(0.0) / moved).sqrt())
            }
            Motor::Servo(_) => None,
        };
        let fastest = spring.into_iter().chain(field).reduce(f64::max)?;
        Some((SWING / fastest).min(ELASTIC_STEP))
    });
    let longest = longest.fold(cycle, f64::min);
    let mut steps = passes;
    while cycle / f64::from(steps) > longest * (1.0 + 1e-9) && steps + passes <= MOST_STEPS {
        steps += passes;
    }
    steps
}

fn least_common_multiple(one: u32, other: u32) -> u32 {
    let (mut a, mut b) = (one, other);
    while b > 0 {
        (a, b) = (b, a % b);
    }
    one / a * other
}
