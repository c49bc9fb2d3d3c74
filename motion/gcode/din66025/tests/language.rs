//! Tests of correct programs and their meaning (manual 3.2).

use super::*;
use crate::decode::{Rule, TextError};
use crate::refeed::tests::Unplugged;
use std::io::{BufReader, Read};
use twin_path::ElementKind::{Cut, Jump, Rapid};
use twin_path::Place;

/// Feed, acceleration and deceleration in mm/s and mm/s².
fn limits_mm(element: &PathElement) -> [f64; 3] {
    [element.feed, element.acceleration, element.deceleration]
        .map(|value| (value * 1e9).round() / 1e6)
}

/// The program example of manual 3.2. Block N20 sets neither E: those of N10 hold.
#[test]
fn program_example() {
    let program = b"%1 example\nN10 G01 X100 Y100 E100 F100 E-200\nN20 G01 Z40 F20\nN30 G03 X-100 R200 F100\n";
    let elements = elements_of(&decode_from([0.0; 3], program));
    assert_eq!(
        ways(&elements),
        "0 0 0 > 100 100 0 | 100 100 0 > 100 100 40 | 100 100 40 > -100 100 40"
    );
    assert_eq!(limits_mm(&elements[0]), [100.0, 100.0, 200.0]);
    assert_eq!(limits_mm(&elements[1]), [20.0, 100.0, 200.0]);
    assert_eq!(limits_mm(&elements[2]), [100.0, 100.0, 200.0]);
    let places: Vec<_> = elements.iter().map(|element| element.place).collect();
    assert_eq!(
        places,
        [(2, 10), (3, 20), (4, 30)]
            .map(|(line, block)| Place { block: Some(block), ..Place::at(line) })
    );
    assert!(elements.iter().all(|element| element.end_velocity == f64::INFINITY));
}

#[test]
fn name() {
    for (first, name) in [
        ("%", None),
        ("% \t", None),
        ("%comment", Some("comment")),
        ("%1 example", Some("1 example")),
        ("  % mounting plate \r", Some("mounting plate")),
        ("\u{feff}%\tplaque", Some("plaque")),
        ("\n\n%late", Some("late")),
    ] {
        let program = format!("{first}\nN10 G1 X1 F1");
        let mut decoder = Decoder::new(program.as_bytes(), DecoderOptions::default());
        assert!(matches!(decoder.next(), Some(Ok(Item::Element(_)))), "{first:?}");
        assert_eq!(decoder.name(), name, "{first:?}");
    }
}

/// Each of these is the same single motion.
#[test]
fn spellings() {
    let plain = elements("N10 G1 X100 Y-0.5 F20");
    for line in [
        "n10 g01 x100 y-0.5 f20",
        "N0010G001X+100.Y-.50F020",
        "\tN10\tG1   X100 Y-0.5\tF20  ",
        "(cut) N10 (a) G1 (F9000) X100 Y-0.5F20(end)",
        "  /N10 G1 X100 Y-0.5 F20",
        "N10 X100 Y-0.5 F20",
        "N10 G1 X100 Y-0.5 F20\r",
    ] {
        assert_eq!(elements(line), plain, "{line:?}");
    }
}

/// Comments may hold any bytes, and a program may end without a line end.
#[test]
fn comments_of_any_bytes() {
    let elements =
        elements_of(&decode_from([0.0; 3], b"%\n(\xD8 10 \x00 \xFF; $ %)\nG1 X1 F1 (\xE9bauche)"));
    assert_eq!(elements.len(), 1);
}

/// Words act from right to left (manual 3.2): of one letter the leftmost is stored last.
#[test]
fn leftmost_word_wins() {
    let elements =
        remaining(&decode("N10 G1 X1 X2 Y3 X4 F10 F20\nN20 G1 X9 E100 E-200 E300 E-400"));
    assert_eq!(ends_mm(&elements)[0][1], [1.0, 3.0, 0.0]);
    assert_eq!(limits_mm(&elements[0]), [10.0, 100.0, 100.0]);
    assert_eq!(limits_mm(&elements[1]), [10.0, 100.0, 200.0]);
}

/// Accelerations are 100 mm/s² until set (manual 6.5).
#[test]
fn default_accelerations() {
    assert_eq!(limits_mm(&elements("G1 X1 F10")[0]), [10.0, 100.0, 100.0]);
    assert_eq!(limits_mm(&elements("G1 X1 F10 E-5")[0]), [10.0, 100.0, 5.0]);
}

/// Without a G word the last motion repeats, G1 at first; modes do not interrupt it.
#[test]
fn motion_repeats() {
    let elements = elements(
        "N10 X10 F10\nN20 G0 X20\nN30 X30\nN40 G3 X40 R5\nN50 G91\nN60 X10 R5\nN70 G90\nN80 G92 X0\nN90 X10 R5\nN100 G1 X0",
    );
    assert_eq!(kinds(&elements), [Cut, Rapid, Rapid, Cut, Cut, Jump, Cut, Cut]);
    let arcs: Vec<_> =
        elements.iter().map(|element| matches!(element.shape, Shape::Arc(_))).collect();
    assert_eq!(arcs, [false, false, false, true, true, false, true, false]);
}

/// I, J and R hold for their block only: the second arc has none.
#[test]
fn arc_words_do_not_stay() {
    let decoded = decode("G2 X10 R5 F10\nX20");
    assert_eq!(remaining(&decoded).len(), 1);
    assert!(matches!(diagnostics(&decoded)[0].error, DecodeError::ArcWithoutCenter));
}

/// Relative targets add up without drift: a tenth of a millimetre a thousand times.
#[test]
fn relative_targets_add_up() {
    let elements = elements(&format!("G91\nG1 F10 X0.1\n{}", "X0.1\n".repeat(999)));
    assert_eq!(elements.len(), 1000);
    assert!((elements[999].end() - Point3::new(0.1, 0.0, 0.0)).norm() < 1e-14);
}

#[test]
fn millimetres_become_metres_once() {
    let element = &elements("G1 X0.1 Y-123.456 Z99.999 F1")[0];
    assert_eq!(element.end(), Point3::new(0.1 / 1e3, -123.456 / 1e3, 99.999 / 1e3));
}

/// A block without coordinates is not a path object; one that goes nowhere is.
#[test]
fn blocks_without_a_path() {
    let elements = elements(
        "N10 G1\nN20 G1 F100\nN30 F50 E10\nN40\n\n(text)\nN50 G0\nN60 G1 X0 F20\nN70 G91\nN80 G1 Z0\n",
    );
    assert_eq!(ends_mm(&elements), [[[0.0; 3]; 2]; 2]);
    assert_eq!(kinds(&elements), [ElementKind::Cut; 2]);
}

#[test]
fn starts_where_it_is_told() {
    let elements = elements_of(&decode_from([300.0, 0.0, 20.0], b"%\nG0 X100 F10"));
    assert_eq!(ways(&elements), "300 0 20 > 100 0 20");
    assert_eq!(elements[0].start(), Point3::new(0.3, 0.0, 0.02));
}

/// G92 at the beginning is the start; of several the last acts, with what it leaves out as it was stored.
#[test]
fn position_set_at_the_beginning() {
    let elements = elements("N10 G92 X5\nN20 G92 Y7 F10\nN30 G91\nN40 G92 X10\nN50 G1 Z1");
    assert_eq!(ways(&elements), "10 7 0 > 10 7 1");
}

/// Later it is a jump; of several the last acts (manual 3.2).
#[test]
fn position_set_later() {
    let elements =
        elements("N10 G1 X10 F10\nN20 G92 X50\nN30 G92 X100 Y5\nN40 G1 X110\nN50 G92 X0");
    assert_eq!(
        ways(&elements),
        "0 0 0 > 10 0 0 | 10 0 0 > 100 5 0 | 100 5 0 > 110 5 0 | 110 5 0 > 0 5 0"
    );
    assert_eq!(kinds(&elements), [Cut, Jump, Cut, Jump]);
    let blocks: Vec<_> = elements.iter().map(|element| element.place.block.unwrap()).collect();
    assert_eq!(blocks, [10, 30, 40, 50]);
}

/// The example of manual 3.2: a G1 to where G92 has set the position makes it be put out once.
#[test]
fn position_put_out_between_two_settings() {
    let elements = elements("G92 X100 Y100\nG1 X100 Y100\nG92 X50 Y100\nG1 X50 Y100");
    let (a, b) = ([100.0, 100.0, 0.0], [50.0, 100.0, 0.0]);
    assert_eq!(ends_mm(&elements), [[a, a], [a, b], [b, b]]);
    assert_eq!(kinds(&elements), [Cut, Jump, Cut]);
}

/// Programs round to three decimals: radii may differ by some micrometres, and 2 R may miss the chord.
#[test]
fn rounded_arcs_are_arcs() {
    let elements =
        elements("G1 X10 F10\nG3 X7.071 Y7.071 I-10 J0\nG0 X0 Y0\nG2 X33.333 Y33.333 R23.570");
    for arc in [&elements[1], &elements[3]] {
        assert!(matches!(arc.shape, Shape::Arc(_)), "{arc:?}");
        assert_eq!(arc.at(arc.length()).position, arc.end());
    }
}

/// Half the chord is the radius in decimals, but in binary not always: an angle of 180° all the same.
#[test]
fn semicircles_of_rounded_numbers() {
    for block in ["X-10.3 F10\nG3 X20.1 R15.2", "X0.1 F10\nG3 X0.4 R0.15", "X7 F10\nG3 X7.2 R.1"] {
        let element = elements(block).pop().unwrap();
        let Shape::Arc(arc) = &element.shape else { panic!("{element:?}") };
        assert!((arc.sweep() - std::f64::consts::PI).abs() < 1e-15, "{block}: {}", arc.sweep());
    }
}

/// Centres relative (by default) and absolute, and words of a target that is where the tool is, left out (manual 3.2.4);
/// the vectors `cnc-arc-…` and `cnc-parabola` have the numbers.
#[test]
fn ways_to_write_a_curve() {
    for blocks in [
        &[
            "G2 X200 Y100 I50 J0",
            "G99\nG2 X200 Y100 I50 J0",
            "G98\nG2 X200 Y100 I150 J100",
            "G2 X200 I50",
        ][..],
        &["G2 X100 Y100 I-10 J0", "G2 I-10"],
        &["G6 X200 Y100 I50 J100", "G98\nG6 X200 Y100 I150 J200", "G6 X200 I50 J100"],
    ] {
        let made = |block: &str| elements(&format!("G1 X100 Y100 F10\n{block}")).remove(1);
        let first = made(blocks[0]);
        assert!(!matches!(first.shape, Shape::Line { .. }));
        for block in blocks {
            let other = made(block);
            for part in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let [one, other] = [&first, &other].map(|it| it.at(part * it.length()).position);
                assert!((one - other).norm() < 1e-12, "{block}: {one} {other}");
            }
        }
    }
}

/// Suppressed blocks are left out with whatever is in them, or executed.
#[test]
fn suppressed_blocks() {
    let program = b"%\nN10 G1 X10 F10\n/N20 G1 X20 T5 (open\n /X30\nN40 Y1\n";
    let options = DecoderOptions { skip_suppressed_blocks: true, ..DecoderOptions::default() };
    let decoded: Vec<_> = Decoder::new(&program[..], options).collect::<Result<_, _>>().unwrap();
    assert_eq!(decoded.len(), 2);
    let decoded = decode_from([0.0; 3], program);
    assert_eq!((remaining(&decoded).len(), diagnostics(&decoded).len()), (3, 2));
}

#[test]
fn empty_programs() {
    for program in ["", "%", "%\n", "\n\n", "%\r\n\r\n", "\u{feff}"] {
        assert_eq!(decode_from([0.0; 3], program.as_bytes()), [], "{program:?}");
    }
}

#[test]
fn reading_errors_end_it() {
    let reader = BufReader::new(b"%\nN1 G1 X1 F1\nN2 G1 X2".as_slice().chain(Unplugged));
    let mut decoder = Decoder::new(reader, DecoderOptions::default());
    assert!(matches!(decoder.next(), Some(Ok(Item::Element(_)))));
    let Some(Err(Failure::Io(error))) = decoder.next() else { panic!("no error") };
    assert_eq!(error.to_string(), "unplugged");
    assert!(decoder.next().is_none() && decoder.next().is_none());
}

#[test]
fn tells_where_it_is() {
    let mut decoder = Decoder::new(&b"%\n\nN1 G1 X1 F1\nN2 G1 X2"[..], DecoderOptions::default());
    decoder.next();
    // An element is given when the next is known.
    assert_eq!((decoder.lines(), decoder.position()), (4, Point3::new(0.002, 0.0, 0.0)));
}

/// The example shipped with the product: 60 to 150 blocks numbered in tens, nothing wrong, within the reach of the
/// machine it names, between safe height and its greatest depth, and back where it began.
#[test]
fn example_program() {
    let program = include_str!("../../../../examples/plate.cnc");
    let elements = elements_of(&decode_from([0.0; 3], program.as_bytes()));
    let blocks: Vec<_> = program.lines().filter(|line| line.starts_with('N')).collect();
    assert!((60..=150).contains(&blocks.len()), "{} blocks", blocks.len());
    for (index, block) in blocks.iter().enumerate() {
        assert!(block.starts_with(&format!("N{} ", 10 * (index + 1))), "{block}");
    }
    let home = Point3::new(0.3, 0.0, 0.02);
    assert_eq!((elements[0].start(), elements.last().unwrap().end()), (home, home));
    for element in &elements {
        for step in 0..=20 {
            let position = element.at(element.length() * f64::from(step) / 20.0).position;
            let reach = position.x.hypot(position.y);
            assert!((0.15..=0.41).contains(&reach), "{position} in {}", element.place);
            assert!((-0.006..=0.02).contains(&position.z), "{position} in {}", element.place);
        }
    }
    // Twice round a plate of 170 mm × 130 mm with corners of 12 mm, a tool of radius 3 mm outside.
    let round = |element: &&PathElement| {
        element.kind == Cut && matches!(element.place.block, Some(890..=970 | 1020..=1100))
    };
    let length: f64 = elements.iter().filter(round).map(PathElement::length).sum();
    let perimeter = 2.0 * (176.0 + 136.0) - 8.0 * 15.0 + std::f64::consts::TAU * 15.0;
    assert_close(length * 1e3, 2.0 * perimeter);
}

/// The manual has `%` in the first line only (3.2). A second one, alone, ends the program as in RS274, with a note.
#[test]
fn a_closing_percent() {
    let ended = |behind: &str| {
        let decoded = decode(&format!("N10 G1 X10 F10\nN20 X20\n%{behind}"));
        assert_eq!(ends_mm(&remaining(&decoded)).len(), 2, "{behind:?}");
        let found = diagnostics(&decoded);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!((found[0].place.line, found[0].columns.clone()), (4, Some(0..1)));
        found[0].error.clone()
    };
    for behind in ["", "\n", "\r\n", " \n\n  \n"] {
        let error = ended(behind);
        assert_eq!(error, DecodeError::ClosingPercent, "{behind:?}");
        assert!(error.is_note());
    }
    let error = ended("\nN30 X30\n%\n");
    assert_eq!(error, DecodeError::LinesBehindPercent);
    assert!(!error.is_note() && error.rule() == Rule::Syntax);
    // With a name it is the beginning of another program.
    let found = diagnostics(&decode("N10 G1 X10 F10\n% other\nN20 X20"));
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].error, DecodeError::MisplacedPercent);
}

/// No jump leads behind the end.
#[test]
fn a_jump_behind_the_closing_percent() {
    let decoded = decode("N10 G1 X10 F10\nN20 G20 L30 K1\n%\nN30 X30");
    let found: Vec<_> = diagnostics(&decoded).into_iter().map(|found| found.error).collect();
    assert_eq!(found, [DecodeError::JumpTarget(30), DecodeError::LinesBehindPercent]);
}
