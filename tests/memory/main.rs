//! Memory test: the stages of motion hold their windows, never the whole program. The heap's peak is the same for a
//! program three hundred times as long; with feeds limited by the axes, which is slower, eight times as long. So it is for one element that is ten times as long.
//!
//! There is only one test, because the counter counts the whole process.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    unreachable_pub,
    reason = "a test fails where it cannot be set up; the modules are shared with other tests"
)]

mod contour;
#[allow(dead_code, reason = "another test counts how often, this one how much")]
mod counter;
#[allow(dead_code, reason = "programs are not placed here")]
#[path = "../planner/machines.rs"]
mod machines;
mod pipeline;

use contour::{Contour, Dialect, din66025_options, rs274_options};
use machines::Machine;
use nalgebra::{Point3, Vector3};
use pipeline::{Failure, count, elements, plan, prepare, sample};
use std::f64::consts::TAU;
use std::io::BufReader;
use std::num::NonZeroUsize;
use twin_gcode::{din66025, rs274};
use twin_kinematics::AxisVector;
use twin_kinematics::gantry::Gantry3;
use twin_path::Place;
use twin_path::prepare::{
    CheckVelocities, CircularLimits, Notices, Preparation, Rounding, ToolRadiusOptions,
};
use twin_path::{Arc, ElementKind, Marks, PathElement, Plane, Shape};
use twin_planner::blended_path::BlendOptions;
use twin_planner::time_optimal::{AxisLimits, KinematicPath, LimitOptions, Planned, Planner};

const FEW: u32 = 1_000;
const MANY: u32 = 300_000;

/// Heap that may come and go with the test's own thread, bytes.
const SLACK: usize = 4096;

/// Where the feed is limited by the axes: rounds of lines with a dwell after each, so that all are planned alike.
const ROUND: u32 = 600;
/// The first leaves behind what the solvers keep: from the second on all are alike.
const ROUNDS: [u32; 2] = [2, 16];

/// Lengths of an element, m.
const LENGTHS: [f64; 2] = [65.0, 650.0];

/// A program of that many lines.
type Run = fn(u32);

fn decode(lines: u32) -> impl Iterator<Item = Result<PathElement, Failure>> {
    let reader = BufReader::new(Contour::new(Dialect::Din66025, lines));
    elements(din66025::Decoder::new(reader, din66025_options()))
}

/// Decoded, planned and sampled.
fn din66025(lines: u32) {
    assert!(sample(prepare(decode(lines))) > lines as usize);
}

fn rs274(lines: u32) {
    let reader = BufReader::new(Contour::new(Dialect::Rs274, lines));
    let decoder = rs274::Decoder::new(reader, rs274_options());
    // M2 is not an element.
    assert_eq!(plan(prepare(elements(decoder))), lines as usize);
}

/// Through the stages of `preparation`, which begin with the first element.
fn prepared(lines: u32, marks: Marks, preparation: &Preparation) {
    let mut marks = Some(marks);
    let path = decode(lines).map(|element| {
        element.map(|element| PathElement { marks: marks.take().unwrap_or_default(), ..element })
    });
    let notices = Notices::default();
    let path = preparation.apply(path, &notices);
    // Whoever runs a path reads what there is to tell.
    let path = CheckVelocities::new(path, 0.1).inspect(|_| while notices.take().is_some() {});
    let elements = count(path);
    assert!(elements >= lines as usize, "{elements}");
}

fn corrected(lines: u32) {
    let marks = Marks::CORRECTION_LEFT.with(Marks::LOOPS);
    let radius = ToolRadiusOptions { radius: 1e-3, ..ToolRadiusOptions::default() };
    let preparation = Preparation {
        tool_radius: Some(radius),
        loops: NonZeroUsize::new(100),
        circular: Some(CircularLimits { acceleration: 1.0, acceleration_jump: 0.1 }),
        ..Preparation::default()
    };
    prepared(lines, marks, &preparation);
}

fn rounded(lines: u32) {
    let preparation = Preparation { rounding: Some(Rounding::default()), ..Preparation::default() };
    prepared(lines, Marks::ROUNDING, &preparation);
}

/// A circle of short lines, over and over.
fn circles(rounds: u32) -> impl Iterator<Item = PathElement> {
    let at = |index: u32| {
        let angle = TAU * f64::from(index % ROUND) / f64::from(ROUND);
        Point3::new(0.3 + 0.04 * angle.cos(), 0.04 * angle.sin(), 0.02)
    };
    let place = |index: u32| Place::at(index + 1);
    (0..rounds * ROUND).flat_map(move |index| {
        let shape = Shape::Line { start: at(index), end: at(index + 1) };
        let line = PathElement::new(place(index), ElementKind::Cut, shape);
        let line = PathElement { feed: 0.06, acceleration: 0.8, deceleration: 0.8, ..line };
        let still = Shape::Line { start: at(index + 1), end: at(index + 1) };
        let dwell = ElementKind::Dwell { time_ns: 10_000_000 };
        let dwell = PathElement::new(place(index), dwell, still);
        [Some(line), (index % ROUND == ROUND - 1).then_some(dwell)].into_iter().flatten()
    })
}

/// Within the limits of the axes, which may be such of jerk.
fn limited(rounds: u32, jerk: bool) {
    let options = LimitOptions::new(BlendOptions::new(1e-5));
    let path = prepare(circles(rounds).map(Ok));
    let mut planner = Planner::new(path, Machine::Scara2.path(jerk), options);
    let mut pauses = 0;
    for planned in &mut planner {
        pauses += u32::from(matches!(planned.unwrap(), Planned::Pause(_)));
    }
    assert_eq!(pauses, rounds);
    assert!(planner.effort().windows >= u64::from(2 * rounds), "{:?}", planner.effort());
}

/// One element on a portal, within the limits of its axes: a line, or a circle of 10 m round and round.
fn element(length: f64, turns: bool, jerk: bool) {
    let start = Point3::origin();
    let shape = if turns {
        let center = Point3::new(10.0, 0.0, 0.0);
        let sweep = length / 10.0;
        let end = center + Vector3::new(-sweep.cos(), -sweep.sin(), 0.0) * 10.0;
        Shape::Arc(Arc::in_plane(Plane::Xy, start, end, center, sweep))
    } else {
        Shape::Line { start, end: Point3::new(0.8 * length, 0.6 * length, 0.0) }
    };
    let place = Place::at(1);
    let element = PathElement { feed: 0.5, ..PathElement::new(place, ElementKind::Cut, shape) };
    let element = PathElement { acceleration: 2.0, deceleration: 2.0, ..element };
    let jerk = jerk.then_some(40.0);
    let limits = AxisLimits { velocity: 0.6, acceleration: 3.0, deceleration: 3.0, jerk };
    let portal = Gantry3::new([0.0; 3]).unwrap();
    let axes = KinematicPath::new(portal, vec![limits; 3], AxisVector::zeros(3));
    let options = LimitOptions::new(BlendOptions::new(1e-6));
    let mut duration = 0.0;
    for planned in Planner::new(prepare(std::iter::once(Ok(element))), axes, options) {
        let Planned::Leg(leg) = planned.unwrap() else { continue };
        duration += leg.stretch.duration();
    }
    // At F, and as long again as it takes to reach F, or a little longer with limited jerk.
    let least = length / 0.5 + 0.5 / 2.0;
    assert!((least - 1e-3..least + 0.1).contains(&duration), "{duration} s, not {least} s");
}

#[test]
fn long_programs_take_no_more_memory_than_short_ones() {
    let runs: [(&str, u32, Run); 4] = [
        ("DIN 66025, sampled", FEW, din66025),
        ("RS274, planned", FEW, rs274),
        // Its windows are longer than a short program.
        ("tool radius correction, loop avoidance, circular limits", 20 * FEW, corrected),
        ("rounding", FEW, rounded),
    ];
    // What counts must count.
    let held = counter::most_during(|| drop(std::hint::black_box(vec![0_u8; 1_000_000])));
    assert!((1_000_000..1_000_000 + SLACK).contains(&held), "{held}");
    for (name, short, run) in runs {
        let few = counter::most_during(|| run(short));
        let many = counter::most_during(|| run(MANY));
        println!("{name}: {few} bytes for {short} lines, {many} bytes for {MANY}");
        assert!(many <= few + SLACK, "{name}: {many} bytes instead of {few}");
    }
    for jerk in [false, true] {
        let [few, many] = ROUNDS.map(|rounds| counter::most_during(|| limited(rounds, jerk)));
        println!("jerks limited: {jerk}: {few} bytes and {many} bytes for {ROUNDS:?} rounds");
        assert!(many <= few + SLACK, "jerks limited: {jerk}: {many} bytes instead of {few}");
        for turns in [false, true] {
            let [few, many] =
                LENGTHS.map(|length| counter::most_during(|| element(length, turns, jerk)));
            let name = format!("an element, circle: {turns}, jerks limited: {jerk}");
            println!("{name}: {few} bytes and {many} bytes for {LENGTHS:?} m");
            // Windows begin where those before end, and are not all equally large.
            assert!(many <= few + few / 4, "{name}: {many} bytes instead of {few}");
        }
    }
}
