//! Tripods (manual 8.2.6), as designed and, with all deviations 0, as measured.

use super::gantries::{lengths, mm, point};
use super::vector::{Vector, check};
use nalgebra::Vector3;
use twin_kinematics::KinematicsError;
use twin_kinematics::transform::Transform;
use twin_kinematics::tripod::{CalibratedTripod, Tripod, TripodDeviations, TripodDimensions};

fn dimensions(vector: &Vector) -> TripodDimensions {
    let length = |name| vector.number(name) * 1e-3;
    TripodDimensions {
        inner_radius: length("dInnerRadius"),
        outer_radius: length("dOuterRadius"),
        rod_length: length("dLength"),
        rod_distance: length("dDistance"),
        rotation: vector.number("dRotationOffset").to_radians(),
    }
}

fn both(dimensions: TripodDimensions, offsets: [f64; 3]) -> (Tripod, CalibratedTripod) {
    let rods = dimensions.rods(&TripodDeviations::default()).unwrap();
    let measured = CalibratedTripod::new(rods, offsets).unwrap();
    (Tripod::new(dimensions, offsets).unwrap(), measured)
}

fn expect_axes(vector: &Vector, axes: &Vector3<f64>) {
    for (name, axis) in ["dA", "dB", "dC"].into_iter().zip(axes) {
        vector.expect(name, [axis * 1e3]);
    }
}

#[test]
pub(crate) fn within_reach() {
    check("trafo-tripod", |vector| {
        let dimensions = dimensions(vector);
        // The middle of a pair's upper ends minus that of its lower ones.
        for pair in dimensions.rods(&TripodDeviations::default()).unwrap().chunks(2) {
            let across = (pair[0].upper - pair[0].lower) + (pair[1].upper - pair[1].lower);
            vector.expect("e", [across.norm() * 0.5e3]);
        }
        let (designed, measured) = both(dimensions, lengths(vector, "off"));
        let tool = point(vector, "pi");
        let axes = designed.to_axes(&tool).unwrap();
        expect_axes(vector, &axes);
        expect_axes(vector, &measured.to_axes(&tool).unwrap());
        vector.expect("fwd", mm(designed.to_tool(&axes).unwrap()));
        vector.expect("fwd", mm(measured.to_tool(&axes).unwrap()));
    });
}

#[test]
pub(crate) fn out_of_reach() {
    check("trafo-tripod-unreachable", |vector| {
        let (designed, measured) = both(dimensions(vector), [0.0; 3]);
        let tool = point(vector, "pi");
        for found in [designed.to_axes(&tool), measured.to_axes(&tool)] {
            vector.expect_that("bError", found.is_err());
            assert!(matches!(found, Err(KinematicsError::Unreachable { .. })), "{found:?}");
        }
    });
}
