//! Motion over one short step: joints by the equation of motion, rotors behind elastic transmissions beside it.
//!
//! Classical Runge–Kutta of fourth order. Motors, springs and viscous friction are part of the right-hand side. Dry
//! friction has a jump where an axis stops, so what it does is settled before the step, as Moreau and Stewart–Trinkle do:
//! an axis that slides all through the step is opposed all through it; if some axis stands or turns round, of all forces
//! within ± the dry friction those are taken that stop as much motion as they can by the end of the step (projected
//! Gauss–Seidel on the velocities an explicit step predicts). An axis that stands still gets what holds it; what is left of its
//! motion at the end of the step, because forces have changed on the way, is taken from it, so that it does not creep.

use twin_kinematics::MAX_AXES;

use super::dynamics::{JointMatrix, JointVector, at};
use super::equation::Equation;
use super::friction::{DryFriction, FrictionParameters, REST};
use super::transmission::ElasticTransmission;

/// Sweeps of the friction solver; it converges in one or two unless several axes stick against each other.
const MAX_FRICTION_SWEEPS: usize = 100;

/// Positions and velocities of all axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct JointState {
    pub(super) position: JointVector,
    pub(super) velocity: JointVector,
}

impl JointState {
    pub(super) fn at_rest(position: JointVector) -> Self {
        Self { position, velocity: JointVector::zeros() }
    }

    pub(super) fn is_finite(&self) -> bool {
        self.position.iter().chain(self.velocity.iter()).all(|value| value.is_finite())
    }

    fn moved(&self, slope: &Self, dt: f64) -> Self {
        Self {
            position: self.position + slope.position * dt,
            velocity: self.velocity + slope.velocity * dt,
        }
    }

    /// What Runge and Kutta make of four slopes.
    fn mean(slopes: [&Self; 4]) -> Self {
        let [first, second, third, fourth] = slopes;
        let mean = |of: fn(&Self) -> &JointVector| {
            (of(first) + (of(second) + of(third)) * 2.0 + of(fourth)) / 6.0
        };
        Self { position: mean(|slope| &slope.position), velocity: mean(|slope| &slope.velocity) }
    }
}

/// Both ends of all transmissions; a motor without an elastic one is where its axis is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MachineState {
    pub(super) axes: JointState,
    pub(super) motors: JointState,
}

impl MachineState {
    pub(super) fn is_finite(&self) -> bool {
        self.axes.is_finite() && self.motors.is_finite()
    }

    fn moved(&self, slope: &Self, dt: f64) -> Self {
        Self {
            axes: self.axes.moved(&slope.axes, dt),
            motors: self.motors.moved(&slope.motors, dt),
        }
    }
}

/// When in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stage {
    Start,
    Middle,
    End,
}

/// What moves the axes.
pub(super) trait Motors {
    /// The efforts of all motors that are there and move so, N or Nm at the axes.
    fn efforts(&self, stage: Stage, motors: &JointState) -> JointVector;
}

/// What is between one motor and its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Train {
    /// Of the axis, and of all that is joined to it rigidly.
    pub(super) friction: FrictionParameters,
    pub(super) elastic: Option<Elastic>,
}

/// A motor at the far end of a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Elastic {
    pub(super) transmission: ElasticTransmission,
    /// Rotor inertia at the axis, kg or kg·m².
    pub(super) inertia: f64,
    pub(super) friction: FrictionParameters,
}

impl Train {
    /// An axis that does not exist.
    pub(super) const NONE: Self = Self { friction: FrictionParameters::NONE, elastic: None };

    /// Adds a brake on the motor that holds `effort`.
    pub(super) fn brake(&mut self, effort: f64) {
        let braked = match &mut self.elastic {
            Some(elastic) => &mut elastic.friction,
            None => &mut self.friction,
        };
        *braked = braked.and(&FrictionParameters::new(effort, 0.0));
    }
}

/// What dry friction does in a step, on both sides.
#[derive(Clone, Copy, Debug)]
struct Dry {
    axes: [DryFriction; MAX_AXES],
    motors: [DryFriction; MAX_AXES],
}

impl Dry {
    const NONE: Self =
        Self { axes: [DryFriction::None; MAX_AXES], motors: [DryFriction::None; MAX_AXES] };
}

/// A machine in a step.
struct Step<'a, M: ?Sized> {
    equation: &'a mut Equation,
    trains: &'a [Train; MAX_AXES],
    motors: &'a M,
    elastic: bool,
}

/// The state after `dt` (s), and the mean efforts of the motors on the way; `None` if some axis moves no inertia, or where the
/// machine cannot be.
pub(super) fn advance(
    equation: &mut Equation,
    trains: &[Train; MAX_AXES],
    state: &MachineState,
    motors: &(impl Motors + ?Sized),
    dt: f64,
) -> Option<(MachineState, JointVector)> {
    let elastic = trains.iter().any(|train| train.elastic.is_some());
    let mut step = Step { equation, trains, motors, elastic };
    let sliding = step.sliding(state);
    let mut dry = sliding.unwrap_or(Dry::NONE);
    let mut mobility = None;
    let (mut first, mut effort) = step.slope(Stage::Start, state, &dry)?;
    if sliding.is_none() || !step.slides_on(&state.moved(&first, dt), &dry) {
        if sliding.is_some() {
            (first, _) = step.slope(Stage::Start, state, &Dry::NONE)?;
        }
        (dry, mobility) = step.settle(state, &first, dt)?;
        (first, effort) = step.slope(Stage::Start, state, &dry)?;
    }
    let half = 0.5 * dt;
    let (second, effort_2) = step.slope(Stage::Middle, &state.moved(&first, half), &dry)?;
    let (third, effort_3) = step.slope(Stage::Middle, &state.moved(&second, half), &dry)?;
    let (fourth, effort_4) = step.slope(Stage::End, &state.moved(&third, dt), &dry)?;
    let slopes = [&first, &second, &third, &fourth];
    let mut axes = state.axes.moved(&JointState::mean(slopes.map(|slope| &slope.axes)), dt);
    if let Some(mobility) = &mobility {
        step.stand_still(&state.axes, &mut axes, &dry.axes, mobility, dt);
    }
    let mut next = MachineState { axes, motors: axes };
    if elastic {
        let motors = state.motors.moved(&JointState::mean(slopes.map(|slope| &slope.motors)), dt);
        next.motors = step.motors_of(&axes, &motors);
        step.stop_motors(&state.motors, &mut next.motors, &dry.motors, dt);
    }
    let effort = (effort + (effort_2 + effort_3) * 2.0 + effort_4) / 6.0;
    Some((next, effort))
}

impl<M: Motors + ?Sized> Step<'_, M> {
    /// `motors` where there are elastic transmissions, and the axes elsewhere.
    fn motors_of(&self, axes: &JointState, motors: &JointState) -> JointState {
        let mut result = *axes;
        let rows = result.position.iter_mut().zip(result.velocity.iter_mut());
        let motors = motors.position.iter().zip(motors.velocity.iter());
        for (((position, velocity), motor), train) in rows.zip(motors).zip(self.trains) {
            if train.elastic.is_some() {
                (*position, *velocity) = (*motor.0, *motor.1);
            }
        }
        result
    }

    /// How everything changes at `state`, and the efforts of the motors.
    fn slope(
        &mut self,
        stage: Stage,
        state: &MachineState,
        dry: &Dry,
    ) -> Option<(MachineState, JointVector)> {
        let MachineState { axes, motors } = state;
        let motors = if self.elastic { self.motors_of(axes, motors) } else { *axes };
        let effort = self.motors.efforts(stage, &motors);
        let mut at_axes = effort;
        let mut faster = JointVector::zeros();
        let rows = at_axes.iter_mut().zip(faster.iter_mut()).zip(self.trains);
        for (axis, (((at_axis, faster), train), (dry, dry_motor))) in
            rows.zip(dry.axes.iter().zip(&dry.motors)).enumerate()
        {
            let velocity = at(&axes.velocity, axis);
            if let Some(elastic) = &train.elastic {
                let motor_velocity = at(&motors.velocity, axis);
                let twist = at(&motors.position, axis) - at(&axes.position, axis);
                let passed = elastic.transmission.effort(twist, motor_velocity - velocity);
                let friction = dry_motor.force(motor_velocity, &elastic.friction);
                *faster = (*at_axis - passed + friction) / elastic.inertia;
                *at_axis = passed;
            }
            *at_axis += dry.force(velocity, &train.friction);
        }
        let acceleration = self.equation.acceleration(&axes.position, &axes.velocity, &at_axes)?;
        let slope = MachineState {
            axes: JointState { position: axes.velocity, velocity: acceleration },
            motors: JointState { position: motors.velocity, velocity: faster },
        };
        Some((slope, effort))
    }

    /// Dry friction if everything goes on sliding as it does; `None` where something stands.
    fn sliding(&self, state: &MachineState) -> Option<Dry> {
        let mut dry = Dry::NONE;
        let rows = dry.axes.iter_mut().zip(&mut dry.motors).zip(self.trains);
        for (axis, ((on_axis, on_motor), train)) in rows.enumerate() {
            *on_axis = DryFriction::opposing(at(&state.axes.velocity, axis), &train.friction)?;
            if let Some(elastic) = &train.elastic {
                let velocity = at(&state.motors.velocity, axis);
                *on_motor = DryFriction::opposing(velocity, &elastic.friction)?;
            }
        }
        Some(dry)
    }

    /// Whether everything slides still at `next` as it did.
    fn slides_on(&self, next: &MachineState, dry: &Dry) -> bool {
        let on = |dry: &[DryFriction; MAX_AXES], velocity: &JointVector| {
            dry.iter().zip(velocity.iter()).all(|(dry, velocity)| dry.lasts(*velocity))
        };
        on(&dry.axes, &next.axes.velocity) && on(&dry.motors, &next.motors.velocity)
    }

    /// Takes what is left of their motion from axes that stick, as far as friction can; others feel it by `mobility`.
    fn stand_still(
        &self,
        before: &JointState,
        axes: &mut JointState,
        dry: &[DryFriction; MAX_AXES],
        mobility: &JointMatrix,
        dt: f64,
    ) {
        for (axis, (dry, train)) in dry.iter().zip(self.trains).enumerate() {
            let DryFriction::Sticks(force) = *dry else { continue };
            let most = train.friction.dry(0.0);
            let left = at(&axes.velocity, axis);
            let own = mobility.get((axis, axis)).copied().unwrap_or(1.0) * dt;
            let wanted = (force - left / own).clamp(-most, most);
            let slower = mobility.column(axis) * ((wanted - force) * dt);
            axes.velocity += slower;
            // What a force that changes evenly has done by now.
            axes.position += slower * (dt / 3.0);
            if wanted.abs() < most && at(&before.velocity, axis).abs() <= REST {
                let slots = axes.position.get_mut(axis).zip(axes.velocity.get_mut(axis));
                if let Some((position, velocity)) = slots {
                    (*position, *velocity) = (at(&before.position, axis), 0.0);
                }
            }
        }
    }

    /// The same of motors behind springs, which do not feel each other.
    fn stop_motors(
        &self,
        before: &JointState,
        motors: &mut JointState,
        dry: &[DryFriction; MAX_AXES],
        dt: f64,
    ) {
        let states = motors.position.iter_mut().zip(motors.velocity.iter_mut());
        let rows = states.zip(dry.iter().zip(self.trains)).enumerate();
        for (axis, ((position, velocity), (dry, train))) in rows {
            let (DryFriction::Sticks(force), Some(elastic)) = (*dry, &train.elastic) else {
                continue;
            };
            let most = elastic.friction.dry(0.0);
            let wanted = (force - *velocity * elastic.inertia / dt).clamp(-most, most);
            let slower = (wanted - force) * dt / elastic.inertia;
            *velocity += slower;
            *position += slower * (dt / 3.0);
            if wanted.abs() < most && at(&before.velocity, axis).abs() <= REST {
                (*position, *velocity) = (at(&before.position, axis), 0.0);
            }
        }
    }

    /// Dry friction over the next `dt`, where without any the state changes by `free`; and the mobility, if it took it.
    fn settle(
        &mut self,
        state: &MachineState,
        free: &MachineState,
        dt: f64,
    ) -> Option<(Dry, Option<JointMatrix>)> {
        let mut dry = Dry::NONE;
        let mut mobility = None;
        let limits = self.trains.iter().zip(state.axes.velocity.iter());
        let limits =
            super::joint_vector(limits.map(|(train, velocity)| train.friction.dry(*velocity)));
        if limits.amax() > 0.0 {
            let velocity = state.axes.velocity + free.axes.velocity * dt;
            let here = self.equation.mobility(&state.axes.position)?;
            let forces = self.hold(velocity, &limits, &(here * dt));
            mobility = Some(here);
            for ((dry, force), most) in dry.axes.iter_mut().zip(&forces).zip(&limits) {
                *dry = DryFriction::of_force(*force, *most);
            }
        }
        for (axis, (dry, train)) in dry.motors.iter_mut().zip(self.trains).enumerate() {
            let Some(elastic) = &train.elastic else { continue };
            let velocity = at(&state.motors.velocity, axis);
            let most = elastic.friction.dry(velocity);
            let free = velocity + at(&free.motors.velocity, axis) * dt;
            let force = (-free * elastic.inertia / dt).clamp(-most, most);
            *dry = DryFriction::of_force(force, most);
        }
        Some((dry, mobility))
    }

    /// The forces within ± `limits` that leave least of `velocity`, which the axes have at the end of a step without them;
    /// `mobility` is what forces add to it by then.
    fn hold(
        &self,
        mut velocity: JointVector,
        limits: &JointVector,
        mobility: &JointMatrix,
    ) -> JointVector {
        let mut force = JointVector::zeros();
        let diagonal = mobility.diagonal();
        for _ in 0..MAX_FRICTION_SWEEPS {
            let mut change = 0.0_f64;
            let axes = mobility
                .column_iter()
                .zip(diagonal.iter())
                .zip(force.iter_mut().zip(limits.iter()));
            for (axis, ((column, mobility), (force, limit))) in
                axes.enumerate().take(self.equation.axis_count())
            {
                let wanted = (*force - at(&velocity, axis) / mobility).clamp(-limit, *limit);
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
}
