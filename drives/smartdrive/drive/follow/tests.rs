//! The closed loop without wire and wall clock: the prediction against plans in closed form.
//!
//! How well an axis can follow: between two commands to one axis a round passes, T = exchanges of all axes. A command
//! makes the speed right on the average of the round; within it the plan, whose acceleration is a, strays from a
//! constant speed by at most a·T²/8. The next command is computed T before it is judged and corrects most of what is
//! left, so that a·T² bounds what the plan's own curvature leaves. The time stamp of a sample is wrong by up to half
//! the response delay D: v·D/2. Speeds are rounded up by less than one rpm: rpm·T. Counters show whole steps: 1.

use std::f64::consts::TAU;

use super::*;
use crate::{
    BusDelays, Mode, SmartDrivePrediction, StepsPerTurn, TrajectoryFlags,
    emulator::{Device, DeviceOptions},
    protocol::frame::{Answer, encode},
};
use twin_drives::{
    IncrementMotion, MAX_DRIVE_AXES, Prediction, SetpointStream, Stamp, prediction::SeenAt,
    ramp::seconds,
};

const MS: i64 = 1_000_000;
const HORIZON_NS: i64 = 250 * MS;

/// A plan in closed form.
struct Plan<F> {
    end_s: f64,
    of: F,
}

impl<F: Fn(f64) -> IncrementMotion + Sync> SetpointStream for Plan<F> {
    fn now_ns(&self) -> i64 {
        panic!("the prediction has no clock but the time it is given");
    }

    fn at(&self, time_ns: i64) -> IncrementMotion {
        let time = seconds(time_ns);
        let mut motion = (self.of)(time.clamp(0.0, self.end_s));
        if time < 0.0 || time >= self.end_s {
            motion.velocity = [0.0; MAX_DRIVE_AXES];
        }
        motion
    }

    fn horizon_ns(&self) -> i64 {
        HORIZON_NS
    }
}

/// 200 full steps of 16, up to 1200 rpm, 6000 rpm/s.
fn axes(count: u8) -> Vec<AxisOptions> {
    let turn = StepsPerTurn::new(200, 16).unwrap();
    let axis = |address| AxisOptions {
        address,
        turn,
        velocity_rpm: 1200,
        acceleration_rpm_per_s: 6000,
        deceleration_rpm_per_s: 0,
    };
    (1..=count).map(axis).collect()
}

fn delays(response_ms: u64) -> BusDelays {
    BusDelays { response: Duration::from_millis(response_ms), ..BusDelays::default() }
}

/// `amplitude`·(1 − cos 2πft): starts and ends at rest if `end·f` is whole; each axis slower than the one before.
fn sines(count: u32, amplitude: f64, frequency: f64) -> impl Fn(f64) -> IncrementMotion + Sync {
    move |time| {
        let axis = |slower: u32| {
            let pulsation = TAU * frequency / f64::from(slower);
            let angle = pulsation * time;
            (amplitude * (1.0 - angle.cos()), amplitude * pulsation * angle.sin())
        };
        IncrementMotion::of((1..=count).map(axis))
    }
}

/// The bound of the module's introduction, µsteps, for a sine of `amplitude` and `frequency` on `count` axes.
fn bound(count: f64, response_ms: f64, amplitude: f64, frequency: f64) -> f64 {
    let pulsation = TAU * frequency;
    let exchange = 20.0 * 10.0 / 115_200.0 + 1e-3 * response_ms + 1e-3;
    let round = count * exchange;
    let curvature = amplitude * pulsation * pulsation * round * round;
    let stamp = amplitude * pulsation * 0.5e-3 * response_ms;
    let rounding = 3200.0 / 60.0 * round;
    curvature + stamp + rounding + 1.0
}

#[test]
fn a_sine_is_followed_within_what_the_bus_allows() {
    // Drives, their response in ms, amplitude in µsteps (a turn has 3200), Hz, seconds.
    for (name, count, response_ms, amplitude, frequency, end_s) in [
        ("half a turn to and fro", 1, 2, 800.0, 1.0, 3.0),
        ("some turns", 1, 2, 4000.0, 1.0, 3.0),
        ("most turns", 1, 2, 8000.0, 0.5, 3.0),
        ("fast turns", 1, 2, 1000.0, 2.0, 3.0),
        ("three drives share the bus", 3, 2, 4000.0, 1.0, 6.0),
        ("a drive that takes its time", 1, 20, 4000.0, 0.5, 4.0),
        ("a drive that takes all its time", 1, 50, 4000.0, 0.5, 4.0),
        // Slower than one rpm the drive goes by single steps: what rounding of position and speed make in a round.
        ("slower than the slowest speed", 1, 2, 10.0, 0.5, 4.0),
    ] {
        // From 200 ms before the plan to a second after.
        let plan = Plan { end_s, of: sines(count.into(), amplitude, frequency) };
        let mut prediction = SmartDrivePrediction::new(&axes(count), delays(response_ms));
        assert_eq!(prediction.axis_count(), usize::from(count));
        let end_ns = twin_drives::ramp::nanoseconds(end_s) + 1000 * MS;
        let mut largest = [0.0_f64; MAX_DRIVE_AXES];
        let mut last = IncrementMotion::default();
        for time_ns in (-200 * MS..end_ns).step_by(500_000) {
            last = prediction.advance(&plan, time_ns);
            let planned = plan.at(time_ns).position;
            for ((largest, position), planned) in largest.iter_mut().zip(last.position).zip(planned)
            {
                *largest = largest.max((position - planned).abs());
            }
        }
        let end = plan.at(end_ns).position;
        let response_ms = f64::from(u32::try_from(response_ms).unwrap());
        for index in 0..count {
            let (slower, axis) = (f64::from(index + 1), usize::from(index));
            let away = (last.position[axis] - end[axis]).abs();
            assert!(away <= 0.6, "{name}, axis {axis}: {last:?} instead of {end:?}");
            let most = bound(count.into(), response_ms, amplitude, frequency / slower);
            assert!(largest[axis] <= most, "{name}, axis {axis}: {} > {most}", largest[axis]);
        }
    }
}

/// The number of exchanges is what the bus has room for: `drives-notes.md` has 280 a second for one drive with 2 ms,
/// here with a gap of one millisecond more.
#[test]
fn exchanges_fill_the_bus() {
    let plan = Plan { end_s: 2.0, of: sines(1, 4000.0, 1.0) };
    let mut prediction = SmartDrivePrediction::new(&axes(1), delays(2));
    prediction.advance(&plan, 0);
    prediction.advance(&plan, 1000 * MS);
    let exchanges = prediction.exchanges();
    // PING: 16 bytes and 3 ms, 228 a second; GOTO v,a: 20 bytes, 211.
    assert!((211..=228).contains(&exchanges), "{exchanges}");
}

/// The same plan gives the same motion, however often it is looked at.
#[test]
fn a_prediction_depends_on_nothing_but_its_plan() {
    let plan = Plan { end_s: 2.0, of: sines(2, 4000.0, 1.0) };
    let mut often = SmartDrivePrediction::new(&axes(2), delays(2));
    let mut seldom = SmartDrivePrediction::new(&axes(2), delays(2));
    for time_ns in (0..=2000 * MS).step_by(250_000) {
        let one = often.advance(&plan, time_ns);
        if time_ns % (10 * MS) == 0 {
            let other = seldom.advance(&plan, time_ns);
            assert_eq!(one.position.map(f64::to_bits), other.position.map(f64::to_bits));
            assert_eq!(one.velocity.map(f64::to_bits), other.velocity.map(f64::to_bits));
        }
    }
    assert_eq!(often.exchanges(), seldom.exchanges());
}

/// The prediction is driver and device without bytes: the same exchanges, spoken with an emulated device in frames, move
/// it in the same way.
#[test]
fn the_prediction_moves_as_the_device_does() {
    let plan = Plan { end_s: 2.0, of: sines(1, 4000.0, 1.0) };
    let mut device =
        Device::new(&DeviceOptions { configured_mode: Mode::Remote, ..DeviceOptions::default() });
    let ask = |device: &mut Device, command: &Command| {
        let answer = device.handle(&encode(1, command)).unwrap();
        Answer::decode(&answer.try_into().unwrap()).unwrap()
    };
    for (parameter, value) in [(30, 1200), (31, 6000), (32, 0)] {
        ask(&mut device, &Command::Set { parameter, value });
    }
    let mut prediction = SmartDrivePrediction::new(&axes(1), delays(2));
    prediction.advance(&plan, 0);
    let mut follower = follower(&axes(1), Duration::from_millis(2));
    let bytes = |count| i64::try_from(wire_time(count).as_nanos()).unwrap();
    let mut now_ns = 0;
    while now_ns < 2500 * MS {
        let needing = follower.survey(&SeenAt { plan: &plan, now_ns });
        let order = if needing.is_empty() { None } else { follower.order(0, 1, now_ns) };
        let command = order.map_or(Command::Ping, |order| order.profile.command());
        let executed_ns = now_ns + bytes(encode(1, &command).len());
        device.advance(executed_ns - device.now_ns());
        let answer = ask(&mut device, &command);
        let moves = TrajectoryFlags::from_tag(answer.tag).contains(TrajectoryFlags::IN_MOTION);
        let stamp = Stamp {
            sent_ns: now_ns,
            executed_ns: executed_ns + MS,
            uncertainty_ns: MS,
            answered_ns: executed_ns + 2 * MS + bytes(9),
        };
        follower.sampled_axis(0, &stamp, answer.number(), moves);
        if let Some(order) = &order {
            follower.executed(order, now_ns, &stamp);
        }
        device.advance(stamp.answered_ns - device.now_ns());
        let (position, velocity) = device.motion();
        let motion = prediction.advance(&plan, stamp.answered_ns);
        assert_eq!(motion.position[0].to_bits(), position.to_bits(), "{now_ns}");
        assert_eq!(motion.velocity[0].to_bits(), velocity.to_bits(), "{now_ns}");
        now_ns = stamp.answered_ns + MS;
    }
    assert_eq!(device.counter(), 0);
}

/// If no command follows, the axis rests where the plan goes within its horizon.
#[test]
fn an_axis_whose_master_dies_stands_on_the_plan() {
    let plan = Plan { end_s: 4.0, of: sines(1, 4000.0, 1.0) };
    for dies_ms in (50..1500).step_by(37) {
        let mut prediction = SmartDrivePrediction::new(&axes(1), delays(2));
        prediction.advance(&plan, 0);
        prediction.advance(&plan, dies_ms * MS);
        let stands = prediction.generators[0].state((dies_ms + 3000) * MS).position;
        let ahead = (0..=HORIZON_NS / MS).map(|part| plan.at((dies_ms + part) * MS).position[0]);
        let nearest = ahead.map(|position| (position - stands).abs()).fold(f64::INFINITY, f64::min);
        // The last command is a round old at most: 5 ms at 25133 µsteps/s.
        assert!(nearest < 130.0, "{nearest} from the plan after {dies_ms} ms");
        assert!((-0.6..=8000.6).contains(&stands), "{stands}, beyond the turning points");
    }
}
