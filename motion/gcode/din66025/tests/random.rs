//! Robustness tests of the decoder: random bytes and random programs.

use super::*;
use proptest::prelude::*;
use std::io::BufReader;

/// Jumps that a random program may take.
const JUMPS: u32 = 5;

fn run(program: &[u8], capacity: usize, skip_suppressed_blocks: bool) -> Vec<String> {
    let mut options = DecoderOptions {
        start: [0.1, 0.0, 0.0],
        skip_suppressed_blocks,
        jumps: JUMPS,
        ..DecoderOptions::default()
    };
    options.variables.set("a", 2.0);
    Decoder::with_jumps(BufReader::with_capacity(capacity, Cursor::new(program)), options)
        .map(|item| format!("{item:?}"))
        .collect()
}

/// An item per byte at the most, each time the program runs, and one for the end.
fn most_items(program: &[u8]) -> usize {
    (JUMPS as usize + 2) * (program.len() + 1)
}

/// Random text that resembles a program more often than random bytes do.
pub(super) fn scraps() -> impl Strategy<Value = Vec<u8>> {
    let scrap = prop_oneof![
        4 => "[NGXYZIJREFngxyzijrefMTDHSKLOPQUVWa$/%() \t.,+-]{0,3}",
        4 => "[NGXYZIJREFDHKLMOPQSUVW]-?[0-9]{0,4}\\.?[0-9]{0,3} ?",
        2 => "[XPKLO]\\$[ab]\\$ ",
        2 => "G(0|1|2|3|5|6|8|9|20|36|37|4[0-2]|5[0-2]|60|61|90|91|92|98|99) ",
        2 => "\r?\n",
        1 => "\\PC{0,4}",
    ];
    let bytes = prop_oneof![8 => scrap.prop_map(String::into_bytes), 1 => prop::collection::vec(any::<u8>(), 0..4)];
    prop::collection::vec(bytes, 0..60).prop_map(|scraps| scraps.concat())
}

/// A coordinate in mm with up to three decimals.
fn coordinate() -> impl Strategy<Value = String> {
    (-400_000..400_000_i32, 0..4_usize)
        .prop_map(|(thousandths, decimals)| format!("{:.decimals$}", f64::from(thousandths) / 1e3))
}

/// One block of a valid program.
fn block() -> impl Strategy<Value = String> {
    let targets = || {
        prop::collection::vec(("[XYZ]", coordinate()).prop_map(|(letter, mm)| letter + &mm), 1..4)
    };
    prop_oneof![
        (prop::sample::select(vec!["", "G0", "G1", "g01"]), targets())
            .prop_map(|(command, targets)| format!("{command} {}", targets.join(" "))),
        (2..4, targets(), 0..900_000).prop_map(|(command, targets, radius)| format!(
            "G{command} {} R{}",
            targets.join(""),
            f64::from(radius) / 1e3
        )),
        (2..4, targets(), coordinate(), coordinate()).prop_map(|(command, targets, i, j)| format!(
            "G{command} {} I{i} J{j}",
            targets.join(" ")
        )),
        (2..4, coordinate()).prop_map(|(command, i)| format!("G{command} I{i}")),
        targets().prop_map(|targets| format!("G5 {}", targets.join(" "))),
        (targets(), coordinate(), coordinate())
            .prop_map(|(targets, i, j)| format!("G6 {} I{i} J{j}", targets.join(" "))),
        (8..10, targets(), coordinate(), coordinate(), 0..360, 1..=10).prop_map(
            |(command, targets, i, j, k, tenths)| format!(
                "G{command} {} I{i} J{j} K{k} R{}",
                targets.join(" "),
                f64::from(tenths) / 10.0
            )
        ),
        ("[PQUVW]", coordinate(), targets())
            .prop_map(|(letter, u, targets)| format!("G1 {letter}{u} {}", targets.join(" "))),
        (targets(), 1..33, 0..=8).prop_map(|(targets, h, o)| format!(
            "G1 {} H{h} O{}",
            targets.join(" "),
            f64::from(o) / 8.0
        )),
        (0..100, 0..9).prop_map(|(m, k)| format!("M{m} K{k}")),
        prop::sample::select(vec![
            "G41", "G42", "G40", "G51 D2", "G52", "G50", "G61", "G60", "S3", "S-3 S7"
        ])
        .prop_map(str::to_owned),
        prop::sample::select(vec![
            "G90",
            "G91",
            "G98",
            "G99",
            "G92 X0 Y0 Z0",
            "G1 F5 E10",
            "(text)",
            ""
        ])
        .prop_map(str::to_owned),
        targets().prop_map(|targets| format!("G92 {}", targets.join("\t"))),
    ]
}

pub(super) fn programs() -> impl Strategy<Value = Vec<String>> {
    prop::collection::vec(block(), 0..40).prop_map(|mut lines| {
        lines.splice(0..0, ["% random".to_owned(), "F20".to_owned()]);
        lines
    })
}

proptest! {
    #[test]
    fn any_bytes_end(program in prop::collection::vec(any::<u8>(), 0..300), skip: bool) {
        prop_assert!(run(&program, 64, skip).len() <= most_items(&program));
    }

    /// Nothing panics, and how the bytes arrive does not matter.
    #[test]
    fn any_scraps_end(program in scraps(), capacity in 1..40_usize, skip: bool) {
        let items = run(&program, 8192, skip);
        prop_assert!(items.len() <= most_items(&program));
        prop_assert_eq!(&run(&program, capacity, skip), &items);
    }

    /// Every diagnostic points at bytes of its line.
    #[test]
    fn columns_are_in_the_line(program in scraps()) {
        let lines: Vec<_> = program.split(|byte| *byte == b'\n').collect();
        for diagnostic in diagnostics(&decode_from([0.0; 3], &program)) {
            let line = lines[diagnostic.place.line as usize - 1];
            let columns = diagnostic.columns.unwrap();
            prop_assert!(columns.start < columns.end && columns.end <= line.len(), "{columns:?} in {line:?}");
            prop_assert!(!diagnostic.error.to_string().is_empty());
        }
    }

    /// Each element starts where the one before ended, bit for bit, and is finite.
    #[test]
    fn elements_join(lines in programs()) {
        let decoded = decode_from([0.0; 3], lines.join("\n").as_bytes());
        let mut end = None;
        let mut line = 0;
        for element in remaining(&decoded) {
            prop_assert_eq!(element.start(), end.unwrap_or(element.start()));
            prop_assert!(element.length().is_finite() && element.feed > 0.0);
            prop_assert_eq!(element.shape.at(element.shape.length()).position, element.end());
            prop_assert!(element.place.line >= line);
            line = element.place.line;
            end = Some(element.end());
        }
        // The only errors a block of these can have are about its arc and about relative targets adding up.
        for item in decoded {
            if let Err(diagnostic) = item {
                let expected = matches!(
                    diagnostic.error,
                    DecodeError::ArcWithoutCenter | DecodeError::CurveWithoutPoint(_) | DecodeError::IncompleteCenter(_) | DecodeError::OutOfRange { .. }
                );
                prop_assert!(expected, "{diagnostic}");
            }
        }
    }

    #[test]
    fn line_ends_do_not_matter(lines in programs()) {
        let unix = decode_from([0.0; 3], lines.join("\n").as_bytes());
        prop_assert_eq!(&decode_from([0.0; 3], lines.join("\r\n").as_bytes()), &unix);
        prop_assert_eq!(&decode_from([0.0; 3], (lines.join("\n") + "\n").as_bytes()), &unix);
    }

    /// Arcs by R go from start to end with that radius, on the side the command says, by no more than half a turn.
    #[test]
    fn arcs_by_radius(
        end in [-300.0..300.0, -300.0..300.0_f64],
        excess in 0.0..300.0_f64,
        clockwise: bool,
    ) {
        let [x, y] = end;
        let radius = x.hypot(y) / 2.0 + excess;
        prop_assume!(x.hypot(y) > 1e-3);
        let command = if clockwise { 2 } else { 3 };
        let elements = elements(&format!("G{command} X{x} Y{y} R{radius} F1"));
        let Shape::Arc(arc) = &elements[0].shape else { panic!("{elements:?}") };
        prop_assert!((arc.radius() * 1e3 - radius).abs() < 1e-8);
        prop_assert!((arc.end_radius() * 1e3 - radius).abs() < 1e-8);
        prop_assert_eq!(arc.sweep() < 0.0, clockwise);
        prop_assert!(arc.sweep().abs() <= std::f64::consts::PI + 1e-12);
        // The chord of the angle swept, which is ill-conditioned near the semicircle only in the angle.
        let chord = 2.0 * radius * (arc.sweep().abs() / 2.0).sin();
        prop_assert!((chord - x.hypot(y)).abs() < 1e-8);
    }
}
