//! A ramp moment by moment, for pictures.

use super::course::{Pull, Way};
use super::problem::{Problem, values};
use super::wish::{RampError, RampIn, RampWish};
use crate::polynomial::value;
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
    /// What the ramp does, stretch by stretch; its acceleration may step between two of them.
    pub stretches: Vec<Vec<RampMoment>>,
}

/// Moments of each stretch of a ramp, and of a part of a sine.
const MOMENTS: u16 = 60;
const SHORT: u16 = 6;

/// Shows the ramp of a wish that has these values.
///
/// # Errors
/// [`RampError`] if the coupling does not start with them.
pub fn ramp_shown(wish: &RampWish, ramp: &RampIn) -> Result<RampShown, RampError> {
    let problem = Problem::new(wish)?;
    let Way { mut velocity, pieces } = problem.way(values(ramp))?;
    let place = problem.place;
    let from = problem.cam_at(place);
    let (mut time_s, mut gone) = (0.0, 0.0);
    let mut stretches = Vec::new();
    for [duration, acceleration, jerk, angular] in pieces {
        if duration <= 0.0 {
            continue;
        }
        let pull = Pull { acceleration, jerk, angular };
        let [way, v, a, _] = pull.motion(velocity, duration, 1.0);
        let of_ramp = |time: f64| [&way, &v, &a].map(|polynomial| value(polynomial, time));
        // A sine has many short stretches.
        let moments = if angular > 0.0 { SHORT } else { MOMENTS };
        let moment = |index: u16| {
            let since = duration * f64::from(index) / f64::from(moments);
            let cam = problem.cam_at(place + problem.speed() * (time_s + since));
            let [way, v, a] = of_ramp(since);
            let slave = State {
                position: wish.slave.position + cam.position - from.position + gone + way,
                velocity: cam.velocity + v,
                acceleration: cam.acceleration + a,
            };
            RampMoment { time_s: time_s + since, cam, slave }
        };
        stretches.push((0..=moments).map(moment).collect::<Vec<_>>());
        gone += of_ramp(duration)[0];
        velocity += pull.later(duration).1;
        time_s += duration;
    }
    // The cam of the turn on which the slave comes onto it.
    let left = stretches.last().and_then(|stretch| stretch.last());
    let turned = left.map_or(0.0, |last| last.slave.position - last.cam.position);
    for moment in stretches.iter_mut().flatten() {
        moment.cam.position += turned;
    }
    Ok(RampShown { duration_s: time_s, stretches })
}

/// Where the cam of a wish has the slave at a time after the start, turns of a rotary slave aside.
///
/// # Errors
/// [`RampError`] if the coupling does not start.
pub fn on_cam(wish: &RampWish, time_s: f64) -> Result<State, RampError> {
    let problem = Problem::new(wish)?;
    Ok(problem.cam_at(problem.place + problem.speed() * time_s))
}

impl Problem<'_> {
    /// Where the cam has the slave with the master here, on its scale.
    pub(super) fn cam_at(&self, place: f64) -> State {
        let RampWish { table, input, slave, .. } = self.wish;
        let at = if table.periodic { self.curve().repeated(place) } else { self.curve().at(place) };
        let (factor, speed) = (input.slave_scaling, self.speed());
        let shift = if table.slave_absolute { 0.0 } else { slave.position };
        State {
            position: at.position * factor + input.slave_offset + shift,
            velocity: at.velocity * speed * factor,
            acceleration: at.acceleration * speed * speed * factor,
        }
    }
}
