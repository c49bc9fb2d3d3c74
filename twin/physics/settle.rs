//! What dry friction does: what moves is opposed, what stands is held or breaks away.
//!
//! Of all forces within ± the dry friction of axes that stand, those are taken that leave as little acceleration as they can, as
//! Moreau and Stewart–Trinkle do with velocities (projected Gauss–Seidel). What they hold stays where it is to the last bit, by
//! whatever force that takes from then on, until that is more than friction has (`stop`): nothing creeps.

use twin_kinematics::MAX_AXES;

use super::dynamics::{JointMatrix, JointVector, at};
use super::friction::{DryFriction, FrictionParameters, REST};
use super::integrate::{JointState, MachineState, Motors, Stage, Step};
use super::linear::solve;

/// Sweeps of the friction solver; it converges in one or two unless several axes stick against each other.
const MAX_SWEEPS: usize = 100;

/// What dry friction does on both sides of the transmissions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dry {
    pub(super) axes: [DryFriction; MAX_AXES],
    pub(super) motors: [DryFriction; MAX_AXES],
    /// Whether any of them sticks.
    pub(super) axes_stick: bool,
    pub(super) motors_stick: bool,
}

impl Dry {
    const NONE: Self = Self {
        axes: [DryFriction::None; MAX_AXES],
        motors: [DryFriction::None; MAX_AXES],
        axes_stick: false,
        motors_stick: false,
    };
}

/// The forces that hold what sticks, N or Nm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Holding {
    pub(super) axes: JointVector,
    pub(super) motors: JointVector,
}

impl Holding {
    fn none() -> Self {
        Self { axes: JointVector::zeros(), motors: JointVector::zeros() }
    }
}

/// What goes on until something stops or breaks away, and what holds at its beginning.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settled {
    pub(super) dry: Dry,
    pub(super) holding: Holding,
}

impl<M: Motors + ?Sized> Step<'_, M> {
    /// What dry friction does from `state` on, at `stage` of the step. What stands is at rest from now on.
    pub(super) fn settle(&mut self, state: &mut MachineState, stage: Stage) -> Option<Settled> {
        let mut settled = Settled { dry: Dry::NONE, holding: Holding::none() };
        if !self.dry {
            return Some(settled);
        }
        let Settled { dry, holding } = &mut settled;
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
        let pushed = self.pushed(stage, state, dry);
        if axes_stand.max() > 0.0 {
            let JointState { position, velocity } = &state.axes;
            let (free, mobility) =
                self.equation.acceleration_and_mobility(position, velocity, &pushed.axes)?;
            holding.axes = hold(free, &axes_stand, &mobility);
            dry.axes_stick = begin(&mut state.axes, &mut dry.axes, &holding.axes, &axes_stand);
        }
        if motors_stand.max() > 0.0 {
            holding.motors = -pushed.motors;
            dry.motors_stick =
                begin(&mut state.motors, &mut dry.motors, &holding.motors, &motors_stand);
        }
        Some(settled)
    }

    /// What holds what sticks at `state`, at `stage` of the step.
    pub(super) fn holding(
        &mut self,
        stage: Stage,
        state: &MachineState,
        dry: &Dry,
    ) -> Option<Holding> {
        let mut holding = Holding::none();
        if !dry.axes_stick && !dry.motors_stick {
            return Some(holding);
        }
        let pushed = self.pushed(stage, state, dry);
        holding.motors = -pushed.motors;
        if dry.axes_stick {
            (_, holding.axes) = self.held(&state.axes, &pushed.axes, dry)?;
        }
        Some(holding)
    }

    /// The accelerations of the axes at `state` under `efforts` where some stick, and the forces that hold these.
    pub(super) fn held(
        &mut self,
        state: &JointState,
        efforts: &JointVector,
        dry: &Dry,
    ) -> Option<(JointVector, JointVector)> {
        let (free, mobility) =
            self.equation.acceleration_and_mobility(&state.position, &state.velocity, efforts)?;
        // M⁻¹ of those that stick, and 1 on the diagonal for the others, which nothing holds.
        let (mut among, mut wanted) = (JointMatrix::identity(), JointVector::zeros());
        let columns = among.column_iter_mut().zip(mobility.column_iter());
        let columns = columns.zip(wanted.iter_mut().zip(&free)).zip(&dry.axes);
        for (((mut among, mobility), (wanted, free)), _) in columns.filter(|(_, dry)| dry.sticks())
        {
            *wanted = -free;
            let rows = among.iter_mut().zip(&mobility).zip(&dry.axes);
            for ((among, mobility), _) in rows.filter(|(_, dry)| dry.sticks()) {
                *among = *mobility;
            }
        }
        let forces = solve(self.equation.axis_count(), &among, &wanted)?;
        let mut accelerations = free + mobility * forces;
        let still = accelerations.iter_mut().zip(&dry.axes).filter(|(_, dry)| dry.sticks());
        still.for_each(|(acceleration, _)| *acceleration = 0.0);
        Some((accelerations, forces))
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

/// Lets what stands stick or break away, as the `forces` say that would hold it and the most there is (`limits`, 0 where nothing
/// stands). Whether anything sticks.
fn begin(
    state: &mut JointState,
    dry: &mut [DryFriction; MAX_AXES],
    forces: &JointVector,
    limits: &JointVector,
) -> bool {
    let mut any = false;
    let rows = state.velocity.iter_mut().zip(dry).zip(forces.iter().zip(limits));
    for ((velocity, dry), (force, most)) in rows.filter(|(_, (_, most))| **most > 0.0) {
        *dry = DryFriction::at_rest(*force, *most);
        any = any || dry.sticks();
        *velocity = 0.0;
    }
    any
}

/// The forces within ± `limits` that leave least of `acceleration`, which the axes have without them; `mobility` is what forces
/// add to it. Axes without a limit are left as they are.
fn hold(
    mut acceleration: JointVector,
    limits: &JointVector,
    mobility: &JointMatrix,
) -> JointVector {
    let mut force = JointVector::zeros();
    for _ in 0..MAX_SWEEPS {
        let mut change = 0.0_f64;
        let rows = mobility.column_iter().zip(force.iter_mut().zip(limits.iter()));
        for (axis, (column, (force, limit))) in rows.enumerate() {
            if *limit <= 0.0 {
                continue;
            }
            let own = column.get(axis).copied().unwrap_or(1.0);
            let wanted = (*force - at(&acceleration, axis) / own).clamp(-limit, *limit);
            let difference = wanted - *force;
            *force = wanted;
            acceleration += column * difference;
            change = change.max(difference.abs());
        }
        if change <= 1e-14 * force.amax() {
            break;
        }
    }
    force
}
