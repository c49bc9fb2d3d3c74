//! Tests of warnings: programs that run, but perhaps not as intended.

use super::*;
use crate::decode::{Rule, TextError};

/// The warnings of a block after `G1 X10 F10`, with the text they point at, and the kind of shape made of it.
#[track_caller]
fn assert_warnings(block: &str, expected: &[(&str, DecodeError)], arc: bool) {
    let decoded = decode(&format!("G1 X10 F10\n{block}"));
    let warnings: Vec<_> = decoded
        .iter()
        .filter_map(|item| match item {
            Ok(Item::Warning(warning)) => {
                Some((&block[warning.columns.clone().unwrap()], warning.error.clone()))
            }
            Ok(Item::Element(_)) => None,
            Err(error) => panic!("{error}"),
        })
        .collect();
    assert_eq!(warnings, expected, "{block}");
    let elements = remaining(&decoded);
    assert_eq!(matches!(elements[1].shape, Shape::Arc(_)), arc, "{block}: {elements:?}");
    // The warning is before the element.
    assert!(matches!(decoded.last(), Some(Ok(Item::Element(_)))));
}

#[test]
fn parameters_of_arcs() {
    use DecodeError as E;
    // A chord of 30, 40: 50 long.
    let small = |radius_mm| E::RadiusTooSmall { radius_mm, half_chord_mm: 25.0 };
    let chordless = E::RadiusWithoutChord { radius_mm: 25.0 };
    for (block, pointed, error, arc) in [
        ("N20 G2 X40 Y40 R24.9 F5", "R24.9", small(24.9), false),
        ("N20 G3 X40 Y40 R0", "R0", small(0.0), false),
        ("N20 G2 X10 R25", "R25", chordless.clone(), false),
        ("N20 G2 Z-5 R25", "R25", chordless, false),
        ("N20 G3 X10 I0 J0", "I0 J0", E::CenterAtStart, false),
        ("N20 G2 X40 R-20", "R-20", E::NegativeRadius { radius_mm: -20.0 }, true),
    ] {
        assert_eq!(error.rule(), Rule::ArcGeometry);
        assert_warnings(block, &[(pointed, error)], arc);
    }
    assert_warnings("N20 G2 X40 Y40 R24.996", &[], true);
    // The sign of R does not ask for the larger arc.
    let (negative, positive) = (decode("G2 X30 R-20 F5"), decode("G2 X30 R20 F5"));
    assert_eq!(remaining(&negative), remaining(&positive));
}

#[test]
fn center_mismatch() {
    // From 10/0 about 20/0: the end is 10.01 away.
    let error = |start_radius_mm, end_radius_mm| DecodeError::CenterMismatch {
        start_radius_mm,
        end_radius_mm,
    };
    assert_eq!(error(1.0, 2.0).rule(), Rule::ArcGeometry);
    for (block, pointed, radii) in [
        ("N20 G2 X30.01 I10 J0 F5", "I10 J0", Some([10.0, 10.01])),
        ("N20 G2 X30.004 J0 F5 I10", "J0 F5 I10", None),
        ("N20 G3 X10.002 I0.01 J0", "I0.01 J0", Some([0.01, 0.008])),
    ] {
        let decoded = decode(&format!("G1 X10 F10\n{block}"));
        let found = diagnostics(&decoded);
        assert_eq!(found.len(), usize::from(radii.is_some()), "{block}");
        let Some([start, end]) = radii else { continue };
        let DecodeError::CenterMismatch { start_radius_mm, end_radius_mm } = found[0].error else {
            panic!("{found:?}")
        };
        assert_close(start_radius_mm, start);
        assert_close(end_radius_mm, end);
        assert_eq!(&block[found[0].columns.clone().unwrap()], pointed);
        assert!(matches!(remaining(&decoded)[1].shape, Shape::Line { .. }));
    }
}

#[test]
fn words_without_effect() {
    let unused = |letter, command| DecodeError::UnusedWord { letter, command };
    assert_eq!(unused('R', 1).rule(), Rule::Syntax);
    assert_warnings("N20 G1 X40 R5 I1", &[("R5", unused('R', 1)), ("I1", unused('I', 1))], false);
    for (block, pointed, letter, command) in [
        ("N20 G0 J2 X40", "J2", 'J', 0),
        ("G1 X1 F1 K5", "K5", 'K', 1),
        ("G1 X1 F1 L5", "L5", 'L', 1),
        ("G1 X1 F1 O0.5", "O0.5", 'O', 1),
    ] {
        assert_warnings(block, &[(pointed, unused(letter, command))], false);
    }
    let decoded = decode("G92 X5 R5");
    assert_eq!(diagnostics(&decoded)[0].error, unused('R', 92));
}

/// The N word is required at the beginning of every block, although it has no meaning (manual 3.2).
#[test]
fn missing_block_numbers() {
    let warnings = |blocks: &str| -> Vec<_> {
        let program = format!("% name\n{blocks}");
        let decoded = decode_all(DecoderOptions::default(), program.as_bytes());
        let lines =
            diagnostics(&decoded).into_iter().map(|Diagnostic { place, columns, error }| {
                assert_eq!(error, DecodeError::MissingBlockNumber);
                (place.line, columns)
            });
        lines.collect()
    };
    assert_eq!(warnings("N10 G1 X10 F10\n(comment)\n\nN20 X20\n/N30 X30"), []);
    // Once per program, at the first such block.
    assert_eq!(warnings("N10 G1 X10 F10\n  X20\nX30"), [(3, Some(2..5))]);
    assert_eq!(warnings("/ G1 X10 F10\nX20"), [(2, Some(2..4))]);
    assert_eq!(DecodeError::MissingBlockNumber.rule(), Rule::Syntax);
}
