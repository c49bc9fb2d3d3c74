//! Tests of work offsets: coordinate systems, G92, G53, G28 and G30, in closed form.

use super::*;
use crate::rs274::LengthUnit;
use ElementKind::{Cut, Rapid};
use nalgebra::{Isometry3, Vector3};
use std::array;
use std::f64::consts::FRAC_PI_2;

/// Where the path ends, mm.
#[track_caller]
fn end_mm(options: &DecoderOptions, program: &str) -> [f64; 3] {
    *ends_mm(&elements_with(options.clone(), &format!("{program}\nM2"))).last().unwrap()
}

/// G54 at 1, G55 at 2 … on X, and 10, 20 … on Y, mm.
fn options() -> DecoderOptions {
    let system = |index: usize| at([1e-3 * (index + 1) as f64, 1e-2 * (index + 1) as f64, 0.0]);
    DecoderOptions {
        work_offsets: array::from_fn(system),
        g28: at([0.1, 0.2, 0.3]),
        g30: at([-0.1, -0.2, -0.3]),
        ..DecoderOptions::default()
    }
}

#[test]
fn coordinate_systems() {
    let words = ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"];
    for (index, word) in words.into_iter().enumerate() {
        let number = (index + 1) as f64;
        let expected = [number + 5.0, 10.0 * number + 6.0, 7.0];
        assert_eq!(end_mm(&options(), &format!("{word} G0 X5 Y6 Z7")), expected, "{word}");
        // Axes that are not named stay where they are in the machine.
        assert_eq!(
            end_mm(&options(), &format!("G0 X1 Y1 Z1\n{word} X5")),
            [number + 5.0, 11.0, 1.0]
        );
    }
    assert_eq!(end_mm(&options(), "G0 X5"), [6.0, 0.0, 0.0], "G54 to begin with");
}

#[test]
fn machine_frame() {
    assert_eq!(end_mm(&options(), "G56 G53 G0 X5 Z7"), [5.0, 0.0, 7.0]);
    // For its line alone.
    assert_eq!(end_mm(&options(), "G53 G0 X5\nX5"), [6.0, 0.0, 0.0]);
    assert_eq!(end_mm(&options(), "G92 X100\nG53 G1 X5 F1"), [5.0, 0.0, 0.0]);
}

#[test]
fn set_position() {
    // On top of the coordinate system; without one in linuxcnc.txt (g92 forms).
    assert_eq!(end_mm(&options(), "G55 G0 X5\nG92 X0\nX1"), [8.0, 0.0, 0.0]);
    assert_eq!(end_mm(&options(), "G55 G0 X5\nG92 X0\nG54 X1"), [7.0, 0.0, 0.0]);
    // No motion, and no element.
    assert_eq!(elements("G92 X7 Y8 Z9\nM2"), []);
}

#[test]
fn home() {
    let home = |program: &str| ends_mm(&elements_with(options(), &format!("{program}\nM2")));
    let (g28, g30) = ([100.0, 200.0, 300.0], [-100.0, -200.0, -300.0]);
    assert_eq!(home("G28").last(), Some(&g28));
    assert_eq!(home("G30").last(), Some(&g30));
    // Through a point of the program's coordinates, with the axes named.
    assert_eq!(home("G28 Z5"), [[0.0, 0.0, 5.0], [0.0, 0.0, 300.0]]);
    assert_eq!(home("G91 G30 X5 Z1"), [[5.0, 0.0, 1.0], [-100.0, 0.0, -300.0]]);
    assert_eq!(home("G55 G28 X5"), [[7.0, 0.0, 0.0], [100.0, 0.0, 0.0]]);
    let found = elements_with(options(), "G1 F60\nG28 X1\nX2\nM2");
    assert_eq!(kinds(&found), [Cut, Rapid, Rapid, Cut], "G1 stays in force");
}

/// Checks where the path ends in a work frame at `translation`, mm, that is turned about z by `angle`.
#[track_caller]
fn expect_in_frame(translation: [f64; 3], angle: f64, cases: &[(&str, [f64; 3])]) {
    let translation = Vector3::from(translation) * 1e-3;
    let work_frame = Isometry3::new(translation, Vector3::z() * angle);
    for (program, expected) in cases {
        let found = end_mm(&DecoderOptions { work_frame, ..options() }, program);
        let near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(near, "{program}: {found:?}, expected {expected:?}");
    }
}

/// machine = work + (100, 50, -20); G54 is at (1, 10, 0).
#[test]
fn machine_frame_beyond_a_shifted_work_frame() {
    expect_in_frame(
        [100.0, 50.0, -20.0],
        0.0,
        &[
            ("G53 G0 X0 Y0", [-100.0, -50.0, 0.0]),
            ("G0 X9 Y10 Z5\nG53 G1 Z0 F1", [10.0, 20.0, 20.0]),
            ("G53 G0 X0\nX0", [1.0, 0.0, 0.0]),
            ("G28", [0.0, 150.0, 320.0]),
            ("G91 G30 Z0", [0.0, 0.0, -280.0]),
            ("G0 X9 Y10 Z5\nG28.1\nG0 X0 Y0 Z0\nG28", [10.0, 20.0, 5.0]),
            ("G0 X9 Y10 Z5\nG30.1\nG0 X#5181 Y#5182 Z#5183", [111.0, 80.0, -15.0]),
            // The tool is in force, but G53 and G28 leave it out.
            ("G43.1 Z7\nG0 Z5\nG53 G0 Z0", [0.0, 0.0, 20.0]),
            ("G43.1 Z7\nG0 Z5\nG91 G28 Z0", [0.0, 0.0, 320.0]),
        ],
    );
}

/// machine = (100 - y, x, z).
#[test]
fn machine_frame_beyond_a_turned_work_frame() {
    expect_in_frame(
        [100.0, 0.0, 0.0],
        FRAC_PI_2,
        &[
            ("G0 X9 Y10 Z5\nG53 G0 X0", [10.0, 100.0, 5.0]),
            ("G0 X9 Y10 Z5\nG53 G0 Y0", [0.0, 20.0, 5.0]),
            ("G0 X9 Y10 Z5\nG53 G0 X0 Y0 Z0", [0.0, 100.0, 0.0]),
            ("G0 X9 Y10 Z5\nG28", [200.0, 0.0, 300.0]),
            ("G0 X9 Y10 Z5\nG28 Y10", [200.0, 20.0, 5.0]),
            ("G0 X9 Y10 Z5\nG28.1\nG0 X#5161 Y#5162", [81.0, 20.0, 5.0]),
        ],
    );
}

/// A move that goes where the machine is goes nowhere.
#[test]
fn machine_frame_where_the_machine_is() {
    let work_frame = Isometry3::new(Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.3, 0.2, 0.1));
    let options = DecoderOptions { work_frame, ..options() };
    let found = elements_with(options, "G53 G0 X1 Y2 Z3\nG53 G0 Y2\nG53 G1 X1 Z3 F1\nM2");
    let [first, others @ ..] = &found[..] else { panic!("{found:?}") };
    assert!(others.iter().all(|element| element.start() == first.end()));
    assert!(others.iter().all(|element| element.length() <= 0.0));
}

#[test]
fn start() {
    let start = at([0.001, -0.002, 0.003]);
    let options = DecoderOptions { start, ..DecoderOptions::default() };
    let found = elements_with(options.clone(), "G0 X5\nM2");
    assert_eq!(<[f64; 3]>::from(found[0].start().coords), start.linear);
    assert_eq!(ends(&found), "5 -2 3");
    assert_eq!(end_mm(&options, "G91 G0 X5 Y5 Z5"), [6.0, 3.0, 8.0]);
    let decoder = Decoder::new(&b"M2"[..], options);
    assert_eq!(decoder.position(), start);
}

#[test]
fn units() {
    let inches = DecoderOptions { units: LengthUnit::Inch, ..DecoderOptions::default() };
    assert_eq!(end_mm(&inches, "G0 X1"), [25.4, 0.0, 0.0]);
    assert_eq!(end_mm(&inches, "G21 G0 X1"), [1.0, 0.0, 0.0]);
    // Offsets do not depend on the units of the program; without them in linuxcnc.txt (units mid, feed change units).
    assert_eq!(end_mm(&options(), "G20 G55 G0 X1"), [27.4, 0.0, 0.0]);
}

/// Rotary axes are the extra axes P Q U, in degrees.
#[test]
fn rotary_axes() {
    let mut options = DecoderOptions::default();
    options.work_offsets[1].rotary = [10.0, 0.0, 0.0];
    let found = elements_with(options, "G55 G0 X1\nG1 A20 F360\nG91 B5 X1\nM2");
    assert!(found[0].extra().is_none(), "none has been named yet");
    assert_eq!(found[1].extra().unwrap().end, [30.0, 0.0, 0.0, 0.0, 0.0]);
    // 360 degrees a minute, as a thousandth of m/s.
    assert_eq!(found[1].feed, 0.006);
    assert_eq!(found[2].extra().unwrap().start, [30.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(found[2].extra().unwrap().end, [30.0, 5.0, 0.0, 0.0, 0.0]);
    assert_eq!(found[2].feed, 0.006);
}
