//! Time integration over one short step: joints by the equation of motion, together with rotors behind elastic
//! transmissions.
//!
//! The method is classical Runge–Kutta of fourth order. Motors, springs and friction are part of the right-hand side.
//! The laws change where something stops or breaks away, or where teeth meet. A step therefore ends there (`stop`), and
//! another one takes the rest of the time. Friction opposes a part as long as it moves; `dry_friction` decides whether a part
//! at rest is held or breaks away. Every step thus covers smooth motion only. Its error is of fifth order, wherever it
//! begins.

use twin_kinematics::MAX_AXES;

use crate::equation::Equation;
use crate::joint::JointVector;
use crate::state::{MachineState, Motors, Stage, Train};
use crate::step::{Springs, Step};

/// Largest number of stops in one step; further ones are ignored.
const MOST_STOPS: usize = 16;

/// The state after `dt` (s) with `motors` at work and a `disturbance` of the axes, and the mean efforts of the motors on the way; `None` if some axis moves no inertia, or where the
/// machine cannot be.
pub(super) fn advance(
    equation: &mut Equation,
    trains: &[Train; MAX_AXES],
    state: &MachineState,
    (motors, disturbance): (&(impl Motors + ?Sized), &JointVector),
    dt: f64,
) -> Option<(MachineState, JointVector)> {
    let axes = equation.axis_count();
    let springs = Springs::of(trains.get(..axes).unwrap_or(trains));
    let is_dry = |train: &Train| {
        train.friction.is_dry() || train.elastic.is_some_and(|elastic| elastic.friction.is_dry())
    };
    let dry = trains.iter().any(is_dry);
    let mut step = Step { equation, trains, motors, disturbance, axes, springs, dry, dt };
    let (mut state, mut from) = (*state, 0.0);
    let mut effort = JointVector::zeros();
    for stops in 0..=MOST_STOPS {
        let settled = step.settle(&mut state, Stage::new(from))?;
        let mut until = 1.0;
        let mut arrival = step.take(&state, &settled, from, until)?;
        if stops < MOST_STOPS {
            until = step.stop(&state, &settled, &mut arrival, from)?;
        }
        effort += arrival.effort * (until - from);
        (state, from) = (arrival.state, until);
        if from >= 1.0 {
            break;
        }
    }
    if springs == Springs::None {
        state.motors = state.axes;
    }
    Some((state, effort))
}
