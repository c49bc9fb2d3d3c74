//! Following a plan with independent moves that are retargeted (command 80).
//!
//! The board knows no set-points, only "go to a target at a speed". A plan is followed by giving each axis, again and
//! again, a target farther along the plan and the speed that brings it to where the plan will be one round later. Two
//! things make that accurate at 10 ms per exchange:
//!
//! * The driver keeps a model of each axis, moved by the board's own kind of profile ([`crate::ramp`]) from the instants
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

use super::{AxisOptions, Line, MoveProfile, Stamp};
use crate::{
    SetpointStream,
    ramp::{Motion, Ramp, State, nanoseconds, seconds},
};

/// An axis is left alone while its present move stays this near to the plan, increments: what rounding makes.
const TOLERANCE: f64 = 0.6;
/// Weight of an exchange in the running means.
const MEAN_GAIN: f64 = 0.2;
/// A duration counts as at most so many times the mean: one exchange that something else delayed says little.
const MEAN_LIMIT: f64 = 2.0;
/// What a model may have strayed between two samples, as a part of what a usual time stamp is uncertain by: samples
/// come with that uncertainty times the speed, and between them the model errs less.
const STRAYING: f64 = 0.36;
/// The same for whole steps and rounded speeds, increments².
const STRAYING_V2: f64 = 0.05;
/// Variance of a counter, which shows whole steps, increments².
const STEP_V2: f64 = 0.1;
/// A difference beyond so many times what is explained is an axis that does not do as modelled: the sample is right.
const DOUBT: f64 = 5.0;

/// A mean of durations, s.
#[derive(Clone, Copy, Debug)]
struct Mean(f64);

impl Mean {
    fn add(&mut self, value: f64) {
        self.0 += MEAN_GAIN * (value.clamp(0.0, MEAN_LIMIT * self.0) - self.0);
    }
}

/// What the driver believes about one axis.
#[derive(Clone, Copy, Debug)]
struct Tracked {
    options: AxisOptions,
    motion: Motion,
    ramp: Ramp,
    /// Variance of the modelled position, increments².
    variance: f64,
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
    /// Duration of an exchange, silence before it included.
    exchange: Mean,
    /// Time from the decision for a command to its execution.
    lead: Mean,
    /// Uncertainty of a time stamp.
    uncertainty: Mean,
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
            variance: 0.0,
            ramp: ramp(options),
        };
        // Request 27 bytes, answer 8, two silences; 2 ms for the board until it is known better.
        let silence = line.silence().as_secs_f64();
        Self {
            axes: axes.iter().map(tracked).collect(),
            window: Window::default(),
            exchange: Mean(line.duration(35).as_secs_f64() + 2.0 * silence + 0.002),
            lead: Mean(line.duration(27).as_secs_f64() + 2.0 * silence),
            uncertainty: Mean(0.5 * silence + 0.001),
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
        let executed_ns = self.window.start_ns + nanoseconds(self.lead.0);
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
            executed_ns: now_ns + nanoseconds(self.lead.0),
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

    /// The board has accepted an order that was decided at `decided_ns`.
    pub(in crate::interpcnc) fn executed(&mut self, order: &Order, decided_ns: i64, stamp: &Stamp) {
        let executed_ns = stamp.executed_ns;
        self.exchange.add(seconds(stamp.answered_ns - decided_ns));
        self.lead.add(seconds(executed_ns - decided_ns));
        self.uncertainty.add(seconds(stamp.uncertainty_ns));
        if let Some(axis) = self.axes.get_mut(order.axis) {
            let before = axis.motion.at(executed_ns);
            axis.ramp = ramp_of(&order.profile);
            axis.motion = Motion::plan(executed_ns, before, &axis.ramp);
            // Had it been executed earlier or later, it would have been at the other speed for that long.
            let after = axis.motion.at(stamp.answered_ns).velocity;
            axis.variance += ((after - before.velocity) * seconds(stamp.uncertainty_ns)).powi(2);
        }
    }

    /// The board has shown its counters and which axes move. Each model goes towards its counter by the part that
    /// its variance has in the sum of both (a Kalman filter in one dimension).
    pub(in crate::interpcnc) fn sampled(
        &mut self,
        stamp: &Stamp,
        counters: impl Iterator<Item = (i32, bool)>,
    ) {
        let time_ns = stamp.executed_ns;
        self.uncertainty.add(seconds(stamp.uncertainty_ns));
        for (axis, (counter, moving)) in self.axes.iter_mut().zip(counters) {
            let counter = f64::from(counter);
            let model = axis.motion.at(time_ns);
            let speed = model.velocity.abs();
            let modelled =
                axis.variance + (STRAYING * speed * self.uncertainty.0).powi(2) + STRAYING_V2;
            let shown = (speed * seconds(stamp.uncertainty_ns)).powi(2) + STEP_V2;
            let difference = counter - model.position;
            let doubtful = difference.abs() > DOUBT * (modelled + shown).sqrt() + 1.0;
            if !self.started || !moving && (doubtful || !axis.motion.moving(time_ns)) {
                axis.motion = Motion::at_rest(counter);
                axis.variance = 0.0;
            } else if doubtful {
                axis.motion =
                    Motion::plan(time_ns, State { position: counter, ..model }, &axis.ramp);
                axis.variance = shown;
            } else {
                let gain = modelled / (modelled + shown);
                axis.variance = (1.0 - gain) * modelled;
                if difference.abs() > 0.5 {
                    let position = model.position + gain * difference;
                    axis.motion = Motion::plan(time_ns, State { position, ..model }, &axis.ramp);
                }
            }
        }
        self.started = true;
    }

    /// True if the time of a sample is so much less certain than usual that another is worth its time.
    pub(in crate::interpcnc) fn is_poor(&self, stamp: &Stamp) -> bool {
        seconds(stamp.uncertainty_ns) > (3.0 * self.uncertainty.0).max(0.004)
    }

    /// Duration of a round of so many commands and a sample, s.
    fn round(&self, commands: usize) -> f64 {
        let exchanges = u32::try_from(commands + 1).unwrap_or(u32::MAX);
        self.exchange.0 * f64::from(exchanges)
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
