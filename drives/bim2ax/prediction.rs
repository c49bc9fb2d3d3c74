//! A module that follows a plan in simulated time.

use super::{AXES, AxisSettings, Bench};
use crate::{
    drive::follow::{Follower, Leg, Timing},
    emulator::axis::{Axis, AxisOrder, saturated, whole},
    protocol::bits::{bloc, coefficient, uc},
};
use twin_drives::{
    IncrementMotion, Prediction, SetpointStream, WireRates, prediction::SeenAt, ramp::seconds,
};

/// Settings of a prediction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PredictionOptions {
    /// The axes in use, one or two.
    pub axes: Vec<AxisSettings>,
    /// From the decision for an order to the begin of its motion, ns. The manual promises at most 10 ms.
    pub order_ns: i64,
    /// Duration of a look at positions and messages, ns. The manual asks to wait 1 ms at least.
    pub read_ns: i64,
    /// Time between two looks while an axis moves, ns. Every look interrupts the module for 300 µs.
    pub look_every_ns: i64,
}

impl PredictionOptions {
    /// The longest latency the manual allows (10 ms), 1 ms a look, 200 looks a second.
    pub fn new(axes: Vec<AxisSettings>) -> Self {
        Self { axes, order_ns: 10_000_000, read_ns: 1_000_000, look_every_ns: 5_000_000 }
    }
}

/// What the driver is about to do.
#[derive(Clone, Copy, Debug)]
enum Next {
    /// It looks at the module; the answer is there at this instant.
    Look,
    /// The module carries out this order.
    Order(Leg),
}

/// The driver's decisions and the module's profiles, without memory between them.
#[derive(Clone, Debug)]
pub struct Bim2AxPrediction {
    options: PredictionOptions,
    follower: Follower,
    axes: Vec<Axis>,
    next: Next,
    next_ns: i64,
    leg_end_ns: i64,
    exchanges: u64,
    /// Sum over legs of duration times mean square error that was expected, and of durations.
    expected: (f64, f64),
}

impl Bim2AxPrediction {
    /// A module whose axes are homed, have no end switches and stand where the plan is at the first call. Of more
    /// than two axes the first two are taken; durations count as 1 µs at least.
    pub fn new(options: &PredictionOptions) -> Self {
        let mut options = options.clone();
        options.axes.truncate(AXES);
        for axis in &mut options.axes {
            axis.coefficient |= coefficient::PRESENT | coefficient::IGNORE_SWITCHES;
        }
        options.order_ns = options.order_ns.max(1000);
        options.read_ns = options.read_ns.max(1000);
        options.look_every_ns = options.look_every_ns.max(options.read_ns);
        let timing = Timing { order_ns: options.order_ns, look_ns: options.read_ns };
        Self {
            follower: Follower::new(&options.axes, timing),
            options,
            axes: Vec::new(),
            next: Next::Look,
            next_ns: i64::MIN,
            leg_end_ns: i64::MIN,
            exchanges: 0,
            expected: (0.0, 0.0),
        }
    }

    /// The error that the follower expected of its legs so far, root of the mean square of both axes together over
    /// the time in which it moved them, µsteps.
    pub fn expected_error(&self) -> f64 {
        let (square, duration) = self.expected;
        if duration > 0.0 { (square / duration).sqrt() } else { 0.0 }
    }

    /// The axes are where the plan is.
    fn begin(&mut self, plan: &dyn SetpointStream, time_ns: i64) {
        let positions = plan.at(time_ns).position;
        let stand = |(settings, position): (&AxisSettings, f64)| {
            let position = saturated(whole(position));
            let bench = Bench::default();
            let mut axis = Axis::power_up(time_ns, settings, &bench, 0, position, position);
            axis.set_homed();
            axis
        };
        self.axes = self.options.axes.iter().zip(positions).map(stand).collect();
        self.next_ns = time_ns + self.options.read_ns;
        self.leg_end_ns = time_ns;
    }

    fn act(&mut self, plan: &dyn SetpointStream) {
        let now_ns = self.next_ns;
        self.axes.iter_mut().for_each(|axis| axis.advance(now_ns));
        self.exchanges += 1;
        match self.next {
            Next::Order(leg) => {
                for ((axis, target), speed) in self.axes.iter_mut().zip(leg.targets).zip(leg.speeds)
                {
                    if axis.counter() != target {
                        axis.order(&order(target, speed));
                    }
                }
                self.leg_end_ns = leg.end_ns;
                self.look_later(now_ns);
            }
            Next::Look => {
                let mut position = [0; AXES];
                for (position, axis) in position.iter_mut().zip(&self.axes) {
                    *position = axis.counter();
                }
                let moving = self.axes.iter().any(Axis::moving);
                let leg = if moving {
                    None
                } else {
                    self.follower.leg(&SeenAt { plan, now_ns }, position)
                };
                if let Some(leg) = leg {
                    let until_ns = leg.end_ns + self.options.read_ns + self.options.order_ns;
                    let duration = seconds(until_ns - leg.start_ns);
                    self.expected.0 += leg.error * leg.error * duration;
                    self.expected.1 += duration;
                    self.next = Next::Order(leg);
                    self.next_ns = leg.start_ns;
                } else {
                    self.look_later(now_ns);
                }
            }
        }
    }

    /// The next look begins when the leg is expected to have ended, or when the usual time has passed.
    fn look_later(&mut self, now_ns: i64) {
        let usual_ns = now_ns + self.options.look_every_ns;
        let begin_ns =
            if self.leg_end_ns >= now_ns { usual_ns.min(self.leg_end_ns) } else { usual_ns };
        self.next = Next::Look;
        self.next_ns = begin_ns + self.options.read_ns;
    }
}

/// The order of a leg for one axis: absolute, at its speed, without detour.
pub(super) fn order(target: i32, speed: u16) -> AxisOrder {
    AxisOrder { uc: uc::PROGRAMMED, bloc: FOLLOWING, target, speed }
}

/// Order bloc of a leg.
pub(super) const FOLLOWING: u32 = bloc::PROGRAMMED_SPEED | bloc::WITHOUT_APPROACH;

impl Prediction for Bim2AxPrediction {
    fn axis_count(&self) -> usize {
        self.options.axes.len()
    }

    fn advance(&mut self, plan: &dyn SetpointStream, time_ns: i64) -> IncrementMotion {
        if self.next_ns == i64::MIN {
            self.begin(plan, time_ns);
        }
        while self.next_ns <= time_ns {
            self.act(plan);
        }
        let mut motion = IncrementMotion::default();
        let places = motion.position.iter_mut().zip(&mut motion.velocity);
        for (axis, (position, velocity)) in self.axes.iter_mut().zip(places) {
            axis.advance(time_ns);
            let state = axis.state();
            (*position, *velocity) = (state.position, state.velocity);
        }
        motion
    }

    fn exchanges(&self) -> u64 {
        self.exchanges
    }

    /// An order, which is for both axes, takes its time, and a look shows that its leg has ended; looks while axes move have a
    /// pace of their own.
    fn rates(&self) -> WireRates {
        let PredictionOptions { axes, order_ns, read_ns, look_every_ns } = &self.options;
        let orders = WireRates::of_rounds(axes.len(), seconds(order_ns + read_ns));
        let looks = WireRates::of_rounds(0, seconds(look_every_ns + read_ns));
        WireRates { commands_per_s: orders.commands_per_s, ..looks }
    }

    fn copied(&self) -> Box<dyn Prediction> {
        Box::new(self.clone())
    }
}
