//! Joint motion over one control period, the motor efforts held.
//!
//! Classical Runge–Kutta of fourth order on [`Equation`]. Viscous friction is part of the right-hand side. Dry
//! (Coulomb) friction has a jump where an axis stops, so its force is settled before the step, as Moreau and
//! Stewart–Trinkle do: of all forces within ±c, those that stop as much motion as they can by the end of the
//! step (projected Gauss–Seidel on the velocities an explicit step predicts). An axis that slides gets exactly ±c,
//! one that stands still gets what holds it and does not creep.

use super::dynamics::{JointVector, at};
use super::equation::Equation;

/// Positions and velocities of all axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct JointState {
    pub(super) position: JointVector,
    pub(super) velocity: JointVector,
}

impl JointState {
    pub(super) fn is_finite(&self) -> bool {
        self.position.iter().chain(self.velocity.iter()).all(|value| value.is_finite())
    }
}

/// Friction of all axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Friction {
    /// N or Nm.
    pub(super) coulomb: JointVector,
    /// N·s/m or Nm·s/rad.
    pub(super) viscous: JointVector,
}

/// Sweeps of the friction solver; it converges in one or two unless several axes stick against each other.
const MAX_FRICTION_SWEEPS: usize = 100;

/// The state after `dt` (s) with the motor efforts `effort` held; `None` if some axis
/// moves no inertia, or where the machine cannot be.
pub(super) fn advance(
    equation: &mut Equation,
    state: &JointState,
    effort: &JointVector,
    friction: &Friction,
    dt: f64,
) -> Option<JointState> {
    let effort = effort + dry_friction(equation, state, effort, friction, dt)?;
    let mut slope = |position: JointVector, velocity: JointVector| {
        let moving = effort - friction.viscous.component_mul(&velocity);
        Some((velocity, equation.acceleration(&position, &velocity, &moving)?))
    };
    let JointState { position, velocity } = *state;
    let half = 0.5 * dt;
    let (v1, a1) = slope(position, velocity)?;
    let (v2, a2) = slope(position + v1 * half, velocity + a1 * half)?;
    let (v3, a3) = slope(position + v2 * half, velocity + a2 * half)?;
    let (v4, a4) = slope(position + v3 * dt, velocity + a3 * dt)?;
    Some(JointState {
        position: position + (v1 + (v2 + v3) * 2.0 + v4) * (dt / 6.0),
        velocity: velocity + (a1 + (a2 + a3) * 2.0 + a4) * (dt / 6.0),
    })
}

/// The dry friction forces over the next `dt`.
fn dry_friction(
    equation: &mut Equation,
    state: &JointState,
    effort: &JointVector,
    friction: &Friction,
    dt: f64,
) -> Option<JointVector> {
    let mut force = JointVector::zeros();
    if friction.coulomb.amax() <= 0.0 {
        return Some(force);
    }
    let moving = effort - friction.viscous.component_mul(&state.velocity);
    let mut velocity =
        state.velocity + equation.acceleration(&state.position, &state.velocity, &moving)? * dt;
    let mobility = equation.mobility(&state.position)? * dt;
    let diagonal = mobility.diagonal();
    for _ in 0..MAX_FRICTION_SWEEPS {
        let mut change = 0.0_f64;
        let axes = mobility
            .column_iter()
            .zip(diagonal.iter())
            .zip(force.iter_mut().zip(friction.coulomb.iter()));
        for (axis, ((column, mobility), (force, limit))) in
            axes.enumerate().take(equation.axis_count())
        {
            let wanted = (*force - at(&velocity, axis) / mobility).clamp(-limit, *limit);
            let difference = wanted - *force;
            *force = wanted;
            velocity += column * difference;
            change = change.max(difference.abs());
        }
        if change <= 1e-14 * friction.coulomb.amax() {
            break;
        }
    }
    Some(force)
}
