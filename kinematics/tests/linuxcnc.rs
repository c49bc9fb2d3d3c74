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

/// One call.
struct Row {
    given: Vec<f64>,
    /// What the function returned was no error.
    succeeded: bool,
    /// The flag for the inverse function that the forward function set.
    flag: u64,
    found: Vec<f64>,
}

fn series(module: &str) -> Vec<Series> {
    let file = include_str!("../../tests/data/linuxcnc-kinematics.json");
    let file: Value = serde_json::from_str(file).unwrap();
    let numbers = |value: &Value| -> Vec<f64> {
        value.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let row = |row: &Value| Row {
        given: numbers(&row[0]),
        succeeded: row[1] == 0,
        flag: row[2].as_u64().unwrap(),
        found: numbers(&row[3]),
    };
    let one = |series: &Value| Series {
        forward: series["direction"] == "forward",
        flag: series["flag"].as_u64().unwrap(),
        pins: numbers(&series["pins"]),
        rows: series["rows"].as_array().unwrap().iter().map(row).collect(),
    };
    file["modules"][module]["series"].as_array().unwrap().iter().map(one).collect()
}

/// The largest difference, mm or degrees, and how many numbers were compared.
#[derive(Debug, Default)]
struct Comparison {
    worst: f64,
    compared: usize,
    /// Where neither has an answer.
    refused: usize,
}

impl Comparison {
    fn compare(&mut self, found: &[f64], theirs: &[f64]) {
        assert_eq!(found.len(), theirs.len());
        for (found, theirs) in found.iter().zip(theirs) {
            let difference = (found - theirs).abs();
            assert!(difference <= TOLERANCE, "{found} {theirs}");
            self.worst = self.worst.max(difference);
            self.compared += 1;
        }
    }

    #[track_caller]
    fn finish(&self, module: &str, compared: usize, refused: usize) {
        println!("{module}: {self:?}");
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

/// Joints are x + y and x − y: an H gantry whose drives move x when they go the same way.
#[test]
fn corexykins_is_an_h_gantry_with_coordinates_exchanged() {
    let layout = BeltLayout { coordinates_exchanged: true, drives_exchanged: false };
    let gantry = Box::new(GantryH2::new([0.0; 2], layout).unwrap());
    let sources = vec![AxisSource::Transform(0), AxisSource::Transform(1), Z];
    let machine = MachineAxes::new(gantry, sources, Vector3::zeros()).unwrap();
    let mut comparison = Comparison::default();
    for series in series("corexykins") {
        for row in &series.rows {
            let found = if series.forward {
                mm(machine.forward(&meters(&row.given)).unwrap().position.iter().copied())
            } else {
                let near = AxisVector::zeros(3);
                mm(machine.inverse(&pose_at(&row.given), &near).unwrap().iter().copied())
            };
            comparison.compare(&found, &row.found);
        }
    }
    comparison.finish("corexykins", 1200, 0);
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
            for row in &series.rows {
                let found = if series.forward {
                    let pose = tripod.forward(&meters(&row.given));
                    pose.map(|pose| mm(pose.position.iter().copied()))
                } else {
                    let axes = tripod.inverse(&pose_at(&row.given), &AxisVector::zeros(3));
                    axes.map(|axes| mm(axes.iter().copied()))
                };
                // Where rods would point up lineardeltakins answers all the same; we do not.
                let points_up = series.forward
                    && row.succeeded
                    && row.given.iter().any(|carriage| row.found[2] > *carriage);
                assert_eq!(found.is_ok(), row.succeeded && !points_up, "{:?}", row.given);
                match found {
                    Ok(found) => comparison.compare(&found, &row.found),
                    Err(KinematicsError::Apart(_)) if series.forward => comparison.refused += 1,
                    Err(KinematicsError::Unreachable { of: ReachOf::Rod(_), .. }) => {
                        comparison.refused += 1;
                    }
                    Err(other) => panic!("{:?}: {other}", row.given),
                }
            }
        }
    }
    comparison.finish("lineardeltakins", 3000, 100);
}

/// D2 and D4 are the first two arms, D6 is a third one or, of any sign, a tool in front of the last axis; D5 is a tool
/// straight down, and the axis of z is D1 + D3 less joint 2.
#[test]
fn scarakins_is_a_scara_with_three_arms() {
    let mut comparison = Comparison::default();
    // What LinuxCNC does about targets out of reach, and its forward function about the elbow.
    let (mut stretched, mut doubtful) = (0, 0);
    for series in series("scarakins") {
        let [d1, d2, d3, d4, d5, d6] = [0, 1, 2, 3, 4, 5].map(|pin| series.pins[pin] * 1e-3);
        let elbow = if series.flag == 0 { Elbow::Low } else { Elbow::High };
        for third in [d6, 0.0].into_iter().filter(|third| *third >= 0.0) {
            let scara = Scara3::new([d2, d4, third], [0.0; 3], elbow).unwrap();
            let sources =
                [0, 1, 2].map(AxisSource::Transform).into_iter().chain([Z]).collect::<Vec<_>>();
            let tool = Vector3::new(d6 - third, 0.0, -d5);
            let machine = MachineAxes::new(Box::new(scara), sources, tool).unwrap();
            let joints_of = |axes: &AxisVector| {
                let [a, b, c] = [0, 1, 2].map(|axis| axes[axis].to_degrees());
                [a, b, (d1 + d3 - axes[3]) * 1e3, c]
            };
            let axes_of = |joints: &[f64]| {
                let [a, b, c] = [0, 1, 3].map(|joint: usize| joints[joint].to_radians());
                AxisVector::from_values([a, b, c, d1 + d3 - joints[2] * 1e-3])
            };
            for Row { given, succeeded, flag, found } in &series.rows {
                assert!(succeeded);
                if series.forward {
                    let axes = axes_of(given);
                    let pose = machine.forward(&axes).unwrap();
                    let position = mm(pose.position.iter().copied());
                    comparison.compare(&position, &found[..3]);
                    comparison.compare(&[pose.direction.to_degrees()], &found[3..]);
                    let ours = u64::from(machine.branch_at(&axes).unwrap() == Branch::ElbowHigh);
                    // Between 0° and 90° the flag names the elbow that these joints do not have.
                    assert_eq!(ours != *flag, (0.0..90.0).contains(&given[1]), "{given:?}");
                    doubtful += usize::from(ours != *flag);
                    continue;
                }
                let pose = Pose { direction: given[3].to_radians(), ..pose_at(given) };
                match machine.inverse(&pose, &axes_of(found)) {
                    Ok(axes) => comparison.compare(&joints_of(&axes), found),
                    Err(KinematicsError::Unreachable { of: ReachOf::Wrist, .. }) => {
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
    println!("{stretched} clamped targets, {doubtful} doubtful elbows");
    assert!(stretched > 50 && doubtful > 50);
    comparison.finish("scarakins", 4000, 50);
}

/// The same arms without a hand: D6 = 0 and the direction does not matter.
#[test]
fn scarakins_without_d6_is_a_scara_with_two_arms() {
    let mut comparison = Comparison::default();
    for series in series("scarakins").into_iter().filter(|series| series.pins[5] == 0.0) {
        let elbow = if series.flag == 0 { Elbow::Low } else { Elbow::High };
        let arms = [series.pins[1] * 1e-3, series.pins[3] * 1e-3];
        let scara = Scara2::new(arms, [0.0; 2], elbow).unwrap();
        for Row { given, found, .. } in &series.rows {
            let angles = |joints: &[f64]| {
                AxisVector::from_values([joints[0].to_radians(), joints[1].to_radians()])
            };
            if series.forward {
                let pose = scara.forward(&angles(given)).unwrap();
                comparison.compare(&mm([pose.position.x, pose.position.y]), &found[..2]);
                continue;
            }
            let pose = Pose::at(given[0] * 1e-3, given[1] * 1e-3, 0.0);
            match scara.inverse(&pose, &angles(found)) {
                Ok(axes) => {
                    let joints: Vec<_> = axes.iter().map(|axis| axis.to_degrees()).collect();
                    comparison.compare(&joints, &found[..2]);
                }
                Err(KinematicsError::Unreachable { of: ReachOf::Arms, .. }) => {
                    comparison.refused += 1;
                }
                Err(other) => panic!("{given:?}: {other}"),
            }
        }
    }
    comparison.finish("scarakins, two arms", 400, 10);
}
