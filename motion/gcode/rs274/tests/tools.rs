//! Tests of the tool table, tool length, and M functions.

use super::*;
use crate::refeed::tests::Unplugged;
use crate::rs274::{LengthUnit, Tool, ToolReference, ToolTable, ToolTableError};
use ElementKind::{Jump, Rapid};

const TABLE: &str = "\
; tools of the mill
T1 P1 Z51.125 D6.35 ;quarter inch end mill

t2 p17 x1 y-2 z+10.5 d-3 a0 b0 c0 u0 v0 w0 i0 j0 q1 ; everything
T0 Z0\r
T99999 Z20
";

fn table() -> ToolTable {
    ToolTable::read(TABLE.as_bytes(), LengthUnit::Millimetre).unwrap()
}

#[test]
fn file() {
    let table = table();
    let numbers: Vec<u32> = table.as_slice().iter().map(|tool| tool.number).collect();
    assert_eq!(numbers, [0, 1, 2, 99_999]);
    let first =
        Tool { number: 1, offset: [0.0, 0.0, 0.051_125], diameter: 0.006_35, ..Tool::default() };
    assert_eq!(table.get(1), Some(&first));
    assert_eq!(
        table.get(2),
        Some(&Tool {
            number: 2,
            offset: [0.001, -0.002, 0.010_5],
            diameter: -0.003,
            orientation: 1,
            ..Tool::default()
        })
    );
    assert_eq!(table.get(3), None);
    let inches = ToolTable::read(&b"T1 Z2 D.5"[..], LengthUnit::Inch).unwrap();
    assert_eq!(inches.get(1).unwrap().offset, [0.0, 0.0, 0.050_8]);
    assert_eq!(inches.get(1).unwrap().diameter, 0.012_7);
}

#[test]
fn errors_of_the_file() {
    let message = |text: &str| {
        ToolTable::read(text.as_bytes(), LengthUnit::Millimetre).unwrap_err().to_string()
    };
    for (text, expected) in [
        ("T1\nT2 Zx", "line 2: 'Z' is not followed by a number"),
        ("T1 Z", "line 1: 'Z' is not followed by a number"),
        ("T1 G5", "line 1: tool tables have no 'G'"),
        (";\nP1 Z5", "line 2: a tool needs a whole number T"),
        ("T1.5 Z5", "line 1: a tool needs a whole number T"),
        ("T-1 Z5", "line 1: a tool needs a whole number T"),
        ("T1\nT2\nT1", "line 3: tool 1 is there already"),
        ("T1 Z1000001", "line 1: Z1000001 is out of range"),
    ] {
        assert_eq!(message(text), expected, "{text}");
    }
    assert_eq!(
        message(&"T".repeat(1 << 21)),
        "line 1: the tool table has more than 1048576 bytes, the most that are read; \
         check that it is the right one, or shorten it"
    );
    assert!(message(&";\n".repeat(1 << 20)).contains("more than 1048576 bytes"));
    let error = ToolTable::read(Unplugged, LengthUnit::Millimetre).unwrap_err();
    assert!(matches!(error, ToolTableError::Io(_)));
    // Of several the last.
    let tool = |diameter| Tool { number: 7, diameter, ..Tool::default() };
    assert_eq!(ToolTable::new([tool(1.0), tool(2.0)]).as_slice(), [tool(2.0)]);
}

fn options(reference: ToolReference) -> DecoderOptions {
    DecoderOptions { tools: Some(table()), reference, ..DecoderOptions::default() }
}

/// G43 lifts the controlled point by the tool's length from the next move on; the tip is where the program says.
#[test]
fn length() {
    let program = "G0 X5 Z5\nG43 H1\nX6\nZ5\nG49\nX7\nZ5\nM2";
    let controlled = elements_with(options(ToolReference::ControlPoint), program);
    assert_eq!(ends(&controlled), "5 0 5 | 6 0 5 | 6 0 56.125 | 7 0 56.125 | 7 0 5");
    let tip = elements_with(options(ToolReference::Tip), program);
    assert_eq!(kinds(&tip), [Rapid, Jump, Rapid, Rapid, Jump, Rapid, Rapid]);
    assert_eq!(
        ends(&tip),
        "5 0 5 | 5 0 -46.125 | 6 0 -46.125 | 6 0 5 | 6 0 56.125 | 7 0 56.125 | 7 0 5"
    );
}

/// Both references differ by the tool at every move, with G53, G28 and offsets in all axes.
#[test]
fn references_differ_by_the_tool() {
    let program = "G43 H2\nG0 X5 Y5 Z5\nG1 X8 F100\nG53 G0 Z50\nG28\nG2 X7 Y10 I4 J4\nM2";
    let ends = |reference| ends_mm(&elements_with(options(reference), program));
    let (controlled, tip) = (ends(ToolReference::ControlPoint), ends(ToolReference::Tip));
    assert_eq!(controlled.len(), 6);
    // The first moves of both begin at the machine's start.
    for (controlled, tip) in controlled.iter().zip(&tip) {
        let difference: [f64; 3] = std::array::from_fn(|axis| controlled[axis] - tip[axis]);
        for (difference, tool) in difference.into_iter().zip([1.0, -2.0, 10.5]) {
            assert!((difference - tool).abs() < 2e-6, "{controlled:?}, {tip:?}");
        }
    }
}

/// G43 without H and with H0 takes the tool in the spindle, which T with M6 changes and T alone does not.
#[test]
fn tool_in_the_spindle() {
    let end = |program: &str| {
        let found = elements_with(options(ToolReference::ControlPoint), &format!("{program}\nM2"));
        ends_mm(&found).last().copied().unwrap()
    };
    assert_eq!(end("T1 M6\nG43\nG0 Z0"), [0.0, 0.0, 51.125]);
    assert_eq!(end("M6 T1\nG43 H0\nG0 Z0"), [0.0, 0.0, 51.125]);
    assert_eq!(end("T1 M6\nT2\nG43\nG0 Z0"), [0.0, 0.0, 51.125]);
    assert_eq!(end("T1\nG43\nG0 Z0"), [0.0, 0.0, 0.0]);
    // LinuxCNC rounds Q of M61.
    assert_eq!(end("M61 Q0.6\nG43\nG0 Z0"), [0.0, 0.0, 51.125]);
    let options = DecoderOptions { tool: 2, ..options(ToolReference::ControlPoint) };
    let found = elements_with(options, "G43 G0 X0 Y0 Z0\nM2");
    assert_eq!(ends(&found), "1 -2 10.5");
}

/// The M functions of a program with line and K.
fn functions(elements: &[PathElement]) -> String {
    let functions = elements.iter().filter_map(|element| {
        let ElementKind::MFunction { number } = element.kind else { return None };
        let k = element.details.as_ref().and_then(|details| details.parameters.k);
        let k = k.map_or_else(String::new, |k| format!(" K{k}"));
        Some(format!("{} M{number}{k}", element.place.line))
    });
    functions.collect::<Vec<_>>().join(" | ")
}

/// The end of the program turns off spindle and coolant, and a tool change the spindle, as LinuxCNC's interpreter hands
/// on (`rs274 -g`: `STOP_SPINDLE_TURNING`, `FLOOD_OFF`).
#[test]
fn m_functions() {
    for (program, expected) in [
        (
            "G0 X1\nM6 T3\nS1000 M3\nS2000\nM4 M8\nM5 M9\nM0\nM1\nM60\nM7\nG0 X2 M0\nM30",
            "2 M6 K3 | 3 M3 K1000 | 5 M4 K2000 | 5 M8 | 6 M5 | 6 M9 | 7 M0 | 8 M1 | 9 M60 | 10 M7 | 11 M0 | 12 M9",
        ),
        ("M3 S100\nM8\nG0 X1\nM30", "1 M3 K100 | 2 M8 | 4 M5 | 4 M9"),
        ("M3 S100\nM5\nM8\nM9\nM2", "1 M3 K100 | 2 M5 | 3 M8 | 4 M9"),
        ("M3 S100\nT1 M6\nM4\nM2", "1 M3 K100 | 2 M5 | 2 M6 K1 | 3 M4 K100 | 4 M5"),
        ("%\nM3 S100\n%", "2 M3 K100 | 3 M5"),
    ] {
        let found = elements(program);
        assert_eq!(functions(&found), expected, "{program}");
        for element in found {
            assert!(element.kind.is_motion() || element.start() == element.end());
        }
    }
    // The stop is behind the motion of its line; everything else before it.
    let m = |number| ElementKind::MFunction { number };
    assert_eq!(kinds(&elements("G0 X1 M0 M3\nM2")), [m(3), Rapid, m(0), m(5)]);
}
