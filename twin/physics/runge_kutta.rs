//! Classical Runge–Kutta method of fourth order over a part of a step without stops.

use crate::dry_friction::{Holding, Settled};
use crate::joint::JointVector;
use crate::state::{JointState, MachineState, Motors, Stage};
use crate::step::{Dry, Springs, Step, Sticking};

/// End of a part of a step.
pub(super) struct Arrival {
    pub(super) state: MachineState,
    /// At this part of the step.
    pub(super) until: f64,
    pub(super) effort: JointVector,
    /// Derivative of the state at its beginning.
    pub(super) first: MachineState,
    /// Forces that hold sticking parts.
    pub(super) holding: Holding,
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

    /// Derivative of the state at `state`, and the efforts of the motors.
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
}
