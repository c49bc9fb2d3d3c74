//! Following a plan with interpolated segments that the board buffers (command 6).
//!
//! All axes stay on straight lines between positions of the plan, at the price of a stop between two segments: each
//! ramps up from the start frequency and down to it again (parameters 4 and 5). Where the plan itself is a move from
//! rest to rest in a line, or slower than the start frequency, that costs nothing; elsewhere the axes swing around the
//! plan by what the stops make.
//!
//! The driver keeps a model of the segments in the board, moved by the board's own kind of profile from the instants
//! at which commands were executed and corrected by what samples show. Shortly before the model ends it looks which
//! length of the next segment keeps nearest to the plan, and sends that one: never more than one waits in the board,
//! so that what a master that dies leaves undone is short.

#[cfg(test)]
mod tests;

use crate::{
    AxisOptions, AxisValues, Command, Line,
    emulator::segment_ramps,
    protocol::registers::{AXES, MAX_SPEED_HZ},
};
use twin_drives::{
    MAX_DRIVE_AXES, SetpointStream, Stamp,
    ramp::{Motion, State, nanoseconds, seconds},
};

/// Lengths of segments that are tried differ by this, and the longest is this many of it.
const SPAN_NS: i64 = 10_000_000;
const MOST_SPANS: i64 = 50;
/// Instants within a segment at which it is compared with the plan.
const COMPARED: i64 = 16;
/// The axes are left alone while the plan stays this near to them, increments: what rounding makes.
const TOLERANCE: f64 = 0.6;
/// Weight of an exchange in the running means, and of a sample in the correction of the model.
const MEAN_GAIN: f64 = 0.2;
const CORRECTION: f64 = 0.3;
/// A sample corrects the model by at most this, ns.
const MOST_CORRECTION_NS: i64 = 5_000_000;
/// Slower than this a counter says little about time, steps/s.
const TELLING_SPEED: f64 = 500.0;

/// A segment that has been decided for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SegmentOrder {
    /// Of the axis with the longest way, steps/s.
    pub(crate) speed_hz: u32,
    /// Targets of the board's axes.
    pub(crate) targets: AxisValues,
}

impl SegmentOrder {
    pub(crate) fn command(&self) -> Command {
        Command::Interpolated { speed_hz: self.speed_hz, targets: self.targets }
    }
}

/// A segment in the board, as modelled.
#[derive(Clone, Debug)]
struct Modelled {
    motions: [Motion; AXES],
    end_ns: i64,
}

/// Follows a plan; speaks to nobody.
#[derive(Clone, Debug)]
pub(crate) struct Buffered {
    axes: Vec<AxisOptions>,
    /// Start frequency, steps/s, and rate of the ramps, steps/s².
    start_stop: f64,
    rate: f64,
    /// Segments in the board, the one under way first.
    queue: Vec<Modelled>,
    /// Where the axes are when all have ended, per axis in use.
    end: Vec<f64>,
    started: bool,
    /// From the decision for a command to its execution, and to its answer, s.
    lead: f64,
    exchange: f64,
}

impl Buffered {
    pub(crate) fn new(
        axes: &[AxisOptions],
        line: Line,
        start_stop_hz: u16,
        acceleration_khz_per_s: u16,
    ) -> Self {
        // Request 17 bytes and 4 per axis, answer 8, two silences; 2 ms for the board until it is known better.
        let silence = line.silence().as_secs_f64();
        let request = line.duration(17 + 4 * axes.len()).as_secs_f64();
        let answer = line.duration(8).as_secs_f64();
        Self {
            axes: axes.to_vec(),
            start_stop: f64::from(start_stop_hz.max(1)),
            rate: 1e3 * f64::from(acceleration_khz_per_s.max(1)),
            queue: Vec::new(),
            end: vec![0.0; axes.len()],
            started: false,
            lead: request + 2.0 * silence,
            exchange: request + answer + 2.0 * silence + 0.002,
        }
    }

    /// Forgets where the axes are: something else than segments has moved or stopped them.
    pub(crate) fn restart(&mut self) {
        self.started = false;
        self.queue.clear();
    }

    /// When all segments have ended, ns.
    fn end_ns(&self) -> Option<i64> {
        self.queue.last().map(|segment| segment.end_ns)
    }

    /// The next segment, decided at `now_ns`; none while there is enough to do, or nothing.
    pub(crate) fn order(&self, stream: &dyn SetpointStream, now_ns: i64) -> Option<SegmentOrder> {
        if !self.started {
            return None;
        }
        let earliest_ns = now_ns + nanoseconds(self.lead);
        // A command and a sample, and half of that to spare: then the next command would come too late.
        let round_ns = nanoseconds(3.0 * self.exchange);
        let end_ns = self.end_ns().unwrap_or(i64::MIN);
        if end_ns > earliest_ns + round_ns {
            return None;
        }
        let start_ns = end_ns.max(earliest_ns);
        let horizon_ns = now_ns + stream.horizon_ns();
        let mut best: Option<(f64, SegmentOrder)> = None;
        let shortest = (round_ns / SPAN_NS + 1).min(MOST_SPANS);
        for span in shortest..=MOST_SPANS {
            let until_ns = start_ns + span * SPAN_NS;
            if until_ns > horizon_ns && span > shortest {
                break;
            }
            let Some(order) = self.segment(stream, start_ns, until_ns) else { continue };
            let cost = self.cost(stream, &order, start_ns, until_ns);
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, order));
            }
        }
        best.map(|(_, order)| order)
    }

    /// The segment that is to bring the axes from one instant of the plan to another; none if they need not move.
    fn segment(
        &self,
        stream: &dyn SetpointStream,
        start_ns: i64,
        until_ns: i64,
    ) -> Option<SegmentOrder> {
        let wanted = stream.at(until_ns).position;
        let ways: Vec<f64> =
            wanted.iter().zip(&self.end).map(|(wanted, from)| wanted.round() - from).collect();
        let longest = ways.iter().fold(0.0_f64, |longest, way| longest.max(way.abs()));
        let apart = wanted.iter().zip(&self.end).map(|(wanted, from)| (wanted - from).abs());
        if longest < 1.0 || apart.fold(0.0, f64::max) <= TOLERANCE {
            return None;
        }
        let mut most = f64::from(MAX_SPEED_HZ);
        let mut targets = [None; AXES];
        for ((axis, way), wanted) in self.axes.iter().zip(&ways).zip(wanted) {
            if way.abs() > 0.0 {
                most = most.min(f64::from(axis.max_speed_hz) * longest / way.abs());
            }
            if let Some(target) = targets.get_mut(axis.axis.index()) {
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "saturates, as counters end there"
                )]
                let position = wanted.round() as i32;
                *target = Some(position);
            }
        }
        let speed = self.speed(longest, seconds(until_ns - start_ns), most);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 200000")]
        let speed_hz = speed.ceil().clamp(1.0, most.max(1.0).floor()) as u32;
        Some(SegmentOrder { speed_hz, targets })
    }

    /// The speed with which a way takes so long, at most `most`.
    fn speed(&self, way: f64, time: f64, most: f64) -> f64 {
        // The duration falls with the speed.
        let (mut low, mut high) = (0.0, most);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.duration(way, middle) > time { low = middle } else { high = middle }
        }
        high
    }

    /// Duration of a way from start frequency to start frequency.
    fn duration(&self, way: f64, speed: f64) -> f64 {
        let base = self.start_stop.min(speed);
        let ramps = (speed * speed - base * base) / self.rate;
        if ramps < way {
            2.0 * (speed - base) / self.rate + (way - ramps) / speed
        } else {
            2.0 * ((self.rate * way + base * base).sqrt() - base) / self.rate
        }
    }

    /// Motions of the board's axes by a segment that starts at an instant.
    fn motions(&self, order: &SegmentOrder, start_ns: i64) -> Modelled {
        let mut from = [0.0; AXES];
        for (axis, end) in self.axes.iter().zip(&self.end) {
            if let Some(from) = from.get_mut(axis.axis.index()) {
                *from = *end;
            }
        }
        let ramps = segment_ramps(from, &order.targets, order.speed_hz, self.start_stop, self.rate);
        let mut motions = from.map(Motion::at_rest);
        let mut end_ns = start_ns;
        for ((motion, ramp), from) in motions.iter_mut().zip(ramps).zip(from) {
            if let Some(ramp) = ramp {
                let state = State { position: from, velocity: 0.0 };
                *motion = Motion::plan(start_ns, state, &ramp);
                end_ns = end_ns.max(motion.end_ns());
            }
        }
        Modelled { motions, end_ns }
    }

    /// How far a segment keeps from the plan, increments²: on the way, and at its end.
    fn cost(
        &self,
        stream: &dyn SetpointStream,
        order: &SegmentOrder,
        start_ns: i64,
        until_ns: i64,
    ) -> f64 {
        let segment = self.motions(order, start_ns);
        let apart = |time_ns: i64| {
            let plan = stream.at(time_ns).position;
            let axes = self.axes.iter().zip(plan);
            axes.map(|(axis, plan)| (position(&segment, axis, time_ns) - plan).powi(2)).sum::<f64>()
        };
        let step = (until_ns - start_ns) / COMPARED;
        let way: f64 = (1..COMPARED).map(|part| apart(start_ns + part * step)).sum();
        #[expect(clippy::cast_precision_loss, reason = "16")]
        let compared = COMPARED as f64;
        way / compared + apart(until_ns)
    }

    /// The board has accepted a segment that was decided at `decided_ns`.
    pub(crate) fn executed(&mut self, order: &SegmentOrder, decided_ns: i64, stamp: &Stamp) {
        let mean = |old: f64, new: f64| old + MEAN_GAIN * (new.clamp(0.0, 2.0 * old) - old);
        self.lead = mean(self.lead, seconds(stamp.executed_ns - decided_ns));
        self.exchange = mean(self.exchange, seconds(stamp.answered_ns - decided_ns));
        let start_ns = self.end_ns().map_or(stamp.executed_ns, |end| end.max(stamp.executed_ns));
        let segment = self.motions(order, start_ns);
        self.queue.push(segment);
        for (axis, end) in self.axes.iter().zip(&mut self.end) {
            if let Some(Some(target)) = order.targets.get(axis.axis.index()) {
                *end = f64::from(*target);
            }
        }
    }

    /// The board has shown the counters of the axes in use, and whether all segments are finished.
    pub(crate) fn sampled(
        &mut self,
        stamp: &Stamp,
        counters: impl Iterator<Item = i32>,
        finished: bool,
    ) {
        let now_ns = stamp.executed_ns;
        let counters: Vec<f64> = counters.map(f64::from).collect();
        if finished || !self.started {
            // What has been lost or stopped on the way shows here: the axes are where their counters say.
            self.queue.clear();
            self.end = counters;
            self.started = finished;
            return;
        }
        while self.queue.len() > 1 && self.queue.first().is_some_and(|first| first.end_ns < now_ns)
        {
            self.queue.remove(0);
        }
        let Some(present) = self.queue.first() else { return };
        // By the fastest axis: how much later the board is than its model.
        let speed = |axis: &AxisOptions| {
            present.motions.get(axis.axis.index()).map_or(0.0, |motion| motion.at(now_ns).velocity)
        };
        let fastest = self
            .axes
            .iter()
            .zip(&counters)
            .max_by(|(a, _), (b, _)| speed(a).abs().total_cmp(&speed(b).abs()));
        let mut late_ns = 0;
        if let Some((axis, counter)) = fastest.filter(|(axis, _)| speed(axis).abs() > TELLING_SPEED)
        {
            let late = (position(present, axis, now_ns) - counter) / speed(axis);
            late_ns = nanoseconds(CORRECTION * late);
        } else if present.end_ns < now_ns {
            late_ns = now_ns - present.end_ns;
        }
        let late_ns = late_ns.clamp(-MOST_CORRECTION_NS, MOST_CORRECTION_NS);
        for segment in &mut self.queue {
            segment.end_ns += late_ns;
            segment.motions = segment.motions.map(|motion| motion.later(late_ns));
        }
    }
}

fn position(segment: &Modelled, axis: &AxisOptions, time_ns: i64) -> f64 {
    segment.motions.get(axis.axis.index()).map_or(0.0, |motion| motion.at(time_ns).position)
}

const _: () = assert!(AXES == MAX_DRIVE_AXES);
