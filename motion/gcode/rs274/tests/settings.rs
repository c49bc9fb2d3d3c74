//! Tests of offsets that the program sets, and of their parameters. The numbers are those of LinuxCNC 2.9
//! (`rs274 -g -t`, a machine in inches); moves are in linuxcnc.txt.

use super::*;
use crate::refeed::tests::Unplugged;
use crate::rs274::{LengthUnit, ParameterFile, ParameterFileError, ToolReference, ToolTable};

const TABLE: &str = "T1 P1 Z1 D0.25 I10 J20 Q3\nT2 P2 X0.1 Y0.2 Z2 D0.5 A4";

/// A machine in inches, the program in millimetres.
fn options() -> DecoderOptions {
    let tools = ToolTable::read(TABLE.as_bytes(), LengthUnit::Inch).unwrap();
    DecoderOptions {
        units: LengthUnit::Inch,
        tools: Some(tools),
        reference: ToolReference::Tip,
        ..DecoderOptions::default()
    }
}

/// What `(PRINT,...)` says.
#[track_caller]
fn printed(options: DecoderOptions, program: &str) -> Vec<String> {
    let decoded = decode_with(options, format!("G21\n{program}\nM2").as_bytes());
    assert_eq!(decoded.errors, [], "{program}");
    let text = |warning: &Diagnostic| warning.error.to_string();
    decoded.warnings.iter().map(text).collect()
}

#[track_caller]
fn assert_printed(program: &str, expected: &[&str]) {
    let printed = printed(options(), program);
    let texts = printed.iter().map(|text| text.split_once("PRINT: ").map_or("", |(_, text)| text));
    assert_eq!(texts.collect::<Vec<_>>(), expected, "{program}");
}

/// Parameters are in the units of the machine, whatever those of the program.
#[test]
fn units_of_parameters() {
    assert_printed(
        "G10 L2 P1 X10 Y20 A30 R15
         (PRINT,#5221 #5222 #5224 #5230)
         G20
         G10 L2 P2 X1
         (PRINT,#5241 #5221)",
        &["0.393701 0.787402 30.000000 15.000000", "1.000000 0.393701"],
    );
    assert_printed(
        "G10 L2 P1 X1270 Y20 A30 R15\nG0 X1 Y0 A0\nG28.1\n(PRINT,#5161 #5162 #5164)",
        &["50.038029 0.797591 30.000000"],
    );
}

/// A parameter that the program sets acts when its system is selected, not with the word of the one in force.
#[test]
fn parameters_act_when_they_are_read() {
    let ends = |program: &str| ends(&elements_with(options(), &format!("G21\n{program}\nM2")));
    assert_eq!(ends("#5221=1\nG0 X0\nG54 X0\nG55 X0\nG54 X0"), "0 0 0 | 0 0 0 | 0 0 0 | 25.4 0 0");
    assert_eq!(ends("#5221=1\nG10 L2 P1 Y1\nG0 X0 Y0"), "25.4 1 0");
    assert_eq!(ends("#5241=1 #5250=90\nG55 G0 X10"), "0 10 0");
    assert_eq!(ends("#5220=2\nG0 X1\nG10 L2 P0 X5\nX1"), "1 0 0 | 6 0 0");
    assert_eq!(ends("#5211=1\nG0 X1\nG92.3 X1"), "1 0 0 | 26.4 0 0");
    assert_eq!(ends("#5161=1 #5183=2\nG28\nG30"), "0 0 0 | 25.4 0 0 | 25.4 0 0 | 0 0 50.8");
}

#[test]
fn parameters_of_g92() {
    assert_printed(
        "G0 X1
         G92 X5
         (PRINT,#5210 #5211 #5212 #5220)
         G20 G92 X5
         (PRINT,#5210 #5211 #5212 #5220)
         G92.2
         (PRINT,#5210 #5211 #5212)
         G92.1
         (PRINT,#5210 #5211 #5212)
         G21
         G52 X7
         (PRINT,#5210 #5211 #5212)
         G59.3
         (PRINT,#5220)
         #5220=4
         G10 L2 P0 X1
         (PRINT,#5220 #5381 #5281)",
        &[
            "1.000000 -0.157480 0.000000 1.000000",
            "1.000000 -4.960630 0.000000 1.000000",
            "0.000000 -4.960630 0.000000",
            "0.000000 0.000000 0.000000",
            "1.000000 0.275591 0.000000",
            "9.000000",
            "4.000000 0.039370 0.000000",
        ],
    );
}

#[test]
fn parameters_of_the_tool() {
    let tool = "(PRINT,#5400 #5403 #5410 #5411 #5412 #5413)";
    assert_printed(
        &format!(
            "{tool}\nT1 M6\n{tool}\nG43\n(PRINT,#<_tool_offset>)\nG10 L1 P1 Z50.8 R2 I1 J2 Q4\n{tool}\nT2\n{tool}\n\
             G49\n(PRINT,#<_tool_offset>)\nM61 Q2\n(PRINT,#5400 #5401 #5403 #5404)\nT0 M6\n{tool}"
        ),
        &[
            "0.000000 0.000000 0.000000 0.000000 0.000000 0.000000",
            "1.000000 1.000000 0.250000 10.000000 20.000000 3.000000",
            "1.000000",
            "1.000000 2.000000 0.157480 1.000000 2.000000 4.000000",
            "1.000000 2.000000 0.157480 1.000000 2.000000 4.000000",
            "0.000000",
            "2.000000 0.100000 2.000000 4.000000",
            "0.000000 0.000000 0.000000 0.000000 0.000000 0.000000",
        ],
    );
    // Touching off in a rotated system with G92.
    assert_printed(
        "G10 L2 P1 X5 Y6 R30
         G92 X3
         G0 Y2
         T1 M6
         G43
         G10 L10 P1 X1 Z2
         (PRINT,#5401 #5402 #5403)
         G10 L11 P1 X1 Y3 Z2
         (PRINT,#5401 #5402 #5403)
         G10 L20 P2 X7 Y8 Z9 A3
         (PRINT,#5241 #5242 #5243 #5244)
         G10 L20 P1 X7
         (PRINT,#5221 #5222 #5223 #5224)
         G28.1
         (PRINT,#5161 #5162 #5163 #5164)",
        &[
            "0.068191 0.039370 -0.078740",
            "-0.131814 0.042007 -0.078740",
            "0.038663 -0.154843 -1.354331 -3.000000",
            "0.060468 0.157480 0.000000 0.000000",
            "-0.092444 0.160118 0.000000 0.000000",
        ],
    );
    let decoded = decode("#5403=1\n#5413=1\nM2");
    assert_eq!(decoded.errors.len(), 2, "{decoded:?}");
}

/// A change of the table acts with the next G43, and where there was no table, it has what the program says.
#[test]
fn tools_are_set_by_the_program() {
    let end = |program: &str, options: DecoderOptions| {
        let found = elements_with(options, &format!("G21\n{program}\nM2"));
        ends_mm(&found).last().copied().unwrap()
    };
    let table = || DecoderOptions { reference: ToolReference::ControlPoint, ..options() };
    let none = DecoderOptions::default;
    assert_eq!(end("G10 L1 P2 Z5\nG43 H2\nG0 Z1 X0 Y0", table()), [2.54, 5.08, 6.0]);
    assert_eq!(end("T1 M6 G43\nG10 L1 P2 Z5\nT2 M6 G43\nG0 Z1 X0 Y0", table()), [2.54, 5.08, 6.0]);
    assert_eq!(end("T1 M6\nM6\nG43 G0 Z1", table()), [0.0, 0.0, 26.4]);
    assert_eq!(end("G20 G43 H1\nG21 G0 Z1", table()), [0.0, 0.0, 26.4]);
    assert_eq!(end("G10 L1 P7 Z5\nG43 H7\nG0 Z1", none()), [0.0, 0.0, 6.0]);
    assert_eq!(end("G10 L1 P7 Z5\nG43 H8\nG0 Z1", none()), [0.0, 0.0, 1.0]);
    // Both references differ by the tool, in a rotated system too.
    let program = "G10 L2 P1 X3 Y4 R30\nG43 H2\nG0 X5 Y6\nG53 G0 X1\nG28 Y2\nG2 X9 Y9 R50 F9";
    let [controlled, tip] = [table(), options()].map(|options| end(program, options));
    for ((controlled, tip), tool) in controlled.into_iter().zip(tip).zip([2.54, 5.08, 50.8]) {
        assert!((controlled - tip - tool).abs() < 2e-6, "{controlled} {tip}");
    }
}

#[test]
fn messages() {
    for (block, pointed, message) in [
        (
            "G10 P1 X1",
            None,
            "L is missing; G10 needs L1, L10 or L11 (tool), or L2 or L20 (coordinate system)",
        ),
        (
            "G10 L3 P1",
            Some("L3"),
            "G10 has no L3; G10 needs L1, L10 or L11 (tool), or L2 or L20 (coordinate system)",
        ),
        ("G10 L2 P10", Some("P10"), "P is 10, outside 0 to 9"),
        ("G10 L2 P1 I5", Some("I5"), "I has no effect in this block"),
        ("G10 L20 P1 R5", Some("R5"), "R has no effect in this block"),
        ("G10 L2 P1 X2e6", None, ""),
        ("G10 L2 P1 X2000000", Some("X2000000"), "X is 2000 m, outside -1000 m to 1000 m"),
        (
            "G10 L1 P1",
            None,
            "G10 L1 sets nothing; add an axis word, R (radius), I and J (angles) or Q (orientation)",
        ),
        ("G10 L1 P9 Z1", Some("P9"), "tool 9 is not in the tool table"),
        ("G10 L1 P1 Q10", Some("Q10"), "Q is 10, outside 0 to 9"),
        ("G43.2", None, "G43.2 needs H, the tool whose offset is added"),
        (
            "G43.2 H1 Y1",
            Some("Y1"),
            "Y cannot be used with G43.2, which takes only H; give offsets in axis words with G43.1",
        ),
        ("M61", None, "M61 needs Q, the number of the tool in the spindle (0 = none)"),
        ("M61 Q9", Some("Q9"), "tool 9 is not in the tool table"),
        ("T9", Some("T9"), "tool 9 is not in the tool table"),
    ] {
        let decoded = decode_with(options(), format!("G21 G0\n{block}\nM2").as_bytes());
        let error = &decoded.errors[0];
        if !message.is_empty() {
            assert_eq!(error.error.to_string(), message, "{block}");
            assert_eq!(error.columns.clone().map(|columns| &block[columns]), pointed, "{block}");
        }
    }
    let decoded = decode("G10 L2 P1 R30\nG18 G2 X5 I2.5 F100\nM2");
    assert_eq!(
        decoded.errors[0].error.to_string(),
        "arcs in G18 and G19 are not supported in a coordinate system that is rotated by 30 degrees; \
         use G17, or a system without rotation (G10 L2 R0)"
    );
}

#[test]
fn parameter_file() {
    let text =
        "31\t7\n5161 1\n\n5210\t1\n5211\t2.000000\n5220  2.0\r\n5241 -3\n5250 90\n5602 1e-3\n";
    let parameters = ParameterFile::read(text.as_bytes()).unwrap();
    assert_eq!(parameters.get(5241), Some(-3.0));
    assert_eq!(parameters.get(5221), None);
    assert_eq!(parameters.iter().count(), 8);
    let start = || DecoderOptions { parameters: parameters.clone(), ..DecoderOptions::default() };
    // G55 at -3, turned by 90 degrees, with G92 at 2.
    assert_eq!(
        ends(&elements_with(start(), "G0 X1 Y1\nG92.1 X1\nG28\nM2")),
        "-4 3 0 | -4 1 0 | -4 1 0 | 1 0 0"
    );
    assert_eq!(ends(&elements_with(start(), "G54 G0 X#31\nM2")), "9 0 0");
    let suspended = ParameterFile::read(text.replace("5210\t1", "5210 0").as_bytes()).unwrap();
    let options = DecoderOptions { parameters: suspended, ..DecoderOptions::default() };
    assert_eq!(ends(&elements_with(options, "G54 G0 X0\nG92.3 X0\nM2")), "0 0 0 | 2 0 0");
    let message = |text: &str| ParameterFile::read(text.as_bytes()).unwrap_err().to_string();
    let line = |line| {
        format!("line {line}: write the number of a parameter and its value, such as `5221 12.5`")
    };
    assert_eq!(message("1 2\nx 5"), line(2));
    assert_eq!(message("5221"), line(1));
    assert_eq!(message("5221 x"), line(1));
    assert_eq!(message("5221 inf"), line(1));
    assert_eq!(message("5221 1 2"), line(1));
    assert_eq!(message("0 1"), "line 1: parameter 0 does not exist: the numbers are 1 to 5602");
    assert_eq!(
        message("70000 1"),
        "line 1: parameter 70000 does not exist: the numbers are 1 to 5602"
    );
    assert_eq!(
        message("5222 1\n5221 2"),
        "line 2: parameter 5221 follows 5222; the numbers must ascend: move the line up or delete it"
    );
    assert!(message("5221 1\n5221 2").contains("follows"));
    assert!(message(&"\n".repeat(1 << 21)).contains("more than 1048576 bytes"));
    let error = ParameterFile::read(Unplugged).unwrap_err();
    assert!(matches!(error, ParameterFileError::Io(_)));
}
