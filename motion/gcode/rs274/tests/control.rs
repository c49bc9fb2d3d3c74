//! Tests of what controls do with words that they do not take as LinuxCNC does.

use super::*;
use crate::decode::TextError;
use crate::rs274::{CONTROL_WORDS, Control, Reading};
use std::collections::BTreeSet;

/// Errors and warnings of a program for `control`.
fn findings(control: Control, program: &str) -> (Vec<String>, Vec<String>) {
    let options = DecoderOptions { control: Some(control), ..DecoderOptions::default() };
    let decoded = decode_with(options, program.as_bytes());
    let texts = |all: &[Diagnostic]| all.iter().map(ToString::to_string).collect();
    (texts(&decoded.errors), texts(&decoded.warnings))
}

#[test]
fn every_row_is_read() {
    let text = include_str!("../control/words.tsv");
    assert_eq!(CONTROL_WORDS.len(), text.lines().count() - 1);
    let words: BTreeSet<_> = CONTROL_WORDS.iter().map(|row| row.word).collect();
    assert_eq!(words.len(), CONTROL_WORDS.len(), "one is twice in it");
    for row in CONTROL_WORDS.iter() {
        for cell in row.cells {
            let silent = matches!(cell.reading, Reading::Different | Reading::Followed);
            assert!(!(silent && cell.reason.is_empty()), "{row:?}");
        }
    }
}

/// Each word of the table that is not one of LinuxCNC's letters, G and M words is found in this program.
#[test]
fn every_word_is_found() {
    let long = format!("G1 X1 ({})", "-".repeat(300));
    let program = format!(
        "%\nO100 (number)\n{long}\nN99999999 G21 ; comment\n/G0 X1\nG2 X3 I1 K4 F100\nG2 X9 R-4\nG0 X0 Y0\nG2 X10 I5.01\nG2 I1 P2\nG18 G2 X1 Z1 R3\nG19 G2 Y1 Z1 R3\nG17 G4 P.5\nG10 L1 P1 R1\nG10 L2 P1 X0\nG10 L2 P7 R0\nG10 L10 P1\nG10 L11 P1\nG10 L20 P2\nG81 X1 Z-1 R2 L2\nG53 G1 X0\nG43.1 X1\nM3 M8 S100\nM10\n#1=[1+2]\n#<x>=1\n@1^2 G0\no1 sub\no1 endsub\no2 if [1]\no2 endif\no3 while [0]\no3 endwhile\n%\n"
    );
    let found: BTreeSet<String> = Control::ALL
        .into_iter()
        .flat_map(|control| {
            let options = DecoderOptions { control: Some(control), ..DecoderOptions::default() };
            let decoded = decode_with(options, program.as_bytes());
            decoded.errors.into_iter().chain(decoded.warnings)
        })
        .filter_map(|diagnostic| of_control(&diagnostic.error))
        .collect();
    let is_code = |word: &str| {
        let mut bytes = word.bytes();
        matches!(bytes.next(), Some(b'A'..=b'Z' | b'$'))
            && bytes.all(|it| it.is_ascii_digit() || matches!(it, b'.' | b'-' | b'G' | b'M'))
    };
    let taken_by_all = [
        "other G words",
        "other M words",
        "block without N",
        "program without an end",
        "motion without any F",
        "coordinates before any motion word",
    ];
    for row in
        CONTROL_WORDS.iter().filter(|row| !is_code(row.word) && !taken_by_all.contains(&row.word))
    {
        assert!(found.contains(row.word), "{} is not found; {found:?}", row.word);
    }
}

fn of_control(error: &crate::rs274::DecodeError) -> Option<String> {
    match error {
        crate::rs274::DecodeError::OfControl(finding) => Some(finding.word.clone()),
        crate::rs274::DecodeError::Repeated { error, .. } => of_control(error),
        _ => None,
    }
}

#[test]
fn grbl() {
    let (errors, warnings) =
        findings(Control::Grbl, "G21\nG0 X1\nG81 X2 Z-1 R1 F60\nX3\nM6 T1\nM1\n");
    assert_eq!(errors, ["line 3: grbl refuses G81", "line 5: grbl refuses M6: error 20",]);
    // It needs no end.
    assert_eq!(warnings, ["line 6: grbl passes over M1: optional stops"]);
    let options = DecoderOptions { control: Some(Control::Grbl), ..DecoderOptions::default() };
    let decoded = decode_with(options, b"F60 G81 X2 Z-1 R1\nM2");
    assert_eq!(
        decoded.errors[0].error.hint().unwrap(),
        "`twin path PROGRAM --for grbl --format rs274` writes it without this word"
    );
}

/// What LinuxCNC refuses others take, and the other way round.
#[test]
fn leniency_is_that_of_the_control() {
    for (control, program, errors, warnings) in [
        (Control::LinuxCnc, "G0 X1", 1, 0),
        (Control::Grbl, "G0 X1", 0, 0),
        (Control::Fanuc, "G0 X1.", 1, 1),
        (Control::Mach3, "M47\nM2", 0, 1),
        (Control::Grbl, "G1 X1\nM2", 1, 0),
        (Control::LinuxCnc, "X1\nM2", 1, 0),
        (Control::Grbl, "X1\nM2", 0, 1),
        (Control::Mach3, "M10\nM2", 0, 1),
        (Control::Grbl, "M10\nM2", 1, 0),
    ] {
        let found = findings(control, program);
        assert_eq!(
            (found.0.len(), found.1.len()),
            (errors, warnings),
            "{control} {program} {found:?}"
        );
    }
}

/// The path is that of the control where its numbers mean something else.
#[test]
fn numbers_that_mean_something_else() {
    let decode_for = |control, program: &str| {
        let options = DecoderOptions { control: Some(control), ..DecoderOptions::default() };
        decode_with(options, program.as_bytes()).elements
    };
    let dwell = |control| decode_for(control, "G4 P500\nM2")[0].kind;
    assert_eq!(dwell(Control::Fanuc), ElementKind::Dwell { time_ns: 500_000_000 });
    assert_eq!(dwell(Control::Grbl), ElementKind::Dwell { time_ns: 500_000_000_000 });
    assert_eq!(ends(&decode_for(Control::Mach3, "G70 G0 X1\nG71 X2\nM2")), "25.4 0 0 | 2 0 0");
    let seconds = decode_for(Control::Fanuc, "G4 X.5\nM2")[0].kind;
    assert_eq!(seconds, ElementKind::Dwell { time_ns: 500_000_000 });
    let holes = decode_for(Control::Fanuc, "G91 F60 G81 X1. Z-1. R0. K3\nM2");
    assert_eq!(ends(&holes).split(" | ").last(), Some("3 0 0"));
    // 3 mm and 4 degrees in the time of 5 mm.
    let both = |control| decode_for(control, "F60 G1 X3 A4\nM2")[0].feed;
    assert!((both(Control::FluidNc) - 0.6e-3).abs() < 1e-12);
    assert_eq!(both(Control::Grbl), 1e-3);
    let hundred = decode_for(Control::Fanuc, "G91\nM98 P1000100\nM2\nO100\nG0 X1.\nM99\n");
    assert_eq!(hundred.len(), 100);
    let program = "G91\nM98 P30200\nM2\nO200\nG0 X1\nM99\n";
    assert_eq!(ends(&decode_for(Control::Fanuc, program)), "1 0 0 | 2 0 0 | 3 0 0");
}

/// Names of functions are no axes.
#[test]
fn names_of_functions() {
    let program = "G21\n#1=ABS[-3]\nG0 X[10*COS[30]+EXP[0]] Y ABS[#<_x>]\nM2";
    let (errors, _) = findings(Control::Grbl, program);
    let lines: Vec<_> = errors.iter().map(|error| error.split(':').nth(1).unwrap()).collect();
    assert_eq!(
        lines,
        [" grbl refuses parameters", " grbl refuses expressions", " grbl refuses named parameters"]
    );
}

/// B-63944EN/03, 19.1 and 20.1: G05.1 Q1 and Q0 stand alone and switch the look-ahead; G05 P10000 and P0 as well.
#[test]
fn look_ahead_of_fanuc() {
    let program =
        "G21\nG5.1 Q1\nG5.1 Q1 R5.\nG05 P10000\nG1 X1. F100.\nX2.\nG5 P0\nG5.1 Q0\nX3.\nM30\n";
    let (errors, warnings) = findings(Control::Fanuc, program);
    assert_eq!((errors, warnings), (vec![], vec![]));
    let options = DecoderOptions { control: Some(Control::Fanuc), ..DecoderOptions::default() };
    let path = elements_with(options, program);
    assert_eq!(ends(&path), "1 0 0 | 2 0 0 | 3 0 0");
    let (errors, _) = findings(Control::Fanuc, "F9.\nG5.1 X1. Y1. I1. J1.\nM30\n");
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(findings(Control::Fanuc, "G5.1\nM30").0, ["line 1: G5.1 needs Q1 (on) or Q0 (off)"]);
    // Others have splines of these names.
    assert_eq!(
        decode("G5.1 Q1\nM2").errors[0].error.hint().unwrap().split_once("--for"),
        Some(("on Fanuc G5 P and G5.1 Q set how far the control looks ahead: ", " fanuc"))
    );
}

/// Manual of `Mach3` Mill, 10.7.20: G59 P1 to P6 are G54 to G59.
#[test]
fn fixtures_of_mach3() {
    let mut options = DecoderOptions { control: Some(Control::Mach3), ..DecoderOptions::default() };
    for (system, x) in [(1, 1.0), (6, 6.0)] {
        options.work_offsets[system] = at([x * 1e-3, 0.0, 0.0]);
    }
    let path = elements_with(options, "G59 P2\nG0 X0\nG59 P7\nX0\nG59 P1\nX0\nG54\nX5\nM30");
    assert_eq!(ends(&path), "1 0 0 | 6 0 0 | 0 0 0 | 5 0 0");
    let (errors, _) = findings(Control::Mach3, "G59 P12 G0 X1\nX2\nM30");
    let [error] = &errors[..] else { panic!("{errors:?}") };
    assert!(
        error.starts_with("line 1: the work offset G59 P12 is not read: there are 1 to 9"),
        "{error}"
    );
}

/// Words of other controls without --for.
#[test]
fn hints_name_the_control() {
    for (program, control) in [
        ("M98 P30200\nM30\nO200\nM99\n", "--for fanuc"),
        ("G70\nM2", "--for mach3"),
        ("G71 G0 X1\nM2", "--for mach3"),
    ] {
        let decoded = decode(program);
        let hint = decoded.errors[0].error.hint().unwrap_or_default();
        assert!(hint.ends_with(control), "{program}: {hint} {:?}", decoded.errors);
    }
    assert_eq!(decode("M98 P200\nM30").errors[0].error.hint(), None);
    assert_eq!(decode("G72\nM30").errors[0].error.hint(), None);
}

/// Each statement of the macro language is one error, which names the O word to use, whatever the control.
#[test]
fn macro_statements_of_fanuc() {
    let program = "G21\n#1=0\nG0 X1.\nN20 IF [#1 EQ 1] GOTO 30\nIF[#1GT1]THEN #1=2\nWHILE [#1 LT 3] DO1\nG1 X2. F100.\n\
        #1=[#1+1]\nEND1\nGOTO 30\ngoto[#1]\nN30 G2 X4. I1.\nM30\n";
    for control in [None, Some(Control::Fanuc)] {
        let decoded = decode_with(
            DecoderOptions { control, ..DecoderOptions::default() },
            program.as_bytes(),
        );
        let found: Vec<_> = decoded.errors.iter().map(ToString::to_string).collect();
        let expected = [
            ("line 4 (N20): IF of", "`O100 if [...]`"),
            ("line 5: IF of", "`O100 if [...]`"),
            ("line 6: WHILE of", "`O100 while [...]`"),
            ("line 9: END of", "`O100 endwhile`"),
            ("line 10: GOTO of", "`O100 while [...]`"),
            ("line 11: GOTO of", "`O100 while [...]`"),
        ];
        assert_eq!(found.len(), expected.len(), "{found:#?}");
        for (found, (start, rewrite)) in found.iter().zip(expected) {
            assert!(found.starts_with(start) && found.contains(rewrite), "{found}");
        }
    }
    // A function behind a letter is not a statement.
    assert_eq!(decode("G2 X2 IFIX[1.5] F9\nM2").errors, []);
}
