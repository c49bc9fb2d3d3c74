//! Tests of ASCII tables: round trips, and errors with their lines.

use super::curve;
use crate::Knot;
use crate::file::{AsciiError, clean, read_ascii, reduce, write_ascii};
use proptest::prelude::*;

/// 0.1 · 3 is 0.30000000000000004; a third stays a third.
#[test]
fn numbers_are_clean() {
    assert_eq!(clean(0.1 * 3.0).to_bits(), 0.3_f64.to_bits());
    assert_eq!(clean(10.351_562_500_000_002).to_string(), "10.3515625");
    for value in [1.0 / 3.0, 0.0, -2.5e-300, 1e300 / 7.0, 0.123_456_789_012_3] {
        assert_eq!(clean(value).to_bits(), value.to_bits());
    }
}

#[test]
fn tables_as_text() {
    let curve = curve(&[Knot::at_rest(0.0, 0.0), Knot::at_rest(128.0, 100.0)]);
    let mut text = Vec::new();
    write_ascii(&curve, 5, &mut text).expect("written");
    let text = String::from_utf8(text).expect("text");
    assert_eq!(text, "0;0\r\n32;10.3515625\r\n64;50\r\n96;89.6484375\r\n128;100\r\n");
    let points = read_ascii(text.as_bytes()).expect("points");
    assert_eq!((points.len(), points[1]), (5, [32.0, 10.351_562_5]));
    // Both separators, a decimal comma, remarks, any order.
    let mixed = "\u{feff}# table\n10:1,5\n\n -2.5 ; 3e0 \r\n";
    assert_eq!(read_ascii(mixed.as_bytes()).expect("points"), [[-2.5, 3.0], [10.0, 1.5]]);
}

#[test]
fn tables_say_where_they_are_wrong() {
    for (text, message) in [
        ("0;0\n1;2;3", "line 2: 3 columns instead of 2"),
        ("0;0\n\n1;two", "line 3: slave `two` is not a number"),
        ("inf;0\n1;1", "line 1: master `inf` is not a number"),
        ("5;0\n1;1\n5;2", "line 3: master 5 is in line 1 already"),
        ("5;0", "a table needs 2 points, there are 1"),
    ] {
        let error = read_ascii(text.as_bytes()).expect_err(message);
        assert_eq!(error.to_string(), message);
    }
    let long = "1".repeat(2000);
    let error = read_ascii(long.as_bytes()).expect_err("long");
    assert!(matches!(error, AsciiError::TooLong { line: 1, what: "bytes", limit: 1000 }));
}

#[test]
fn lines_need_two_points() {
    let points: Vec<_> = (0..=100_i32).map(|i| [f64::from(i), f64::from(i) * 0.1]).collect();
    assert_eq!(reduce(&points, 1e-9), [points[0], points[100]]);
    // A roof needs its ridge.
    let roof: Vec<_> = (0..=100_i32).map(|i| [f64::from(i), f64::from((i - 50).abs())]).collect();
    assert_eq!(reduce(&roof, 1e-9), [roof[0], roof[50], roof[100]]);
    assert_eq!(reduce(&roof, 50.0).len(), 2);
    assert_eq!(reduce(&roof[..1], 1.0), roof[..1]);
    assert!(reduce(&[], 1.0).is_empty());
    // A parabola 1/2·x² between points w apart is missed by w²/8: 1 u for 0.125.
    let parabola: Vec<_> =
        (0..=1000_i32).map(|i| f64::from(i) / 100.0).map(|x| [x, x * x / 2.0]).collect();
    assert_eq!(reduce(&parabola, 0.125).len(), 11);
}

proptest! {
    #[test]
    fn reduced_tables_keep_their_tolerance(steps in prop::collection::vec((0.01..5.0_f64, -3.0..3.0_f64), 2..200), tolerance in 0.0..5.0_f64) {
        let mut at = [0.0, 0.0];
        let points: Vec<_> = steps.iter().map(|(dx, dy)| { at = [at[0] + dx, at[1] + dy]; at }).collect();
        let kept = reduce(&points, tolerance);
        prop_assert_eq!((kept.first(), kept.last()), (points.first(), points.last()));
        for point in &points {
            let index = kept.partition_point(|kept| kept[0] <= point[0]).clamp(1, kept.len() - 1);
            let [a, b] = [kept[index - 1], kept[index]];
            let on_line = a[1] + (b[1] - a[1]) / (b[0] - a[0]) * (point[0] - a[0]);
            prop_assert!((on_line - point[1]).abs() <= tolerance + 1e-12);
        }
    }

    #[test]
    fn any_bytes_end(noise in prop::collection::vec(any::<u8>(), 0..200)) {
        let _points = read_ascii(noise.as_slice());
    }
}
