//! Event detection within a step: a part comes to rest or breaks away, or teeth with backlash meet, part or cease to
//! push.
//!
//! Another law holds from such an event on, so the step ends there: at the zero of a smooth quantity, found by
//! false position over repeated parts of the step.

use twin_kinematics::MAX_AXES;

use crate::dry_friction::{Holding, Settled};
use crate::friction::{DryFriction, REST};
use crate::runge_kutta::Arrival;
use crate::state::{Elastic, MachineState, Motors, Train};
use crate::step::Step;

/// Ends tried for one stop; three or four do.
const MOST_ENDS: usize = 12;

/// As near to it as this part of the step is there.
const THERE: f64 = 1e-10;

/// And where no more than this is left, m, m/s or N: rounding.
const NOUGHT: f64 = 1e-13;

/// Relative size of a value whose sign has changed before.
const NOTHING: f64 = 1e-7;

/// Something after which another law holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stop {
    /// An axis that moves in this direction comes to rest.
    Axis(usize, f64),
    /// So does a motor.
    Motor(usize, f64),
    /// The holding force of a sticking axis exceeds this, N or Nm.
    AxisBreaks(usize, f64),
    /// The same of a motor.
    MotorBreaks(usize, f64),
    /// Teeth meet, or are fully engaged, at this lead of the motor over the axis (m or rad).
    Teeth(usize, f64),
    /// Teeth that are wound up cease to push, or begin again.
    Push(usize),
}

impl Stop {
    /// Quantity that is 0 at the stop: a velocity, the friction left, the distance of the teeth, or their push.
    fn value(&self, trains: &[Train; MAX_AXES], state: &MachineState, holding: &Holding) -> f64 {
        match *self {
            Self::Axis(axis, direction) => direction * state.axes.velocity[axis],
            Self::Motor(axis, direction) => direction * state.motors.velocity[axis],
            Self::AxisBreaks(axis, most) => most - holding.axes[axis].abs(),
            Self::MotorBreaks(axis, most) => most - holding.motors[axis].abs(),
            Self::Teeth(axis, edge) => twist(state, axis) - edge,
            Self::Push(axis) => push(trains, state, axis).1,
        }
    }

    /// True if the stop lies between two values.
    fn happens(&self, before: f64, after: f64) -> bool {
        match self {
            // What breaks away moves from no velocity on.
            Self::Axis(..) | Self::Motor(..) => after < 0.0 && before.max(-after) > REST,
            Self::AxisBreaks(..) | Self::MotorBreaks(..) => after < 0.0 && before > 0.0,
            Self::Teeth(..) | Self::Push(_) => {
                before * after < 0.0 && before.abs() > NOUGHT.max(NOTHING * after.abs())
            }
        }
    }

    /// Rate of that quantity if the state changes like `slope`; `None` if it is not known.
    fn rate(&self, slope: &MachineState) -> Option<f64> {
        match *self {
            Self::Axis(axis, direction) => Some(direction * slope.axes.velocity[axis]),
            Self::Motor(axis, direction) => Some(direction * slope.motors.velocity[axis]),
            Self::Teeth(axis, _) => Some(twist(slope, axis)),
            Self::AxisBreaks(..) | Self::MotorBreaks(..) | Self::Push(_) => None,
        }
    }

    /// Takes from a part that comes to rest what is left of its velocity.
    fn happen(&self, state: &mut MachineState) {
        match *self {
            Self::Axis(axis, _) => state.axes.velocity[axis] = 0.0,
            Self::Motor(axis, _) => state.motors.velocity[axis] = 0.0,
            _ => {}
        }
    }
}

/// Lead of the motor of `axis` over the axis.
fn twist(state: &MachineState, axis: usize) -> f64 {
    state.motors.position[axis] - state.axes.position[axis]
}

/// Loaded side of the teeth of `axis`, and its push.
fn push(trains: &[Train; MAX_AXES], state: &MachineState, axis: usize) -> (f64, f64) {
    let elastic = trains.get(axis).and_then(|train| train.elastic.as_ref());
    let rate = state.motors.velocity[axis] - state.axes.velocity[axis];
    elastic.map_or((0.0, 0.0), |elastic| elastic.transmission.push(twist(state, axis), rate))
}

impl<M: Motors + ?Sized> Step<'_, M> {
    /// Shortens the part of the step from `from` that ends at `arrival` to its first stop; returns the place of the
    /// stop.
    pub(super) fn stop(
        &mut self,
        state: &MachineState,
        settled: &Settled,
        arrival: &mut Arrival,
        from: f64,
    ) -> Option<f64> {
        let (mut until, mut known) = (1.0, None);
        // Another one may have happened before what seemed to be the first.
        for _ in 0..MAX_AXES {
            let first = self.first_stop(state, settled, arrival, (until - from, known));
            let Some((stop, part)) = first else { break };
            let guess = from + part * (until - from);
            until = self.find(&stop, (state, settled), arrival, [from, guess, until])?;
            known = Some(stop);
        }
        if let Some(stop) = known {
            stop.happen(&mut arrival.state);
        }
        Some(until)
    }

    /// Finds the `stop` between `from` and `until`, first at `guess`, and ends `arrival` there.
    fn find(
        &mut self,
        stop: &Stop,
        (state, settled): (&MachineState, &Settled),
        arrival: &mut Arrival,
        [from, guess, until]: [f64; 3],
    ) -> Option<f64> {
        let trains = self.trains;
        // What has no sign yet is above 0.
        let before = stop.value(trains, state, &settled.holding) + 0.0;
        let after = stop.value(trains, &arrival.state, &arrival.holding);
        let (mut early, mut late) = (from, until);
        let (mut end, mut last) = (guess, (until, after));
        if before.abs() < after.abs() {
            last = (from, before);
        }
        for _ in 0..MOST_ENDS {
            *arrival = self.take(state, settled, from, end)?;
            let value = stop.value(trains, &arrival.state, &arrival.holding);
            if value.abs() <= NOUGHT {
                break;
            }
            if value.is_sign_negative() == before.is_sign_negative() {
                early = end;
            } else {
                late = end;
            }
            let mut next = end - value * (end - last.0) / (value - last.1);
            if (next - end).abs() <= THERE {
                break;
            }
            if !(next > early && next < late) {
                next = 0.5 * (early + late);
            }
            last = (end, value);
            end = next;
        }
        Some(arrival.until)
    }

    /// First stop between `state` and `arrival`, `part` of the step apart, and its place between them; not `known`.
    fn first_stop(
        &self,
        state: &MachineState,
        settled: &Settled,
        arrival: &Arrival,
        (part, known): (f64, Option<Stop>),
    ) -> Option<(Stop, f64)> {
        let mut first: Option<(Stop, f64)> = None;
        let mut consider = |stop: Stop| {
            let before = stop.value(self.trains, state, &settled.holding);
            let after = stop.value(self.trains, &arrival.state, &arrival.holding);
            if known == Some(stop) || !stop.happens(before, after) {
                return;
            }
            let rate = stop.rate(&arrival.first);
            let straight = before / (before - after);
            let part = rate.map_or(straight, |rate| crossing(before, after, rate * part * self.dt));
            if first.is_none_or(|(_, earliest)| part < earliest) {
                first = Some((stop, part));
            }
        };
        let trains = self.trains.iter().zip(settled.dry.axes.iter().zip(&settled.dry.motors));
        for (axis, (train, (dry, dry_motor))) in trains.enumerate().take(self.axes) {
            match dry {
                DryFriction::None => {}
                DryFriction::Slides(direction) => consider(Stop::Axis(axis, *direction)),
                DryFriction::Sticks => consider(Stop::AxisBreaks(axis, train.friction.dry(0.0))),
            }
            let Some(Elastic { transmission, friction, .. }) = &train.elastic else { continue };
            match dry_motor {
                DryFriction::None => {}
                DryFriction::Slides(direction) => consider(Stop::Motor(axis, *direction)),
                DryFriction::Sticks => consider(Stop::MotorBreaks(axis, friction.dry(0.0))),
            }
            if transmission.backlash <= 0.0 {
                continue;
            }
            let [before, after] = [state, &arrival.state].map(|state| twist(state, axis));
            for edge in transmission.edges_between(before, after) {
                consider(Stop::Teeth(axis, edge));
            }
            if transmission.is_wound(before) && before * after > 0.0 {
                consider(Stop::Push(axis));
            }
        }
        first
    }
}

/// Root, as a part of the way, of the parabola from `before` to `after`, on the other side of 0, that begins with `slope`.
fn crossing(before: f64, after: f64, slope: f64) -> f64 {
    let side = -after.signum();
    let bend = after - before - slope;
    let root = side * (slope * slope - 4.0 * bend * before).sqrt();
    // The same root either way: the one without a difference of like numbers.
    let part = if slope * side > 0.0 {
        (-slope - root) / (2.0 * bend)
    } else {
        -2.0 * before / (slope - root)
    };
    if (0.0..=1.0).contains(&part) { part } else { before / (before - after) }
}

#[cfg(test)]
mod tests {
    use super::crossing;

    /// Of parabolas whose roots are known, from either side; one begins at a root that is not meant, and one is a straight line.
    #[test]
    fn parabolas_cross() {
        for (before, slope, bend, root) in [
            (1.0, -3.0, 2.0 - 1e-9, 0.5),
            (0.75, -0.5, -2.0, 0.5),
            (0.0, 1.0, -2.0, 0.5),
            (0.5, 0.5, -4.0, (0.5 + f64::sqrt(8.25)) / 8.0),
            (1.0, -4.0, 0.0, 0.25),
        ] {
            let after: f64 = before + slope + bend;
            for side in [1.0, -1.0] {
                let found = crossing(side * before, side * after, side * slope);
                assert!((found - root).abs() < 1e-8, "{found} is not {root}");
            }
        }
        // A slope that belongs to no such parabola is not trusted.
        assert!((crossing(1.0, -1.0, f64::INFINITY) - 0.5).abs() < 1e-15);
    }
}
