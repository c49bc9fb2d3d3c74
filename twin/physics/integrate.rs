//! Time integration over one short step: joints by the equation of motion, together with rotors behind elastic
//! transmissions.
//!
//! Classical Runge–Kutta of fourth order over motors, springs and friction. A step ends where a part stops or
//! breaks away, or where teeth meet (`stop`); another takes the rest. `dry_friction` decides whether a part at rest
//! is held. Each step is smooth, with an error of fifth order.

use twin_kinematics::MAX_AXES;

use crate::equation::Equation;
use crate::joint::JointVector;
use crate::state::{MachineState, Motors, Stage, Train};
use crate::step::{Springs, Step};

/// Largest number of stops in one step; further ones are ignored.
const MOST_STOPS: usize = 16;

/// State after `dt` (s) with `motors` and a `disturbance` of the axes, and mean motor efforts; `None` at singular
/// positions, or if an axis moves no inertia.
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
