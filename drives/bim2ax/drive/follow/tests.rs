//! Legs against closed forms, and whole plans in simulated time.

use super::*;
use crate::{Bim2AxPrediction, DriveMode, PredictionOptions};
use twin_drives::{IncrementMotion, Prediction};

const MS: i64 = 1_000_000;
/// Order latency and a look, s.
const DEAD_S: f64 = 0.011;

/// 1/16 steps with speeds in µsteps/s.
fn settings() -> AxisSettings {
    AxisSettings {
        mode: DriveMode::from_code(0x0040).unwrap(),
        start_stop_speed: 2000,
        fast_speed: 20_000,
        acceleration: 60_000,
        ..AxisSettings::default()
    }
}

/// A plan given by a function of seconds, known 500 ms ahead.
struct Plan<F>(F);

impl<F: Fn(f64) -> IncrementMotion + Sync> SetpointStream for Plan<F> {
    fn now_ns(&self) -> i64 {
        panic!("a prediction has a time of its own")
    }
    fn at(&self, time_ns: i64) -> IncrementMotion {
        (self.0)(seconds(time_ns))
    }
    fn horizon_ns(&self) -> i64 {
        500 * MS
    }
}

fn motion_of(position: [f64; 2], velocity: [f64; 2]) -> IncrementMotion {
    let [x, y] = position;
    let [u, v] = velocity;
    IncrementMotion { position: [x, y, 0.0, 0.0, 0.0], velocity: [u, v, 0.0, 0.0, 0.0] }
}

fn prediction() -> Bim2AxPrediction {
    Bim2AxPrediction::new(&PredictionOptions::new(vec![settings(); 2]))
}

/// Largest error of an axis over a span of the prediction, µsteps, and the prediction.
fn largest(plan: &dyn SetpointStream, from_ms: i64, to_ms: i64) -> ([f64; 2], Bim2AxPrediction) {
    let mut prediction = prediction();
    let mut worst = [0.0_f64; 2];
    for time_ms in 0..=to_ms {
        let found = prediction.advance(plan, time_ms * MS).position;
        let planned = plan.at(time_ms * MS).position;
        if time_ms >= from_ms {
            for axis in 0..2 {
                worst[axis] = worst[axis].max((found[axis] - planned[axis]).abs());
            }
        }
    }
    (worst, prediction)
}

/// A line from rest at 0: it begins after 0.1 s.
fn line(speeds: [f64; 2]) -> impl Fn(f64) -> IncrementMotion + Sync {
    move |time| {
        if time < 0.1 {
            motion_of([0.0; 2], [0.0; 2])
        } else {
            motion_of(speeds.map(|speed| speed * (time - 0.1)), speeds)
        }
    }
}

#[test]
fn speeds_are_those_whose_trapezoid_takes_the_time() {
    let axis = settings();
    for (distance, duration) in [(100.0, 0.2), (-3000.0, 0.5), (9000.0, 1.0), (1.0, 0.3)] {
        let speed = speed_for(&axis, distance, duration);
        let took = motion(&axis, 0, 0, whole(distance).try_into().unwrap(), speed).end_ns();
        // A whole unit of speed more or less makes this much of a difference.
        let grain = duration / f64::from(speed);
        assert!((seconds(took) - duration).abs() <= grain, "{distance} in {duration}: {took}");
    }
    assert_eq!(speed_for(&axis, 10_000.0, 0.01), 20_000, "impossible: as fast as it goes");
}

#[test]
fn both_axes_arrive_together() {
    let follower =
        Follower::new(&[settings(), settings()], Timing { order_ns: 10 * MS, look_ns: MS });
    let plan = Plan(line([5000.0, -800.0]));
    let seen = twin_drives::prediction::SeenAt { plan: &plan, now_ns: 200 * MS };
    let leg = follower.leg(&seen, [500, -80]).unwrap();
    assert_eq!(leg.start_ns, 210 * MS);
    let ends_s = [0, 1].map(|axis| {
        let from = [500, -80][axis];
        seconds(motion(&settings(), 0, from, leg.targets[axis], leg.speeds[axis]).end_ns())
    });
    // Speeds are whole: each axis is up to half a unit too fast or too slow, d/v² · ½ without ramps; with ramps of
    // a tenth of a second, which take longer for higher speeds, less.
    let grain: f64 = leg.speeds.iter().map(|speed| 0.5 * ends_s[0] / f64::from(*speed)).sum();
    assert!((ends_s[0] - ends_s[1]).abs() <= grain, "{ends_s:?} of {leg:?}");
}

#[test]
fn a_plan_at_rest_gets_no_orders() {
    let plan = Plan(|_| motion_of([12.3, -4.0], [0.0; 2]));
    let (worst, prediction) = largest(&plan, 0, 300);
    // The device is on whole µsteps.
    assert!(worst[0] <= 0.31 && worst[1] == 0.0, "{worst:?}");
    // Looks only, one after the other: the first at 1 ms, then every 6 ms.
    assert_eq!(prediction.exchanges(), 50);
}

#[test]
fn a_line_below_the_start_stop_speed_is_followed_within_half_a_dead_time() {
    // Without ramps the error is a saw tooth of v · dead from top to bottom. Half of it is the least; rounding adds
    // a µstep, speeds in whole units as much as duration · 0.5 (0.5 s at most: 0.25), and the choice of how far to
    // lie ahead (tenths of a dead time) up to a tenth.
    let speeds = [1500.0, -400.0];
    let plan = Plan(line(speeds));
    let (worst, prediction) = largest(&plan, 600, 4000);
    for axis in 0..2 {
        let saw_tooth = speeds[axis].abs() * DEAD_S;
        assert!(worst[axis] <= 0.6 * saw_tooth + 1.25, "axis {axis}: {worst:?}");
        assert!(worst[axis] >= 0.4 * saw_tooth - 1.25, "axis {axis}: better than possible");
    }
    // What it expects is not less than a saw tooth within ±v·dead/2 could have, and no more than its bounds allow.
    let bound = (1500.0_f64.hypot(400.0)) * DEAD_S * 0.6 + 1.8;
    assert!((0.5..bound).contains(&prediction.expected_error()), "{}", prediction.expected_error());
}

#[test]
fn a_fast_line_costs_its_ramps_on_top() {
    // 8000 µsteps/s from a start-stop speed of 2000 at 60000: the ramps of a leg at w cost (w − u)²/(2a) each. The
    // legs need not be faster than half as fast again, 12000: 833 µsteps at most; the dead time costs 44.
    let plan = Plan(line([8000.0, 0.0]));
    let (worst, _) = largest(&plan, 1000, 4000);
    assert!(worst[0] < 833.0 + 44.0, "{worst:?}");
    assert!(worst[1] == 0.0, "{worst:?}");
}

#[test]
fn a_sine_is_followed_to_its_turning_points_and_ends_at_rest() {
    // 1000 µsteps at 0.5 Hz for two periods; then rest where it ends.
    let omega = std::f64::consts::PI;
    let plan = Plan(move |time: f64| {
        let time = time.clamp(0.0, 4.0);
        let velocity = if time < 4.0 { -1000.0 * omega * (omega * time).sin() } else { 0.0 };
        motion_of([1000.0 * (omega * time).cos(), 0.0], [velocity, 0.0])
    });
    let (worst, prediction) = largest(&plan, 0, 4000);
    // A chord of T has an error of c·T²/8 with c = 1000·π²; the largest speed is 3142, so dead times cost 17 either
    // way; ramps from 2000 to at most 4000 cost 33. With T = 0.2 s that is 49 + 17 + 33.
    assert!(worst[0] < 100.0, "{worst:?} with {} exchanges", prediction.exchanges());
    let (worst, _) = largest(&plan, 4200, 4500);
    assert!(worst[0] <= 0.6, "{worst:?}: it stands where the plan ends");
}

#[test]
fn expectation_and_prediction_agree() {
    // The mean square over the whole motion, sampled, is what the follower expected of its legs: they are moved by
    // the same profiles. The time before the first leg (latency) and rounding of sampling differ.
    let plan = Plan(line([1500.0, -400.0]));
    let mut prediction = prediction();
    let mut square = 0.0;
    let mut count = 0.0;
    for step in 0..40_000 {
        let time_ns = step * MS / 10;
        let found = prediction.advance(&plan, time_ns).position;
        let planned = plan.at(time_ns).position;
        if time_ns > 120 * MS {
            square += (found[0] - planned[0]).powi(2) + (found[1] - planned[1]).powi(2);
            count += 1.0;
        }
    }
    let (found, expected) = ((square / count).sqrt(), prediction.expected_error());
    assert!((found - expected).abs() < 0.15 * expected, "expected {expected}, found {found}");
}

#[test]
fn the_same_plan_gives_the_same_motion_however_often_it_is_asked() {
    let plan = Plan(line([3000.0, 2000.0]));
    let mut once = prediction();
    let mut often = prediction();
    once.advance(&plan, 0);
    for time_ms in 0..=1500 {
        often.advance(&plan, time_ms * MS);
    }
    assert_eq!(once.advance(&plan, 1500 * MS), often.advance(&plan, 1500 * MS));
}

#[test]
fn a_prediction_is_of_axes_that_are_homed_and_have_no_switches() {
    use crate::protocol::bits::coefficient;
    // Opening switches that are not there would be actuated, and before homing nothing would move.
    let coefficient = coefficient::PRESENT | coefficient::HOMING_MANDATORY;
    let axis = AxisSettings { coefficient, ..settings() };
    let mut prediction = Bim2AxPrediction::new(&PredictionOptions::new(vec![axis]));
    let plan = Plan(line([1500.0, 0.0]));
    prediction.advance(&plan, 0);
    let reached = prediction.advance(&plan, 1100 * MS).position[0];
    assert!((reached - 1500.0).abs() <= 1500.0 * DEAD_S + 1.25, "{reached}");
    // A soft limit counts, as it does in the module.
    let axis = AxisSettings { soft_plus: 700, ..axis };
    let mut prediction = Bim2AxPrediction::new(&PredictionOptions::new(vec![axis]));
    prediction.advance(&plan, 0);
    let stands = prediction.advance(&plan, 2000 * MS).position[0];
    assert!((stands - 700.0).abs() < 1e-9, "{stands}");
}

/// What a quarter of a second of horizon, a start-stop speed of a tenth of the fast speed and a circle make of it:
/// printed with `--nocapture`, and compared with the bounds of the module's documentation.
#[test]
fn a_circle_is_followed_within_chord_dead_time_and_ramps() {
    let (radius, omega) = (1600.0_f64, std::f64::consts::TAU / 4.0);
    let plan = Plan(move |time: f64| {
        let (sin, cos) = (omega * time).sin_cos();
        let speed = radius * omega;
        motion_of([radius * cos, radius * sin], [-speed * sin, speed * cos])
    });
    let (worst, prediction) = largest(&plan, 500, 8000);
    let speed = radius * omega;
    // Legs of T = 0.15 s would have a chord of r·ω²·T²/8 = 11 and a dead time of v·0.011/2 = 14 to either side; the
    // start at 2513 µsteps/s has to accelerate from 2000, which costs (w − u)²/(2a) = 3 with w = 2600.
    let bound = radius * omega * omega * 0.15 * 0.15 / 8.0 + speed * DEAD_S / 2.0 + 3.0;
    println!(
        "circle of {radius} µsteps at {speed:.0} µsteps/s: worst {worst:.1?}, expected {:.1} rms, {} exchanges",
        prediction.expected_error(),
        prediction.exchanges()
    );
    // The plan at the begin moves already, and legs end at turning points of either axis: twice that at most.
    assert!(worst.iter().all(|worst| *worst <= 2.0 * bound), "{worst:?} > 2 · {bound}");
}
