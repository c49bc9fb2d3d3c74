//! Servo drive: cascaded position, velocity and current loops.
//!
//! ```text
//! v_cmd  = ff_v·v_set + Kv·(q_set − q)                                                        every position period
//! effort = gain·(v_cmd − v) + ∫ gain/Tn·(v_cmd − v) dt + feed-forward + balance, limited      every velocity period
//! motor  = effort, `delay` velocity periods later, by a current loop of first order           at all times
//! ```
//!
//! While the effort is limited, the integral only moves towards zero error (no wind-up). `balance` holds the axis
//! against gravity when the drive is enabled. A current loop tuned by pole cancellation is a first-order lag.

use super::curve::EffortCurve;
use super::encoder::{EncoderParameters, EncoderSide};
use crate::state::Stage;

/// Most velocity periods from measuring to the current set-point.
pub(crate) const MAX_DELAY: usize = 8;

/// Parameters of a servo drive. Efforts in N or Nm, lengths in m or rad, everything at the axis (behind the gear).
#[derive(Clone, Debug, PartialEq)]
pub struct ServoParameters {
    /// Position loop gain Kv, 1/s; machine tools have 15 to 150.
    pub position_gain: f64,
    /// Velocity loop gain, N·s/m or Nm·s/rad.
    pub velocity_gain: f64,
    /// Reset time Tn of the velocity loop, s; infinite for none. Usually 5 to 50 ms.
    pub integral_time: f64,
    /// Part of the set-point's velocity that is fed forward, 0 to 1.
    pub velocity_feed_forward: f64,
    /// Effort feed-forward.
    pub effort_feed_forward: EffortFeedForward,
    /// Largest force or torque, N or Nm; infinite for no limit.
    pub effort_limit: f64,
    /// Effort limit over speed.
    pub effort_curve: EffortCurve,
    /// Bandwidth of the current loop, rad/s; infinite if it is there at once. Usually 500 to 3000 Hz.
    pub current_bandwidth: f64,
    /// Passes of the position loop per cycle.
    pub position_passes: u8,
    /// Passes of the velocity loop per cycle, a multiple of those of the position loop.
    pub velocity_passes: u8,
    /// Velocity periods from measuring to the current set-point, 0 to 8; digital drives have 1 or 2.
    pub delay: u8,
    /// Its encoder.
    pub encoder: EncoderParameters,
}

/// Effort feed-forward of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EffortFeedForward {
    /// Nothing.
    None,
    /// The set-point's acceleration times this inertia, kg or kg·m².
    Inertia(f64),
    /// This part (0 to 1) of the inverse dynamics of the whole machine at the set-point.
    Dynamics(f64),
}

impl ServoParameters {
    /// Velocity loop bandwidth of drives of unknown tuning, Hz: low for a modern servo drive.
    pub const DEFAULT_BANDWIDTH_HZ: f64 = 50.0;

    /// Passes of both loops per cycle where nothing is known: 4 kHz at a cycle of 1 ms.
    pub const DEFAULT_PASSES: u8 = 4;

    /// Gives no effort of its own.
    pub const SLACK: Self = Self {
        position_gain: 0.0,
        velocity_gain: 0.0,
        integral_time: f64::INFINITY,
        velocity_feed_forward: 0.0,
        effort_feed_forward: EffortFeedForward::None,
        effort_limit: f64::INFINITY,
        effort_curve: EffortCurve::UNLIMITED,
        current_bandwidth: f64::INFINITY,
        position_passes: Self::DEFAULT_PASSES,
        velocity_passes: Self::DEFAULT_PASSES,
        delay: 0,
        encoder: EncoderParameters::IDEAL,
    };

    /// Drive tuned by the symmetrical optimum for an axis of `inertia` (kg or kg·m², rotor included): velocity gain
    /// `inertia·ω` (ω = 2π·bandwidth), position gain ω/4, reset time 4/ω, full velocity and inertia feed-forward.
    pub fn tuned(inertia: f64, bandwidth_hz: f64, effort_limit: f64) -> Self {
        let bandwidth = bandwidth_hz * std::f64::consts::TAU;
        Self {
            position_gain: 0.25 * bandwidth,
            velocity_gain: inertia * bandwidth,
            integral_time: 4.0 / bandwidth,
            velocity_feed_forward: 1.0,
            effort_feed_forward: EffortFeedForward::Inertia(inertia),
            effort_limit,
            ..Self::SLACK
        }
    }

    /// The largest force or torque at `velocity` (m/s or rad/s), N or Nm; infinite for no limit.
    pub(super) fn most_effort(&self, velocity: f64) -> f64 {
        self.effort_limit.min(self.effort_curve.at(velocity))
    }

    /// The fields with their names and ranges.
    pub(super) fn ranges(&self) -> [(&'static str, f64, f64, f64); 11] {
        let (feed_forward, most) = match self.effort_feed_forward {
            EffortFeedForward::None => (0.0, 0.0),
            EffortFeedForward::Inertia(inertia) => (inertia, f64::MAX),
            EffortFeedForward::Dynamics(part) => (part, 1.0),
        };
        let passes = f64::from(self.velocity_passes);
        // Of velocity periods, 0 where it is a whole number.
        let uneven = f64::from(self.velocity_passes % self.position_passes.max(1));
        [
            ("position_gain", self.position_gain, 0.0, f64::MAX),
            ("velocity_gain", self.velocity_gain, 0.0, f64::MAX),
            ("integral_time", self.integral_time, f64::MIN_POSITIVE, f64::INFINITY),
            ("velocity_feed_forward", self.velocity_feed_forward, 0.0, 1.0),
            ("effort_feed_forward", feed_forward, 0.0, most),
            ("effort_limit", self.effort_limit, 0.0, f64::INFINITY),
            ("current_bandwidth", self.current_bandwidth, f64::MIN_POSITIVE, f64::INFINITY),
            ("position_passes", f64::from(self.position_passes), 1.0, passes),
            ("velocity_passes", if uneven > 0.0 { f64::NAN } else { passes }, 1.0, 64.0),
            ("delay", f64::from(self.delay), 0.0, 8.0),
            ("encoder resolution", self.encoder.resolution, 0.0, f64::MAX),
        ]
    }
}

/// Set-point and state of one axis as its drive sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DriveInput {
    pub(crate) position_setpoint: f64,
    pub(crate) velocity_setpoint: f64,
    /// Feed-forward, N or Nm.
    pub(crate) effort: f64,
    /// Of the axis.
    pub(crate) position: f64,
    pub(crate) motor_position: f64,
    pub(crate) motor_velocity: f64,
}

/// A servo drive at work.
#[derive(Clone, Debug)]
pub(crate) struct ServoDrive {
    pub(crate) parameters: ServoParameters,
    /// Effort of the integral action, with the balance it was started from.
    integral: f64,
    /// Output of the position loop.
    velocity_command: f64,
    /// The motor's position at the last pass, in increments of its encoder.
    measured: Option<f64>,
    /// Outputs that are under way, the next to come first.
    delayed: [f64; MAX_DELAY],
    /// Effort set-point of the current loop.
    target: f64,
    /// Effort of the current loop.
    effort: f64,
    /// The same in the middle and at the end of the step.
    course: [f64; 2],
    /// Length of the step in time constants of the current loop.
    changes: f64,
}

impl ServoDrive {
    /// A drive that is enabled with the effort `holding`, of which `fed_forward` is fed forward.
    pub(super) fn enabled(parameters: ServoParameters, holding: f64, fed_forward: f64) -> Self {
        Self {
            parameters,
            integral: holding - fed_forward,
            velocity_command: 0.0,
            measured: None,
            delayed: [holding; MAX_DELAY],
            target: holding,
            effort: holding,
            course: [holding; 2],
            changes: 0.0,
        }
    }

    /// One pass of the velocity loop, and of the position loop if it is due; `period` (s) is that of the velocity
    /// loop. True if limited.
    pub(crate) fn control(&mut self, input: &DriveInput, positions: bool, period: f64) -> bool {
        let parameters = &self.parameters;
        let EncoderParameters { side, resolution } = parameters.encoder;
        if positions {
            let position = match side {
                EncoderSide::Motor => input.motor_position,
                EncoderSide::Axis => input.position,
            };
            let error = input.position_setpoint - parameters.encoder.measured(position);
            self.velocity_command = parameters.velocity_feed_forward * input.velocity_setpoint
                + parameters.position_gain * error;
        }
        let velocity = if resolution > 0.0 {
            let now = parameters.encoder.measured(input.motor_position);
            let before = self.measured.replace(now);
            before.map_or(0.0, |before| (now - before) / period)
        } else {
            input.motor_velocity
        };
        let proportional = parameters.velocity_gain * (self.velocity_command - velocity);
        let wanted = proportional + self.integral + input.effort;
        let most = parameters.most_effort(input.motor_velocity);
        let effort = wanted.clamp(-most, most);
        let excess = wanted - effort;
        let saturated = excess.abs() > 0.0;
        // Not further into the limit.
        if !saturated || proportional * excess < 0.0 {
            self.integral += proportional * (period / parameters.integral_time);
        }
        self.target = match usize::from(parameters.delay).checked_sub(1) {
            None => effort,
            Some(last) => {
                let next = self.delayed[0];
                self.delayed.rotate_left(1);
                if let Some(slot) = self.delayed.get_mut(last) {
                    *slot = effort;
                }
                next
            }
        };
        saturated
    }

    /// Lets the current loop go on for `dt` (s).
    pub(crate) fn begin_step(&mut self, dt: f64) {
        let [_, before] = self.course;
        self.effort = before;
        if self.parameters.current_bandwidth.is_infinite() {
            self.effort = self.target;
        }
        self.changes = self.parameters.current_bandwidth * dt;
        self.course = [self.after(0.5), self.after(1.0)];
    }

    /// Effort after this part of the step.
    fn after(&self, part: f64) -> f64 {
        self.target + (self.effort - self.target) * (-self.changes * part).exp()
    }

    /// Motor effort in the step.
    pub(super) fn effort(&self, stage: Stage) -> f64 {
        let [middle, end] = self.course;
        match stage {
            Stage::Start => self.effort,
            Stage::Middle => middle,
            Stage::End => end,
            Stage::At(part) => self.after(part),
        }
    }
}
