//! Variables and jumps (manual 3.2.3, 3.2.7 and 3.2.8).

use super::*;
use crate::din66025::Variables;

fn with(variables: &[(&str, f64)]) -> DecoderOptions {
    let mut options = DecoderOptions::default();
    for (name, value) in variables {
        options.variables.set(name, *value);
    }
    options
}

/// `cnc-loop`; the example of manual 3.2.8 with the implicit variable, its blocks in order.
#[test]
fn loop_with_the_implicit_variable() {
    let program = b"%\nN1000 G36 D5\nN1010 G1 X100 F100 E100 E-100\nN1020 G1 X0\nN1030 G37 D-1\nN1040 G20 L1010";
    let options = DecoderOptions { start: [0.1, 0.0, 0.0], ..DecoderOptions::default() };
    let elements = elements_of(decode_with(options, program));
    assert_eq!(elements.len(), 10);
    assert!(elements[0].length() == 0.0);
    let length: f64 = elements.iter().map(PathElement::length).sum();
    assert_close(length * 1e3, 900.0);
    let lines: Vec<_> = elements.iter().map(|element| element.place.line).collect();
    assert_eq!(lines, [3, 4, 3, 4, 3, 4, 3, 4, 3, 4]);
}

/// The example of manual 3.2.8 with a variable of the controller.
#[test]
fn loop_with_a_named_variable() {
    let program = b"%\nN1000 G36 O$g_i$ D5\nN1010 G1 X100 F100 E100 E-100\nN1020 G1 X0\nN1030 G37 O$g_i$ D-1\nN1040 G20 L1010 K$G_I$\n";
    let elements = elements_of(decode_with(with(&[("g_I", 77.0)]), program));
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
        let elements = elements_of(decode_with(with(&[("GO", k)]), program));
        let found: Vec<_> = elements.iter().map(|element| element.place.block.unwrap()).collect();
        assert_eq!(found, blocks);
    }
}

#[test]
fn variables_stand_for_any_number() {
    let variables = [("x", 12.5), ("Feed", 20.0), ("code", 1.0)];
    let program = b"%\nN10 G$code$ X$x$ Y$ X $ F$feed$\n";
    let elements = elements_of(decode_with(with(&variables), program));
    assert_eq!(ends_mm(&elements)[0][1], [12.5, 12.5, 0.0]);
    assert_close(elements[0].feed, 0.02);
    // What they stand for is checked as if it were written there.
    let decoded = decode_with(with(&[("f", -1.0)]), b"%\nN10 G1 X1 F$f$\n");
    assert_eq!(diagnostics(&decoded)[0].error, DecodeError::NonPositiveFeed { value: -1.0 });
    assert_eq!(diagnostics(&decoded)[0].columns, Some(10..14));
}

/// A variable that changes while the program runs is what it is when its line is decoded.
#[test]
fn variables_are_looked_up_line_by_line() {
    let program = b"%\nN10 G36 O$a$ D1\nN20 G1 X$a$ F10\nN30 G37 O$a$ D2.5\nN40 G1 X$a$\n";
    let elements = elements_of(decode_with(with(&[("a", 0.0)]), program));
    assert_eq!(ends_mm(&elements)[1], [[1.0, 0.0, 0.0], [3.5, 0.0, 0.0]]);
}

#[test]
fn what_cannot_be_jumped_to_or_looked_up() {
    use DecodeError as E;
    let name = |text: &str| text.to_owned();
    for (block, pointed, error) in [
        ("N20 G1 X$nothing$ Y3", "X$nothing$", E::UnknownVariable { name: name("nothing") }),
        ("N20 G36 O$nothing$ D3", "O$nothing$", E::UnknownVariable { name: name("nothing") }),
        ("N20 G36 O3 D3", "O3", E::VariableExpected { value: 3.0 }),
        ("N20 M3 O$nothing$", "O$nothing$", E::UnknownParameters { name: name("nothing") }),
        ("N20 G20 L99", "L99", E::JumpTarget { block: 99 }),
        ("N20 G20 L1.5", "L1.5", E::NotWhole { letter: 'L', value: 1.5 }),
        ("N20 G20 K1", "G20", E::JumpWithoutTarget),
        ("N20 G20 L99 X5", "L99", E::JumpTarget { block: 99 }),
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
    assert_eq!(diagnostic.error, DecodeError::TooManyJumps { limit: 50 });
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
