//! SCARAs (manual 8.2.4 and 8.2.5).

use super::gantries::{lengths, mm, point};
use super::vector::{Vector, check};
use nalgebra::{Vector2, Vector3};
use twin_kinematics::KinematicsError;
use twin_kinematics::scara::{Elbow, Scara2, Scara3};
use twin_kinematics::transform::Transform;

fn elbow(vector: &Vector) -> Elbow {
    match vector.word("bElbowLow").as_str() {
        "true" => Elbow::Low,
        "false" => Elbow::High,
        other => panic!("bElbowLow is {other}"),
    }
}

/// Two arms and a tool position for them.
fn two_arms(id: &str) {
    check(id, |vector| {
        let offsets = Vector2::from_vec(vector.numbers("off")).map(f64::to_radians);
        let scara = Scara2::new(lengths(vector, "L"), offsets.into(), elbow(vector)).unwrap();
        let found = scara.to_axes(&point(vector, "pi"));
        vector.expect_that("bError", found.is_err());
        let axes = found.unwrap();
        vector.expect("dA", [axes.x.to_degrees()]);
        vector.expect("dB", [axes.y.to_degrees()]);
        let back = scara.to_tool(&axes).unwrap() - point::<2>(vector, "pi");
        assert!(back.norm() < 1e-15, "{back}");
    });
}

#[test]
pub(crate) fn two_arms_low() {
    two_arms("trafo-scara2-low");
}

#[test]
pub(crate) fn two_arms_high() {
    two_arms("trafo-scara2-high");
}

#[test]
pub(crate) fn two_arms_too_short() {
    check("trafo-scara2-unreachable", |vector| {
        for elbow in [Elbow::Low, Elbow::High] {
            let scara = Scara2::new(lengths(vector, "L"), [0.0; 2], elbow).unwrap();
            let found = scara.to_axes(&point(vector, "pi"));
            vector.expect_that("bError", found.is_err());
            assert!(matches!(found, Err(KinematicsError::Unreachable { .. })), "{found:?}");
        }
    });
}

#[test]
pub(crate) fn three_arms() {
    check("trafo-scara3", |vector| {
        let arms = lengths::<3>(vector, "L");
        let scara = Scara3::new(arms, [0.0; 3], elbow(vector)).unwrap();
        let tip = point::<2>(vector, "pi");
        let tool = Vector3::new(tip.x, tip.y, vector.number("Direction").to_radians());
        let axes = scara.to_axes(&tool).unwrap();
        vector.expect("dA", [axes.x.to_degrees()]);
        vector.expect("dB", [axes.y.to_degrees()]);
        vector.expect("dC", [axes.z.to_degrees()]);
        // The first two arms alone end at the wrist.
        let upper = Scara2::new([arms[0], arms[1]], [0.0; 2], scara.elbow()).unwrap();
        vector.expect("wrist", mm(upper.to_tool(&axes.xy()).unwrap()));
        let back = scara.to_tool(&axes).unwrap() - tool;
        assert!(back.norm() < 1e-15, "{back}");
    });
}
