//! Following a plan in simulated time: the driver's follower and the drives' generators, with a bus between them.

use std::time::Duration;

use super::AnswerLength;
use crate::{
    client::AxisOptions,
    drive::follow::{Follower, GoTo, follower},
    emulator::motion::Generator,
    protocol::frame::ANSWER_BYTES,
    protocol::line::wire_time,
};
use twin_drives::ramp::whole_ns;
use twin_drives::{
    IncrementMotion, Prediction, SetpointStream, Stamp, WireRates, follow::Order,
    prediction::SeenAt,
};

/// Bytes of GOTO v,a and of PING.
const GOTO_BYTES: usize = 11;
const PING_BYTES: usize = 7;

/// Delays of an exchange in addition to its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BusDelays {
    /// From the execution of a command to the first byte of its answer; the manual allows 50 ms.
    pub response: Duration,
    /// From an answer to the next command: adapter, operating system, silence.
    pub gap: Duration,
    /// Length of answers.
    pub answers: AnswerLength,
}

impl Default for BusDelays {
    /// 2 ms, as the emulator has it, and 1 ms; four bytes of data.
    fn default() -> Self {
        Self {
            response: Duration::from_millis(2),
            gap: Duration::from_millis(1),
            answers: AnswerLength::Four,
        }
    }
}

impl BusDelays {
    /// Time of the answer to a command of this length on the wire.
    fn answer(&self, command: usize) -> Duration {
        wire_time(match self.answers {
            AnswerLength::Four => ANSWER_BYTES,
            AnswerLength::AsCommand => command + 2,
        })
    }
}

/// An exchange under way.
#[derive(Clone, Copy, Debug)]
struct OnWire {
    axis: usize,
    order: Option<Order<GoTo>>,
    stamp: Stamp,
    /// When the drive really executes it, ns.
    executed_ns: i64,
    /// Counter and whether it moves, once executed.
    shown: Option<(i32, bool)>,
}

/// Up to five drives on one bus that follow a plan in simulated time, one exchange after the other, with the follower
/// of the driver and the generators of the emulated device.
#[derive(Clone, Debug)]
pub struct SmartDrivePrediction {
    axes: Vec<AxisOptions>,
    follower: Follower,
    pub(crate) generators: Vec<Generator>,
    delays: BusDelays,
    /// When the next exchange may begin, ns; none before the first call.
    next_ns: Option<i64>,
    /// Axes of this round that need a command.
    needing: Vec<usize>,
    /// Axis of the next exchange.
    turn: usize,
    on_wire: Option<OnWire>,
    exchanges: u64,
}

impl SmartDrivePrediction {
    /// Drives whose parameters are `axes`; increments are µsteps. At least one axis.
    pub fn new(axes: &[AxisOptions], delays: BusDelays) -> Self {
        Self {
            axes: axes.to_vec(),
            follower: follower(axes, delays.response),
            generators: Vec::new(),
            delays,
            next_ns: None,
            needing: Vec::new(),
            turn: 0,
            on_wire: None,
            exchanges: 0,
        }
    }

    /// The driver decides and sends.
    fn send(&mut self, plan: &dyn SetpointStream, now_ns: i64) -> OnWire {
        let seen = SeenAt { plan, now_ns };
        if self.turn == 0 {
            self.needing = self.follower.survey(&seen);
        }
        let axis = self.turn;
        let order = if self.needing.contains(&axis) {
            self.follower.order(axis, self.axes.len(), now_ns)
        } else {
            None
        };
        let bytes = if order.is_some() { GOTO_BYTES } else { PING_BYTES };
        let executed_ns = now_ns + whole_ns(wire_time(bytes));
        let response_ns = whole_ns(self.delays.response);
        let stamp = Stamp {
            sent_ns: now_ns,
            executed_ns: executed_ns + response_ns / 2,
            uncertainty_ns: response_ns / 2,
            answered_ns: executed_ns + response_ns + whole_ns(self.delays.answer(bytes)),
        };
        OnWire { axis, order, stamp, executed_ns, shown: None }
    }

    /// The drive executes and shows its counter.
    fn execute(&mut self, exchange: &mut OnWire) {
        let now_ns = exchange.executed_ns;
        let Some((generator, options)) =
            self.generators.get_mut(exchange.axis).zip(self.axes.get(exchange.axis))
        else {
            return;
        };
        exchange.shown = Some((generator.counter(now_ns), generator.in_motion(now_ns)));
        if let Some(order) = exchange.order {
            let GoTo { target, speed, rate } = order.profile;
            // There are no position limits here, the only reason to refuse.
            let accepted = generator.go_to(now_ns, &options.ceilings(), target, speed, rate);
            debug_assert!(accepted.is_ok());
        }
    }

    /// The answer is there.
    fn take(&mut self, exchange: &OnWire) {
        self.exchanges += 1;
        if let Some((counter, moving)) = exchange.shown {
            self.follower.sampled_axis(exchange.axis, &exchange.stamp, counter, moving);
        }
        if let Some(order) = &exchange.order {
            self.follower.executed(order, exchange.stamp.sent_ns, &exchange.stamp);
        }
        self.turn = (exchange.axis + 1) % self.axes.len().max(1);
        self.next_ns = Some(exchange.stamp.answered_ns + whole_ns(self.delays.gap));
    }
}

impl Prediction for SmartDrivePrediction {
    fn axis_count(&self) -> usize {
        self.axes.len()
    }

    fn advance(&mut self, plan: &dyn SetpointStream, time_ns: i64) -> IncrementMotion {
        let mut next_ns = self.next_ns.unwrap_or_else(|| {
            let start = plan.at(time_ns).position;
            let stand = |(_, position): (_, &f64)| Generator::at_rest(position.round());
            self.generators = self.axes.iter().zip(&start).map(stand).collect();
            time_ns
        });
        self.next_ns = Some(next_ns);
        while !self.axes.is_empty() {
            let Some(mut exchange) = self.on_wire.take() else {
                if next_ns > time_ns {
                    break;
                }
                self.on_wire = Some(self.send(plan, next_ns));
                continue;
            };
            if exchange.shown.is_none() && exchange.executed_ns <= time_ns {
                self.execute(&mut exchange);
            }
            if exchange.stamp.answered_ns > time_ns {
                self.on_wire = Some(exchange);
                break;
            }
            self.take(&exchange);
            next_ns = self.next_ns.unwrap_or(next_ns);
        }
        let states = self.generators.iter().map(|generator| generator.state(time_ns));
        IncrementMotion::of(states.map(|state| (state.position, state.velocity)))
    }

    fn exchanges(&self) -> u64 {
        self.exchanges
    }

    /// Every answer to a command is a sample of its axis.
    fn rates(&self) -> WireRates {
        let exchange =
            wire_time(GOTO_BYTES) + self.delays.response + self.delays.answer(GOTO_BYTES);
        let exchange = (exchange + self.delays.gap).as_secs_f64();
        let axes = u32::try_from(self.axes.len()).unwrap_or(u32::MAX);
        WireRates::of_rounds(self.axes.len(), f64::from(axes) * exchange)
    }

    fn copied(&self) -> Box<dyn Prediction> {
        Box::new(self.clone())
    }
}
