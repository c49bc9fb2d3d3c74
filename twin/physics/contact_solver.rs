//! Contact solver: forces that push and never pull, computed in joint space.
//!
//! Each contact point i has a gap gᵢ and a row Jᵢ, the change of the gap with the axes. It pushes with fᵢ =
//! k·max(0, −gᵢ) of the gap at the end of the step (implicit Euler), so stiff contacts come to rest instead of
//! ringing. The velocities v at the end of a step of T are the minimum of
//!
//! ```text
//! ½·(v − v₁)ᵀ·M·(v − v₁) + ½·k·Σ max(0, −sᵢ(v))²        sᵢ(v) = gᵢ + T·Jᵢ·(v − v₁)
//! ```
//!
//! gᵢ and v₁ are gap and velocities at the end of the step without contact. The function is convex, smooth and
//! piecewise quadratic, so Newton's method with an exact line search ends after a few steps (E. Todorov, "Convex
//! and analytically-invertible dynamics with contacts and constraints", ICRA 2014). Contacts have no friction: the
//! normal force is enough to report a crash or a probe.

use crate::joint::{JointMatrix, JointVector};

/// Newton steps; each changes which points push, and there are few.
const MOST_STEPS: usize = 60;

/// Halvings of a line search.
const HALVINGS: usize = 60;

/// A point of contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Change of its gap with the axes, m per m or rad.
    pub(super) opening: JointVector,
    /// Gap at the end of the step without contact, m; below 0: penetration depth.
    pub(super) gap: f64,
}

/// A step without contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct FreeStep<'a> {
    /// M at its beginning.
    pub(super) inertia: &'a JointMatrix,
    /// Velocities at its end.
    pub(super) velocity: &'a JointVector,
    /// s.
    pub(super) dt: f64,
}

/// Result of a contact step.
#[derive(Clone, Debug)]
pub(super) struct ContactSolution {
    /// Velocities at the end of the step.
    pub(super) velocity: JointVector,
    /// Force at each point, N.
    pub(super) forces: Vec<f64>,
}

/// The end of a step in which points of `rows` may touch with `stiffness` (N/m) each; `None` if some axis moves no inertia.
pub(super) fn solve(step: &FreeStep<'_>, rows: &[Row], stiffness: f64) -> Option<ContactSolution> {
    let FreeStep { inertia, velocity: free, dt } = *step;
    let gap =
        |row: &Row, velocity: &JointVector| row.gap + dt * row.opening.dot(&(velocity - free));
    let gradient = |velocity: &JointVector| {
        let mut gradient = inertia * (velocity - free);
        for row in rows {
            let depth = (-gap(row, velocity)).max(0.0);
            gradient -= row.opening * (stiffness * depth * dt);
        }
        gradient
    };
    let mut velocity = *free;
    for _ in 0..MOST_STEPS {
        let slope = gradient(&velocity);
        let mut curvature = *inertia;
        for row in rows.iter().filter(|row| gap(row, &velocity) < 0.0) {
            curvature.ger(stiffness * dt * dt, &row.opening, &row.opening, 1.0);
        }
        let direction = -curvature.cholesky()?.solve(&slope);
        let next = velocity + direction;
        let same = |row: &Row| (gap(row, &next) < 0.0) == (gap(row, &velocity) < 0.0);
        if rows.iter().all(same) {
            velocity = next;
            break;
        }
        // The parabola ends on the way: to the least along it.
        let climbs = |part: f64| gradient(&(velocity + direction * part)).dot(&direction) > 0.0;
        let (mut low, mut high) = (0.0, 1.0);
        if climbs(high) {
            for _ in 0..HALVINGS {
                let middle = f64::midpoint(low, high);
                if climbs(middle) { high = middle } else { low = middle }
            }
        } else {
            low = high;
        }
        velocity += direction * low;
        if low <= 0.0 {
            break;
        }
    }
    let forces = rows.iter().map(|row| stiffness * (-gap(row, &velocity)).max(0.0)).collect();
    Some(ContactSolution { velocity, forces })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const DT: f64 = 1e-3;

    fn vector<const N: usize>(values: [f64; N]) -> JointVector {
        crate::joint::joint_vector(values.into_iter())
    }

    /// M of three axes, and 1 beyond.
    fn inertia(entries: [f64; 6]) -> JointMatrix {
        let [a, b, c, d, e, f] = entries;
        let root = nalgebra::Matrix3::new(a, 0.0, 0.0, b, c, 0.0, d, e, f);
        let mut result = JointMatrix::identity();
        result.fixed_view_mut::<3, 3>(0, 0).copy_from(&(root * root.transpose()));
        result
    }

    /// One point on one axis: M·(v − v₁) = k·T·d and d = −g − T·(v − v₁).
    #[test]
    fn one_point_has_a_closed_form() {
        let mass = JointMatrix::identity() * 4.0;
        let (stiffness, free) = (1e6, vector([-0.5]));
        let row = Row { opening: vector([1.0]), gap: -2e-4 };
        let step = FreeStep { inertia: &mass, velocity: &free, dt: DT };
        let touched = solve(&step, &[row], stiffness).unwrap();
        let force = stiffness * 2e-4 / (1.0 + stiffness * DT * DT / 4.0);
        assert!((touched.forces[0] - force).abs() < 1e-9 * force, "{touched:?}");
        assert!((touched.velocity[0] - (-0.5 + force * DT / 4.0)).abs() < 1e-12, "{touched:?}");
    }

    proptest! {
        /// At the minimum momentum changes by what the points push, nothing pulls, and every point pushes by its depth.
        #[test]
        fn what_comes_out_is_in_balance(
            root in prop::array::uniform6(0.3..3.0_f64),
            free in prop::array::uniform3(-2.0..2.0_f64),
            rows in prop::collection::vec(
                (prop::array::uniform3(-1.0..1.0_f64), -3e-3..2e-3_f64), 1..12,
            ),
            stiffness in 4.0..9.0_f64,
        ) {
            let (inertia, stiffness) = (inertia(root), 10_f64.powf(stiffness));
            let free = vector(free);
            let rows: Vec<_> = rows
                .into_iter()
                .map(|(opening, gap)| Row { opening: vector(opening), gap })
                .collect();
            let step = FreeStep { inertia: &inertia, velocity: &free, dt: DT };
            let touched = solve(&step, &rows, stiffness).unwrap();
            let mut push = JointVector::zeros();
            for (row, force) in rows.iter().zip(&touched.forces) {
                push += row.opening * *force * DT;
                let end = row.gap + DT * row.opening.dot(&(touched.velocity - free));
                let wanted = stiffness * (-end).max(0.0);
                prop_assert!(*force >= 0.0 && (force - wanted).abs() <= 1e-9 * (1.0 + wanted));
            }
            let momentum = inertia * (touched.velocity - free);
            prop_assert!((momentum - push).amax() < 1e-7 * (1.0 + push.amax()), "{touched:?}");
        }
    }
}
