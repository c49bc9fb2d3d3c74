//! Dry friction: it opposes moving parts, and holds parts at rest until they break away.
//!
//! The solver finds the forces within ± the dry friction of axes at rest that leave the least acceleration (Moreau,
//! Stewart and Trinkle; projected Gauss–Seidel). A held axis keeps its position to the last bit until its holding
//! force exceeds the friction (`stop`).

use twin_kinematics::MAX_AXES;

use crate::friction::{DryFriction, FrictionParameters, REST};
use crate::joint::{JointMatrix, JointVector};
use crate::linear::solve;
use crate::state::{JointState, MachineState, Motors, Stage};
use crate::step::{Dry, Step, Sticking};

/// Sweeps of the friction solver; it converges in one or two unless several axes stick against each other.
const MAX_SWEEPS: usize = 100;

/// The forces that hold what sticks, N or Nm.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Holding {
    pub(super) axes: JointVector,
    pub(super) motors: JointVector,
}

/// Dry friction until the next stop or breakaway, and the holding forces at its beginning.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Settled {
    pub(super) dry: Dry,
    pub(super) holding: Holding,
}

impl<M: Motors + ?Sized> Step<'_, M> {
    /// Dry friction from `state` on, at `stage` of the step. Parts at rest have exactly zero velocity from now on.
    pub(super) fn settle(&mut self, state: &mut MachineState, stage: Stage) -> Option<Settled> {
        let mut settled = Settled::default();
        if !self.dry {
            return Some(settled);
        }
        let Settled { dry, holding } = &mut settled;
        let (mut axes_stand, mut motors_stand) = (JointVector::zeros(), JointVector::zeros());
        let axes = dry.axes.iter_mut().zip(axes_stand.iter_mut());
        let motors = dry.motors.iter_mut().zip(motors_stand.iter_mut());
        for (axis, (train, (at_axis, at_motor))) in
            self.trains.iter().zip(axes.zip(motors)).enumerate()
        {
            oppose(state.axes.velocity[axis], &train.friction, at_axis);
            if let Some(elastic) = &train.elastic {
                oppose(state.motors.velocity[axis], &elastic.friction, at_motor);
            }
        }
        if axes_stand.max() <= 0.0 && motors_stand.max() <= 0.0 {
            return Some(settled);
        }
        let pushed = self.pushed(stage, state, dry);
        if axes_stand.max() > 0.0 {
            holding.axes = self.hold(&state.axes, &pushed.axes, &axes_stand)?;
            dry.sticking_axes =
                self.begin(&mut state.axes, &mut dry.axes, &holding.axes, &axes_stand);
        }
        if motors_stand.max() > 0.0 {
            holding.motors = -pushed.motors;
            dry.sticking_motors =
                self.begin(&mut state.motors, &mut dry.motors, &holding.motors, &motors_stand);
        }
        Some(settled)
    }

    /// Forces that hold sticking parts at `state`, at `stage` of the step.
    pub(super) fn holding(
        &mut self,
        stage: Stage,
        state: &MachineState,
        dry: &Dry,
    ) -> Option<Holding> {
        let mut holding = Holding::default();
        if [dry.sticking_axes, dry.sticking_motors] == [Sticking::None; 2] {
            return Some(holding);
        }
        let pushed = self.pushed(stage, state, dry);
        holding.motors = -pushed.motors;
        match dry.sticking_axes {
            Sticking::None => {}
            Sticking::Some => (_, holding.axes) = self.held(&state.axes, &pushed.axes, dry)?,
            Sticking::All => holding.axes = self.hold_all(&state.axes, &pushed.axes)?,
        }
        Some(holding)
    }

    /// Forces within ± `limits` that leave least acceleration of the axes at rest; axes in motion have the limit 0.
    fn hold(
        &mut self,
        state: &JointState,
        efforts: &JointVector,
        limits: &JointVector,
    ) -> Option<JointVector> {
        if limits.iter().take(self.axes).all(|limit| *limit > 0.0) {
            let forces = self.hold_all(state, efforts)?;
            let mut all = forces.iter().zip(limits).take(self.axes);
            if all.all(|(force, most)| DryFriction::at_rest(*force, *most).sticks()) {
                return Some(forces);
            }
        }
        let JointState { position, velocity } = state;
        let (free, mobility) =
            self.equation.acceleration_and_mobility(position, velocity, efforts)?;
        Some(least(free, limits, &mobility))
    }

    /// Forces that hold all axes at `state` under `efforts`.
    fn hold_all(&mut self, state: &JointState, efforts: &JointVector) -> Option<JointVector> {
        let zero = JointVector::zeros();
        Some(self.equation.inverse_dynamics(&state.position, &zero, &zero)? - efforts)
    }

    /// Accelerations of the axes at `state` under `efforts` where some stick, and the forces that hold these.
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

    /// Decides which parts at rest stick and which break away, from their holding `forces` and `limits` (0: in
    /// motion).
    fn begin(
        &self,
        state: &mut JointState,
        dry: &mut [DryFriction; MAX_AXES],
        forces: &JointVector,
        limits: &JointVector,
    ) -> Sticking {
        let (mut any, mut all) = (false, true);
        let rows = state.velocity.iter_mut().zip(dry).zip(forces.iter().zip(limits));
        for ((velocity, dry), (force, most)) in rows.take(self.axes) {
            if *most > 0.0 {
                *dry = DryFriction::at_rest(*force, *most);
                *velocity = 0.0;
            }
            any = any || dry.sticks();
            all = all && dry.sticks();
        }
        match (any, all) {
            (false, _) => Sticking::None,
            (true, false) => Sticking::Some,
            (true, true) => Sticking::All,
        }
    }
}

/// Opposes the `velocity` of a part, or notes the largest friction that can hold it at rest.
fn oppose(velocity: f64, friction: &FrictionParameters, part: (&mut DryFriction, &mut f64)) {
    let (dry, holds) = part;
    if !friction.is_dry() {
        return;
    }
    if velocity.abs() > REST {
        *dry = DryFriction::Slides(velocity.signum());
    } else {
        *holds = friction.dry(0.0);
    }
}

/// Forces within ± `limits` that leave least of `acceleration`; `mobility` is acceleration per force. Axes without
/// a limit keep theirs.
fn least(
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
            let wanted = (*force - acceleration[axis] / column[axis]).clamp(-limit, *limit);
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
