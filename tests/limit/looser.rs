//! Monotonicity: a path takes no longer with looser limits.

use crate::lines::Random;
use crate::path::Limits;
use crate::programs::{Checked, UNLIMITED, all};
use crate::seven_segments;
use nalgebra::{Point3, Vector3};
use std::f64::consts::PI;
use twin_gcode::rs274::PathMode;
use twin_kinematics::AxisVector;
use twin_kinematics::gantry::Gantry3;
use twin_path::prepare::{CheckError, CheckVelocities, CheckedElement};
use twin_path::{ElementKind, PathElement, Place, Shape};
use twin_planner::blended_path::{BlendOptions, Order};
use twin_planner::time_optimal::{AxisLimits, KinematicPath, LimitOptions, Planned, Planner};

/// Path with the tolerance of its blends, m.
struct Course {
    name: String,
    elements: Vec<CheckedElement>,
    tolerance: f64,
    /// The part by which it may take longer with a looser limit.
    room: f64,
}

/// Largest part by which a path may take longer where it stops at corners.
const STOPS: f64 = 1e-4;
/// The same where corners are blended. There the limit of jerk is not convex, and cells in which it is exceeded between the
/// nodes get tighter limits. Plans about different first profiles differ by this part.
const BLENDS: f64 = 1e-3;

/// Limits of every axis and the feed, which is a factor of the programmed one.
#[derive(Clone, Copy, Debug)]
struct Setting {
    axis: Limits,
    feed: f64,
}

impl Setting {
    /// With one of the four limits so many times as large.
    fn looser(mut self, which: usize, times: f64) -> Self {
        let Limits { velocity, acceleration, jerk } = &mut self.axis;
        *[velocity, acceleration, jerk, &mut self.feed][which] *= times;
        self
    }
}

/// Duration of a plan, s.
fn duration(course: &Course, Setting { axis, feed }: Setting) -> f64 {
    let limits = AxisLimits {
        velocity: axis.velocity,
        acceleration: axis.acceleration,
        deceleration: axis.acceleration,
        jerk: Some(axis.jerk),
    };
    let blends = BlendOptions { order: Order::Acceleration, ..BlendOptions::new(course.tolerance) };
    let options = LimitOptions { path_acceleration: false, ..LimitOptions::new(blends) };
    let axes = KinematicPath::new(
        Gantry3::new([0.0; 3]).expect("a gantry"),
        vec![limits; 3],
        AxisVector::zeros(3),
    );
    let elements = course.elements.iter().map(|element| {
        let feed = feed * element.feed;
        // Stops remain.
        let end_velocity = if element.end_velocity > 0.0 { f64::INFINITY } else { 0.0 };
        Ok::<_, CheckError>(PathElement { feed, end_velocity, ..PathElement::clone(element) })
    });
    let mut planner = Planner::new(CheckVelocities::new(elements, PI), axes, options);
    let mut duration = 0.0;
    for part in planner.by_ref() {
        if let Planned::Leg(leg) = part.expect("a plan") {
            duration += leg.stretch.duration();
        }
    }
    assert_eq!(planner.effort().failed, 0, "{}: {axis:?}, feed {feed}", course.name);
    duration
}

/// Programs with cycle times of `LinuxCNC`'s planner, the longer ones up to their sixth element: stops at corners, blends,
/// arcs.
fn programs() -> Vec<Course> {
    let some = ["arcs_g61", "square_g64", "zigzag_g64", "arcs_g64"];
    let programs = all().into_iter().filter(|program| some.contains(&program.name.as_str()));
    let courses = programs.map(|program| {
        let Checked { mut elements, mode } = program.checked(UNLIMITED);
        elements.truncate(6);
        let tolerance = match mode {
            PathMode::Tolerance { path, .. } => path,
            PathMode::ExactPath | PathMode::ExactStop | PathMode::Continuous => 1e-6,
        };
        let room = if program.is_exact() { STOPS } else { BLENDS };
        Course { name: program.name, elements, tolerance, room }
    });
    courses.collect()
}

/// Turns of the path from which on they are stops, rad.
const SHARP: f64 = 0.1;

/// Lines of 0.01 mm up to the `longest`, m, with feeds of 0.1 mm/s up to the `fastest`, m/s, where `direction` leads, with a
/// pause after every fourth. Turns of more than `sharp` are stops.
fn polyline(
    random: &mut Random,
    [longest, fastest]: [f64; 2],
    sharp: f64,
    direction: impl Fn(u32, &mut Random) -> Vector3<f64>,
) -> Vec<CheckedElement> {
    let mut at = Point3::origin();
    let mut elements = Vec::new();
    for line in 1..=12 {
        let length = random.within(1e-5, longest);
        let feed = random.within(1e-4, fastest).max(length / 0.5);
        let end = at + direction(line, random) * length;
        let place = Place::at(line);
        let element = |kind, shape| PathElement {
            feed,
            acceleration: UNLIMITED,
            deceleration: UNLIMITED,
            ..PathElement::new(place, kind, shape)
        };
        elements.push(element(ElementKind::Cut, Shape::Line { start: at, end }));
        if line % 4 == 0 {
            let here = Shape::Line { start: end, end };
            let pause = if line % 8 == 0 {
                ElementKind::MFunction { number: 7 }
            } else {
                ElementKind::Dwell { time_ns: 1_000_000 }
            };
            elements.push(element(pause, here));
        }
        at = end;
    }
    let elements = elements.into_iter().map(Ok::<_, CheckError>);
    CheckVelocities::new(elements, sharp).collect::<Result<_, _>>().expect("a path")
}

/// Factors of one limit.
const STEPS: [f64; 8] = [1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0];

/// The largest part by which a path takes longer with one of its limits looser, the others as they are, than with that limit
/// tighter.
fn longer(course: &Course, setting: Setting) -> f64 {
    let mut worst = f64::NEG_INFINITY;
    for (which, name) in ["velocity", "acceleration", "jerk", "feed"].into_iter().enumerate() {
        let durations = STEPS.map(|times| duration(course, setting.looser(which, times)));
        let mut least = f64::INFINITY;
        for duration in durations {
            worst = worst.max(duration / least - 1.0);
            least = least.min(duration);
        }
        println!("{} {name} {worst:+.1e} {durations:?}", course.name);
    }
    worst
}

const SETTING: Setting =
    Setting { axis: Limits { velocity: 0.05, acceleration: 2.0, jerk: 5.0 }, feed: 1.0 };

fn take_no_longer(courses: &[Course]) {
    for course in courses {
        let worst = longer(course, SETTING);
        println!("{:12} {worst:+.1e}", course.name);
        assert!(worst < course.room, "{}: {worst:+.1e}", course.name);
    }
}

#[test]
fn programs_take_no_longer_with_looser_limits() {
    take_no_longer(&programs());
}

/// Random polylines of twelve lines.
fn polylines() -> Vec<Course> {
    let mut random = Random(3);
    let course = |number| {
        // Every second one is slow, as in a V-carving, and stops at its corners; others are blended.
        let (ranges, sharp, room) =
            if number % 2 == 0 { ([5e-4, 2e-3], SHARP, STOPS) } else { ([1e-2, 0.1], PI, BLENDS) };
        let elements = polyline(&mut random, ranges, sharp, |_, random| {
            Vector3::from([0; 3].map(|_| random.within(0.1, 10.0).ln())).normalize()
        });
        Course { name: format!("polyline {number}"), elements, tolerance: 5e-5, room }
    };
    (0..4).map(course).collect()
}

#[test]
fn polylines_take_no_longer_with_looser_limits() {
    take_no_longer(&polylines());
}

/// Starts and ends at corners, dwells and M functions are like those of a program.
#[test]
fn lines_between_stops_take_the_closed_form() {
    let mut random = Random(5);
    for jerk in [0.5, 5.0, 60.0, 600.0] {
        let axis = Limits { velocity: 0.4, acceleration: 3.0, jerk };
        // To and fro along X.
        let elements = polyline(&mut random, [1e-2, 0.1], SHARP, |line, _| {
            Vector3::x() * if line % 2 == 0 { 1.0 } else { -1.0 }
        });
        let lines = elements.iter().filter(|element| element.kind == ElementKind::Cut);
        let least = lines.map(|line| {
            let limits = Limits { velocity: line.feed, ..axis };
            seven_segments::duration(line.path_length(), limits).0
        });
        let least: f64 = least.sum();
        let course =
            Course { name: format!("{jerk} m/s³"), elements, tolerance: 1e-6, room: STOPS };
        let part = duration(&course, Setting { axis, feed: 1.0 }) / least - 1.0;
        println!("{:10} {part:+.1e}", course.name);
        assert!((-1e-6..5e-4).contains(&part), "{}: {part:+e}", course.name);
    }
}
