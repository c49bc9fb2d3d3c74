//! Homing by a switch for drives that have no homing of their own: `SMC_Homing` (2.2.7).
//!
//! [`Homing`] is the sequence, which says what to do for what it is shown; [`home_by_switch`] carries it out with a
//! device. The manual names the six modes and does not number them; 0 to 2 and 4 to 6 are from the vendor's later
//! documentation, and so is that the second three, of which this edition repeats the names of the first, are
//! `FAST_SLOW_*`.
//!
//! Where the manual is silent: an axis that is on its switch already begins with the slow part; one that has been
//! carried past its switch comes back over it, and in the modes without reversal has failed; every search ends after a
//! way that the user gives.

mod execute;
mod fault;
mod history;
mod legs;
mod sequence;
#[cfg(test)]
mod tests;

pub use execute::{HomingError, HomingReport, HomingRun, Switch, home_by_switch};
pub use fault::HomingFault;
pub use history::History;
pub use sequence::{Homing, Order, Seen};

/// `nDirection`: the direction in which the switch is sought.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// 1.
    #[default]
    Positive,
    /// −1.
    Negative,
}

impl Direction {
    fn sign(self) -> f64 {
        match self {
            Self::Positive => 1.0,
            Self::Negative => -1.0,
        }
    }
}

/// `SMC_HOMING_MODE`.
#[doc(alias = "SMC_HOMING_MODE")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HomingMode {
    /// 0, `FAST_BSLOW_S_STOP`: fast onto the switch, slowly back off it; where it opens is the reference; stop.
    #[default]
    FastBslowSStop = 0,
    /// 1, `FAST_BSLOW_STOP_S`: as 0, but where the axis then rests is the reference.
    FastBslowStopS = 1,
    /// 2, `FAST_BSLOW_I_S_STOP`: as 0, but the next index pulse is the reference.
    FastBslowISStop = 2,
    /// 4, `FAST_SLOW_S_STOP`: as 0, but slowly on over the switch.
    FastSlowSStop = 4,
    /// 5, `FAST_SLOW_STOP_S`: as 1, but slowly on over the switch.
    FastSlowStopS = 5,
    /// 6, `FAST_SLOW_I_S_STOP`: as 2, but slowly on over the switch.
    FastSlowISStop = 6,
}

impl HomingMode {
    /// All, in the order of their numbers.
    pub const ALL: [Self; 6] = [
        Self::FastBslowSStop,
        Self::FastBslowStopS,
        Self::FastBslowISStop,
        Self::FastSlowSStop,
        Self::FastSlowStopS,
        Self::FastSlowISStop,
    ];

    /// Its number.
    pub fn number(self) -> u8 {
        self as u8
    }

    /// The mode of a number.
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| mode.number() == number)
    }

    /// Whether the axis goes back off its switch.
    fn reverses(self) -> bool {
        matches!(self, Self::FastBslowSStop | Self::FastBslowStopS | Self::FastBslowISStop)
    }

    /// Whether an index pulse is the reference.
    fn by_index(self) -> bool {
        matches!(self, Self::FastBslowISStop | Self::FastSlowISStop)
    }

    /// Whether the reference is where the axis is at the end.
    fn at_rest(self) -> bool {
        matches!(self, Self::FastBslowStopS | Self::FastSlowStopS)
    }
}

/// Inputs of `SMC_Homing`. Positions and velocities are in any unit, the same for all; [`home_by_switch`] takes
/// increments.
#[doc(alias = "SMC_Homing")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomingOptions {
    /// `fHomePosition`: position of the reference, u.
    pub home_position: f64,
    /// `fVelocitySlow`, u/s.
    pub velocity_slow: f64,
    /// `fVelocityFast`, u/s.
    pub velocity_fast: f64,
    /// `fAcceleration`, u/s². Devices accelerate by their own options; it must be above 0.
    pub acceleration: f64,
    /// `fDeceleration`, u/s². Devices brake by their own options; it must be above 0.
    pub deceleration: f64,
    /// `nDirection`, in which the switch is sought.
    pub direction: Direction,
    /// `nHomingMode`.
    pub mode: HomingMode,
    /// `fSignalDelay`, s: the switch says now what was so long ago.
    pub signal_delay: f64,
    /// `bReturnToZero`: goes to position 0 at the end, fast.
    pub return_to_zero: bool,
    /// `bIgnoreHWLimit`: limit switches do not end homing, so that one of them can be the home switch.
    pub ignore_hardware_limit: bool,
    /// Longest way of the axis to its switch, u.
    pub max_fast_way: f64,
    /// Longest slow way until the switch has opened and the index has come, u.
    pub max_slow_way: f64,
}

impl HomingOptions {
    /// The manual's defaults (negative direction, mode 0, no delay, limit switches watched), position 0, and ten times the
    /// slow velocity for the fast one.
    pub fn new(
        velocity_slow: f64,
        acceleration: f64,
        max_fast_way: f64,
        max_slow_way: f64,
    ) -> Self {
        Self {
            home_position: 0.0,
            velocity_slow,
            velocity_fast: 10.0 * velocity_slow,
            acceleration,
            deceleration: acceleration,
            direction: Direction::Negative,
            mode: HomingMode::default(),
            signal_delay: 0.0,
            return_to_zero: false,
            ignore_hardware_limit: false,
            max_fast_way,
            max_slow_way,
        }
    }

    /// Checks what cannot be done.
    ///
    /// # Errors
    /// [`HomingFault::Value`] (50) for velocities, accelerations and ways that are not above 0, a delay below 0 and
    /// a home position that is not a number; [`HomingFault::NeedsHardwareLimit`] (51).
    pub fn check(&self) -> Result<(), HomingFault> {
        let above = [
            ("fVelocitySlow", self.velocity_slow),
            ("fVelocityFast", self.velocity_fast),
            ("fAcceleration", self.acceleration),
            ("fDeceleration", self.deceleration),
            ("the fast way", self.max_fast_way),
            ("the slow way", self.max_slow_way),
        ];
        let bad = above.into_iter().find(|(_, value)| !value.is_finite() || *value <= 0.0);
        let delay = ("fSignalDelay", self.signal_delay);
        let bad = bad.or((!delay.1.is_finite() || delay.1 < 0.0).then_some(delay));
        let home = ("fHomePosition", self.home_position);
        let bad = bad.or((!home.1.is_finite()).then_some(home));
        match bad {
            Some((what, value)) => Err(HomingFault::Value { what, value }),
            None if !self.mode.reverses() && self.ignore_hardware_limit => {
                Err(HomingFault::NeedsHardwareLimit)
            }
            None => Ok(()),
        }
    }

    /// Largest distance of the reference from the opening point of the switch, u, if the longest time from one look at the switch to the
    /// next is `looks_s`: what the axis goes slowly in that time, and in half of it, as neither switch nor position are
    /// known to be of the middle of their exchanges. A signal delay of half that time makes the mean error 0.
    pub fn uncertainty(&self, looks_s: f64) -> f64 {
        1.5 * self.velocity_slow * looks_s
    }

    /// Longest leg of [`home_by_switch`], u: the axis goes no farther when nobody looks any more.
    pub fn longest_leg(&self) -> f64 {
        legs::leg(self.velocity_fast.max(self.velocity_slow))
    }

    /// Longest ways of the axis in its direction and against it from its start, u, before it returns to zero:
    /// a drive is sent no further, so that it stops there if the switch never comes.
    pub fn longest_ways(&self) -> (f64, f64) {
        if self.mode.reverses() {
            (self.max_fast_way, self.max_slow_way)
        } else {
            (self.max_fast_way + self.max_slow_way, 0.0)
        }
    }
}
