//! The board and its driver in simulated time, without bytes.

mod buffered;
mod predict;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;

use super::{
    EncoderOptions, MoveProfile, Stamp,
    emulator::{Axis, Wire},
};
use crate::{
    client::options::AxisOptions,
    drive::{
        ENCODER_EVERY,
        follow::{Follower, follower},
    },
};
use twin_drives::ramp::{seconds, whole_ns};
use twin_drives::{
    IncrementMotion, Prediction, SetpointStream, WireRates, follow::Order, prediction::SeenAt,
};

pub use predict::{PredictionSummary, board_prediction, predict};

/// Bytes of command 80 and of its answer.
const COMMAND_BYTES: (usize, usize) = (27, 8);
/// Bytes of a question for status and five positions, and of its answer.
const STATE_BYTES: (usize, usize) = (8, 29);

/// Bytes of a question for the position of the encoder, and of its answer.
const ENCODER_BYTES: (usize, usize) = (8, 9);

/// Readings of the encoder of a board while it follows a plan.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Readings {
    /// The place of its axis among those in use; none of a board without.
    place: Option<usize>,
    looks: u32,
    rested: bool,
}

impl Readings {
    pub(super) fn new(axes: &[AxisOptions], encoder: Option<EncoderOptions>) -> Self {
        let place =
            encoder.and_then(|encoder| axes.iter().position(|axis| axis.axis == encoder.axis));
        Self { place, ..Self::default() }
    }

    /// After another look: whether the encoder is read, as the driver decides it.
    fn due(&mut self, moving: impl Fn(usize) -> bool, all_rest: bool) -> bool {
        let Some(place) = self.place else { return false };
        let rests = !moving(place);
        self.looks += 1;
        let due = self.looks >= ENCODER_EVERY || all_rest || rests && !self.rested;
        self.rested = rests;
        if due {
            self.looks = 0;
        }
        due
    }

    /// Time that readings take of a round while axes move, s.
    fn share(&self, wire: &Wire) -> f64 {
        let reading = exchange(wire, 0, ENCODER_BYTES).0.answered_ns;
        self.place.map_or(0.0, |_| seconds(reading) / f64::from(ENCODER_EVERY))
    }
}

/// An InterpCNC board that follows a plan by independent moves that are retargeted (command 80), as its driver lets it
/// in a run: commands for the axes that need one, then a sample, as fast as the wire allows.
#[derive(Clone, Debug)]
pub struct InterpCncPrediction {
    follower: Follower,
    axes: Vec<Axis>,
    wire: Wire,
    /// What happens next, and when.
    next: Next,
    due_ns: i64,
    begun: bool,
    exchanges: u64,
    readings: Readings,
}

/// Next event.
#[derive(Clone, Debug)]
enum Next {
    /// The driver looks at the plan, and begins a round of commands for the axes that need one.
    Survey,
    /// The board executes a command.
    Execute(Sent),
    /// Its answer is there.
    Confirm(Sent),
    /// The board looks at its counters.
    Show(Stamp),
    /// The driver knows them, and which axes moved.
    Sample(Stamp, Vec<(i32, bool)>),
}

/// A command on its way, in a round.
#[derive(Clone, Debug)]
struct Sent {
    order: Order<MoveProfile>,
    decided_ns: i64,
    stamp: Stamp,
    round: Round,
}

/// The axes that are still to be commanded, and the number of those that need it.
#[derive(Clone, Debug)]
struct Round {
    left: VecDeque<usize>,
    of: usize,
}

impl InterpCncPrediction {
    /// A board on `wire`, of which `axes` are in use.
    pub fn new(axes: &[AxisOptions], wire: &Wire) -> Self {
        Self {
            follower: follower(axes, wire.line),
            axes: axes.iter().map(|_| Axis::default()).collect(),
            wire: *wire,
            next: Next::Survey,
            due_ns: 0,
            begun: false,
            exchanges: 0,
            readings: Readings::default(),
        }
    }

    /// With an encoder that is read.
    fn reading(self, readings: Readings) -> Self {
        Self { readings, ..self }
    }

    /// The axes are where the plan is.
    fn begin(&mut self, plan: &dyn SetpointStream, time_ns: i64) {
        self.begun = true;
        self.due_ns = time_ns;
        for (axis, position) in self.axes.iter_mut().zip(plan.at(time_ns).position) {
            *axis = Axis::at_rest(position);
        }
        self.next = self.ask();
    }

    /// An exchange that begins now: what the driver will make of its times, and when the board executes it.
    fn exchange(&mut self, bytes: (usize, usize)) -> (Stamp, i64) {
        self.exchanges += 1;
        exchange(&self.wire, self.due_ns, bytes)
    }

    /// The next command of a round, or the sample at its end.
    fn command(&mut self, mut round: Round) -> Next {
        let decided_ns = self.due_ns;
        while let Some(index) = round.left.pop_front() {
            if let Some(order) = self.follower.order(index, round.of, decided_ns) {
                let (stamp, executed_ns) = self.exchange(COMMAND_BYTES);
                self.due_ns = executed_ns;
                return Next::Execute(Sent { order, decided_ns, stamp, round });
            }
        }
        self.ask()
    }

    fn ask(&mut self) -> Next {
        let (stamp, executed_ns) = self.exchange(STATE_BYTES);
        self.due_ns = executed_ns;
        Next::Show(stamp)
    }

    /// Makes the due event happen.
    fn happen(&mut self, plan: &dyn SetpointStream) {
        let now_ns = self.due_ns;
        self.next = match std::mem::replace(&mut self.next, Next::Survey) {
            Next::Survey => {
                let left: VecDeque<_> = self.follower.survey(&SeenAt { plan, now_ns }).into();
                let of = left.len();
                self.command(Round { left, of })
            }
            Next::Execute(sent) => {
                if let Some(axis) = self.axes.get_mut(sent.order.axis) {
                    axis.start(now_ns, &sent.order.profile);
                }
                self.due_ns = sent.stamp.answered_ns;
                Next::Confirm(sent)
            }
            Next::Confirm(Sent { order, decided_ns, stamp, round }) => {
                self.follower.executed(&order, decided_ns, &stamp);
                self.command(round)
            }
            Next::Show(stamp) => {
                let shown = self.axes.iter();
                let shown = shown.map(|axis| (axis.counter(now_ns), axis.moving(now_ns))).collect();
                self.due_ns = stamp.answered_ns;
                Next::Sample(stamp, shown)
            }
            Next::Sample(stamp, shown) => {
                let moving = |place: usize| shown.get(place).is_some_and(|(_, moving)| *moving);
                let all_rest = shown.iter().all(|(_, moving)| !moving);
                if self.readings.due(moving, all_rest) {
                    self.due_ns = self.exchange(ENCODER_BYTES).0.answered_ns;
                }
                self.follower.sampled(&stamp, shown.into_iter());
                Next::Survey
            }
        };
    }
}

impl Prediction for InterpCncPrediction {
    fn axis_count(&self) -> usize {
        self.axes.len()
    }

    fn advance(&mut self, plan: &dyn SetpointStream, time_ns: i64) -> IncrementMotion {
        if !self.begun {
            self.begin(plan, time_ns);
        }
        while self.due_ns <= time_ns {
            self.happen(plan);
        }
        let states = self.axes.iter().map(|axis| axis.state(time_ns));
        IncrementMotion::of(states.map(|state| (state.position, state.velocity)))
    }

    fn exchanges(&self) -> u64 {
        self.exchanges
    }

    /// A command for each axis, then a sample, and every few samples a look at the encoder.
    fn rates(&self) -> WireRates {
        let [command, sample] =
            [COMMAND_BYTES, STATE_BYTES].map(|bytes| exchange(&self.wire, 0, bytes).0.answered_ns);
        let commands = i64::try_from(self.axes.len()).unwrap_or(0);
        let round = seconds(commands * command + sample) + self.readings.share(&self.wire);
        WireRates::of_rounds(self.axes.len(), round)
    }

    fn copied(&self) -> Box<dyn Prediction> {
        Box::new(self.clone())
    }
}

/// An exchange of these bytes that the client begins at `begin_ns`: what it will make of its times, and when the board
/// executes it.
fn exchange(wire: &Wire, begin_ns: i64, (request, answer): (usize, usize)) -> (Stamp, i64) {
    let line = wire.line;
    let silence = whole_ns(line.silence());
    let sent_ns = begin_ns + silence;
    let heard_ns = sent_ns + whole_ns(line.duration(request));
    let executed_ns = heard_ns + silence;
    let answering_ns = executed_ns + whole_ns(wire.turnaround);
    // The driver knows when its last byte was sent and when the first one came, and takes the middle.
    let stamp = Stamp {
        sent_ns,
        executed_ns: heard_ns.midpoint(answering_ns),
        uncertainty_ns: (answering_ns - heard_ns) / 2,
        answered_ns: answering_ns + whole_ns(line.duration(answer)),
    };
    (stamp, executed_ns)
}
