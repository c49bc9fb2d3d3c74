//! The closed loop without wire and wall clock: follower and board, exchanges of computed duration.

use std::{
    sync::{
        Arc,
        atomic::{AtomicI64, Ordering},
    },
    time::Duration,
};

use super::*;
use crate::{
    BoardAxis, Command,
    emulator::Board,
    protocol::vectors::{frame, vector},
    tests::{MS, Plan, motion, sines, steep_axes, unlocked},
};
use twin_drives::{
    IncrementMotion, Prediction, SetpointStream, Stamp,
    follow::{Order, TOLERANCE},
    ramp::seconds,
};

type Clock = Box<dyn Fn() -> i64 + Sync>;

/// How exchanges go.
#[derive(Clone, Copy, Debug)]
struct Wire {
    /// Between the end of a request and its execution, ns: silence and the board's own time.
    before_ns: i64,
    /// Between execution and answer, ns.
    turnaround_ns: i64,
    /// Up to so much later, at random, is everything that is woken by a timer, ns.
    jitter_ns: i64,
    /// One wait in so many lasts so much longer, ns: a master or an emulator that the operating system keeps waiting.
    stalls: Option<(u64, i64)>,
}

const EMULATED: Wire =
    Wire { before_ns: 1_750_000, turnaround_ns: 2 * MS, jitter_ns: MS, stalls: None };

/// Position errors of one axis over a run, increments.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    largest: f64,
    squares: f64,
    count: f64,
    fastest: f64,
}

impl Errors {
    /// Root mean square and largest error as lags: milliseconds at the largest speed.
    fn lags_ms(&self) -> (f64, f64) {
        let rms = (self.squares / self.count).sqrt();
        (1e3 * rms / self.fastest, 1e3 * self.largest / self.fastest)
    }
}

/// Follower and board, following `plan` from 200 ms before its start until one second after its end.
struct Loop<'a> {
    now_ns: Arc<AtomicI64>,
    plan: Plan<Clock, &'a (dyn Fn(f64) -> IncrementMotion + Sync)>,
    board: Board,
    follower: Follower,
    wire: Wire,
    line: Line,
    seed: u64,
    errors: Vec<Errors>,
    orders: u32,
}

impl Loop<'_> {
    /// A number from 0 to the jitter (a linear congruential generator: the same every time).
    fn jitter(&mut self) -> i64 {
        self.seed = self
            .seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let number = self.seed >> 33;
        let stall = self
            .wire
            .stalls
            .filter(|(one_in, _)| (number / 7919).is_multiple_of(*one_in))
            .map_or(0, |(_, ns)| ns);
        i64::try_from(number).unwrap() % (self.wire.jitter_ns + 1) + stall
    }

    fn bytes(&self, count: usize) -> i64 {
        i64::try_from(self.line.duration(count).as_nanos()).unwrap()
    }

    /// Lets time pass and compares the board with the plan every half millisecond.
    fn pass(&mut self, ns: i64) {
        let mut left = ns;
        while left > 0 {
            let step = left.min(MS / 2);
            left -= step;
            let now = self.now_ns.fetch_add(step, Ordering::Relaxed) + step;
            self.board.advance(step);
            let motion = self.plan.at(now);
            for (index, errors) in self.errors.iter_mut().enumerate() {
                let error = self.board.position(BoardAxis::ALL[index]) - motion.position[index];
                errors.largest = errors.largest.max(error.abs());
                errors.squares += error * error;
                errors.count += 1.0;
                errors.fastest = errors.fastest.max(motion.velocity[index].abs());
            }
        }
    }

    /// One exchange; what the driver takes for the instant of execution, and what the board shows at the real one.
    fn exchange(&mut self, request: &[u8], answer_bytes: usize) -> (Stamp, Vec<(i32, bool)>) {
        let silence = 1_750_000 + self.jitter();
        self.pass(silence);
        let sent_ns = self.plan.now_ns();
        self.pass(self.bytes(request.len()) + self.wire.before_ns);
        self.board.handle(request).unwrap();
        let moving = self.board.status().moving();
        let shown = self.board.counters().into_iter().zip(BoardAxis::ALL);
        let shown = shown.map(|(counter, axis)| (counter, moving.contains(axis))).collect();
        let late = self.jitter();
        self.pass(self.wire.turnaround_ns + self.bytes(answer_bytes) + late);
        let answered_ns = self.plan.now_ns();
        let (first, last) =
            (sent_ns + self.bytes(request.len()), answered_ns - self.bytes(answer_bytes));
        let executed_ns = i64::midpoint(first, last);
        (Stamp { sent_ns, executed_ns, uncertainty_ns: (last - first) / 2, answered_ns }, shown)
    }

    fn round(&mut self) {
        let needing = self.follower.survey(&self.plan);
        for index in &needing {
            let decided = self.plan.now_ns();
            let Some(order) = self.follower.order(*index, needing.len(), decided) else { continue };
            self.check_target(&order, decided);
            self.orders += 1;
            let command = Command::Move { axis: BoardAxis::ALL[*index], profile: order.profile };
            let (stamp, _) = self.exchange(&frame(&command), 8);
            self.follower.executed(&order, decided, &stamp);
        }
        let (mut stamp, mut shown) = self.exchange(&vector(20), 29);
        if self.follower.is_poor(&stamp) {
            (stamp, shown) = self.exchange(&vector(20), 29);
        }
        self.follower.sampled(&stamp, shown.into_iter());
    }

    /// A target is a position that the plan reaches within its horizon.
    fn check_target(&self, order: &Order<MoveProfile>, decided_ns: i64) {
        let target = f64::from(order.profile.target);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for part in 0..=self.plan.horizon_ns / MS {
            let position = self.plan.at(decided_ns + part * MS).position[order.axis];
            low = low.min(position);
            high = high.max(position);
        }
        assert!(
            target >= low - 0.6 && target <= high + 0.6,
            "{order:?}: the plan goes from {low} to {high}"
        );
    }
}

/// Follows a plan; the errors per axis, which is at rest on the end of the plan afterwards.
fn follow(
    axes: &[AxisOptions],
    wire: Wire,
    seed: u64,
    end_s: f64,
    of: &(dyn Fn(f64) -> IncrementMotion + Sync),
) -> Vec<Errors> {
    let mut run = start(axes, wire, seed, end_s, of);
    while seconds(run.plan.now_ns()) < end_s + 1.0 {
        run.round();
    }
    for (axis, end) in BoardAxis::ALL.into_iter().zip(of(end_s).position).take(axes.len()) {
        let position = run.board.position(axis);
        assert!((position - end).abs() <= TOLERANCE, "{axis:?} ends at {position}, plan at {end}");
    }
    assert!(run.board.status().moving().is_empty());
    run.errors
}

/// Everything at rest on the start of the plan, 200 ms before it begins.
fn start<'a>(
    axes: &[AxisOptions],
    wire: Wire,
    seed: u64,
    end_s: f64,
    of: &'a (dyn Fn(f64) -> IncrementMotion + Sync),
) -> Loop<'a> {
    let line = Line::default();
    let now_ns = Arc::new(AtomicI64::new(-200 * MS));
    let now = Arc::clone(&now_ns);
    let clock: Clock = Box::new(move || now.load(Ordering::Relaxed));
    let plan = Plan::new(clock, 0, end_s, of);
    let mut board = unlocked();
    let start = of(0.0).position.map(|position| {
        #[expect(clippy::cast_possible_truncation, reason = "small")]
        Some(position.round() as i32)
    });
    board.handle(&frame(&Command::WritePosition { positions: start })).unwrap();
    let follower = follower(axes, line);
    let errors = vec![Errors::default(); axes.len()];
    Loop { now_ns, plan, board, follower, wire, line, seed, errors, orders: 0 }
}

/// Sines of the first axes, each a bit slower than the one before.
fn staggered(
    count: usize,
    amplitude: f64,
    frequency: f64,
) -> impl Fn(f64) -> IncrementMotion + Sync {
    let waves = (1..).take(count).map(|axis: u32| (amplitude, frequency / f64::from(axis)));
    sines(waves.collect())
}

fn assert_within(errors: &[Errors], rms_ms: f64, largest_ms: f64) {
    for (axis, errors) in errors.iter().enumerate() {
        let (rms, largest) = errors.lags_ms();
        assert!(
            rms <= rms_ms && largest <= largest_ms,
            "axis {axis}: rms {rms:.2} ms, max {largest:.2} ms"
        );
    }
}

#[test]
fn sines_are_followed() {
    let gentle = |options: AxisOptions| AxisOptions {
        acceleration_khz_per_s: 200,
        deceleration_khz_per_s: 200,
        max_speed_hz: 30_000,
        ..options
    };
    let gentle: Vec<_> = steep_axes(2).into_iter().map(gentle).collect();
    // Executed just before the answer instead of just after the request.
    let late = Wire { before_ns: 6 * MS, turnaround_ns: 0, jitter_ns: MS, ..EMULATED };
    // The 16 ms latency timer of USB adapters, and answers up to 5 ms late.
    let slow = Wire { before_ns: 2 * MS, turnaround_ns: 16 * MS, jitter_ns: 5 * MS, ..EMULATED };
    // One wait in fifty lasts 40 ms longer: a stall every 250 ms.
    let busy = Wire { stalls: Some((50, 40 * MS)), ..EMULATED };
    // Axes, wire, seeds, end, sine, and bounds of the errors, ms.
    for (axes, wire, seeds, end_s, (amplitude, frequency), (rms_ms, largest_ms)) in [
        // 80 mm to and fro at 100 increments per mm, 1 Hz: 25 kHz, 158 kHz/s.
        (steep_axes(1), EMULATED, 0..4, 3.0, (4000.0, 1.0), (0.5, 1.5)),
        (steep_axes(3), EMULATED, 1..2, 6.0, (4000.0, 1.0), (0.8, 3.0)),
        // 3 Hz: a turn every 170 ms, a round takes 30.
        (steep_axes(2), EMULATED, 1..2, 4.0, (1000.0, 3.0), (1.0, 4.0)),
        (gentle, EMULATED, 1..2, 4.0, (4000.0, 1.0), (1.0, 4.0)),
        (steep_axes(2), late, 1..2, 4.0, (4000.0, 1.0), (3.0, 6.0)),
        (steep_axes(2), slow, 1..2, 4.0, (4000.0, 1.0), (10.0, 20.0)),
        (steep_axes(2), busy, 0..4, 6.0, (4000.0, 1.0), (5.0, 40.0)),
    ] {
        for seed in seeds {
            let sines = staggered(axes.len(), amplitude, frequency);
            assert_within(&follow(&axes, wire, seed, end_s, &sines), rms_ms, largest_ms);
        }
    }
}

/// Position and velocity after `time` of a move over `way` with speed `v` and acceleration `a`, from rest to rest.
fn trapezoid(time: f64, way: f64, v: f64, a: f64) -> (f64, f64) {
    let up = v / a;
    let end = way / v + up;
    let left = end - time;
    if time < up {
        (0.5 * a * time * time, a * time)
    } else if left > up {
        (v * (time - 0.5 * up), v)
    } else if left > 0.0 {
        (way - 0.5 * a * left * left, a * left)
    } else {
        (way, 0.0)
    }
}

/// A plan of axis X: way, speed and rate of its ramps, in increments.
fn ramps(way: f64, speed: f64, rate: f64) -> impl Fn(f64) -> IncrementMotion + Sync {
    move |time| motion([trapezoid(time, way, speed, rate)])
}

#[test]
fn a_trapezoid_is_followed_and_an_axis_that_it_leaves_alone_gets_no_command() {
    // Up to 40 and 5 kHz.
    for (end_s, way, speed) in [(1.5, 40e3, 40e3), (4.5, 20e3, 5e3)] {
        let errors = follow(&steep_axes(2), EMULATED, 1, end_s, &ramps(way, speed, 400e3));
        // The second axis is on the plan from beginning to end.
        assert_eq!(errors[1].largest.to_bits(), 0.0_f64.to_bits());
        assert_within(&errors[..1], 0.5, 2.0);
    }
}

#[test]
fn a_slow_axis_is_followed_step_by_step() {
    // 9 increments per second: never farther than rounding and one round make.
    let errors = follow(&steep_axes(1), EMULATED, 1, 4.0, &staggered(1, 3.0, 0.5));
    assert!(errors[0].largest < 1.5, "{errors:?}");
}

#[test]
fn an_axis_whose_master_dies_rests_on_the_plan() {
    let of = staggered(2, 4000.0, 1.0);
    for rounds in 10..60 {
        let mut run = start(&steep_axes(2), EMULATED, 7, 4.0, &of);
        (0..rounds).for_each(|_| run.round());
        let now = run.plan.now_ns();
        run.board.advance(3000 * MS);
        for axis in 0..2 {
            let rest = run.board.position(BoardAxis::ALL[axis]);
            let planned = (0..=run.plan.horizon_ns / MS)
                .map(|part| run.plan.at(now + part * MS).position[axis]);
            // The last command is a few rounds old at most.
            let nearest =
                planned.map(|position| (position - rest).abs()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 60.0, "axis {axis} is at {rest}, {nearest} from the plan");
            assert!(
                (-0.6..=8000.6).contains(&rest),
                "axis {axis} is at {rest}, beyond the turning points"
            );
        }
    }
}

#[test]
fn a_short_horizon_makes_the_axis_lag_and_never_lead() {
    // The plan reaches 60 ms ahead only: the axis brakes for the end of what is planned.
    let of = ramps(20e3, 20e3, 200e3);
    let mut run = start(&steep_axes(1), EMULATED, 3, 1.5, &of);
    run.plan.horizon_ns = 60 * MS;
    while run.plan.now_ns() < 2500 * MS {
        run.round();
        let ahead = run.plan.at(run.plan.now_ns() + 60 * MS).position[0];
        assert!(run.board.position(BoardAxis::X) <= ahead + 0.6);
    }
    assert!((run.board.position(BoardAxis::X) - 20e3).abs() < TOLERANCE);
}

#[test]
fn an_axis_that_was_left_behind_comes_back_no_faster_than_three_times_the_plan() {
    // 30 mm/s at 320 increments per mm; a lost answer takes 770 ms, in which the axis runs to its last target and rests there.
    let (way, speed) = (60e3, 9.6e3);
    let end_s = way / speed + speed / 100e3;
    let of = ramps(way, speed, 100e3);
    for rounds in 60..80 {
        let mut run = start(&steep_axes(1), EMULATED, 5, end_s, &of);
        (0..rounds).for_each(|_| run.round());
        run.pass(770 * MS);
        let behind = run.plan.at(run.plan.now_ns()).position[0] - run.board.position(BoardAxis::X);
        assert!(behind > 4000.0, "{behind}");
        let mut before = (run.plan.now_ns(), run.board.position(BoardAxis::X));
        let mut fastest = 0.0_f64;
        while run.plan.now_ns() < 7500 * MS {
            run.round();
            let now = (run.plan.now_ns(), run.board.position(BoardAxis::X));
            fastest = fastest.max((now.1 - before.1) / seconds(now.0 - before.0));
            assert!(now.1 <= way + 0.6, "{} is beyond the end", now.1);
            before = now;
            if now.0 > 4500 * MS && now.0 < 6000 * MS {
                let apart = run.plan.at(now.0).position[0] - now.1;
                assert!(apart.abs() < 100.0, "still {apart} behind after 2 s");
            }
        }
        assert!(fastest > 2.0 * speed && fastest <= 3.0 * speed * 1.000_001, "{fastest}");
        assert!((before.1 - way).abs() <= TOLERANCE, "{before:?}");
    }
}

#[test]
fn an_axis_left_behind_stops_with_the_plan() {
    let (way, speed, rate) = (60e3, 9.6e3, 100e3);
    let of = ramps(way, speed, rate);
    // Orders from before the change of plan are still carried out: brake at 1000 kHz/s from its largest speed.
    let braking = (3.0 * speed).powi(2) * 0.5 / 1e6;
    for rounds in 60..80 {
        let mut run = start(&steep_axes(1), EMULATED, 5, 7.0, &of);
        (0..rounds).for_each(|_| run.round());
        run.pass(770 * MS);
        // So late after it has noticed, the run brakes: another plan.
        for _ in 0..rounds % 5 {
            run.round();
        }
        let from_s = seconds(run.plan.now_ns());
        let (start, _) = trapezoid(from_s, way, speed, rate);
        let rest = start + speed * speed * 0.5 / rate;
        let braked = |time: f64| {
            let mut motion = of(time.min(from_s));
            let since = (time - from_s).clamp(0.0, speed / rate);
            motion.position[0] += (speed - 0.5 * rate * since) * since;
            if time >= from_s {
                motion.velocity[0] = speed - rate * since;
            }
            motion
        };
        let mut run = Loop { plan: Plan { of: &braked, end_s: 8.0, ..run.plan }, ..run };
        while run.plan.now_ns() < 6000 * MS {
            run.round();
            let position = run.board.position(BoardAxis::X);
            assert!(position <= rest + braking, "{position} is beyond {rest}");
        }
        assert!((run.board.position(BoardAxis::X) - rest).abs() <= TOLERANCE);
    }
}

#[test]
fn a_prediction_is_what_driver_and_board_do_without_jitter() {
    let wire = Wire { jitter_ns: 0, ..EMULATED };
    let turnaround = Duration::from_nanos(u64::try_from(wire.turnaround_ns).unwrap());
    let of = staggered(3, 4000.0, 1.0);
    let mut run = start(&steep_axes(3), wire, 0, 6.0, &of);
    let paced = crate::emulator::Wire { line: Line::default(), turnaround };
    let mut prediction = crate::InterpCncPrediction::new(&steep_axes(3), &paced);
    let mut farthest = 0.0_f64;
    let first_ns = run.plan.now_ns();
    prediction.advance(&run.plan, first_ns);
    while seconds(run.plan.now_ns()) < 7.0 {
        run.round();
        let now_ns = run.plan.now_ns();
        let motion = prediction.advance(&run.plan, now_ns);
        for (index, position) in motion.position.iter().take(3).enumerate() {
            let board = run.board.position(BoardAxis::ALL[index]);
            assert!((position - board).abs() < 1e-6, "{index} at {now_ns}: {position}, {board}");
            farthest = farthest.max(board);
        }
    }
    assert!(farthest > 7900.0 && run.orders > 100);
    // Three axes and a sample: every exchange of the loop is one of the prediction.
    assert!(prediction.exchanges() > u64::from(run.orders));
}
