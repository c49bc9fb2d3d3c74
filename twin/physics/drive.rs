//! The drive of one axis: a cascade of position and velocity loop with limited force or torque, as in a servo drive.
//!
//! ```text
//! v_cmd  = ff_v·v_set + Kv·(q_set − q)
//! effort = gain·(v_cmd − v) + ∫ gain/Tn·(v_cmd − v) dt + feed-forward + balance     within ± effort_limit
//! ```
//!
//! While the effort is limited the integral only moves towards zero error (no wind-up). `balance` is the effort that
//! holds the axis against gravity where the drive is enabled, the start value a real drive gets before it lets go
//! of the brake.

/// Parameters of a drive. Efforts in N or Nm, lengths in m or rad, everything at the joint (behind the gear).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisDriveParameters {
    /// Position loop gain Kv, 1/s.
    pub position_gain: f64,
    /// Velocity loop gain, N·s/m or Nm·s/rad.
    pub velocity_gain: f64,
    /// Reset time Tn of the velocity loop, s; infinite for none.
    pub integral_time: f64,
    /// Part of the set-point's velocity that is fed forward, 0 to 1.
    pub velocity_feed_forward: f64,
    /// What is fed forward to the effort.
    pub effort_feed_forward: EffortFeedForward,
    /// Largest force or torque, N or Nm; infinite for no limit.
    pub effort_limit: f64,
    /// Dry friction of the axis, N or Nm.
    pub coulomb_friction: f64,
    /// Friction proportional to velocity, N·s/m or Nm·s/rad.
    pub viscous_friction: f64,
    /// Rotor (and gear) inertia as felt at the joint, gear ratio squared times rotor inertia, kg or kg·m².
    pub armature: f64,
}

/// What a drive knows ahead of the effort a motion takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EffortFeedForward {
    /// Nothing.
    None,
    /// The set-point's acceleration times this inertia, kg or kg·m².
    Inertia(f64),
    /// This part (0 to 1) of the inverse dynamics of the whole machine at the set-point, gravity and coupling of
    /// the axes included.
    Dynamics(f64),
}

impl AxisDriveParameters {
    /// Bandwidth of the velocity loop, Hz, for drives of which nothing is known: low for a modern servo drive, reached
    /// by any.
    pub const DEFAULT_BANDWIDTH_HZ: f64 = 50.0;

    /// A drive tuned by the usual rules for an axis that moves `inertia` (kg or kg·m², rotor included), without
    /// friction: velocity gain `inertia·ω` for a velocity loop of `bandwidth_hz` (ω = 2π·bandwidth), position gain
    /// ω/4 and reset time 4/ω (symmetrical optimum), full velocity and inertia feed-forward.
    pub fn tuned(inertia: f64, bandwidth_hz: f64, effort_limit: f64) -> Self {
        let bandwidth = bandwidth_hz * std::f64::consts::TAU;
        Self {
            position_gain: 0.25 * bandwidth,
            velocity_gain: inertia * bandwidth,
            integral_time: 4.0 / bandwidth,
            velocity_feed_forward: 1.0,
            effort_feed_forward: EffortFeedForward::Inertia(inertia),
            effort_limit,
            coulomb_friction: 0.0,
            viscous_friction: 0.0,
            armature: 0.0,
        }
    }

    /// The first field out of range, by name.
    pub(super) fn out_of_range(&self) -> Option<(&'static str, f64)> {
        let feed_forward = match self.effort_feed_forward {
            EffortFeedForward::None => 0.0,
            EffortFeedForward::Inertia(inertia) => inertia,
            EffortFeedForward::Dynamics(part) => part,
        };
        let largest_feed_forward = match self.effort_feed_forward {
            EffortFeedForward::Dynamics(_) => 1.0,
            EffortFeedForward::None | EffortFeedForward::Inertia(_) => f64::MAX,
        };
        let ranges = [
            ("position_gain", self.position_gain, 0.0, f64::MAX),
            ("velocity_gain", self.velocity_gain, 0.0, f64::MAX),
            ("integral_time", self.integral_time, f64::MIN_POSITIVE, f64::INFINITY),
            ("velocity_feed_forward", self.velocity_feed_forward, 0.0, 1.0),
            ("effort_feed_forward", feed_forward, 0.0, largest_feed_forward),
            ("effort_limit", self.effort_limit, 0.0, f64::INFINITY),
            ("coulomb_friction", self.coulomb_friction, 0.0, f64::MAX),
            ("viscous_friction", self.viscous_friction, 0.0, f64::MAX),
            ("armature", self.armature, 0.0, f64::MAX),
        ];
        let outside =
            ranges.into_iter().find(|(_, value, low, high)| !(low..=high).contains(&value));
        outside.map(|(name, value, ..)| (name, value))
    }
}

/// Set-point of one axis as its drive sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct DriveInput {
    pub(super) position_setpoint: f64,
    pub(super) velocity_setpoint: f64,
    /// Feed-forward, N or Nm.
    pub(super) effort: f64,
    pub(super) position: f64,
    pub(super) velocity: f64,
}

/// What a drive puts on its axis over a control period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DriveOutput {
    pub(super) effort: f64,
    pub(super) saturated: bool,
}

/// A drive at work.
#[derive(Clone, Debug)]
pub(super) struct AxisDrive {
    pub(super) parameters: AxisDriveParameters,
    /// Effort of the integral action, with the balance it was started from.
    integral: f64,
}

impl AxisDrive {
    /// A drive that is enabled with the effort `balance` on.
    pub(super) fn enabled(parameters: AxisDriveParameters, balance: f64) -> Self {
        Self { parameters, integral: balance }
    }

    /// One pass of both loops; `dt` is the control period in s.
    pub(super) fn control(&mut self, input: &DriveInput, dt: f64) -> DriveOutput {
        let parameters = &self.parameters;
        let command = parameters.velocity_feed_forward * input.velocity_setpoint
            + parameters.position_gain * (input.position_setpoint - input.position);
        let proportional = parameters.velocity_gain * (command - input.velocity);
        let wanted = proportional + self.integral + input.effort;
        let effort = wanted.clamp(-parameters.effort_limit, parameters.effort_limit);
        let excess = wanted - effort;
        let saturated = excess.abs() > 0.0;
        // Not further into the limit.
        if !saturated || proportional * excess < 0.0 {
            self.integral += proportional * (dt / parameters.integral_time);
        }
        DriveOutput { effort, saturated }
    }
}
