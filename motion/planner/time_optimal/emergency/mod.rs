//! Emergency stop: every axis brakes to rest as fast as its own limits allow, off the path.
//!
//! With an acceleration limit A alone the axis brakes with A, for |v|/A. With a jerk limit J the acceleration first
//! changes to the braking side, is held there, and is released so that acceleration and velocity become 0 together:
//!
//! ```text
//! a  a₀                          v + a·|a|/2J is the velocity that is left if a is released at once;
//!      ╲           ─ t           where it is above 0 the axis brakes downwards, else everything is mirrored.
//!  0 ───╲─────────╱──            x² = J·v₀ + a₀²/2 is the square of the lowest acceleration reached …
//! −x     ╲_______╱               … if that is within A; else A is held for (v₁ − A²/2J)/A, where v₁ is the
//!                                velocity when it is reached.
//! ```
//!
//! An axis that already brakes too hard to stop at zero velocity passes it and comes back. An axis that starts beyond A
//! returns to A with the jerk J.

#[cfg(test)]
mod tests;

use twin_kinematics::{AxisMotion, AxisVector, MAX_AXES};

/// Braking limits of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopLimits {
    /// Largest acceleration, m/s² or rad/s².
    pub acceleration: f64,
    /// Largest jerk, m/s³ or rad/s³; `None`: the acceleration may jump.
    pub jerk: Option<f64>,
}

/// Reason why a stop cannot be planned.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StopError {
    /// A limit is not a finite number above 0.
    #[error(
        "axis {axis} cannot be braked: its acceleration and its jerk must be finite and above 0"
    )]
    Limits {
        /// The axis.
        axis: usize,
        /// Its acceleration limit.
        acceleration: f64,
        /// Its jerk limit.
        jerk: Option<f64>,
    },
    /// Position, velocity or acceleration is infinite or no number.
    #[error("axis {axis} moves in a way no numbers say")]
    Motion {
        /// The axis.
        axis: usize,
    },
    /// Motion and limits are not of the same number of axes.
    #[error("the motion has {motion} axes, the limits have {limits}")]
    AxisCount {
        /// Axes of the motion.
        motion: usize,
        /// Axes with limits.
        limits: usize,
    },
}

/// Constant jerk for some time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Phase {
    /// s.
    duration: f64,
    jerk: f64,
    position: f64,
    velocity: f64,
    acceleration: f64,
}

impl Phase {
    /// Position, velocity and acceleration `t` s after its beginning.
    fn at(&self, t: f64) -> [f64; 3] {
        let Self { jerk, position, velocity, acceleration, .. } = *self;
        [
            position + t * (velocity + t * (0.5 * acceleration + t * jerk / 6.0)),
            velocity + t * (acceleration + 0.5 * t * jerk),
            acceleration + t * jerk,
        ]
    }
}

/// Stop of one axis, in the shortest time that its limits allow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisStop {
    start: f64,
    end: f64,
    duration: f64,
    phases: [Phase; 3],
}

impl AxisStop {
    /// From `position`, `velocity` and `acceleration` (m or rad and their derivatives). Without a jerk limit the present
    /// acceleration does not matter; with one it may be beyond its limit.
    ///
    /// # Errors
    /// [`StopError`], with 0 for the axis.
    pub fn new(
        position: f64,
        velocity: f64,
        acceleration: f64,
        limits: &StopLimits,
    ) -> Result<Self, StopError> {
        let usable = |limit: f64| limit.is_finite() && limit > 0.0;
        let StopLimits { acceleration: most, jerk } = *limits;
        if !usable(most) || jerk.is_some_and(|jerk| !usable(jerk)) {
            return Err(StopError::Limits { axis: 0, acceleration: most, jerk });
        }
        if ![position, velocity, acceleration].into_iter().all(f64::is_finite) {
            return Err(StopError::Motion { axis: 0 });
        }
        let stop = match jerk {
            None => Self::braked(position, velocity, most),
            Some(jerk) => Self::eased(position, [velocity, acceleration], most, jerk),
        };
        // A jerk next to nothing takes longer than numbers go.
        let finite = stop.duration.is_finite() && stop.end.is_finite();
        if finite { Ok(stop) } else { Err(StopError::Motion { axis: 0 }) }
    }

    /// With an acceleration that may jump.
    fn braked(position: f64, velocity: f64, most: f64) -> Self {
        let acceleration = -most.copysign(velocity);
        let phase =
            Phase { duration: velocity.abs() / most, jerk: 0.0, position, velocity, acceleration };
        let end = position + 0.5 * velocity * phase.duration;
        Self {
            start: position,
            end,
            duration: phase.duration,
            phases: [phase, Phase::default(), Phase::default()],
        }
    }

    /// With limited jerk.
    fn eased(start: f64, [velocity, acceleration]: [f64; 2], most: f64, jerk: f64) -> Self {
        let left = velocity + acceleration * acceleration.abs() / (2.0 * jerk);
        let side = if left < 0.0 { -1.0 } else { 1.0 };
        // From here on it brakes downwards.
        let (v0, a0) = (side * velocity, side * acceleration);
        let lowest_squared = jerk * v0 + 0.5 * a0 * a0;
        let (to, hold) = if lowest_squared <= most * most {
            // Rounding must not raise it above where it starts from.
            (-lowest_squared.max(0.0).sqrt().max(-a0), 0.0)
        } else {
            let gained = 0.5 * (a0 * a0 - most * most) / jerk;
            let v1 = if a0 < -most { v0 - gained } else { v0 + gained };
            (-most, ((v1 - 0.5 * most * most / jerk) / most).max(0.0))
        };
        let slopes = [if a0 < to { jerk } else { -jerk }, 0.0, jerk];
        let durations = [(a0 - to).abs() / jerk, hold, -to / jerk];
        let mut phases = [Phase::default(); 3];
        let mut state = [start, velocity, acceleration];
        for (phase, (duration, slope)) in phases.iter_mut().zip(durations.into_iter().zip(slopes)) {
            let [position, velocity, acceleration] = state;
            *phase = Phase { duration, jerk: side * slope, position, velocity, acceleration };
            state = phase.at(duration);
        }
        let [end, ..] = state;
        Self { start, end, duration: durations.into_iter().sum(), phases }
    }

    /// Until it rests, s.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// From where it starts to where it rests, m or rad.
    pub fn distance(&self) -> f64 {
        self.end - self.start
    }

    /// Position, velocity and acceleration `time` s after its beginning: the start before, at rest from the end on.
    pub fn at(&self, time: f64) -> (f64, f64, f64) {
        if time >= self.duration {
            return (self.end, 0.0, 0.0);
        }
        let time = time.max(0.0);
        let [first, second, third] = &self.phases;
        let later = time - first.duration;
        let (phase, time) = if later < 0.0 {
            (first, time)
        } else if later < second.duration {
            (second, later)
        } else {
            (third, (later - second.duration).min(third.duration))
        };
        let [position, velocity, acceleration] = phase.at(time);
        (position, velocity, acceleration)
    }
}

/// Emergency stop: all axes of a machine come to rest, each for itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmergencyStop {
    stops: [Option<AxisStop>; MAX_AXES],
    axes: usize,
}

impl EmergencyStop {
    /// From `motion`, with the limits of every axis.
    ///
    /// # Errors
    /// [`StopError`].
    pub fn new(motion: &AxisMotion, limits: &[StopLimits]) -> Result<Self, StopError> {
        let AxisMotion { position, velocity, acceleration } = motion;
        let axes = position.len();
        let shortest = velocity.len().min(acceleration.len());
        if limits.len() != axes || shortest != axes {
            return Err(StopError::AxisCount { motion: shortest.min(axes), limits: limits.len() });
        }
        let mut stops = [None; MAX_AXES];
        let values = position.iter().zip(velocity.iter()).zip(acceleration.iter());
        let values = values.zip(limits).zip(&mut stops).enumerate();
        for (axis, ((((position, velocity), acceleration), limits), slot)) in values {
            let stop = AxisStop::new(*position, *velocity, *acceleration, limits);
            *slot = Some(stop.map_err(|error| match error {
                StopError::Limits { acceleration, jerk, .. } => {
                    StopError::Limits { axis, acceleration, jerk }
                }
                StopError::Motion { .. } => StopError::Motion { axis },
                other @ StopError::AxisCount { .. } => other,
            })?);
        }
        Ok(Self { stops, axes })
    }

    /// Every axis, in order.
    pub fn axes(&self) -> impl Iterator<Item = &AxisStop> {
        self.stops.iter().take(self.axes).flatten()
    }

    /// Until all axes rest, s.
    pub fn duration(&self) -> f64 {
        self.axes().map(AxisStop::duration).fold(0.0, f64::max)
    }

    /// From where each axis starts to where it rests, m or rad.
    pub fn distance(&self) -> AxisVector {
        AxisVector::from_values(self.axes().map(AxisStop::distance))
    }

    /// The axes `time` s after the beginning of the stop.
    pub fn at(&self, time: f64) -> AxisMotion {
        let part = |part: fn((f64, f64, f64)) -> f64| {
            AxisVector::from_values(self.axes().map(|stop| part(stop.at(time))))
        };
        AxisMotion {
            position: part(|(position, ..)| position),
            velocity: part(|(_, velocity, _)| velocity),
            acceleration: part(|(.., acceleration)| acceleration),
        }
    }
}
