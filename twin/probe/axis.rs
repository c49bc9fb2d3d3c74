//! A probing move of one axis: command 40 of InterpCNC (`ICNC_CMD_PROBE`), and what a PLC does with `MC_MoveVelocity`,
//! `MC_TouchProbe` and `MC_Stop`.
//!
//! The axis speeds up from its start velocity, goes on until the probe trips, and is brought to rest by its deceleration. Where it
//! was when the probe tripped is latched before that. Without a trip it comes to rest at the end of its stroke.

use crate::machine::{Machine, SimulationError};
use crate::physics::PhysicsError;
use crate::report::seconds;
use crate::simulated::Simulated;
use twin_kinematics::{AxisMotion, AxisVector};

/// What the axis is asked for. m or rad, and s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisProbe {
    /// The axis, in machine-file order.
    pub axis: usize,
    /// How far it goes at most, with the sign of the direction.
    pub stroke: f64,
    /// Velocity at the first and behind the last moment; what a step motor starts and stops at.
    pub start_velocity: f64,
    /// Velocity of the search.
    pub velocity: f64,
    /// To reach it.
    pub acceleration: f64,
    /// To rest.
    pub deceleration: f64,
}

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AxisProbeEnd {
    /// The probe tripped.
    Tripped {
        /// Where the axis was then (`RecordedPosition`).
        latched: f64,
        /// Where it came to rest.
        rest: f64,
    },
    /// The end of the stroke came first.
    NotTripped,
    /// The probe had tripped before the move: the axis stays where it is.
    AlreadyTripped,
}

/// Cycles without motion after which the axis has come to rest.
const SETTLING: u32 = 100;

impl AxisProbe {
    /// Carries it out on a machine at rest. The other axes stay where they are.
    ///
    /// # Errors
    /// Whatever keeps the simulated machine from following; [`PhysicsError::Input`] for velocities and accelerations that are no
    /// numbers.
    pub fn run(
        &self,
        machine: &Machine,
        simulated: &mut Simulated,
    ) -> Result<AxisProbeEnd, SimulationError> {
        self.carried_out(seconds(machine.cycle_ns), simulated)
            .map_err(|error| SimulationError::of(machine, error))
    }

    fn carried_out(
        &self,
        cycle: f64,
        machine: &mut Simulated,
    ) -> Result<AxisProbeEnd, PhysicsError> {
        if machine.touches()? {
            return Ok(AxisProbeEnd::AlreadyTripped);
        }
        let from = machine.physics().setpoint().position;
        let mut course = Course::new(self);
        let mut latched = None;
        let mut rested = 0;
        while rested < SETTLING {
            course.advance(cycle, latched.is_some());
            let motion = course.motion(self, &from);
            machine.probe_towards(&motion)?;
            if latched.is_none() && machine.touches()? {
                latched = machine.physics().axis_state().position.get(self.axis).copied();
            }
            rested = if course.velocity > 0.0 { 0 } else { rested + 1 };
        }
        let rest = machine.physics().axis_state().position;
        let rest = rest.get(self.axis).copied().unwrap_or_default();
        Ok(latched
            .map_or(AxisProbeEnd::NotTripped, |latched| AxisProbeEnd::Tripped { latched, rest }))
    }
}

/// The set-points along the stroke.
struct Course {
    length: f64,
    start_velocity: f64,
    most: f64,
    acceleration: f64,
    deceleration: f64,
    way: f64,
    velocity: f64,
    change: f64,
}

impl Course {
    fn new(probe: &AxisProbe) -> Self {
        let start_velocity = probe.start_velocity.clamp(0.0, probe.velocity.max(0.0));
        Self {
            length: probe.stroke.abs(),
            start_velocity,
            most: probe.velocity,
            acceleration: probe.acceleration,
            deceleration: probe.deceleration,
            way: 0.0,
            velocity: start_velocity,
            change: 0.0,
        }
    }

    /// A cycle of `dt` s, braking or on the search.
    fn advance(&mut self, dt: f64, brakes: bool) {
        let left = (self.length - self.way).max(0.0);
        // What still stops at the end of the stroke after this cycle.
        let stoppable = |velocity: f64, way: f64| {
            let slow = velocity * velocity - self.start_velocity * self.start_velocity;
            way + slow.max(0.0) / (2.0 * self.deceleration) <= left
        };
        let faster = (self.velocity + self.acceleration * dt).min(self.most);
        let slower = self.velocity - self.deceleration * dt;
        let ahead = 0.5 * (self.velocity + faster) * dt;
        let under_way = self.velocity > 0.0 || self.way <= 0.0;
        let next = if !brakes && under_way && stoppable(faster, ahead) {
            faster
        } else if slower > self.start_velocity {
            slower
        } else {
            0.0
        };
        let way = 0.5 * (self.velocity + next) * dt;
        self.way = if brakes { self.way + way } else { (self.way + way).min(self.length) };
        self.change = (next - self.velocity) / dt;
        self.velocity = next;
    }

    fn motion(&self, probe: &AxisProbe, from: &AxisVector) -> AxisMotion {
        let mut motion = AxisMotion::at_rest(*from);
        let sense = probe.stroke.signum();
        let slots = motion.position.iter_mut().zip(motion.velocity.iter_mut());
        let slots = slots.zip(motion.acceleration.iter_mut()).nth(probe.axis);
        if let Some(((position, velocity), acceleration)) = slots {
            *position += sense * self.way;
            *velocity = sense * self.velocity;
            *acceleration = sense * self.change;
        }
        motion
    }
}
