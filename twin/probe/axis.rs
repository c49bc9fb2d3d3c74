//! Probing move of one axis: command 40 of InterpCNC (`ICNC_CMD_PROBE`), or `MC_MoveVelocity`, `MC_TouchProbe` and
//! `MC_Stop` of a PLC.
//!
//! The axis accelerates from its start velocity, moves until the probe trips, and decelerates to rest. Its position at
//! the trip is latched. Without a trip it comes to rest at the end of its stroke.
//!
//! If the axis is on an InterpCNC board in the loop of the simulated machine, the board itself moves it.

use super::board::{BoardRefusal, BoardSearch};
use crate::simulated::Simulated;
use twin_kinematics::{AxisMotion, AxisVector};
use twin_machine::{Machine, SimulationError};
use twin_number::seconds;
use twin_physics::PhysicsError;

/// Parameters of a probing move. m or rad, and s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisProbe {
    /// The axis, in machine-file order.
    pub axis: usize,
    /// Longest way, with the sign of the direction.
    pub stroke: f64,
    /// Velocity at the first and behind the last moment; what a step motor starts and stops at.
    pub start_velocity: f64,
    /// Velocity of the search.
    pub velocity: f64,
    /// To reach it.
    pub acceleration: f64,
    /// To rest.
    pub deceleration: f64,
    /// Window in which a trip counts (`WindowOnly`, `FirstPosition`, `LastPosition` of `MC_TouchProbe`); none:
    /// everywhere.
    pub window: Option<[f64; 2]>,
}

/// Result of a probing move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AxisProbeEnd {
    /// The probe tripped.
    Tripped {
        /// Where the axis was then (`RecordedPosition`); of a board, where its counter was.
        latched: f64,
        /// Where it came to rest.
        rest: f64,
    },
    /// The end of the stroke came first.
    NotTripped,
    /// The probe had tripped before the move: the axis stays where it is.
    AlreadyTripped,
}

/// Errors that make a probing move impossible.
#[derive(Debug, thiserror::Error)]
pub enum AxisProbeError {
    /// The simulated machine.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The board has no such command.
    #[error(transparent)]
    Board(#[from] BoardRefusal),
}

/// Mover of the axis during the search.
pub(super) trait Search {
    /// Lets a cycle pass, `dt` s; `tripped` once the probe has.
    fn advance(&mut self, cycle_ns: i64, dt: f64, tripped: bool);

    /// How far it has come, its velocity and its acceleration: m or rad, and s.
    fn motion(&self) -> [f64; 3];

    fn is_under_way(&self) -> bool;

    /// What its own counter was when the probe tripped, if it has one.
    fn latched(&self) -> Option<f64>;
}

/// Cycles without motion after which the axis has come to rest.
const SETTLING: u32 = 100;

impl AxisProbe {
    /// Carries it out on a machine at rest. The other axes stay where they are.
    ///
    /// # Errors
    /// What keeps the simulated machine from following, collisions and limit switches included; [`PhysicsError::Input`]
    /// for an axis that is not there, a stroke beyond its software limits, and velocities and rates that are not above 0;
    /// what a board refuses.
    pub fn run(
        &self,
        machine: &Machine,
        simulated: &mut Simulated,
    ) -> Result<AxisProbeEnd, AxisProbeError> {
        let refused = |error| SimulationError::of(machine, error);
        let above = [self.velocity, self.acceleration, self.deceleration];
        let from = simulated.physics().setpoint().position.get(self.axis).copied();
        let limits = machine.axes.get(self.axis).map(|axis| axis.position_limits);
        let reached = from
            .zip(limits)
            .is_some_and(|(from, [low, high])| (low..=high).contains(&(from + self.stroke)));
        if !reached || !above.iter().all(|value| value.is_finite() && *value > 0.0) {
            return Err(refused(PhysicsError::Input(0)).into());
        }
        let axis = machine.axes.get(self.axis).zip(from);
        let board = axis.and_then(|(axis, from)| BoardSearch::begin(self, machine, axis, from));
        let mut search: Box<dyn Search> = match board {
            Some(board) => Box::new(board?),
            None => Box::new(Course::new(self)),
        };
        Ok(self.carried_out(machine.cycle_ns, &mut *search, simulated).map_err(refused)?)
    }

    fn carried_out(
        &self,
        cycle_ns: i64,
        search: &mut dyn Search,
        machine: &mut Simulated,
    ) -> Result<AxisProbeEnd, PhysicsError> {
        let from = machine.physics().setpoint().position;
        let mut touches = machine.touches()?;
        if touches && self.counts(machine) {
            return Ok(AxisProbeEnd::AlreadyTripped);
        }
        let mut latched = None;
        let mut rested = 0;
        while rested < SETTLING {
            search.advance(cycle_ns, seconds(cycle_ns), latched.is_some());
            machine.probe_towards(&self.setpoint(&from, search.motion()))?;
            // A trip is an edge: what touches where it does not count has to come free before.
            let touched = std::mem::replace(&mut touches, machine.touches()?);
            if latched.is_none() && touches && !touched && self.counts(machine) {
                latched = machine.physics().axis_state().position.get(self.axis).copied();
            }
            rested = if search.is_under_way() { 0 } else { rested + 1 };
        }
        let rest = machine.physics().axis_state().position;
        let rest = rest.get(self.axis).copied().unwrap_or_default();
        Ok(latched
            .map(|latched| search.latched().unwrap_or(latched))
            .map_or(AxisProbeEnd::NotTripped, |latched| AxisProbeEnd::Tripped { latched, rest }))
    }

    /// Whether a trip counts where the axis is.
    fn counts(&self, machine: &Simulated) -> bool {
        let position = machine.physics().axis_state().position.get(self.axis).copied();
        self.window.zip(position).is_none_or(|([first, last], position)| {
            (first.min(last)..=first.max(last)).contains(&position)
        })
    }

    /// The other axes stay at `from`.
    fn setpoint(&self, from: &AxisVector, [way, speed, change]: [f64; 3]) -> AxisMotion {
        let mut motion = AxisMotion::at_rest(*from);
        let slots = motion.position.iter_mut().zip(motion.velocity.iter_mut());
        let slots = slots.zip(motion.acceleration.iter_mut()).nth(self.axis);
        if let Some(((position, velocity), acceleration)) = slots {
            *position += way;
            *velocity = speed;
            *acceleration = change;
        }
        motion
    }
}

/// A profile of our own along the stroke.
struct Course {
    sense: f64,
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
            sense: probe.stroke.signum(),
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
}

impl Search for Course {
    fn advance(&mut self, _cycle_ns: i64, dt: f64, brakes: bool) {
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

    fn motion(&self) -> [f64; 3] {
        [self.way, self.velocity, self.change].map(|value| self.sense * value)
    }

    fn is_under_way(&self) -> bool {
        self.velocity > 0.0
    }

    fn latched(&self) -> Option<f64> {
        None
    }
}
