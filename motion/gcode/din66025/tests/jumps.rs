//! Tests of variables and jumps (manual 3.2.3, 3.2.7 and 3.2.8).

use super::*;
use crate::din66025::Variables;
use std::io::{BufReader, Read, Seek, SeekFrom};

fn with(variables: &[(&str, f64)]) -> DecoderOptions {
    let mut options = DecoderOptions::default();
    for (name, value) in variables {
        options.variables.set(name, *value);
    }
    options
}

/// The example of manual 3.2.8 with a variable of the controller.
#[test]
fn loop_with_a_named_variable() {
    let program = b"%\nN1000 G36 O$g_i$ D5\nN1010 G1 X100 F100 E100 E-100\nN1020 G1 X0\nN1030 G37 O$g_i$ D-1\nN1040 G20 L1010 K$G_I$\n";
    let elements = elements_of(&decode_with(with(&[("g_I", 77.0)]), program));
    assert_eq!(elements.len(), 10);
}

/// The implicit variable is -1 at first, so a jump without K is taken.
#[test]
fn the_implicit_variable_begins_at_minus_one() {
    let blocks = "N10 G1 X1 F10\nN20 G20 L40\nN30 G1 X2\nN40 G1 X3\nN50 G37 D1\nN60 G20 L10\n";
    let lines: Vec<_> = elements(blocks).iter().map(|element| element.place.line).collect();
    assert_eq!(lines, [2, 5]);
}

#[test]
fn jumps_forward_and_on_a_condition() {
    for (k, blocks) in [(0.0, vec![10, 30, 40]), (2.5, vec![10, 40])] {
        let program = b"%\nN10 G1 X1 F10\nN20 G20 L40 K$go$\nN30 G1 X2\n  /n040 G1 X3";
        let elements = elements_of(&decode_with(with(&[("GO", k)]), program));
        let found: Vec<_> = elements.iter().map(|element| element.place.block.unwrap()).collect();
        assert_eq!(found, blocks);
    }
}

#[test]
fn variables_stand_for_any_number() {
    let variables = [("x", 12.5), ("Feed", 20.0), ("code", 1.0)];
    let program = b"%\nN10 G$code$ X$x$ Y$ X $ F$feed$\n";
    let elements = elements_of(&decode_with(with(&variables), program));
    assert_eq!(ends_mm(&elements)[0][1], [12.5, 12.5, 0.0]);
    assert_close(elements[0].feed, 0.02);
    // Their values are checked as if written there.
    let decoded = decode_with(with(&[("f", -1.0)]), b"%\nN10 G1 X1 F$f$\n");
    assert_eq!(diagnostics(&decoded)[0].error, DecodeError::NonPositiveFeed(-1.0));
    assert_eq!(diagnostics(&decoded)[0].columns, Some(10..14));
}

/// A variable that changes while the program runs is what it is when its line is decoded.
#[test]
fn variables_are_looked_up_line_by_line() {
    let program = b"%\nN10 G36 O$a$ D1\nN20 G1 X$a$ F10\nN30 G37 O$a$ D2.5\nN40 G1 X$a$\n";
    let elements = elements_of(&decode_with(with(&[("a", 0.0)]), program));
    assert_eq!(ends_mm(&elements)[1], [[1.0, 0.0, 0.0], [3.5, 0.0, 0.0]]);
}

#[test]
fn what_cannot_be_jumped_to_or_looked_up() {
    use DecodeError as E;
    let name = |text: &str| text.to_owned();
    for (block, pointed, error) in [
        ("N20 G1 X$nothing$ Y3", "X$nothing$", E::UnknownVariable(name("nothing"))),
        ("N20 G36 O$nothing$ D3", "O$nothing$", E::UnknownVariable(name("nothing"))),
        ("N20 G36 O3 D3", "O3", E::VariableExpected(3.0)),
        ("N20 M3 O$nothing$", "O$nothing$", E::UnknownParameters(name("nothing"))),
        ("N20 G20 L99", "L99", E::JumpTarget(99)),
        ("N20 G20 L1.5", "L1.5", E::NotWhole { letter: 'L', value: 1.5 }),
        ("N20 G20 K1", "G20", E::JumpWithoutTarget),
        ("N20 G20 L99 X5", "L99", E::JumpTarget(99)),
    ] {
        let decoded = decode(&format!("N10 G1 X1 F10\n{block}\nN30 G1 X50"));
        let found = diagnostics(&decoded);
        let of = found.iter().find(|found| found.error == error);
        let Some(diagnostic) = of else { panic!("{block}: {found:?}") };
        assert_eq!(&block[diagnostic.columns.clone().unwrap()], pointed);
        assert_eq!(ends_mm(&remaining(&decoded)).last().unwrap()[1], [50.0, 0.0, 0.0]);
    }
}

#[test]
fn endless_loops_end() {
    let options = DecoderOptions { jumps: 50, ..DecoderOptions::default() };
    let decoded = decode_with(options, b"%\nN10 G1 X1 F10\nN20 G1 X0\nN30 G20 L10 K1\nN40 G1 X9\n");
    let [diagnostic] = &diagnostics(&decoded)[..] else { panic!("{decoded:?}") };
    assert_eq!(diagnostic.error, DecodeError::TooManyJumps(50));
    assert_eq!(diagnostic.place.line, 4);
    assert_eq!(remaining(&decoded).len(), 2 * 51);
}

#[test]
fn streams_cannot_jump() {
    let program = &b"%\nN10 G1 X1 F10\nN20 G20 L10 K0\nN30 G20 L10 K1\nN40 G1 X2\n"[..];
    let decoded: Vec<_> = Decoder::new(program, DecoderOptions::default()).collect();
    assert_eq!(decoded.len(), 3);
    let errors = decoded.iter().filter_map(|item| item.as_ref().err()).collect::<Vec<_>>();
    let [Failure::Diagnostic(diagnostic)] = errors[..] else { panic!("{errors:?}") };
    assert_eq!((&diagnostic.error, diagnostic.place.line), (&DecodeError::JumpInStream, 4));
}

/// Case does not matter, and what was set last counts.
#[test]
fn names() {
    let mut variables = Variables::default();
    variables.set("g_fX", 1.0);
    variables.set("G_FX", 2.0);
    assert_eq!((variables.get("g_fx"), variables.get("other")), (Some(2.0), None));
    assert_eq!(variables.iter().collect::<Vec<_>>(), [("G_FX", 2.0)]);
}

/// The D of G36 and G37 is a value, not a tool radius, and the tool radius is not a value.
#[test]
fn values_are_no_radii() {
    let elements = elements("F10\nG41 D5\nG1 X1\nG36 D3\nG37 D-1\nG1 X2");
    assert!(elements.iter().all(|element| element.tool_radius == 0.005), "{elements:?}");
    for (block, command) in [("G36", 36), ("G37", 37)] {
        let decoded = decode(&format!("D5\n{block}"));
        assert_eq!(diagnostics(&decoded)[0].error, DecodeError::ValueMissing(command));
    }
}

/// The implicit variable is an INT (manual 3.2.8): it rounds, and it has limits.
#[test]
fn the_implicit_variable_is_an_int() {
    let end = |blocks: &str| elements(blocks)[0].end().x * 1e3;
    assert_close(end("F10\nG36 D0.4\nG20 L5\nN1 G1 X1\nN5 G1 X2"), 1.0);
    assert_close(end("F10\nG36 D0.5\nG20 L5\nN1 G1 X1\nN5 G1 X2"), 2.0);
    let decoded = decode("G36 D32767\nG37 D1");
    let [diagnostic] = &diagnostics(&decoded)[..] else { panic!("{decoded:?}") };
    let (min, max) = (-32_768.0, 32_767.0);
    let error = DecodeError::VariableOverflow { kind: "INT", value: 32_768.0, min, max };
    assert_eq!((&diagnostic.error, diagnostic.columns.clone()), (&error, Some(4..6)));
}

/// The types of `SMC_VARLIST` (manual 10.2) hold what theirs in IEC 61131-3 hold.
#[test]
fn types() {
    for (kind, min, max) in [
        ("INT", -32_768.0, 32_767.0),
        ("byte", 0.0, 255.0),
        ("Word", 0.0, 65_535.0),
        ("DINT", -2_147_483_648.0, 2_147_483_647.0),
        ("DWORD", 0.0, 4_294_967_295.0),
        ("SINT", -128.0, 127.0),
        ("USINT", 0.0, 255.0),
        ("UINT", 0.0, 65_535.0),
        ("UDINT", 0.0, 4_294_967_295.0),
    ] {
        let mut variables = Variables::default();
        for (value, held) in [(min, Some(min)), (max, Some(max)), (2.5, Some(3.0))] {
            assert!(variables.set_typed("v", kind, value), "{kind} {value}");
            assert_eq!(variables.get("V"), held);
        }
        for value in [min - 1.0, max + 1.0, f64::NAN, f64::INFINITY] {
            assert!(!variables.set_typed("v", kind, value), "{kind} {value}");
        }
        assert_eq!(variables.get("v"), Some(3.0));
        let options = DecoderOptions { variables, ..DecoderOptions::default() };
        let program = format!("%\nG36 O$v$ D{max}\nG37 O$v$ D-0.4\nG37 O$v$ D1");
        let found = diagnostics(&decode_with(options, program.as_bytes()));
        let [Diagnostic { error: DecodeError::VariableOverflow { value, .. }, place, .. }] =
            &found[..]
        else {
            panic!("{kind}: {found:?}")
        };
        assert_eq!((*value, place.line), (max + 1.0, 4));
    }
    let mut variables = Variables::default();
    assert!(variables.set_typed("r", "REAL", 0.1) && variables.set_typed("l", "LREAL", 0.1));
    assert_eq!((variables.get("r"), variables.get("l")), (Some(f64::from(0.1_f32)), Some(0.1)));
    assert!(!variables.set_typed("b", "BOOL", 1.0) && !variables.set_typed("r", "REAL", 1e39));
}

/// Every error in a loop is reported once; one that only appears in a later pass is reported then.
#[test]
fn told_once() {
    let blocks = "F10\nG36 D4\nN1 G1 X1 R5 I2\nN2 G91\nN3 X400000 T1\nN4 X300000\nG37 D-1\nG20 L1";
    let reported: Vec<_> = diagnostics(&decode(blocks))
        .into_iter()
        .map(|found| (found.place.line, found.columns.unwrap()))
        .collect();
    // R, I, T on the first pass; on the fourth the relative targets lead too far.
    assert_eq!(reported, [(4, 9..11), (4, 12..14), (6, 11..13), (7, 3..10)]);
}

/// Blocks are found behind comments and in odd spellings, not in comments, and of two the first is meant.
#[test]
fn finding_blocks() {
    for target in ["N7 G1 X1", "n007 G1 X1", "(N8) N7G1 X1", " \t/N7 G1 X1", "(a)(b)\tn7.0 G1 X1"] {
        let elements = elements(&format!("F10\nG20 L7 K1\n(N7) X5\nN6 X6\n{target}\nN7 G1 X2"));
        let lines: Vec<_> = elements.iter().map(|element| element.place.line).collect();
        assert_eq!(lines, [6, 7], "{target}");
    }
}

/// A suppressed block is not there.
#[test]
fn suppressed_targets() {
    let program = b"%\nF10\nG20 L7 K1\n/N7 G1 X1\nN8 G1 X2\nN7 G1 X3";
    let options = DecoderOptions { skip_suppressed_blocks: true, ..DecoderOptions::default() };
    let elements = elements_of(&decode_with(options, program));
    assert_eq!((elements.len(), elements[0].place.line), (1, 6));
}

/// A program need not begin at the beginning of its reader.
#[test]
fn a_reader_part_of_the_way() {
    let mut reader =
        Cursor::new(&b"JUNK\n%\nN9 F10\nN8 G36 D2\nN1 G1 X1\nN2 G37 D-1\nN3 G20 L1\nN4 G1 X5"[..]);
    reader.set_position(5);
    let lines: Vec<_> = Decoder::with_jumps(reader, DecoderOptions::default())
        .map(|item| match item.unwrap() {
            Item::Element(element) => element.place.line,
            Item::Warning(warning) => panic!("{warning}"),
        })
        .collect();
    assert_eq!(lines, [4, 4, 7]);
}

/// Counts seeks.
struct Counting<'a>(Cursor<&'a [u8]>, &'a std::cell::Cell<u32>);

impl Read for Counting<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.0.read(buffer)
    }
}

impl Seek for Counting<'_> {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.1.set(self.1.get() + 1);
        self.0.seek(to)
    }
}

/// A loop within the buffer goes back to the file for nothing.
#[test]
fn short_loops_stay_in_the_buffer() {
    let program = b"%\nN1 F10\nN3 G36 D100\nN2 G1 X1\nN4 G37 D-1\nN5 G20 L2\n";
    let seeks = std::cell::Cell::new(0);
    let reader = BufReader::new(Counting(Cursor::new(program), &seeks));
    assert_eq!(Decoder::with_jumps(reader, DecoderOptions::default()).count(), 100);
    assert!(seeks.get() <= 2, "{}", seeks.get());
}
