//! Time integration over one short step: joints by the equation of motion, together with rotors behind elastic
//! transmissions.
//!
//! The method is classical Runge–Kutta of fourth order. Motors, springs and friction are part of the right-hand side.
//! The laws change where something stops or breaks away, or where teeth meet. A step therefore ends there (`stop`), and
//! another one takes the rest of the time. Friction opposes a part as long as it moves; `settle` decides whether a part
//! at rest is held or breaks away. Every step thus covers smooth motion only. Its error is of fifth order, wherever it
//! begins.

use twin_kinematics::MAX_AXES;

use super::dynamics::{JointVector, at};
use super::equation::Equation;
use super::friction::FrictionParameters;
use super::settle::{Dry, Holding, Settled, Sticking};
use super::transmission::ElasticTransmission;

/// How often another law may begin in one step; beyond that, what goes on is as it would be without.
const MOST_STOPS: usize = 16;

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

/// Stage of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stage {
    Start,
    Middle,
    End,
    /// At this part of it.
    At(f64),
}

impl Stage {
    fn new(part: f64) -> Self {
        if part <= 0.0 {
            Self::Start
        } else if part >= 1.0 {
            Self::End
        } else if (part - 0.5).abs() <= f64::EPSILON {
            Self::Middle
        } else {
            Self::At(part)
        }
    }
}

/// Motors of the axes.
pub(super) trait Motors {
    /// The efforts of all motors that are there and move so, N or Nm at the axes.
    fn efforts(&self, stage: Stage, motors: &JointState) -> JointVector;
}

/// Transmission between one motor and its axis.
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

/// Which axes are behind springs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Springs {
    None,
    Some,
    All,
}

impl Springs {
    fn of(trains: &[Train]) -> Self {
        let is_elastic = |train: &Train| train.elastic.is_some();
        if trains.iter().all(is_elastic) {
            Self::All
        } else if trains.iter().any(is_elastic) {
            Self::Some
        } else {
            Self::None
        }
    }
}

/// A machine in a step.
pub(super) struct Step<'a, M: ?Sized> {
    pub(super) equation: &'a mut Equation,
    pub(super) trains: &'a [Train; MAX_AXES],
    motors: &'a M,
    /// What else pushes the axes, N or Nm.
    disturbance: &'a JointVector,
    /// Number of axes.
    pub(super) axes: usize,
    springs: Springs,
    /// True if there is dry friction.
    pub(super) dry: bool,
    /// s.
    pub(super) dt: f64,
}

/// Efforts on axes and motors at some time, N or Nm.
pub(super) struct Pushed {
    pub(super) axes: JointVector,
    /// Only of motors behind springs.
    pub(super) motors: JointVector,
    /// The efforts of all motors.
    effort: JointVector,
}

/// End of a part of a step.
pub(super) struct Arrival {
    pub(super) state: MachineState,
    /// At this part of the step.
    pub(super) until: f64,
    effort: JointVector,
    /// Derivative of the state at its beginning.
    pub(super) first: MachineState,
    /// Forces that hold sticking parts.
    pub(super) holding: Holding,
}

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

impl<M: Motors + ?Sized> Step<'_, M> {
    /// From `state` through the part of the step between `from` and `until`.
    pub(super) fn take(
        &mut self,
        state: &MachineState,
        settled: &Settled,
        from: f64,
        until: f64,
    ) -> Option<Arrival> {
        let dt = (until - from) * self.dt;
        let half = 0.5 * dt;
        let [start, middle, end] = [from, 0.5 * (from + until), until].map(Stage::new);
        let dry = &settled.dry;
        let (first, effort) = self.slope(start, state, dry)?;
        let (second, effort_2) = self.slope(middle, &state.moved(&first, half), dry)?;
        let (third, effort_3) = self.slope(middle, &state.moved(&second, half), dry)?;
        let (fourth, effort_4) = self.slope(end, &state.moved(&third, dt), dry)?;
        let slopes = [&first, &second, &third, &fourth];
        let mut next = *state;
        next.axes = state.axes.moved(&JointState::mean(slopes.map(|slope| &slope.axes)), dt);
        if self.springs != Springs::None {
            let mean = JointState::mean(slopes.map(|slope| &slope.motors));
            next.motors = state.motors.moved(&mean, dt);
            if self.springs == Springs::Some {
                next.motors = self.motors_of(&next.axes, &next.motors);
            }
        }
        let effort = (effort + (effort_2 + effort_3) * 2.0 + effort_4) / 6.0;
        let holding = self.holding(end, &next, dry)?;
        Some(Arrival { state: next, until, effort, first, holding })
    }

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
        let pushed = self.pushed(stage, state, dry);
        let MachineState { axes, motors } = state;
        let acceleration = match dry.sticking_axes {
            Sticking::None => {
                self.equation.acceleration(&axes.position, &axes.velocity, &pushed.axes)?
            }
            Sticking::Some => self.held(axes, &pushed.axes, dry)?.0,
            Sticking::All => JointVector::zeros(),
        };
        let mut faster = pushed.motors;
        let rows = faster.iter_mut().zip(self.trains).zip(&dry.motors);
        for ((faster, train), dry) in rows.take(self.axes) {
            *faster = match &train.elastic {
                Some(elastic) if !dry.sticks() => *faster / elastic.inertia,
                _ => 0.0,
            };
        }
        let slope = MachineState {
            axes: JointState { position: axes.velocity, velocity: acceleration },
            motors: JointState { position: motors.velocity, velocity: faster },
        };
        Some((slope, pushed.effort))
    }

    /// Efforts on all parts at `state`, except the forces that hold sticking parts.
    #[inline]
    pub(super) fn pushed(&self, stage: Stage, state: &MachineState, dry: &Dry) -> Pushed {
        let MachineState { axes, motors } = state;
        let mixed;
        let motors = match self.springs {
            Springs::None => axes,
            Springs::All => motors,
            Springs::Some => {
                mixed = self.motors_of(axes, motors);
                &mixed
            }
        };
        let effort = self.motors.efforts(stage, motors);
        let mut pushed = Pushed { axes: effort, motors: JointVector::zeros(), effort };
        let rows = pushed.axes.iter_mut().zip(pushed.motors.iter_mut()).zip(self.trains);
        for (axis, (((at_axis, at_motor), train), (dry, dry_motor))) in
            rows.zip(dry.axes.iter().zip(&dry.motors)).enumerate().take(self.axes)
        {
            let velocity = at(&axes.velocity, axis);
            if let Some(elastic) = &train.elastic {
                let motor_velocity = at(&motors.velocity, axis);
                let twist = at(&motors.position, axis) - at(&axes.position, axis);
                let passed = elastic.transmission.effort(twist, motor_velocity - velocity);
                let friction = dry_motor.force(motor_velocity, &elastic.friction);
                *at_motor = *at_axis - passed + friction;
                *at_axis = passed;
            }
            *at_axis += dry.force(velocity, &train.friction);
        }
        pushed.axes += self.disturbance;
        pushed
    }
}
