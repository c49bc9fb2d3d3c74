//! Tests of tools that turn with the path.

use super::Outcome;
use super::tests::checked as outcome;
use crate::finding::Rule;

/// R: 1080 deg/s, 20000 deg/s²; the edge of the knife is 2 mm behind R.
const CUTTER: &str = include_str!("../../machines/gantry_cutter3.toml");
const SCARA3: &str = include_str!("../../machines/scara3.toml");

/// F50 on a radius of 20 mm turns the knife with 50/20 rad/s, and its axis runs on a circle of √(20² + 2²) mm.
#[test]
fn a_knife_on_a_circle() {
    let program = "% circle\nN10 G92 X100 Y0 Z20\nN20 G3 X100 Y0 I0 J20 F50 E2000 E-2000\n";
    let outcome = outcome(CUTTER, program);
    assert!(outcome.findings.is_empty(), "{:#?}", outcome.findings);
    let knife = &outcome.peaks[3];
    assert!((knife.velocity.value - 2.5).abs() < 1e-9, "{:?}", knife.velocity);
    let [low, high] = knife.position.unwrap();
    assert!(low.abs() < 1e-9 && (high - std::f64::consts::TAU).abs() < 1e-9, "{low} {high}");
    let [left, right] = outcome.peaks[0].position.unwrap();
    let radius = 0.02_f64.hypot(0.002);
    assert!((right - left - 2.0 * radius).abs() < 1e-6, "{left} {right}");
    assert!((outcome.peaks[0].velocity.value - 2.5 * radius).abs() < 1e-6);
}

/// At a corner the knife would have to turn at once.
#[test]
fn a_knife_at_a_corner() {
    let program = "% corner\nN10 G92 X0 Y0 Z20\nN20 G1 X50 Y0 F50\nN30 G1 X50 Y50\n";
    let outcome = outcome(CUTTER, program);
    let turned: Vec<_> = outcome
        .findings
        .iter()
        .filter(|finding| finding.axis.as_deref() == Some("R"))
        .map(|finding| (finding.rule, finding.line))
        .collect();
    assert_eq!(turned, [(Rule::AxisVelocity, 4)], "{:#?}", outcome.findings);
    // Its edge behind R, the other axes would have to swing round it at once.
    assert!(outcome.findings.iter().any(|finding| finding.axis.as_deref() == Some("Y")));
}

/// The word P turns the hand of a SCARA, in degrees.
#[test]
fn a_hand_that_an_additional_axis_turns() {
    let machine = SCARA3.replacen("direction = \"fixed\"", "direction = \"P\"", 1);
    let program = "% turn\nN10 G92 X300 Y0 Z20\nN20 G1 X300 Y50 P90 F50\n";
    let turned = outcome(&machine, program);
    assert!(turned.findings.is_empty(), "{:#?}", turned.findings);
    let still = outcome(SCARA3, program);
    assert_eq!(still.findings[0].rule, Rule::UnsupportedWord);
    let range = |outcome: &Outcome| {
        let [low, high] = outcome.peaks[2].position.unwrap();
        high - low
    };
    assert!(range(&turned) > range(&still) + 0.5, "{} {}", range(&turned), range(&still));
}

/// A turn of 0.9° is within the angle tolerance: the path goes on, and the knife would have to turn by it in one cycle.
#[test]
fn a_knife_at_a_slight_turn() {
    let (sin, cos) = 0.9_f64.to_radians().sin_cos();
    let (x, y) = (100.0 + 100.0 * cos, 100.0 * sin);
    let program = format!("% turn\nN10 G92 X0 Y0 Z20\nN20 G1 X100 F50\nN30 G1 X{x:.6} Y{y:.6}\n");
    let outcome = outcome(CUTTER, &program);
    let found: Vec<_> = outcome
        .findings
        .iter()
        .filter(|finding| finding.axis.as_deref() == Some("R"))
        .map(|finding| (finding.rule, finding.line, finding.value.unwrap()))
        .collect();
    let [(Rule::AxisVelocityStep, 4, value)] = found[..] else { panic!("{:#?}", outcome.findings) };
    // 0.9° in a thousandth of a second.
    assert!((value - 900.0).abs() < 0.01, "{value}");
}
