//! Tests of switches, M functions, extra axes, S profiles, tool radius and marks.

use super::*;
use twin_path::ElementKind::MFunction;
use twin_path::{AxisMask, Marks};

/// Numbers (negative: off) and places of the switches of an element.
fn switches(element: &PathElement) -> Vec<(i16, f64)> {
    let sign = |on: bool| if on { 1 } else { -1 };
    element.switches().iter().map(|s| (i16::from(s.number) * sign(s.on), s.at)).collect()
}

/// The length of a spline is known only with its successor.
#[test]
fn switches_on_splines() {
    let elements = elements("G5 X20 Y0 F10 H1 L-5\nG5 X20 Y20");
    let length = elements[0].length() * 1e3;
    assert_close(switches(&elements[0])[0].1, 1.0 - 5.0 / length);
}

#[test]
fn switches_that_cannot_be() {
    use DecodeError as E;
    for (block, error) in [
        ("N20 G1 X10 H0 O0", E::SwitchNumber(0.0)),
        ("N20 G1 X10 H33 O0", E::SwitchNumber(33.0)),
        ("N20 G1 X10 H1.5 O0", E::NotWhole { letter: 'H', value: 1.5 }),
        ("N20 G1 X10 H1 O1.5", E::SwitchBeyond { at: 1.5, length_mm: 10.0 }),
        ("N20 G1 X10 H1 L25", E::SwitchBeyond { at: 2.5, length_mm: 10.0 }),
        ("N20 G1 X10 O1 H1", E::SwitchWithoutPlace),
        ("N20 G1 X10 O0 H1 O0 H2 O0 H3 O0 H4 O0", E::TooManySwitches(3)),
        ("N20 G90 H1 O0", E::WordWithoutMotion { letter: 'H', command: 90 }),
        ("N20 F10 H1 O0", E::WordWithoutMotion { letter: 'H', command: 1 }),
    ] {
        let found = diagnostics(&decode(&format!("F10\n{block}")));
        assert!(found.iter().any(|found| found.error == error), "{block}: {found:?}");
        assert!(found.iter().all(|found| found.place.line == 3), "{found:?}");
    }
}

/// Manual 3.2.2: the path waits where the block has led.
#[test]
fn auxiliary_functions() {
    let mut options = DecoderOptions::default();
    options.variables.set_parameters("g_myMParams", [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
    let program =
        b"%\nN90 M10\nN100 G1 X10 F10 M3 K2.5 L-4\nN150 M13 O$g_myMParams$\nN160 G1 X20\n";
    let elements = elements_of(&decode_with(options, program));
    let m = |number| MFunction { number };
    assert_eq!(kinds(&elements), [m(10), ElementKind::Cut, m(3), m(13), ElementKind::Cut]);
    for element in &elements[2..4] {
        assert_eq!((element.start(), element.end()), (elements[1].end(), elements[1].end()));
        assert!(element.length() == 0.0);
    }
    let parameters = |index: usize| elements[index].details.as_ref().unwrap().parameters;
    assert!(elements[0].details.is_none());
    assert_eq!((parameters(2).k, parameters(2).l, parameters(2).o), (Some(2.5), Some(-4.0), None));
    assert_eq!(parameters(3).o.unwrap()[7], 8.0);
}

/// Manual 3.2.2: `gSMC_MParameters` goes with an M function, unless O names another structure.
#[test]
fn global_parameters_of_auxiliary_functions() {
    let mut options = DecoderOptions::default();
    options.variables.set_parameters("GSMC_mparameters", [7.0; 8]);
    options.variables.set_parameters("g_own", [1.0; 8]);
    let program = b"%\nN10 M3\nN20 M4 K2 O$g_own$\nN30 G1 X10 F10\nN40 G1 X20 M5 H1 O0.5\n";
    let elements = elements_of(&decode_with(options, program));
    let parameters = |element: &PathElement| Some(element.details.as_ref()?.parameters);
    let o = |index: usize| parameters(&elements[index]).unwrap().o;
    assert_eq!((o(0), o(1), o(4)), (Some([7.0; 8]), Some([1.0; 8]), Some([7.0; 8])));
    assert_eq!(parameters(&elements[1]).unwrap().k, Some(2.0));
    // Only M functions have parameters.
    assert_eq!(parameters(&elements[2]), None);
    assert_eq!((parameters(&elements[3]).unwrap().o, elements[3].switches().len()), (None, 1));
}

/// An M function after a G92: the set-point jumps first.
#[test]
fn auxiliary_function_after_a_jump() {
    let elements = elements("G1 X10 F10\nG92 X50\nM5\nG1 X60");
    let m5 = MFunction { number: 5 };
    assert_eq!(kinds(&elements), [ElementKind::Cut, ElementKind::Jump, m5, ElementKind::Cut]);
    assert_eq!(ends_mm(&elements)[2], [[50.0, 0.0, 0.0], [50.0, 0.0, 0.0]]);
}

/// Manual 3.1 and 3.2: extra axes keep their targets, obey G91 and G92, and go along with every object.
#[test]
fn extra_axes() {
    let elements =
        elements("G1 X10 F10\nG1 X20 P90 W-5\nG91\nG1 X10 P10\nG92 Q7\nG1 X1\nG90\nG1 U3");
    assert!(elements[0].extra().is_none());
    let ends: Vec<_> = elements[1..].iter().map(|element| *element.extra().unwrap()).collect();
    assert_eq!(ends[0].start, [0.0; 5]);
    assert_eq!(ends[0].end, [90.0, 0.0, 0.0, 0.0, -5.0]);
    assert_eq!((ends[1].start, ends[1].end[0]), (ends[0].end, 100.0));
    assert_eq!(elements[3].kind, ElementKind::Jump);
    assert_eq!((ends[2].start[1], ends[2].end[1]), (0.0, 7.0));
    assert_eq!(ends[4].end, [100.0, 7.0, 3.0, 0.0, -5.0]);
    // Alone they travel their own length: 3 u at F10 are 0.3 s.
    assert_close(elements[5].length() / elements[5].feed, 0.3);
}

#[test]
fn where_extra_axes_start() {
    let options = DecoderOptions { start_extra: [1.0, 2.0, 3.0, 4.0, 5.0], ..Default::default() };
    let elements = elements_of(&decode_with(options, b"%\nN10 G91\nN20 G1 P1 F10\n"));
    assert_eq!(elements[0].extra().unwrap().end, [2.0, 2.0, 3.0, 4.0, 5.0]);
}

/// `cnc-S-profile` is about the curve; here is which axes follow it.
#[test]
fn s_profiles() {
    let elements = elements("S7 S3\nG1 X10 P40 F10\nS-7 S11\nG1 X20 Z5 P50\nG1 X100 Z5 S-3");
    let profile = |index: usize| elements[index].details.as_ref().map(|details| details.s_profile);
    let (p, w) = (AxisMask::extra(0), AxisMask::extra(4));
    assert_eq!(profile(0), Some(AxisMask::Z.with(p)));
    assert_eq!(profile(1), Some(AxisMask::Z.with(w)));
    assert_eq!(profile(2), Some(w));
    assert_close(elements[0].extra_at(0.0025).unwrap().position[0], 4.140_625);
    for number in ["0", "4", "6", "12", "-5"] {
        let found = diagnostics(&decode(&format!("S{number}")));
        assert!(matches!(found[..], [Diagnostic { error: DecodeError::ProfileAxis(_), .. }]));
    }
}

/// The tool radius goes with every object; marks begin with the next one and end behind the last.
#[test]
fn tool_radius_and_marks() {
    let elements = elements(
        "G1 X10 F10 D3\nG41\nG61\nG1 X20\nG1 X30 D2\nG40\nG51\nM5\nG1 X40\nG50\nG60\nG1 X50\nG52\nG50",
    );
    let marks: Vec<_> = elements.iter().map(|element| element.marks).collect();
    assert_eq!(
        marks,
        [
            Marks::default(),
            Marks::CORRECTION_LEFT.with(Marks::LOOPS),
            Marks::CORRECTION_END,
            Marks::default(),
            Marks::SMOOTHING.with(Marks::CORNERS_END).with(Marks::LOOPS_END),
            // The rounding that nothing followed has not begun.
            Marks::CORNERS_END,
        ]
    );
    let radii: Vec<_> = elements.iter().map(|element| element.tool_radius).collect();
    assert_eq!(radii, [0.003, 0.003, 0.002, 0.0, 0.002, 0.002]);
    let found = diagnostics(&decode("N10 G41 D-1"));
    assert_eq!(found[0].error, DecodeError::NegativeToolRadius(-1.0));
}

#[test]
fn the_other_side_replaces_what_has_not_begun() {
    let elements = elements("G41\nG42\nG51\nG52\nG1 X10 F10");
    assert_eq!(elements[0].marks, Marks::CORRECTION_RIGHT.with(Marks::ROUNDING));
}

/// Words that act twice: the left one counts, with one warning.
#[test]
fn words_that_come_twice() {
    let decoded = decode("N10 G1 X1 X2 F10 E100 E-200");
    let [diagnostic] = &diagnostics(&decoded)[..] else { panic!("{decoded:?}") };
    assert_eq!(diagnostic.error, DecodeError::DuplicateWord { letter: 'X', value: 1.0 });
    assert_eq!(diagnostic.columns, Some(7..9));
    assert_eq!(ends_mm(&remaining(&decoded))[0][1], [1.0, 0.0, 0.0]);
    assert_eq!(diagnostics(&decode("N10 G1 X1 F10 E-100 E-200")).len(), 1);
}

/// What O names must be there, and be what H or M needs.
#[test]
fn names_that_are_something_else() {
    let mut options = DecoderOptions::default();
    options.variables.set("g_n", 0.5);
    options.variables.set_parameters("g_p", [1.0; 8]);
    let run = |block: &str| decode_with(options.clone(), format!("%\nF10\n{block}").as_bytes());
    for name in ["nothing", "g_p"] {
        let decoded = run(&format!("G1 X10 H1 O${name}$"));
        assert_eq!(diagnostics(&decoded)[0].error, DecodeError::SwitchWithoutPlace);
        assert!(remaining(&decoded)[0].switches().is_empty());
    }
    assert_eq!(switches(&remaining(&run("G1 X10 H1 O$g_n$"))[0]), [(1, 0.5)]);
    let name = || "g_n".to_owned();
    for (block, error) in [
        ("M5 O2", DecodeError::ParametersExpected(2.0)),
        ("M5 O$g_n$", DecodeError::UnknownParameters(name())),
        // The motion of a block with an error is none.
        ("G1 X10 M5 O2", DecodeError::ParametersExpected(2.0)),
    ] {
        let decoded = run(block);
        assert_eq!(diagnostics(&decoded)[0].error, error);
        assert!(remaining(&decoded).is_empty(), "{block}");
    }
}

/// Numbers in messages are those somebody would write.
#[test]
fn messages_round() {
    let found = diagnostics(&decode("G91\nG1 X999999.9 F10\nX0.3"));
    let message = found[0].error.to_string();
    assert_eq!(message, "X is 1000000.2 mm, outside -1000000 mm to 1000000 mm");
}
