//! Inputs of the interpolator, read once per cycle: override, velocity mode, stops.

use super::IpoError;

/// The inputs of `SMC_Interpolator` (manual 6.2.9), read once per cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "each is an input of its own in the manual")]
pub struct Inputs {
    /// `bSlow_Stop`: brakes with the profile and the programmed deceleration, and waits until it falls. A stop once
    /// begun comes to rest even if the input falls before.
    pub slow_stop: bool,
    /// `bEmergency_Stop`: the velocity is 0 at once, the position held; afterwards the path goes on from rest.
    pub emergency_stop: bool,
    /// `bWaitAtNextStop`: waits at the next element end where the path is at rest anyway.
    pub wait_at_next_stop: bool,
    /// `dOverride`. Taken over outside of ramps.
    pub override_factor: Override,
    /// `iVelMode`. Taken over outside of ramps; [`VelocityMode::JerkLimited`], which brakes over a longer way, at
    /// rest.
    pub mode: VelocityMode,
    /// `bAbort`: the path ends where it is, at once. For a gentle end there is [`super::Interpolator::request_stop`].
    pub abort: bool,
    /// `bSingleStep`: rests for a cycle at the end of every element; the first of them is the first that can be
    /// stopped at with the programmed deceleration.
    pub single_step: bool,
    /// `bAcknM`: an M function that was shown for at least a cycle is done. True if nothing else is said, so that
    /// every M function takes one cycle.
    pub acknowledge_m: bool,
}

impl Default for Inputs {
    fn default() -> Self {
        Self {
            slow_stop: false,
            emergency_stop: false,
            wait_at_next_stop: false,
            override_factor: Override::default(),
            mode: VelocityMode::default(),
            abort: false,
            single_step: false,
            acknowledge_m: true,
        }
    }
}

/// Factor on all programmed velocities (`dOverride`): at least 0.01.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Override(f64);

impl Override {
    /// The smallest factor (manual 6.2.9).
    pub const LEAST: f64 = 0.01;

    /// A factor of at least [`Self::LEAST`].
    ///
    /// # Errors
    /// [`IpoError::VelocityZero`] (`SMC_INT_VEL_ZERO`) if it is less or no finite number.
    pub fn new(factor: f64) -> Result<Self, IpoError> {
        if factor >= Self::LEAST && factor.is_finite() {
            Ok(Self(factor))
        } else {
            Err(IpoError::VelocityZero { factor })
        }
    }

    /// The factor.
    pub fn factor(self) -> f64 {
        self.0
    }
}

impl Default for Override {
    /// As programmed.
    fn default() -> Self {
        Self(1.0)
    }
}

/// Velocity mode, the shape of velocity changes: `SMC_INT_VELMODE`, and one more.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum VelocityMode {
    /// `TRAPEZOID` (0): with constant acceleration.
    #[default]
    Trapezoid,
    /// `SIGMOID` (1): v0 + Δv·sin²(πt/2T), as long as the trapezoid's ramp, with π/2 times its acceleration at most.
    Sigmoid,
    /// Beyond the manual: the acceleration is continuous, it changes by at most `jerk` m/s³ and never exceeds the
    /// programmed one. Takes longer than the other two. A jerk that is not positive counts as none given.
    JerkLimited {
        /// Largest change of the acceleration along the path, m/s³.
        jerk: f64,
    },
}
