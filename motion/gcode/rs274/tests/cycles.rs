//! Tests of canned cycles: the examples of LinuxCNC's documentation (G-codes, G81), and their limits.

use super::*;
use crate::rs274::MAX_CYCLE_MOVES;
use ElementKind::{Cut, Rapid};

/// From X1 Y2 Z3, F60.
#[track_caller]
fn assert_moves(blocks: &str, expected: &[(ElementKind, [f64; 3])]) {
    let options = DecoderOptions { start: at([0.001, 0.002, 0.003]), ..DecoderOptions::default() };
    let found = elements_with(options, &format!("F60\n{blocks}\nM2"));
    let kinds = found.iter().map(|element| element.kind);
    let found: Vec<_> = kinds.zip(ends_mm(&found)).collect();
    assert_eq!(found, expected, "{blocks}");
}

/// Example 1: absolute position.
#[test]
fn drilling() {
    assert_moves(
        "G90 G81 G98 X4 Y5 Z1.5 R2.8",
        &[
            (Rapid, [4.0, 5.0, 3.0]),
            (Rapid, [4.0, 5.0, 2.8]),
            (Cut, [4.0, 5.0, 1.5]),
            (Rapid, [4.0, 5.0, 3.0]),
        ],
    );
    // Back to R only.
    assert_moves(
        "G81 G99 X4 Y5 Z1.5 R2.8",
        &[
            (Rapid, [4.0, 5.0, 3.0]),
            (Rapid, [4.0, 5.0, 2.8]),
            (Cut, [4.0, 5.0, 1.5]),
            (Rapid, [4.0, 5.0, 2.8]),
        ],
    );
}

/// Example 2: relative position, three holes; the tool goes up to R first.
#[test]
fn drilling_repeatedly() {
    let hole = |x, y| {
        [(Rapid, [x, y, 4.8]), (Rapid, [x, y, 4.8]), (Cut, [x, y, 4.2]), (Rapid, [x, y, 4.8])]
    };
    let mut expected = vec![(Rapid, [1.0, 2.0, 4.8])];
    expected.extend([hole(5.0, 7.0), hole(9.0, 12.0), hole(13.0, 17.0)].concat());
    assert_eq!(
        motions("G91 G81 G98 X4 Y5 Z-0.6 R1.8 L3"),
        expected
            .into_iter()
            .scan([1.0, 2.0, 3.0], |before, (kind, end)| {
                Some((std::mem::replace(before, end) != end).then_some((kind, end)))
            })
            .flatten()
            .collect::<Vec<_>>()
    );
}

/// The moves that lead anywhere.
fn motions(blocks: &str) -> Vec<(ElementKind, [f64; 3])> {
    let options = DecoderOptions {
        start: at([0.001, 0.002, 0.003]),
        keep_empty_moves: false,
        ..DecoderOptions::default()
    };
    let found = elements_with(options, &format!("F60\n{blocks}\nM2"));
    let kinds = found.iter().map(|element| element.kind);
    kinds.zip(ends_mm(&found)).collect()
}

#[test]
fn dwell_at_the_bottom() {
    let found = motions("G82 X4 Y5 Z1.5 R2.8 P1.25");
    let kinds: Vec<_> = found.iter().map(|(kind, _)| *kind).collect();
    let dwell = ElementKind::Dwell { time_ns: 1_250_000_000 };
    assert_eq!(kinds, [Rapid, Rapid, Cut, dwell, Rapid]);
    assert_eq!(found[3].1, [4.0, 5.0, 1.5]);
}

/// 10 mm in pecks of 4 mm, back to R after each, and down again to 0.01 inch above where the peck before ended.
#[test]
fn pecking() {
    assert_eq!(
        motions("G83 X1 Y2 Z-8 R2 Q4"),
        [
            (Rapid, [1.0, 2.0, 2.0]),
            (Cut, [1.0, 2.0, -2.0]),
            (Rapid, [1.0, 2.0, 2.0]),
            (Rapid, [1.0, 2.0, -1.746]),
            (Cut, [1.0, 2.0, -6.0]),
            (Rapid, [1.0, 2.0, 2.0]),
            (Rapid, [1.0, 2.0, -5.746]),
            (Cut, [1.0, 2.0, -8.0]),
            (Rapid, [1.0, 2.0, 2.0]),
        ]
    );
}

/// Lines without a G word repeat the cycle with what they change; G80 and G0 end it.
#[test]
fn rows() {
    assert_eq!(
        motions("G81 G99 X4 Z1.5 R2.8\nX5\nY9 Z1\nG80\nG0 Z9"),
        [
            (Rapid, [4.0, 2.0, 3.0]),
            (Rapid, [4.0, 2.0, 2.8]),
            (Cut, [4.0, 2.0, 1.5]),
            (Rapid, [4.0, 2.0, 2.8]),
            (Rapid, [5.0, 2.0, 2.8]),
            (Cut, [5.0, 2.0, 1.5]),
            (Rapid, [5.0, 2.0, 2.8]),
            (Rapid, [5.0, 9.0, 2.8]),
            (Cut, [5.0, 9.0, 1.0]),
            (Rapid, [5.0, 9.0, 2.8]),
            (Rapid, [5.0, 9.0, 9.0]),
        ]
    );
    let decoded = decode("F60 G81 X1 Z-1 R1\nG0 X2\nG81 X3\nM2");
    assert_eq!(decoded.errors[0].to_string(), "line 3: G81 needs R");
}

/// In G18 the hole goes along Y, in G19 along X.
#[test]
fn planes() {
    assert_eq!(
        motions("G18 G81 G99 X4 Z5 Y-1 R1"),
        [
            (Rapid, [4.0, 2.0, 5.0]),
            (Rapid, [4.0, 1.0, 5.0]),
            (Cut, [4.0, -1.0, 5.0]),
            (Rapid, [4.0, 1.0, 5.0]),
        ]
    );
    assert_eq!(
        motions("G19 G81 G99 Y4 Z5 X-1 R0"),
        [
            (Rapid, [1.0, 4.0, 5.0]),
            (Rapid, [0.0, 4.0, 5.0]),
            (Cut, [-1.0, 4.0, 5.0]),
            (Rapid, [0.0, 4.0, 5.0]),
        ]
    );
}

/// One block gives at most [`MAX_CYCLE_MOVES`] moves, and a block with that many is decoded.
#[test]
fn limit() {
    let count =
        |repeats: usize| decode(&format!("F60 G91 G81 X.001 Z-1 R1 L{repeats}\nM2")).elements.len();
    let most = MAX_CYCLE_MOVES / 5;
    // Up to R once; then for each hole above it, down to the bottom and up to R.
    assert_eq!(count(most), 1 + 3 * most);
    assert_eq!(count(most + 1), 0);
}
