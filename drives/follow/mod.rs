//! Following a plan with moves that are retargeted in flight.
//!
//! Devices that know no set-points, only "go to a target at a speed" (InterpCNC command 80, SmartDRIVE GOTO), follow a
//! plan by being given for each axis, again and again, a target farther along the plan and the speed that brings it to
//! where the plan will be one round later. Two things make that accurate at 10 ms per exchange:
//!
//! * The driver keeps a model of each axis, moved by the device's own kind of profile ([`crate::ramp`]) from the
//!   instants at which commands were executed, and corrected by what samples show. It gives the position of the axis
//!   when the next command reaches it.
//! * Of a few commands that make sense (cruise with one of several ramps, stand on the next point of rest, turn),
//!   the one whose modelled motion stays nearest to the plan is sent; none if the present one does as well.
//!
//! A target is always a position that the plan reaches within its horizon, at most its next turning point: if no
//! command follows, the axis rests there. It is far enough ahead that the axis does not brake for it before the next
//! command is due.
//!
//! An axis that has been left behind (an answer was lost, the axis was held) comes back at no more than three times
//! the speed of the plan around it (or a twentieth of what it can, where that is more), and never so fast that it could
//! not stop where the plan rests or turns: nobody has agreed to an axis that catches up as fast as it can.
//!
//! What the registers of a family can say, its [`Registers`] tell: which speeds and rates there are, and whether
//! acceleration and deceleration are one number.

mod candidates;
mod window;

use std::fmt::Debug;

use candidates::{COMPARED, Candidates};
use window::Window;

use crate::{
    SetpointStream, Stamp,
    ramp::{Motion, Ramp, State, nanoseconds, seconds},
};

/// An axis is left alone while its present move stays this near to the plan, increments: what rounding makes.
pub const TOLERANCE: f64 = 0.6;
/// Weight of an exchange in the running means.
const MEAN_GAIN: f64 = 0.2;
/// A duration counts as at most this multiple of the mean: one exchange that something else delayed says little.
const MEAN_LIMIT: f64 = 2.0;
/// What a model may have strayed between two samples, as a part of what a usual time stamp is uncertain by: samples
/// come with that uncertainty times the speed, and between them the model errs less.
const STRAYING: f64 = 0.36;
/// The same for whole steps and rounded speeds, increments².
const STRAYING_V2: f64 = 0.05;
/// Variance of a counter, which shows whole steps, increments².
const STEP_V2: f64 = 0.1;
/// A difference beyond this multiple of the explained one is an axis that does not move as modelled: the sample is right.
const DOUBT: f64 = 5.0;
/// Samples in a row at the same place, and the way that the axis should have gone meanwhile, increments: both together are not an accident.
const STUCK_SAMPLES: u32 = 12;
const STUCK_WAY: f64 = 50.0;
/// Commands in a row without effect that are not an accident.
const MOST_VAIN: u32 = 2;
/// How fast an axis may come back to its plan: in parts of the plan's own speed, which counts for a while behind it, s,
/// and at least, in parts of what the axis can.
const CATCH_UP: f64 = 3.0;
const CATCH_UP_FADES_S: f64 = 1.0;
const CATCH_UP_LEAST: f64 = 0.05;
/// What the model of an axis that rests may move between two samples, increments.
const STUCK_STEP: f64 = 2.0;

/// Resolution of the registers of one axis of a device for a move.
pub trait Registers: Copy + Debug {
    /// A move as it goes to the device.
    type Move: Copy + Debug + PartialEq;

    /// Whether one number is acceleration and deceleration.
    const ONE_RATE: bool;

    /// Start/stop speed and the largest speed, acceleration and deceleration; the target does not count.
    fn limits(&self) -> Ramp;

    /// Distance between two speeds the registers can say, steps/s.
    fn speed_step(&self) -> f64;

    /// A speed the registers can say, near `speed`, steps/s.
    fn whole_speed(&self, speed: f64) -> f64;

    /// A rate the registers can say, at least as steep as wanted and at most `most`, steps/s².
    fn whole_rate(&self, rate: f64, most: f64) -> f64;

    /// The move nearest to what is wanted, within the limits.
    fn encode(&self, wanted: &Ramp) -> Self::Move;

    /// Ramp that the device makes of a move.
    fn ramp(&self, order: &Self::Move) -> Ramp;
}

/// Expected times of exchanges until some have been measured, s.
#[derive(Clone, Copy, Debug)]
pub struct Timing {
    /// From the decision for a command to its answer.
    pub exchange: f64,
    /// From the decision for a command to its execution.
    pub lead: f64,
    /// Uncertainty of a time stamp.
    pub uncertainty: f64,
    /// Exchanges of a round besides its commands: 1 where samples are asked for, 0 where every answer is one.
    pub samples: usize,
}

/// A mean of durations, s.
#[derive(Clone, Copy, Debug)]
struct Mean(f64);

impl Mean {
    fn add(&mut self, value: f64) {
        self.0 += MEAN_GAIN * (value.clamp(0.0, MEAN_LIMIT * self.0) - self.0);
    }
}

/// How long samples have shown an axis at the same place.
#[derive(Clone, Copy, Debug, Default)]
struct Stuck {
    counter: f64,
    /// Samples in a row that have shown it.
    samples: u32,
    /// How far the axis should have gone meanwhile, increments.
    way: f64,
    /// Where it should have been at the last of them.
    expected: f64,
    /// Instant of the last of them, ns.
    time_ns: i64,
}

impl Stuck {
    /// Another sample, at which the axis should have gone so far since the one before.
    fn sampled(&mut self, started: bool, counter: f64, expected: f64, way: f64) {
        #[expect(clippy::float_cmp, reason = "whole numbers")]
        let same = started && counter == self.counter && way > STUCK_STEP;
        (self.samples, self.way) = if same { (self.samples + 1, self.way + way) } else { (0, 0.0) };
        (self.counter, self.expected) = (counter, expected);
    }
}

/// What the driver believes about one axis.
#[derive(Clone, Copy, Debug)]
struct Tracked<R> {
    registers: R,
    motion: Motion,
    ramp: Ramp,
    /// Variance of the modelled position, increments².
    variance: f64,
    /// Whether the model has been started from a sample.
    started: bool,
    /// Samples in a row that show it at the same place.
    stuck: Stuck,
    /// A command has been executed since the axis was seen to move.
    commanded: bool,
    /// Commands in a row after which the axis was seen at rest where it was before.
    vain: u32,
    /// The plan's largest speed ahead and of late, steps/s.
    pace: f64,
}

/// A command for an axis, computed for the instant at which it will probably be executed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order<M> {
    /// Index of the axis among those in use.
    pub axis: usize,
    /// Move to send.
    pub profile: M,
}

/// Follows a plan; speaks to nobody.
#[derive(Clone, Debug)]
pub struct Follower<R> {
    axes: Vec<Tracked<R>>,
    window: Window,
    /// Duration of an exchange, silence before it included.
    exchange: Mean,
    /// Time from the decision for a command to its execution.
    lead: Mean,
    /// Uncertainty of a time stamp.
    uncertainty: Mean,
    /// Exchanges of a round besides its commands.
    samples: usize,
}

impl<R: Registers> Follower<R> {
    /// A follower of axes at rest at 0, until the first sample, on a wire with this timing.
    pub fn new(axes: &[R], timing: &Timing) -> Self {
        let tracked = |registers: &R| Tracked {
            registers: *registers,
            motion: Motion::at_rest(0.0),
            ramp: registers.limits(),
            variance: 0.0,
            started: false,
            stuck: Stuck::default(),
            commanded: false,
            vain: 0,
            pace: 0.0,
        };
        Self {
            axes: axes.iter().map(tracked).collect(),
            window: Window::default(),
            exchange: Mean(timing.exchange),
            lead: Mean(timing.lead),
            uncertainty: Mean(timing.uncertainty),
            samples: timing.samples,
        }
    }

    /// Forgets where the axes are: something else than [`Self::order`] has moved or stopped them.
    pub fn restart(&mut self) {
        for axis in &mut self.axes {
            axis.started = false;
            axis.stuck = Stuck::default();
            (axis.commanded, axis.vain) = (false, 0);
        }
    }

    /// An axis that samples have shown at the same place for long although its commands move it, and where they should
    /// have brought it: its status is stuck.
    pub fn astray(&self) -> Option<(usize, f64)> {
        let astray =
            |axis: &Tracked<R>| axis.stuck.samples >= STUCK_SAMPLES && axis.stuck.way > STUCK_WAY;
        let index = self.axes.iter().position(astray)?;
        self.axes.get(index).map(|axis| (index, axis.stuck.expected))
    }

    /// An axis that rests although two commands in a row were to move it, each confirmed: the second one repeated the first.
    pub fn idle(&self) -> Option<usize> {
        self.axes.iter().position(|axis| axis.vain >= MOST_VAIN)
    }

    /// Looks at the plan and names the axes that need a command.
    pub fn survey(&mut self, stream: &dyn SetpointStream) -> Vec<usize> {
        let before_ns = self.window.start_ns;
        self.window = Window::look(stream, self.axes.len());
        let faded = (-seconds(self.window.start_ns - before_ns).max(0.0) / CATCH_UP_FADES_S).exp();
        for (index, axis) in self.axes.iter_mut().enumerate() {
            axis.pace = self.window.axis(index).fastest().max(axis.pace * faded);
        }
        // An axis left alone now gets its next command a round of all axes later at worst.
        let round = self.round(self.axes.len());
        let executed_ns = self.window.start_ns + nanoseconds(self.lead.0);
        let needs = |(index, axis): &(usize, &Tracked<R>)| {
            let plan = self.window.axis(*index);
            axis.started
                && COMPARED.iter().any(|part| {
                    let time_ns = executed_ns + nanoseconds(part * round);
                    (axis.motion.at(time_ns).position - plan.at(time_ns).position).abs() > TOLERANCE
                })
        };
        self.axes.iter().enumerate().filter(needs).map(|(index, _)| index).collect()
    }

    /// The command for an axis, decided at `now_ns` in a round of `round` commands; none if no command makes it
    /// better than it is.
    pub fn order(&self, index: usize, round: usize, now_ns: i64) -> Option<Order<R::Move>> {
        let axis = self.axes.get(index).filter(|axis| axis.started)?;
        let plan = self.window.axis(index);
        let candidates = Candidates {
            axis,
            plan,
            executed_ns: now_ns + nanoseconds(self.lead.0),
            round: self.round(round),
        };
        let mut best = (candidates.cost(&axis.motion), None);
        for profile in candidates.profiles() {
            let cost = candidates.cost(&candidates.motion(&profile));
            if cost < best.0 {
                best = (cost, Some(profile));
            }
        }
        best.1.map(|profile| Order { axis: index, profile })
    }

    /// The device has accepted an order that was decided at `decided_ns`.
    pub fn executed(&mut self, order: &Order<R::Move>, decided_ns: i64, stamp: &Stamp) {
        let executed_ns = stamp.executed_ns;
        self.exchange.add(seconds(stamp.answered_ns - decided_ns));
        self.lead.add(seconds(executed_ns - decided_ns));
        self.uncertainty.add(seconds(stamp.uncertainty_ns));
        if let Some(axis) = self.axes.get_mut(order.axis) {
            let before = axis.motion.at(executed_ns);
            axis.commanded = true;
            axis.ramp = axis.registers.ramp(&order.profile);
            axis.motion = Motion::plan(executed_ns, before, &axis.ramp);
            // Had it been executed earlier or later, it would have been at the other speed for that long.
            let after = axis.motion.at(stamp.answered_ns).velocity;
            axis.variance += ((after - before.velocity) * seconds(stamp.uncertainty_ns)).powi(2);
        }
    }

    /// The device has shown the counters of all axes and which of them move.
    pub fn sampled(&mut self, stamp: &Stamp, counters: impl Iterator<Item = (i32, bool)>) {
        self.uncertainty.add(seconds(stamp.uncertainty_ns));
        for (axis, (counter, moving)) in self.axes.iter_mut().zip(counters) {
            axis.sampled(stamp, self.uncertainty.0, counter, moving);
        }
    }

    /// The device has shown the counter of one axis and whether it moves.
    pub fn sampled_axis(&mut self, index: usize, stamp: &Stamp, counter: i32, moving: bool) {
        self.uncertainty.add(seconds(stamp.uncertainty_ns));
        if let Some(axis) = self.axes.get_mut(index) {
            axis.sampled(stamp, self.uncertainty.0, counter, moving);
        }
    }

    /// Way of an axis from one instant to another, as modelled; 0 if nothing is known of it.
    pub fn moved(&self, index: usize, from_ns: i64, to_ns: i64) -> f64 {
        self.axes
            .get(index)
            .filter(|axis| axis.started)
            .map_or(0.0, |axis| axis.motion.at(to_ns).position - axis.motion.at(from_ns).position)
    }

    /// True if the time of a sample is so much less certain than usual that another is worth its time.
    pub fn is_poor(&self, stamp: &Stamp) -> bool {
        seconds(stamp.uncertainty_ns) > (3.0 * self.uncertainty.0).max(0.004)
    }

    /// Duration of a round of `commands` commands and a sample, s.
    fn round(&self, commands: usize) -> f64 {
        let exchanges = u32::try_from(commands + self.samples).unwrap_or(u32::MAX);
        self.exchange.0 * f64::from(exchanges)
    }
}

impl<R: Registers> Tracked<R> {
    /// How fast it may go, steps/s.
    fn most_speed(&self) -> f64 {
        let limits = self.registers.limits();
        let least = limits.start_stop.max(CATCH_UP_LEAST * limits.speed);
        (CATCH_UP * self.pace).max(least).min(limits.speed)
    }

    /// The model goes towards a counter by the part that its variance has in the sum of both (a Kalman filter in one
    /// dimension). `usual` is the uncertainty of a usual time stamp, s.
    fn sampled(&mut self, stamp: &Stamp, usual: f64, counter: i32, moving: bool) {
        let time_ns = stamp.executed_ns;
        let counter = f64::from(counter);
        let model = self.motion.at(time_ns);
        let speed = model.velocity.abs();
        let modelled = self.variance + (STRAYING * speed * usual).powi(2) + STRAYING_V2;
        let shown = (speed * seconds(stamp.uncertainty_ns)).powi(2) + STEP_V2;
        let difference = counter - model.position;
        let doubtful = difference.abs() > DOUBT * (modelled + shown).sqrt() + 1.0;
        let still = self.started && !moving && (counter - self.stuck.counter).abs() < 0.5;
        if !still {
            (self.commanded, self.vain) = (false, 0);
        } else if doubtful && std::mem::take(&mut self.commanded) {
            self.vain += 1;
        }
        self.stuck.sampled(self.started, counter, model.position, {
            let since = self.motion.at(self.stuck.time_ns).position;
            (model.position - since).abs()
        });
        self.stuck.time_ns = time_ns;
        if !self.started || !moving && (doubtful || !self.motion.moving(time_ns)) {
            self.motion = Motion::at_rest(counter);
            self.variance = 0.0;
        } else if doubtful {
            self.motion = Motion::plan(time_ns, State { position: counter, ..model }, &self.ramp);
            self.variance = shown;
        } else {
            let gain = modelled / (modelled + shown);
            self.variance = (1.0 - gain) * modelled;
            if difference.abs() > 0.5 {
                let position = model.position + gain * difference;
                self.motion = Motion::plan(time_ns, State { position, ..model }, &self.ramp);
            }
        }
        self.started = true;
    }
}
