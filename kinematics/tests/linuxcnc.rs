//! Comparison with LinuxCNC's kinematics modules: `tests/data/linuxcnc-kinematics.json`, made by
//! `tests/peers/linuxcnc_kins.py`. The file gives its source and conventions, such as mm and degrees.

use crate::gantry::{BeltLayout, GantryH2};
use crate::scara::{Elbow, Scara2, Scara3};
use crate::tripod::{Tripod, TripodDimensions};
use crate::{
    AxisSource, AxisVector, Branch, Coordinate, Kinematics, KinematicsError, MachineAxes, Pose,
    ReachOf,
};
use nalgebra::Vector3;
use serde_json::Value;
use std::f64::consts::FRAC_PI_2;

/// What the two may differ by, mm or degrees: rounding, and what is left of it where LinuxCNC solves a quadratic whose
/// coefficients are far larger than its solution.
const TOLERANCE: f64 = 1e-10;

const Z: AxisSource = AxisSource::Coordinate(Coordinate::Z);

/// Calls of one function with one set of dimensions.
struct Series {
    forward: bool,
    flag: u64,
    pins: Vec<f64>,
    rows: Vec<Row>,
}

/// One call: the given values, 0 or an error, the flag for the inverse function that the forward function set, and the
/// values found.
type Row = (Vec<f64>, i64, u64, Vec<f64>);

fn series(module: &str) -> Vec<Series> {
    let file = include_str!("../../tests/data/linuxcnc-kinematics.json");
    let file: Value = serde_json::from_str(file).unwrap();
    let one = |series: &Value| Series {
        forward: series["direction"] == "forward",
        flag: series["flag"].as_u64().unwrap(),
        pins: serde_json::from_value(series["pins"].clone()).unwrap(),
        rows: serde_json::from_value(series["rows"].clone()).unwrap(),
    };
    file["modules"][module]["series"].as_array().unwrap().iter().map(one).collect()
}

/// Number of values compared, and of calls to which neither has an answer.
#[derive(Debug, Default)]
struct Comparison {
    compared: usize,
    refused: usize,
}

impl Comparison {
    fn compare(&mut self, found: &[f64], theirs: &[f64]) {
        assert_eq!(found.len(), theirs.len());
        for (found, theirs) in found.iter().zip(theirs) {
            assert!((found - theirs).abs() <= TOLERANCE, "{found} {theirs}");
        }
        self.compared += found.len();
    }

    #[track_caller]
    fn finish(&self, compared: usize, refused: usize) {
        assert!(self.compared >= compared && self.refused >= refused, "{self:?}");
    }
}

fn mm(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    values.into_iter().map(|value| value * 1e3).collect()
}

fn meters(values: &[f64]) -> AxisVector {
    AxisVector::from_values(values.iter().map(|value| value * 1e-3))
}

fn pose_at(values: &[f64]) -> Pose {
    Pose::at(values[0] * 1e-3, values[1] * 1e-3, values[2] * 1e-3)
}

/// The place or the three axes, mm.
fn answer(machine: &dyn Kinematics, forward: bool, given: &[f64]) -> crate::Result<Vec<f64>> {
    if forward {
        return Ok(mm(machine.forward(&meters(given))?.position.iter().copied()));
    }
    Ok(mm(machine.inverse(&pose_at(given), &AxisVector::zeros(3))?.iter().copied()))
}

/// Joints are x + y and x − y: an H gantry whose drives move x when they go the same way.
#[test]
fn corexykins_is_an_h_gantry_with_coordinates_exchanged() {
    let layout = BeltLayout { coordinates_exchanged: true, drives_exchanged: false };
    let gantry = Box::new(GantryH2::new([0.0; 2], layout).unwrap());
    let sources = vec![AxisSource::Transform(0), AxisSource::Transform(1), Z];
    let machine = MachineAxes::new(gantry, sources, Vector3::zeros()).unwrap();
    let mut comparison = Comparison::default();
    for series in series("corexykins") {
        for (given, _, _, theirs) in &series.rows {
            let found = answer(&machine, series.forward, given).unwrap();
            comparison.compare(&found, theirs);
        }
    }
    comparison.finish(1200, 0);
}

/// Towers at the distance R from the middle of a platform without extent or, which is the same, so much farther out
/// than the rod ends of one that has some; A at +y.
#[test]
fn lineardeltakins_is_a_tripod_with_carriage_a_at_y() {
    let mut comparison = Comparison::default();
    for series in series("lineardeltakins") {
        let [radius, rod_length] = [series.pins[0] * 1e-3, series.pins[1] * 1e-3];
        for (inner_radius, rod_distance) in [(0.0, 0.0), (0.033, 0.0), (0.04, 0.05)] {
            let half = 0.5 * rod_distance;
            let inner = f64::sqrt(inner_radius * inner_radius - half * half);
            let dimensions = TripodDimensions {
                inner_radius,
                outer_radius: (inner + radius).hypot(half),
                rod_length,
                rod_distance,
                rotation: FRAC_PI_2,
            };
            let tripod = Tripod::new(dimensions, [0.0; 3]).unwrap();
            for (given, status, _, theirs) in &series.rows {
                let found = answer(&tripod, series.forward, given);
                // Where rods would point up lineardeltakins answers all the same; we do not.
                let succeeded = *status == 0;
                let is_below = |carriage: &f64| theirs[2] > *carriage;
                let points_up = series.forward && succeeded && given.iter().any(is_below);
                assert_eq!(found.is_ok(), succeeded && !points_up, "{given:?}");
                match found {
                    Ok(found) => comparison.compare(&found, theirs),
                    Err(KinematicsError::Apart(_)) if series.forward => comparison.refused += 1,
                    Err(KinematicsError::Unreachable { of: ReachOf::Rod(_), .. }) => {
                        comparison.refused += 1;
                    }
                    Err(other) => panic!("{given:?}: {other}"),
                }
            }
        }
    }
    comparison.finish(3000, 100);
}

/// D2 and D4 are the first two arms, D6 is a third one or, of any sign, a tool in front of the last axis; with 0 for it there
/// may be no hand. D5 is a tool straight down, and the axis of z is D1 + D3 less joint 2.
#[test]
fn scarakins_is_a_scara_with_three_arms_or_two() {
    // Numbers of the machines with two arms and of those with three.
    let mut comparisons = [Comparison::default(), Comparison::default()];
    // LinuxCNC's answers to targets out of reach, and those of its forward function about the elbow.
    let (mut stretched, mut doubtful) = (0, 0);
    for series in series("scarakins") {
        let [d1, d2, d3, d4, d5, d6] = [0, 1, 2, 3, 4, 5].map(|pin| series.pins[pin] * 1e-3);
        let elbow = if series.flag == 0 { Elbow::Low } else { Elbow::High };
        let mut machines: Vec<(usize, Box<dyn Kinematics>, f64)> = Vec::new();
        for third in [d6, 0.0].into_iter().filter(|third| *third >= 0.0) {
            let scara = Scara3::new([d2, d4, third], [0.0; 3], elbow).unwrap();
            machines.push((3, Box::new(scara), d6 - third));
        }
        if d6 == 0.0 {
            machines.push((2, Box::new(Scara2::new([d2, d4], [0.0; 2], elbow).unwrap()), 0.0));
        }
        for (arms, scara, ahead) in machines {
            let comparison = &mut comparisons[arms - 2];
            let sources = (0..arms).map(AxisSource::Transform).chain([Z]).collect();
            let machine = MachineAxes::new(scara, sources, Vector3::new(ahead, 0.0, -d5)).unwrap();
            let joints_of = |axes: &AxisVector| {
                let z = (d1 + d3 - axes[arms]) * 1e3;
                [axes[0].to_degrees(), axes[1].to_degrees(), z, axes[2].to_degrees()]
            };
            let axes_of = |joints: &[f64]| {
                let angles = [0, 1, 3].map(|joint: usize| joints[joint].to_radians());
                let z = d1 + d3 - joints[2] * 1e-3;
                AxisVector::from_values(angles.into_iter().take(arms).chain([z]))
            };
            for (given, status, flag, found) in &series.rows {
                assert_eq!(*status, 0);
                if series.forward {
                    let axes = axes_of(given);
                    let pose = machine.forward(&axes).unwrap();
                    let position = mm(pose.position.iter().copied());
                    comparison.compare(&position, &found[..3]);
                    if arms == 3 {
                        comparison.compare(&[pose.direction.to_degrees()], &found[3..]);
                    }
                    let ours = u64::from(machine.branch_at(&axes).unwrap() == Branch::ElbowHigh);
                    // Between 0° and 90° the flag names the elbow that these joints do not have.
                    assert_eq!(ours != *flag, (0.0..90.0).contains(&given[1]), "{given:?}");
                    doubtful += usize::from(ours != *flag);
                    continue;
                }
                let direction = if arms == 3 { given[3].to_radians() } else { 0.0 };
                let pose = Pose { direction, ..pose_at(given) };
                let reach = if arms == 3 { ReachOf::Wrist } else { ReachOf::Arms };
                match machine.inverse(&pose, &axes_of(found)) {
                    Ok(axes) => comparison.compare(&joints_of(&axes)[..=arms], &found[..=arms]),
                    Err(KinematicsError::Unreachable { of, .. }) if of == reach => {
                        // 0 is success, with arms stretched that do not get there (or folded).
                        let reached = machine.forward(&axes_of(found)).unwrap().position;
                        assert!((reached - pose.position).norm() > 1e-5);
                        assert!([0.0, 180.0].contains(&found[1].abs()), "{found:?}");
                        comparison.refused += 1;
                        stretched += 1;
                    }
                    Err(other) => panic!("{given:?}: {other}"),
                }
            }
        }
    }
    assert!(stretched > 50 && doubtful > 50, "{stretched} clamped targets, {doubtful} elbows");
    comparisons[0].finish(400, 10);
    comparisons[1].finish(4000, 50);
}
