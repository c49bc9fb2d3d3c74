//! Tests of cutter radius compensation beyond LinuxCNC's moves (`linuxcnc.rs`): what waits for the next corner, errors,
//! and lathe tools of the table.

use super::moves::decode_as_linuxcnc;
use super::*;
use crate::decode::{Rule, TextError};
use crate::rs274::{LengthUnit, ToolTable};

/// Line and kind of each element, with the time of dwells and the number of M functions.
fn order(elements: &[PathElement]) -> String {
    let name = |element: &PathElement| {
        let kind = match element.kind {
            ElementKind::Dwell { time_ns } => format!("P{}", time_ns as f64 / 1e9),
            ElementKind::MFunction { number } => format!("M{number}"),
            kind => format!("{kind:?}"),
        };
        format!("{} {kind}", element.place.line)
    };
    elements.iter().map(name).collect::<Vec<_>>().join(" | ")
}

/// `rs274 -g` gives the order, the moves of `linuxcnc_oracle.py` the ends: the feed to X17, `DWELL(1)`,
/// `START_SPINDLE_CLOCKWISE`, the feed to Z-1, `DWELL(2)`, the feed to Y20. Before that dwell nothing waits, so that
/// dwells and M functions of outer corners come before the arc.
#[test]
fn what_waits_for_the_corner_keeps_its_order() {
    let program = "F100 S100 T1 M6\nG41 D1 G1 X10\nX20\nG4 P1\nM3\nG1 Z-1\nG4 P2\nM8\nY20\nG4 P4\nX40\nG40\nG4 P3\n\
                   G0 X50 Y50\nM2";
    let decoded = decode_as_linuxcnc(program.as_bytes());
    assert_eq!(decoded.errors, []);
    assert_eq!(
        order(&decoded.elements),
        "1 M6 | 2 Cut | 3 Cut | 4 P1 | 5 M3 | 6 Cut | 7 P2 | 8 M8 | 9 Cut | 10 P4 | 11 Cut | 11 Cut | 13 P3 | 14 Rapid | \
         15 M5 | 15 M9"
    );
    assert_eq!(
        ends(&decoded.elements),
        "0 0 0 | 10 3 0 | 17 3 0 | 17 3 0 | 17 3 0 | 17 3 -1 | 17 3 -1 | 17 3 -1 | 17 20 -1 | 17 20 -1 | 20 23 -1 | \
         40 23 -1 | 40 23 -1 | 50 50 -1 | 50 50 -1 | 50 50 -1"
    );
}

/// A gouge names both lines; the path goes on, so that further errors are found.
#[test]
fn gouges() {
    let gouge = |other: &str| {
        format!(
            "a tool with a radius of 3 mm does not fit into the corner with the move of {other}: it would gouge the \
             contour; take a smaller tool, or lengthen that move"
        )
    };
    for (program, errors) in [
        ("G1 X20\nX40\nN5 Y5\nX0\nG40 Y20", vec![format!("line 6: {}", gouge("line 5 (N5)"))]),
        (
            "G1 X40\nY-20\nG3 X60 I10\nG1 X20 Y-50\nG40",
            vec![format!("line 6: {}", gouge("line 5"))],
        ),
        (
            "G1 X20\nX40\nY5\nG1 X0\nY2\nX30\nG40",
            vec![format!("line 6: {}", gouge("line 5")), format!("line 8: {}", gouge("line 7"))],
        ),
        (
            "G1 X20\nG3 X20 Y4 J2\nG40",
            vec![
                "line 4: the radius of the arc is 2 mm; with the tool inside it must be larger than the tool's radius \
                 of 3 mm: take a smaller tool"
                    .to_owned(),
            ],
        ),
    ] {
        let decoded = decode_as_linuxcnc(format!("F100 T1 M6\nG41\n{program}\nM2").as_bytes());
        let found: Vec<_> = decoded.errors.iter().map(ToString::to_string).collect();
        assert_eq!(found, errors, "{program}");
        for error in &decoded.errors {
            assert_eq!(error.error.rule(), Rule::CompensationGouge);
        }
        let joined = decoded.elements.windows(2).all(|pair| pair[0].end() == pair[1].start());
        assert!(joined, "{program}");
    }
}

/// Without end, or at the second %, LinuxCNC loses the last move; here it is part of the path.
#[test]
fn ends_of_programs() {
    for end in ["M2", "%", ""] {
        let program = format!("%\nF100 T1 M6\nG41 G1 X10\nY20\n{end}\n");
        let decoded = decode_as_linuxcnc(program.as_bytes());
        assert_eq!(decoded.errors.len(), usize::from(end.is_empty()), "{:?}", decoded.errors);
        assert_eq!(
            ends(&decoded.elements),
            "0 0 0 | 10 3 0 | 7 20 0".replace("10 3 0", "7 3 0"),
            "{end}"
        );
    }
}

/// Diameter and orientation of the table are those of G41.1 with D and L.
#[test]
fn tools_of_the_table() {
    let table = b"T1 P1 D2 Q2\nT2 P2 D-2 Q9\n";
    let tools = Some(ToolTable::read(&table[..], LengthUnit::Millimetre).unwrap());
    let options = DecoderOptions { tools, ..DecoderOptions::default() };
    for (tool, words) in [("G42 D1", "G42.1 D2 L2"), ("G41 D2", "G42.1 D2"), ("G42 D2", "G41.1 D2")]
    {
        let program = |word: &str| {
            let text = format!("F100 G18\nG0 X20 Z10\n{word} G1 X0 Z0\nX15\nZ-20\nG40 G0 X30\nM2");
            elements_with(options.clone(), &text)
        };
        assert_eq!(program(tool), program(words), "{tool}");
    }
    let decoded = decode_with(options, b"F100\nG41 D1 G1 X20\nM2");
    assert_eq!(
        decoded.errors[0].to_string(),
        "line 2: G41 needs the plane G18 for the orientation 2 of a lathe tool"
    );
}

#[test]
fn without_a_tool_table() {
    let decoded = decode("F100\nG42 D3 G1 X20\nG40 M2");
    assert_eq!(
        decoded.errors[0].to_string(),
        "line 2: without a tool table G42 does not know the diameter of tool 3: give a table, or use G42.1 with the \
         diameter D"
    );
    assert_eq!(decode("F100\nG42.1 D3 G1 X20\nG40 M2").errors, []);
}

/// What waits is bounded, and no error of the language makes more of it.
#[test]
fn moves_along_the_normal_are_bounded() {
    let program = "F100 G41.1 D2 G1 X20\n".to_owned() + &"Z1\nZ2\n".repeat(10_000) + "X30\nG40\nM2";
    let decoded = decode(&program);
    assert_eq!(
        decoded.errors[0].to_string(),
        "line 10001: with cutter radius compensation 10000 moves, dwells and M functions follow each other without a move \
         in the plane, the most that are kept: end it with G40 before"
    );
}
