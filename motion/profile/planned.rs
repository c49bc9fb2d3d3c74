//! [`Profile`]: a motion that is planned to its end.

use super::rates::Rates;
use super::segment::{Segment, Track};
use super::{AxisLimits, ProfileError, RampType, State, parabolic, sigmoid, trapezoid};

/// Motion of an axis over time, from a state at time 0 to an end with constant velocity, and on with that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    track: Track,
    start: State,
    end: State,
}

impl Profile {
    /// The way to `target` u, with `end_velocity` u/s there, in the direction of its sign; it goes on from there.
    ///
    /// Where it has to, the axis first backs up, goes past the target and returns, or brakes to a velocity limit that
    /// it exceeds.
    ///
    /// # Errors
    ///
    /// A [`ProfileError`] for a number that is not finite, a limit that is not positive, an end velocity above the limit, and
    /// for times or ways that are too large for a number.
    pub fn to_position(
        from: State,
        target: f64,
        end_velocity: f64,
        limits: AxisLimits,
        ramp: RampType,
    ) -> Result<Self, ProfileError> {
        check(from, limits, ramp)?;
        finite("target position", target)?;
        end_velocity_within(end_velocity, limits)?;
        let end = State { position: target, velocity: end_velocity, acceleration: 0.0 };
        let mut profile = Self { track: Track::new(from), start: from, end };
        let (track, rates) = (&mut profile.track, &Rates::from(&limits));
        match ramp {
            RampType::Trapezoid => trapezoid::to_position(track, target, end_velocity, limits),
            RampType::Sigmoid => sigmoid::to_position(track, target, end_velocity, rates),
            RampType::Parabolic => parabolic::to_position(track, target, end_velocity, rates),
        }
        profile.check(target)?;
        Ok(profile)
    }

    /// From the state to a constant `velocity` u/s, in the direction of its sign, as fast as the limits allow.
    ///
    /// # Errors
    ///
    /// Like [`Self::to_position`].
    pub fn to_velocity(
        from: State,
        velocity: f64,
        limits: AxisLimits,
        ramp: RampType,
    ) -> Result<Self, ProfileError> {
        check(from, limits, ramp)?;
        end_velocity_within(velocity, limits)?;
        let mut profile = Self { track: Track::new(from), start: from, end: from };
        let (track, rates) = (&mut profile.track, &Rates::from(&limits));
        match ramp {
            RampType::Trapezoid => trapezoid::ramp(track, velocity, limits),
            RampType::Sigmoid => sigmoid::ramp(track, velocity, rates),
            RampType::Parabolic => parabolic::ramp(track, velocity, rates),
        }
        profile.end = State { velocity, acceleration: 0.0, ..track.state };
        profile.check(velocity)?;
        Ok(profile)
    }

    /// From the state to a standstill, as fast as the limits allow.
    ///
    /// # Errors
    ///
    /// Like [`Self::to_position`].
    pub fn halt(from: State, limits: AxisLimits, ramp: RampType) -> Result<Self, ProfileError> {
        Self::to_velocity(from, 0.0, limits, ramp)
    }

    /// Checks that all of it could be computed.
    fn check(&self, target: f64) -> Result<(), ProfileError> {
        if (self.track.duration + self.track.state.position).is_finite() {
            Ok(())
        } else {
            Err(ProfileError::TooLarge { target })
        }
    }

    /// Time from the start to the end, s.
    pub fn duration(&self) -> f64 {
        self.track.duration
    }

    /// State at the start.
    pub fn start(&self) -> State {
        self.start
    }

    /// State at the end, [`Self::duration`] s after the start.
    pub fn end(&self) -> State {
        self.end
    }

    /// Spans of constant jerk of profiles without sigmoid ramps: when each begins, s, the state there and the jerk, u/s³.
    pub fn spans(&self) -> impl Iterator<Item = (f64, State, f64)> {
        let segments = self.track.segments().iter();
        segments.map(|segment| (segment.start, segment.state, segment.jerk))
    }

    /// State `time` s after the start, for times before that the start itself. After the end the motion goes on with
    /// the velocity it has there. Where the acceleration steps, it is that after the step.
    pub fn at(&self, time: f64) -> State {
        let after = time - self.track.duration;
        if after >= 0.0 {
            let position = self.end.position + self.end.velocity * after;
            return State { position, ..self.end };
        }
        let segments = self.track.segments();
        let current = segments.iter().rev().find(|segment| segment.start <= time);
        current
            .or(segments.first())
            .map_or(self.start, |segment: &Segment| segment.after((time - segment.start).max(0.0)))
    }
}

/// Everything that moves is finite, and the limits that count are positive.
fn check(from: State, limits: AxisLimits, ramp: RampType) -> Result<(), ProfileError> {
    all_finite(from)?;
    positive("velocity", limits.velocity)?;
    positive("acceleration", limits.acceleration)?;
    positive("deceleration", limits.deceleration)?;
    if ramp == RampType::Trapezoid { Ok(()) } else { positive("jerk", limits.jerk) }
}

pub(super) fn all_finite(state: State) -> Result<(), ProfileError> {
    finite("position", state.position)?;
    finite("velocity", state.velocity)?;
    finite("acceleration", state.acceleration)?;
    Ok(())
}

pub(super) fn finite(quantity: &'static str, value: f64) -> Result<f64, ProfileError> {
    if value.is_finite() { Ok(value) } else { Err(ProfileError::NotFinite { quantity, value }) }
}

fn positive(quantity: &'static str, value: f64) -> Result<(), ProfileError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(ProfileError::NotPositive { quantity, value })
    }
}

fn end_velocity_within(velocity: f64, limits: AxisLimits) -> Result<(), ProfileError> {
    finite("end velocity", velocity)?;
    let limit = limits.velocity;
    if velocity.abs() > limit {
        return Err(ProfileError::EndVelocity { velocity, limit });
    }
    Ok(())
}
