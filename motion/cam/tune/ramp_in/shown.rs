//! A ramp moment by moment, for pictures.

use super::problem::Problem;
use super::wish::{RampError, RampIn, RampWish};
use twin_profile::State;

/// A moment of a start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RampMoment {
    /// s after the start.
    pub time_s: f64,
    /// Where the cam has the slave; of a rotary one on the turn on which it comes onto its cam.
    pub cam: State,
    /// What the slave does: ramp and cam together.
    pub slave: State,
}

/// A start from its begin until the slave is on its cam.
#[derive(Clone, Debug, PartialEq)]
pub struct RampShown {
    /// When the slave is on its cam, s after the start.
    pub duration_s: f64,
    /// What the ramp does.
    pub moments: Vec<RampMoment>,
}

/// Moments of a picture.
const MOMENTS: u32 = 500;

/// Shows the ramp of a wish that has these values.
///
/// # Errors
/// [`RampError`] if the coupling does not start with them.
pub fn ramp_shown(wish: &RampWish, ramp: &RampIn) -> Result<RampShown, RampError> {
    let RampIn { velocity_difference, acceleration, deceleration, ramp_jerk, .. } = *ramp;
    let values = [velocity_difference, acceleration, deceleration, ramp_jerk];
    let problem = Problem::new(wish)?;
    let (duration_s, moments) = problem.moments(values, MOMENTS)?;
    let moments = moments.map(|(time_s, cam, slave)| RampMoment { time_s, cam, slave });
    Ok(RampShown { duration_s, moments: moments.collect() })
}

/// State of the slave on the cam of a wish at a time after the start, turns of a rotary slave aside.
///
/// # Errors
/// [`RampError`] if the coupling does not start.
pub fn on_cam(wish: &RampWish, time_s: f64) -> Result<State, RampError> {
    Ok(Problem::new(wish)?.cam_at(time_s))
}
