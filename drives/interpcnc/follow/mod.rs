//! Following a plan with independent moves that are retargeted (command 80).
//!
//! The board knows no set-points, only "go to a target at a speed". A plan is followed by giving each axis, again and
//! again, a target farther along the plan and the speed that brings it to where the plan will be one round later. Two
//! things make that accurate at 10 ms per exchange:
//!
//! * The driver keeps a model of each axis, moved by the board's own kind of profile ([`super::ramp`]) from the instants
//!   at which commands were executed, and corrected by what samples show. It tells where the axis will be when the
//!   next command reaches it.
//! * Of a few commands that make sense (cruise with one of several ramps, stand on the next point of rest, turn),
//!   the one whose modelled motion stays nearest to the plan is sent; none if the present one does as well.
//!
//! A target is always a position that the plan reaches within its horizon, at most its next turning point: if no
//! command follows, the axis stands there. It is far enough ahead that the axis does not brake for it before the next
//! command is due.

mod chance;
#[cfg(test)]
mod tests;
mod window;

use chance::{COMPARED, Chance};
use window::Window;

use super::{
    AxisOptions, Line, MoveProfile,
    ramp::{Motion, Ramp, State, nanoseconds, seconds},
};
use crate::SetpointStream;

/// An axis is left alone while its present move stays this near to the plan, increments: what rounding makes.
const TOLERANCE: f64 = 0.6;
/// Samples move the model by this part of the difference: their time stamps are uncertain by a millisecond or two,
/// which at speed is more than the model errs between two samples.
const SAMPLE_GAIN: f64 = 0.3;
/// A difference that lasts longer than the uncertainty of time stamps explains is an axis that does not do as
/// modelled: then the sample is right, s.
const STAMP_UNCERTAINTY: f64 = 0.05;
/// Weight of an exchange in the running means.
const MEAN_GAIN: f64 = 0.2;

/// What the driver believes about one axis.
#[derive(Clone, Copy, Debug)]
struct Tracked {
    options: AxisOptions,
    motion: Motion,
    ramp: Ramp,
}

/// A command for an axis, computed for the instant at which it will probably be executed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::interpcnc) struct Order {
    /// Index of the axis among those in use.
    pub(in crate::interpcnc) axis: usize,
    /// What to send.
    pub(in crate::interpcnc) profile: MoveProfile,
}

/// Follows a plan; speaks to nobody.
#[derive(Clone, Debug)]
pub(in crate::interpcnc) struct Follower {
    axes: Vec<Tracked>,
    window: Window,
    /// Running mean of the duration of an exchange, silence before it included, s.
    exchange: f64,
    /// Running mean of the time from the decision for a command to its execution, s.
    lead: f64,
    /// Whether the models have been started from a sample.
    started: bool,
}

impl Follower {
    pub(in crate::interpcnc) fn new(axes: &[AxisOptions], line: Line) -> Self {
        let ramp = |options: &AxisOptions| Ramp {
            start_stop: f64::from(options.start_stop_hz),
            acceleration: 1e3 * f64::from(options.acceleration_khz_per_s),
            speed: f64::from(options.max_speed_hz),
            deceleration: 1e3 * f64::from(options.deceleration_khz_per_s),
            target: 0.0,
        };
        let tracked = |options: &AxisOptions| Tracked {
            options: *options,
            motion: Motion::at_rest(0.0),
            ramp: ramp(options),
        };
        // Request 27 bytes, answer 8, two silences; 2 ms for the board until it is known better.
        let silence = line.silence().as_secs_f64();
        Self {
            axes: axes.iter().map(tracked).collect(),
            window: Window::default(),
            exchange: line.duration(35).as_secs_f64() + 2.0 * silence + 0.002,
            lead: line.duration(27).as_secs_f64() + 2.0 * silence,
            started: false,
        }
    }

    /// Forgets where the axes are: something else than [`Self::order`] has moved or stopped them.
    pub(in crate::interpcnc) fn restart(&mut self) {
        self.started = false;
    }

    /// Looks at the plan and names the axes that need a command.
    pub(in crate::interpcnc) fn survey(&mut self, stream: &dyn SetpointStream) -> Vec<usize> {
        self.window = Window::look(stream, self.axes.len());
        if !self.started {
            return Vec::new();
        }
        // An axis left alone now gets its next command a round of all axes later at worst.
        let round = self.round(self.axes.len());
        let executed_ns = self.window.start_ns + nanoseconds(self.lead);
        let needs = |(index, axis): &(usize, &Tracked)| {
            let plan = self.window.axis(*index);
            COMPARED.iter().any(|part| {
                let time_ns = executed_ns + nanoseconds(part * round);
                (axis.motion.at(time_ns).position - plan.at(time_ns).position).abs() > TOLERANCE
            })
        };
        self.axes.iter().enumerate().filter(needs).map(|(index, _)| index).collect()
    }

    /// The command for an axis, decided at `now_ns` in a round of `round` commands; none if no command makes it
    /// better than it is.
    pub(in crate::interpcnc) fn order(
        &self,
        index: usize,
        round: usize,
        now_ns: i64,
    ) -> Option<Order> {
        let axis = self.axes.get(index)?;
        let plan = self.window.axis(index);
        let chance = Chance {
            axis,
            plan,
            executed_ns: now_ns + nanoseconds(self.lead),
            round: self.round(round),
        };
        let mut best = (chance.cost(&axis.motion), None);
        for profile in chance.candidates() {
            let cost = chance.cost(&chance.motion(&profile));
            if cost < best.0 {
                best = (cost, Some(profile));
            }
        }
        best.1.map(|profile| Order { axis: index, profile })
    }

    /// The board has accepted an order, decided at `decided_ns`, and executed it at `executed_ns`.
    pub(in crate::interpcnc) fn executed(
        &mut self,
        order: &Order,
        decided_ns: i64,
        executed_ns: i64,
        answered_ns: i64,
    ) {
        self.exchange += MEAN_GAIN * (seconds(answered_ns - decided_ns) - self.exchange);
        self.lead += MEAN_GAIN * (seconds(executed_ns - decided_ns) - self.lead);
        if let Some(axis) = self.axes.get_mut(order.axis) {
            axis.ramp = ramp_of(&order.profile);
            axis.motion = Motion::plan(executed_ns, axis.motion.at(executed_ns), &axis.ramp);
        }
    }

    /// The board has shown its counters and which axes move, as they were at `time_ns`.
    pub(in crate::interpcnc) fn sampled(
        &mut self,
        time_ns: i64,
        counters: impl Iterator<Item = (i32, bool)>,
    ) {
        for (axis, (counter, moving)) in self.axes.iter_mut().zip(counters) {
            let counter = f64::from(counter);
            let model = axis.motion.at(time_ns);
            let difference = counter - model.position;
            let explained = model.velocity.abs() * STAMP_UNCERTAINTY + 2.0;
            if !self.started || !moving && !axis.motion.moving(time_ns) {
                axis.motion = Motion::at_rest(counter);
            } else if difference.abs() > explained {
                let velocity = if moving { model.velocity } else { 0.0 };
                let state = State { position: counter, velocity };
                axis.motion = if moving {
                    Motion::plan(time_ns, state, &axis.ramp)
                } else {
                    Motion::at_rest(counter)
                };
            } else if difference.abs() > 0.5 {
                let state = State { position: model.position + SAMPLE_GAIN * difference, ..model };
                axis.motion = Motion::plan(time_ns, state, &axis.ramp);
            }
        }
        self.started = true;
    }

    /// Duration of a round of so many commands and a sample, s.
    fn round(&self, commands: usize) -> f64 {
        let exchanges = u32::try_from(commands + 1).unwrap_or(u32::MAX);
        self.exchange * f64::from(exchanges)
    }
}

fn ramp_of(profile: &MoveProfile) -> Ramp {
    Ramp {
        start_stop: f64::from(profile.start_stop_hz),
        acceleration: 1e3 * f64::from(profile.acceleration_khz_per_s),
        speed: f64::from(profile.speed_hz),
        deceleration: 1e3 * f64::from(profile.deceleration_khz_per_s),
        target: f64::from(profile.target),
    }
}
