//! Tests of programs that limits on curves slow down, against closed forms.

use super::effort_tests::{GANTRY3, Limited, edited, limited, near};
use super::*;
use twin_machine::Machine;

/// dMaxAcc 500 and dMaxAccJump 125 mm/s²: on arcs of 50 mm √(500·50) mm/s, into them √(125·50) mm/s.
const CURVES: (&str, &str) = (
    "# max_circular_acceleration_mm_per_s2 = 2000.0 ",
    "max_circular_acceleration_mm_per_s2 = 500.0\nmax_circular_acceleration_jump_mm_per_s2 = 125.0 ",
);
const FEED: f64 = 0.2;
const ACCELERATION: f64 = 2.0;
const RADIUS: f64 = 0.05;
const ON_ARC: f64 = 0.5 * RADIUS;
const INTO_ARC: f64 = 0.125 * RADIUS;

/// A line of 100 mm, half a circle, a line of 100 mm.
const HAIRPIN: &str = "\
% hairpin
N10 G92 X0 Y0 Z0 F200 E2000 E-2000
N20 G1 X100
N30 G3 X100 Y100 I0 J50
N40 G1 X0
";

/// Time for `length` from and to these squared velocities with at most `top_v2`.
fn trapezoid(length: f64, from_v2: f64, top_v2: f64, to_v2: f64) -> f64 {
    let way = |v2: f64| (top_v2 - v2) / (2.0 * ACCELERATION);
    let time = |v2: f64| (top_v2.sqrt() - v2.sqrt()) / ACCELERATION;
    let rest = length - way(from_v2) - way(to_v2);
    assert!(rest > 0.0);
    time(from_v2) + time(to_v2) + rest / top_v2.sqrt()
}

/// The squared velocities near `way` are within those that lead to `v2` there.
#[track_caller]
fn passes(found: &Limited, way: f64, v2: f64) {
    let mut closest = f64::INFINITY;
    for sample in &found.samples {
        let distance = (sample.way - way).abs();
        let most = v2 + 2.0 * ACCELERATION * distance;
        let found = sample.path_velocity.powi(2);
        assert!(found <= most * (1.0 + 1e-4), "{found} and not {most} at {} m", sample.way);
        closest = closest.min(most - found);
    }
    assert!(closest < 0.05 * v2, "slower than need be by {closest} of {v2}");
}

fn machine(more: &[(&str, &str)]) -> Machine {
    edited(GANTRY3, &[&[CURVES], more].concat())
}

#[test]
fn arcs_and_the_ways_into_them_have_their_velocities() {
    let machine = machine(&[]);
    let found = limited(&machine, HAIRPIN, LimitRules::default());
    let line = trapezoid(0.1, 0.0, FEED * FEED, INTO_ARC);
    let arc = trapezoid(std::f64::consts::PI * RADIUS, INTO_ARC, ON_ARC, INTO_ARC);
    near(found.duration, 2.0 * line + arc, 1e-4);
    passes(&found, 0.1, INTO_ARC);
    passes(&found, 0.1 + std::f64::consts::PI * RADIUS, INTO_ARC);
    let gain = found.changes.iter().find(|change| change.binding == Binding::Centripetal).unwrap();
    // What the closed form gains by 20 % more.
    let duration = |part: f64| {
        let (into, on) = (part * INTO_ARC, part * ON_ARC);
        2.0 * trapezoid(0.1, 0.0, FEED * FEED, into)
            + trapezoid(std::f64::consts::PI * RADIUS, into, on, into)
    };
    near(gain.gain_s, duration(1.0) - duration(1.2), 2e-3);
    let held = |sample: &&ProfileSample| sample.binding == Some(Binding::Centripetal);
    let held: Vec<_> = found.samples.iter().filter(held).collect();
    assert!(held.iter().all(|sample| sample.place.line >= 3), "{:?}", held.first());
    assert!(held.iter().filter(|sample| sample.place.line == 4).count() > 800);
    // The program asks for F200 all the same.
    assert!(found.samples.iter().all(|sample| (sample.feed - FEED).abs() < 1e-12));
    let line = found.lines.iter().find(|line| line.line == 4).unwrap();
    near(line.feed, ON_ARC.sqrt(), 1e-9);

    let rules = LimitRules { centripetal: false, ..LimitRules::default() };
    let free = limited(&machine, HAIRPIN, rules);
    let length = 0.2 + std::f64::consts::PI * RADIUS;
    near(free.duration, length / FEED + FEED / ACCELERATION, 1e-4);
}

/// Around a short arc the places where the acceleration changes come out of several looks and differ by rounding: every leg has a
/// duration all the same. Lines of 100 mm to and from 150 mm/s, which the arc allows √(3000·3) mm/s.
#[test]
fn a_short_arc_between_lines_is_planned() {
    let text = "\
% corner
N10 G92 X100 Y100 Z0
N20 G1 X200 F150 E1000 E-1000
N30 G3 X203 Y103 I0 J3
N40 G1 Y200
";
    let found = limited(&edited(GANTRY3, &[]), text, LimitRules::default());
    assert_eq!(found.findings, []);
    let line = |length: f64, at_arc: f64| {
        let (top, to_top) = (0.15_f64.powi(2), (0.15_f64.powi(2) - at_arc) / 2.0);
        let ramps = 0.15 + (0.15 - at_arc.sqrt());
        ramps + (length - 0.5 * top - to_top) / 0.15
    };
    let arc = 0.003 * std::f64::consts::FRAC_PI_2 / (3.0_f64 * 0.003).sqrt();
    let longest = line(0.1, 0.009) + arc + line(0.097, 0.009);
    // On its way through the arc the path may be faster, for each axis has its limit at one end alone.
    assert!(
        found.duration < longest + 1e-4 && found.duration > longest - arc,
        "{}",
        found.duration
    );
}

/// From one sense of rotation into the other the curvature steps by twice 1/r.
#[test]
fn from_arc_to_arc_it_is_slower() {
    let text = "\
% wave
N10 G92 X0 Y0 Z0 F200 E2000 E-2000
N20 G3 X100 Y0 I50 J0
N30 G2 X200 Y0 I50 J0
";
    let found = limited(&machine(&[]), text, LimitRules::default());
    let half = std::f64::consts::PI * RADIUS;
    passes(&found, half, 0.5 * INTO_ARC);
    near(found.duration, 2.0 * trapezoid(half, 0.0, ON_ARC, 0.5 * INTO_ARC), 1e-4);
}

/// With limited jerk, where joints are rounded, the same velocities hold.
#[test]
fn rounded_joints_keep_the_velocities_of_the_programmed_ones() {
    let jerk = |axis: &'static str, all: &'static str| (axis, all);
    let machine = machine(&[
        jerk("name = \"X\"\n", "name = \"X\"\nmax_jerk_mm_per_s3 = 100000.0\n"),
        jerk("name = \"Y\"\n", "name = \"Y\"\nmax_jerk_mm_per_s3 = 100000.0\n"),
    ]);
    let found = limited(&machine, HAIRPIN, LimitRules::default());
    passes(&found, 0.1, INTO_ARC);
    let line = trapezoid(0.1, 0.0, FEED * FEED, INTO_ARC);
    let arc = trapezoid(std::f64::consts::PI * RADIUS, INTO_ARC, ON_ARC, INTO_ARC);
    let least = 2.0 * line + arc;
    assert!(found.duration > least && found.duration < 1.2 * least, "{} {least}", found.duration);
}
