//! What dry friction does: what moves is opposed, what stands is held or breaks away; and where a step has to end because another law
//! holds from there on: where something stops, or teeth with play between them meet or part.
//!
//! Of all forces within ± the dry friction of axes that stand, those are taken that leave as little motion as they can by the end
//! of the step, as Moreau and Stewart–Trinkle do (projected Gauss–Seidel on the velocities an explicit step predicts). What is left
//! of the motion of something that sticks, because forces have changed on the way, is taken from it at the end: nothing creeps.

use twin_kinematics::MAX_AXES;

use super::dynamics::{JointMatrix, JointVector, at};
use super::friction::{DryFriction, FrictionParameters, REST};
use super::integrate::{Arrival, JointState, MachineState, Motors, Stage, Step, Train};

/// Sweeps of the friction solver; it converges in one or two unless several axes stick against each other.
const MAX_SWEEPS: usize = 100;

/// Teeth as near to where they meet as this are there, m or rad.
const AT_EDGE: f64 = 1e-13;

/// What dry friction does on both sides of the transmissions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dry {
    pub(super) axes: [DryFriction; MAX_AXES],
    pub(super) motors: [DryFriction; MAX_AXES],
}

impl Dry {
    const NONE: Self =
        Self { axes: [DryFriction::None; MAX_AXES], motors: [DryFriction::None; MAX_AXES] };
}

/// The same for a while, and what follows for what stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settled {
    pub(super) dry: Dry,
    /// Accelerations of axes by efforts, where some axis sticks.
    mobility: Option<JointMatrix>,
}

/// Something after which another law holds.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stop {
    /// An axis comes to rest.
    Axis(usize),
    /// So does a motor.
    Motor(usize),
    /// The teeth of a transmission meet, where the motor is so far ahead of the axis (m or rad).
    Teeth(usize, f64),
}

impl Stop {
    /// What is 0 there: a velocity, how far teeth are from each other, or what they push with.
    pub(super) fn value(&self, state: &MachineState) -> f64 {
        match self {
            Self::Axis(axis) => at(&state.axes.velocity, *axis),
            Self::Motor(axis) => at(&state.motors.velocity, *axis),
            Self::Teeth(axis, edge) => twist(state, *axis) - edge,
        }
    }

    /// How fast that changes where everything changes like `slope`.
    pub(super) fn rate(&self, slope: &MachineState) -> f64 {
        match self {
            Self::Axis(_) | Self::Motor(_) => self.value(slope),
            Self::Teeth(axis, _) => twist(slope, *axis),
        }
    }

    /// Takes from it what is left of its velocity.
    pub(super) fn stop(&self, state: &mut MachineState) {
        let velocity = match self {
            Self::Axis(axis) => state.axes.velocity.get_mut(*axis),
            Self::Motor(axis) => state.motors.velocity.get_mut(*axis),
            Self::Teeth(..) => None,
        };
        if let Some(velocity) = velocity {
            *velocity = 0.0;
        }
    }
}

/// How far the motor of `axis` is ahead of it.
fn twist(state: &MachineState, axis: usize) -> f64 {
    at(&state.motors.position, axis) - at(&state.axes.position, axis)
}

impl<M: Motors + ?Sized> Step<'_, M> {
    /// What dry friction does from `state`, at `stage` of the step, for `dt` s.
    pub(super) fn settle(
        &mut self,
        state: &MachineState,
        stage: Stage,
        dt: f64,
    ) -> Option<Settled> {
        let mut settled = Settled { dry: Dry::NONE, mobility: None };
        if !self.dry {
            return Some(settled);
        }
        let dry = &mut settled.dry;
        let (mut axes_stand, mut motors_stand) = (JointVector::zeros(), JointVector::zeros());
        for (axis, train) in self.trains.iter().enumerate() {
            let velocity = at(&state.axes.velocity, axis);
            oppose(velocity, &train.friction, axis, &mut dry.axes, &mut axes_stand);
            if let Some(elastic) = &train.elastic {
                let velocity = at(&state.motors.velocity, axis);
                oppose(velocity, &elastic.friction, axis, &mut dry.motors, &mut motors_stand);
            }
        }
        if axes_stand.max() <= 0.0 && motors_stand.max() <= 0.0 {
            return Some(settled);
        }
        let (free, _) = self.slope(stage, state, dry)?;
        if axes_stand.max() > 0.0 {
            let velocity = state.axes.velocity + free.axes.velocity * dt;
            let mobility = self.equation.mobility(&state.axes.position)?;
            let forces = hold(velocity, &axes_stand, &(mobility * dt));
            for ((dry, force), most) in dry.axes.iter_mut().zip(&forces).zip(&axes_stand) {
                if *most > 0.0 {
                    *dry = DryFriction::of_force(*force, *most);
                }
            }
            settled.mobility = Some(mobility);
        }
        let rows = dry.motors.iter_mut().zip(&motors_stand).zip(self.trains).enumerate();
        for (axis, ((dry, most), train)) in rows {
            if let Some(elastic) = train.elastic.as_ref().filter(|_| *most > 0.0) {
                let free = at(&(state.motors.velocity + free.motors.velocity * dt), axis);
                let force = (-free * elastic.inertia / dt).clamp(-most, *most);
                *dry = DryFriction::of_force(force, *most);
            }
        }
        Some(settled)
    }
}

/// Opposes `velocity`, or notes the most that can hold what stands.
fn oppose(
    velocity: f64,
    friction: &FrictionParameters,
    axis: usize,
    dry: &mut [DryFriction; MAX_AXES],
    stands: &mut JointVector,
) {
    if !friction.is_dry() {
        return;
    }
    if velocity.abs() > REST {
        if let Some(dry) = dry.get_mut(axis) {
            *dry = DryFriction::Slides(velocity.signum());
        }
    } else if let Some(most) = stands.get_mut(axis) {
        *most = friction.dry(0.0);
    }
}

/// The forces within ± `limits` that leave least of `velocity`, which the axes have at the end of a step without them;
/// `mobility` is what forces add to it by then. Axes without a limit are left as they are.
fn hold(mut velocity: JointVector, limits: &JointVector, mobility: &JointMatrix) -> JointVector {
    let mut force = JointVector::zeros();
    for _ in 0..MAX_SWEEPS {
        let mut change = 0.0_f64;
        let rows = mobility.column_iter().zip(force.iter_mut().zip(limits.iter()));
        for (axis, (column, (force, limit))) in rows.enumerate() {
            if *limit <= 0.0 {
                continue;
            }
            let own = column.get(axis).copied().unwrap_or(1.0);
            let wanted = (*force - at(&velocity, axis) / own).clamp(-limit, *limit);
            let difference = wanted - *force;
            *force = wanted;
            velocity += column * difference;
            change = change.max(difference.abs());
        }
        if change <= 1e-14 * force.amax() {
            break;
        }
    }
    force
}

impl Settled {
    /// What comes to rest first between `state` and `arrival`, `dt` s later, or which teeth meet or part, and at which part of the way.
    /// Only what was moving can come to rest.
    pub(super) fn first_stop(
        &self,
        trains: &[Train; MAX_AXES],
        state: &MachineState,
        arrival: &Arrival,
        dt: f64,
    ) -> Option<(Stop, f64)> {
        let mut first: Option<(Stop, f64)> = None;
        let axes = self.dry.axes.iter().enumerate().map(|(axis, dry)| (Stop::Axis(axis), dry));
        let motors = self.dry.motors.iter().enumerate().map(|(axis, dry)| (Stop::Motor(axis), dry));
        for (stop, dry) in axes.chain(motors) {
            let DryFriction::Slides(direction) = dry else { continue };
            let [before, after] = [state, &arrival.state].map(|state| stop.value(state));
            if before * direction <= REST || after * direction >= 0.0 {
                continue;
            }
            let part = crossing(before, after, stop.rate(&arrival.first) * dt);
            if first.is_none_or(|(_, earliest)| part < earliest) {
                first = Some((stop, part));
            }
        }
        for (axis, train) in trains.iter().enumerate() {
            let Some(elastic) = &train.elastic else { continue };
            for stop in elastic.transmission.edges().map(|edge| Stop::Teeth(axis, edge)) {
                let [before, after] = [state, &arrival.state].map(|state| stop.value(state));
                if before * after >= 0.0 || before.abs() <= AT_EDGE {
                    continue;
                }
                let part = crossing(before, after, stop.rate(&arrival.first) * dt);
                if first.is_none_or(|(_, earliest)| part < earliest) {
                    first = Some((stop, part));
                }
            }
        }
        first
    }

    /// Takes what is left of its motion, since `before`, dt s ago, from what sticks, as far as friction can; axes feel it of each
    /// other.
    pub(super) fn stand_still(
        &self,
        trains: &[Train; MAX_AXES],
        before: &MachineState,
        state: &mut MachineState,
        dt: f64,
    ) {
        // In no time there is no motion.
        if dt <= 0.0 {
            return;
        }
        for (axis, train) in trains.iter().enumerate() {
            if let (Some(DryFriction::Sticks(force)), Some(mobility)) =
                (self.dry.axes.get(axis), &self.mobility)
            {
                let column = mobility.column(axis).into_owned();
                let most = train.friction.dry(0.0);
                stick(&before.axes, &mut state.axes, axis, &column, (*force, most), dt);
            }
            if let (Some(DryFriction::Sticks(force)), Some(elastic)) =
                (self.dry.motors.get(axis), &train.elastic)
            {
                let mut column = JointVector::zeros();
                if let Some(entry) = column.get_mut(axis) {
                    *entry = 1.0 / elastic.inertia;
                }
                let most = elastic.friction.dry(0.0);
                stick(&before.motors, &mut state.motors, axis, &column, (*force, most), dt);
            }
        }
    }
}

/// Changes the `force` on one axis, which has held for `dt` s, within ± `most` so that the axis rests. `column` are the
/// accelerations by that force.
fn stick(
    before: &JointState,
    state: &mut JointState,
    axis: usize,
    column: &JointVector,
    (force, most): (f64, f64),
    dt: f64,
) {
    let own = at(column, axis) * dt;
    let wanted = (force - at(&state.velocity, axis) / own).clamp(-most, most);
    let slower = column * ((wanted - force) * dt);
    state.velocity += slower;
    // What a force that changes evenly has done by now.
    state.position += slower * (dt / 3.0);
    if wanted.abs() < most {
        let slots = state.position.get_mut(axis).zip(state.velocity.get_mut(axis));
        if let Some((position, velocity)) = slots {
            (*position, *velocity) = (at(&before.position, axis), 0.0);
        }
    }
}

/// Where a velocity that goes from `before` to `after`, at first by `slope` per way, is 0: on the parabola through these.
fn crossing(before: f64, after: f64, slope: f64) -> f64 {
    let straight = before / (before - after);
    let bend = after - before - slope;
    let root = slope * slope - 4.0 * bend * before;
    if root < 0.0 {
        return straight;
    }
    // The root that the straight line becomes as the bend goes.
    let part = -2.0 * before / (slope - before.signum() * root.sqrt());
    if (0.0..=1.0).contains(&part) { part } else { straight }
}
