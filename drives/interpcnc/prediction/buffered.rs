//! A board that follows a plan by interpolated segments, in simulated time and without bytes.

use super::{ENCODER_BYTES, Readings, STATE_BYTES};
use crate::{
    AxisOptions, AxisValues, Command,
    drive::follow::{Buffered, SegmentOrder},
    emulator::{Board, BoardOptions, Wire},
    protocol::{parameters, registers::AXES},
};
use twin_drives::{
    IncrementMotion, Prediction, SetpointStream, Stamp, WireRates, prediction::SeenAt,
    ramp::seconds,
};

/// An InterpCNC board that follows a plan by interpolated segments from its buffer (command 6), as its driver lets it
/// in a run: a segment when one is due, then a sample, as fast as the wire allows.
#[derive(Clone, Debug)]
pub(super) struct BufferedPrediction {
    follower: Buffered,
    axes: Vec<AxisOptions>,
    board: Board,
    /// Board time less plan time, ns.
    offset_ns: i64,
    wire: Wire,
    next: Next,
    due_ns: i64,
    begun: bool,
    exchanges: u64,
    readings: Readings,
}

/// Next event.
#[derive(Clone, Debug)]
enum Next {
    /// The driver looks at the plan, and sends a segment if one is due.
    Survey,
    /// The board executes a command.
    Execute(SegmentOrder, i64, Stamp),
    /// Its answer is there.
    Confirm(SegmentOrder, i64, Stamp),
    /// The board looks at its counters.
    Show(Stamp),
    /// The driver knows them, and whether all segments are finished.
    Sample(Stamp, Vec<i32>, bool),
}

impl BufferedPrediction {
    pub(super) fn new(
        axes: &[AxisOptions],
        wire: &Wire,
        start_stop_hz: u16,
        acceleration_khz_per_s: u16,
    ) -> Self {
        let mut board = Board::new(&BoardOptions::default());
        board.set_parameter(parameters::DEFAULT_START_STOP, start_stop_hz.into());
        board.set_parameter(parameters::DEFAULT_ACCELERATION, acceleration_khz_per_s.into());
        Self {
            follower: Buffered::new(axes, wire.line, start_stop_hz, acceleration_khz_per_s),
            axes: axes.to_vec(),
            board,
            offset_ns: 0,
            wire: *wire,
            next: Next::Survey,
            due_ns: 0,
            begun: false,
            exchanges: 0,
            readings: Readings::default(),
        }
    }

    /// With an encoder that is read.
    pub(super) fn reading(self, readings: Readings) -> Self {
        Self { readings, ..self }
    }

    /// The axes are where the plan is, to the nearest step.
    fn begin(&mut self, plan: &dyn SetpointStream, time_ns: i64) {
        self.begun = true;
        self.due_ns = time_ns;
        self.offset_ns = self.board.now_ns() - time_ns;
        let mut positions = [None; 5];
        for (axis, position) in self.axes.iter().zip(plan.at(time_ns).position) {
            if let Some(slot) = positions.get_mut(axis.axis.index()) {
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "saturates, as counters end there"
                )]
                let position = position.round() as i32;
                *slot = Some(position);
            }
        }
        let unlock = Command::Reset { unlock: true, homing_error: false, probe_error: false };
        for command in [unlock, Command::WritePosition { positions }] {
            // A board that is enabled and stands takes both.
            self.board.send(&command).unwrap_or_default();
        }
        self.next = self.ask();
    }

    fn board_to(&mut self, time_ns: i64) {
        self.board.advance(time_ns + self.offset_ns - self.board.now_ns());
    }

    /// An exchange that begins now: what the driver will make of its times, and when the board executes it.
    fn exchange(&mut self, bytes: (usize, usize)) -> (Stamp, i64) {
        self.exchanges += 1;
        super::exchange(&self.wire, self.due_ns, bytes)
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
            Next::Survey => match self.follower.order(&SeenAt { plan, now_ns }, now_ns) {
                Some(order) => {
                    let (stamp, executed_ns) = self.exchange(bytes(&order.command()));
                    self.due_ns = executed_ns;
                    Next::Execute(order, now_ns, stamp)
                }
                None => self.ask(),
            },
            Next::Execute(order, decided_ns, stamp) => {
                self.board_to(now_ns);
                // At most two are in the buffer, and no axis moves otherwise.
                self.board.send(&order.command()).unwrap_or_default();
                self.due_ns = stamp.answered_ns;
                Next::Confirm(order, decided_ns, stamp)
            }
            Next::Confirm(order, decided_ns, stamp) => {
                self.follower.executed(&order, decided_ns, &stamp);
                self.ask()
            }
            Next::Show(stamp) => {
                self.board_to(now_ns);
                let counters = self.board.counters();
                let shown = self.axes.iter().filter_map(|axis| counters.get(axis.axis.index()));
                let shown = shown.copied().collect();
                self.due_ns = stamp.answered_ns;
                Next::Sample(stamp, shown, self.board.status().segments_finished())
            }
            Next::Sample(stamp, shown, finished) => {
                // Between two segments no axis counts as resting.
                if self.readings.due(|_| !finished, finished) {
                    self.due_ns = self.exchange(ENCODER_BYTES).0.answered_ns;
                }
                self.follower.sampled(&stamp, shown.into_iter(), finished);
                Next::Survey
            }
        };
    }
}

impl Prediction for BufferedPrediction {
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
        self.board_to(time_ns);
        let axes = self.axes.iter().map(|axis| axis.axis);
        IncrementMotion::of(axes.map(|axis| (self.board.position(axis), self.board.velocity(axis))))
    }

    fn exchanges(&self) -> u64 {
        self.exchanges
    }

    /// A segment for all axes, then a sample.
    fn rates(&self) -> WireRates {
        let mut targets: AxisValues = [None; AXES];
        for axis in &self.axes {
            if let Some(target) = targets.get_mut(axis.axis.index()) {
                *target = Some(0);
            }
        }
        let segment = bytes(&Command::Interpolated { speed_hz: 1, targets });
        let [segment, sample] =
            [segment, STATE_BYTES].map(|bytes| super::exchange(&self.wire, 0, bytes).0.answered_ns);
        WireRates::of_rounds(1, seconds(segment + sample) + self.readings.share(&self.wire))
    }

    fn copied(&self) -> Box<dyn Prediction> {
        Box::new(self.clone())
    }
}

/// Bytes of a command and of its answer.
fn bytes(command: &Command) -> (usize, usize) {
    (9 + 2 * command.registers().len(), 8)
}
