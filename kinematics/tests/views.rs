//! Normalised outputs that no worked vector covers, computed by hand.

use super::measures::TRIPOD;
use crate::Transform;
use crate::gantry::{Gantry2, Range, ToolBeside};
use crate::tripod::{Tripod, TripodDimensions};
use nalgebra::{Vector2, Vector3};
use std::f64::consts::FRAC_PI_2;

#[track_caller]
fn within(error: f64, found: [f64; 2], expected: [f64; 2]) {
    let off = (Vector2::from(found) - Vector2::from(expected)).norm();
    assert!(off < error, "{found:?} {expected:?}");
}

#[track_caller]
fn close(found: [f64; 2], expected: [f64; 2]) {
    within(1e-15, found, expected);
}

/// The axes cross at (40, 30) mm in a picture of 200 × 100 mm; the tool is 20 mm up the picture from there and 10 mm to
/// the left of that, at (30, 50) mm.
#[test]
fn tools_beside() {
    let beside = ToolBeside { angle: FRAC_PI_2, ahead: 0.02, left: 0.01 };
    let gantry = Gantry2::with_tool_offset([0.004, -0.002], beside).unwrap();
    let range = Range { x: [0.0, 0.2], y: [0.0, 0.1] };
    let view = gantry.tool_view(&Vector2::new(0.044, 0.028), &range);
    close(view.crossing.tool, [0.2, 0.3]);
    close(view.crossing.offset, [0.02, -0.02]);
    close(view.legs, [0.1, 0.05]);
    close(view.corner, [0.2, 0.5]);
    close(view.tool, [0.15, 0.5]);
    assert!((view.crossing.ratio - 2.0).abs() < 1e-15);
}

/// Rods 60 mm apart on circles of 50 and 130 mm: the middles of the pairs are 40 and √(130² − 30²) mm out.
#[test]
fn rod_ends() {
    let dimensions = TripodDimensions { outer_radius: 0.13, rod_length: 0.3, ..TRIPOD };
    let tripod = Tripod::new(dimensions, [0.0; 3]).unwrap();
    let tool = Vector3::new(0.013, -0.026, -0.1);
    let view = tripod.view(&tripod.to_axes(&tool).unwrap()).unwrap();
    within(1e-13, view.tool, [0.1, -0.2]);
    assert!((view.ratio - 5.0 / 13.0).abs() < 1e-15);
    let out = (130.0_f64 * 130.0 - 900.0).sqrt() / 130.0;
    close(view.outer[0], [out, -3.0 / 13.0]);
    close(view.outer[1], [out, 3.0 / 13.0]);
    within(1e-13, view.inner[0], [0.1 + 4.0 / 13.0, -0.2 - 3.0 / 13.0]);
    within(1e-13, view.inner[1], [0.1 + 4.0 / 13.0, -0.2 + 3.0 / 13.0]);
    // The ends of every pair are all on their circles.
    for [x, y] in view.outer {
        assert!((x.hypot(y) - 1.0).abs() < 1e-15);
    }
    for [x, y] in view.inner {
        assert!(((x - 0.1).hypot(y + 0.2) - 5.0 / 13.0).abs() < 1e-13);
    }
}
