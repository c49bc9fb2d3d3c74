//! [`Axis`]: an axis with its values, motion and owner (`AXIS_REF`, manual 2.4).

mod values;

use super::config::{AxisConfig, Movement};
use super::drive::{Capture, Feedback};
use super::math::fmod;
use super::state::AxisState;
use twin_profile::{AxisLimits, Profile, RampType, State};
use values::AxisValues;

/// An axis (`AXIS_REF`, manual 2.4), cycle by cycle.
///
/// [`Axis::begin_cycle`] reads the drive's feedback; then the program calls its blocks in any order; [`Axis::end_cycle`]
/// supervises them and gives the set-point for the drive, as in the example of the [crate](crate).
///
/// The set-points of a running block count in the drive's coordinates. [`Axis::shift_zero`] moves the zero under it
/// without moving the axis.
#[derive(Clone, Debug)]
pub struct Axis {
    pub(super) values: AxisValues,
    pub(super) state: AxisState,
    pub(super) movement: Movement,
    pub(super) ramp: RampType,
    /// Motion by the owner, in the drive's coordinates, unwound.
    pub(super) base: State,
    /// Motion on top of it.
    pub(super) overlay: State,
    /// Owner of the superimposed motion, 0 for none.
    pub(super) overlay_owner: i64,
    /// End of that motion, u, while it has an owner.
    pub(super) overlay_aim: f64,
    pub(super) overlay_moved: bool,
    /// Base and overlay together when the cycle began.
    pub(super) saved: State,
    /// Base when the cycle began; the owner goes on from it.
    pub(super) saved_base: State,
    /// The target of a discrete motion, in the coordinates of `base`.
    pub(super) aim: Option<f64>,
    /// Sign of its last motion: motion in the current direction from rest takes it.
    pub(super) went: i64,
    /// Cycles so far, as time, ns.
    pub(super) clock_ns: i64,
    /// Rounding of that time, ns.
    pub(super) clock_rest: f64,
    /// Total shift of its zero so far, u: it changes positions without motion.
    pub(super) zero: f64,
    /// Braking of the axis on its own, and the time since its start, s.
    pub(super) braking: Option<(Profile, f64)>,
    pub(super) capture: Option<Capture>,
    pub(super) home: Option<f64>,
    pub(super) has_capture_window: bool,
    /// Feedback of the drive in this cycle.
    pub(super) drive: Feedback,
    /// True once the drive has answered.
    pub(super) drive_known: bool,
    /// Every transition, for the checker of the tests.
    #[cfg(test)]
    pub(super) entered: Vec<[AxisState; 2]>,
    /// Number of commands, of the base and of the superimposed motion, for the checker of the tests.
    #[cfg(test)]
    pub(super) commands: [u32; 2],
}

impl Axis {
    /// An axis at rest, without power and without feedback of its drive.
    #[must_use]
    pub fn new(config: AxisConfig) -> Self {
        let [negative, positive] = config.software_limits.unwrap_or_default();
        let values = AxisValues {
            task_cycle: config.cycle,
            drive_id: config.drive_id.into(),
            max_jerk: config.jerk,
            sw_max_jerk: config.jerk,
            sw_max_velocity: config.max_velocity,
            sw_max_acceleration: config.max_acceleration,
            sw_max_deceleration: config.max_deceleration,
            sw_limit_enable: config.software_limits.is_some(),
            sw_limit_negative: negative,
            sw_limit_positive: positive,
            ..AxisValues::default()
        };
        Self {
            values,
            state: AxisState::Standstill,
            movement: config.movement,
            ramp: config.ramp,
            base: State::default(),
            overlay: State::default(),
            overlay_owner: 0,
            overlay_aim: 0.0,
            overlay_moved: false,
            saved: State::default(),
            saved_base: State::default(),
            aim: None,
            #[cfg(test)]
            entered: Vec::new(),
            #[cfg(test)]
            commands: [0; 2],
            went: 1,
            clock_ns: 0,
            clock_rest: 0.0,
            zero: 0.0,
            braking: None,
            capture: None,
            home: None,
            has_capture_window: config.capture_window,
            drive: Feedback::default(),
            drive_known: false,
        }
    }

    /// State of the axis (`nAxisState`).
    #[must_use]
    pub fn state(&self) -> AxisState {
        self.state
    }

    /// Time of this cycle's set-point, ns: the cycles of the axis so far.
    #[must_use]
    pub fn now_ns(&self) -> i64 {
        self.clock_ns
    }

    /// Linear or rotary.
    #[must_use]
    pub fn movement(&self) -> Movement {
        self.movement
    }

    /// Shape of its velocity ramps.
    #[must_use]
    pub fn ramp(&self) -> RampType {
        self.ramp
    }

    /// Period of a rotary axis, u.
    #[must_use]
    pub fn period(&self) -> Option<f64> {
        match self.movement {
            Movement::Linear => None,
            Movement::Rotary { period } => Some(period),
        }
    }

    /// Number of the axis's error (`wErrorID`, `MC_ReadAxisError`): of [`SmcError`](super::SmcError) or, above 0, of the drive.
    #[doc(alias = "MC_ReadAxisError")]
    #[must_use]
    pub fn error_id(&self) -> Option<i64> {
        self.values.error.then_some(self.values.error_id)
    }

    /// Limits of a motion with its own velocity, acceleration and deceleration; the jerk is the axis's.
    #[must_use]
    pub fn limits(&self, velocity: f64, acceleration: f64, deceleration: f64) -> AxisLimits {
        AxisLimits { velocity, acceleration, deceleration, jerk: self.values.max_jerk }
    }

    /// Largest acceleration of direct set-points and implicit motion (`fSWMaxAcceleration`), u/s².
    #[must_use]
    pub fn max_acceleration(&self) -> f64 {
        self.values.sw_max_acceleration
    }

    /// Limits of implicit motion: braking in errorstop.
    pub(super) fn implicit_limits(&self) -> AxisLimits {
        let it = &self.values;
        AxisLimits {
            velocity: it.sw_max_velocity,
            acceleration: it.sw_max_acceleration,
            deceleration: it.sw_max_deceleration,
            jerk: it.sw_max_jerk,
        }
    }

    /// A position within the period of a rotary axis (`SMC_fmod`, manual 2.2.1); any of a linear one.
    #[must_use]
    pub fn wrapped(&self, position: f64) -> f64 {
        match self.movement {
            Movement::Linear => position,
            Movement::Rotary { period } => fmod(position, period),
        }
    }

    /// Base and overlay together, in the drive's coordinates, unwound.
    pub(super) fn total(&self) -> State {
        State {
            position: self.base.position + self.overlay.position,
            velocity: self.base.velocity + self.overlay.velocity,
            acceleration: self.base.acceleration + self.overlay.acceleration,
        }
    }

    /// The same at the end of the cycle: a superimposed motion that is not called yet goes on at its velocity.
    pub(super) fn total_after_cycle(&self) -> State {
        let total = self.total();
        let on_top = self.overlay_owner != 0 && !self.overlay_moved;
        let way = if on_top { self.overlay.velocity * self.values.task_cycle } else { 0.0 };
        State { position: total.position + way, ..total }
    }

    /// The drive's position where the program says `position`, u.
    #[must_use]
    pub fn to_drive(&self, position: f64) -> f64 {
        position - self.values.offset_position
    }

    /// The program's position where the drive says `position`, u; within the period.
    #[must_use]
    pub fn in_program(&self, position: f64) -> f64 {
        self.wrapped(position + self.values.offset_position)
    }

    /// True if the last motion was in negative direction.
    pub(super) fn was_negative(&self) -> bool {
        self.went < 0
    }

    /// Set position (`fSetPosition`, `SMC_ReadSetPosition`), u; of a rotary axis in [0, period).
    #[doc(alias = "SMC_ReadSetPosition")]
    #[must_use]
    pub fn set_position(&self) -> f64 {
        self.values.set_position
    }

    /// Set velocity (`fSetVelocity`), u/s.
    #[must_use]
    pub fn set_velocity(&self) -> f64 {
        self.values.set_velocity
    }

    /// Set acceleration (`fSetAcceleration`), u/s²: that of the velocity with its sign.
    #[must_use]
    pub fn set_acceleration(&self) -> f64 {
        self.values.set_acceleration
    }

    /// Cycle time (`fTaskCycle`), s.
    #[must_use]
    pub fn cycle(&self) -> f64 {
        self.values.task_cycle
    }

    /// The block that moves the axis (`iOwner`), 0 for none.
    #[must_use]
    pub fn owner(&self) -> i64 {
        self.values.owner
    }

    /// Actual position (`MC_ReadActualPosition`), u; of a rotary axis in [0, period).
    #[doc(alias = "MC_ReadActualPosition")]
    #[must_use]
    pub fn act_position(&self) -> f64 {
        self.values.act_position
    }

    /// Actual velocity (`MC_ReadActualVelocity`), u/s.
    #[doc(alias = "MC_ReadActualVelocity")]
    #[must_use]
    pub fn act_velocity(&self) -> f64 {
        self.values.act_velocity
    }
}
