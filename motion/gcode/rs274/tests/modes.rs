//! Tests of saved modal states, overrides, inputs and outputs.

use super::*;
use crate::rs274::PathMode;
use twin_path::MParameters;

/// M functions of a program as `number K L [O]`.
fn m_functions(program: &str) -> Vec<String> {
    let functions = elements(program).into_iter().filter_map(|element| {
        let ElementKind::MFunction { number } = element.kind else { return None };
        let MParameters { k, l, o } = element.details.map(|it| it.parameters).unwrap_or_default();
        let number_of = |value: Option<f64>| value.map_or("-".to_owned(), |it| it.to_string());
        let set = o.map_or(String::new(), |o| format!(" {:?}", &o[..2]));
        Some(format!("{number} {} {}{set}", number_of(k), number_of(l)))
    });
    functions.collect()
}

/// The error of the last line but one.
fn error(program: &str) -> String {
    let decoded = decode(program);
    let [error] = &decoded.errors[..] else { panic!("{program:?}: {:?}", decoded.errors) };
    error.error.to_string()
}

#[test]
fn outputs_are_passed_on() {
    for (block, function) in [
        ("M62 P1", "62 1 -"),
        ("M63 P0", "63 0 -"),
        ("M64 P3", "64 3 -"),
        ("M65 P4", "65 4 -"),
        // LinuxCNC rounds the numbers of inputs and outputs.
        ("M65 P1.5", "65 2 -"),
        ("M68 E1.4 Q1", "68 1 1"),
        ("M66 P2.6", "66 3 - [0.0, 0.0]"),
        ("M66 P2", "66 2 - [0.0, 0.0]"),
        ("M66 P2 L3 Q1.5", "66 2 - [3.0, 1.5]"),
        ("M66 E1 Q-1", "66 - 1 [0.0, 0.0]"),
        ("M67 E1 Q2.5", "67 1 2.5"),
        ("M68 E0 Q-2.5", "68 0 -2.5"),
        ("M100", "100 - -"),
        ("M150 P-1.5", "150 -1.5 -"),
        ("M199 P1 Q2", "199 1 2"),
    ] {
        assert_eq!(m_functions(&format!("{block}\nM2")), [function], "{block}");
    }
    assert_eq!(m_functions("M48\nM49\nM50 P0\nM51\nM52\nM53\nM70\nM2"), [""; 0]);
}

#[test]
fn m_functions_of_a_block_are_in_order() {
    let functions = m_functions("S100 M101 M8 M3 M62 P1\nM2");
    assert_eq!(functions, ["62 1 -", "3 100 -", "8 - -", "101 1 -", "5 - -", "9 - -"]);
}

#[test]
fn spindle_and_coolant_are_restored() {
    let functions = m_functions("S100 M3 M7\nM70\nS50 M4\nM9\nM8\nM72\nM72\nM2");
    let expected = [
        "3 100 -", "7 - -", "4 50 -", "9 - -", "8 - -", "3 100 -", "9 - -", "7 - -", "5 - -",
        "9 - -",
    ];
    assert_eq!(functions, expected);
    // Nothing to do.
    assert_eq!(m_functions("M3 M8\nM70\nM72\nM2"), ["3 - -", "8 - -", "5 - -", "9 - -"]);
    assert_eq!(m_functions("M70\nM3 M8\nM72\nM2"), ["3 - -", "8 - -", "5 - -", "9 - -"]);
}

#[test]
fn modes_are_shown_in_parameters() {
    let value = |program: &str, parameter: &str| {
        let elements = elements(&format!("{program}\nG0 X#{parameter}\nM2"));
        ends_mm(&elements).last().unwrap()[0]
    };
    for (program, parameter, expected) in [
        ("", "<_feed_override>", 1.0),
        ("M49", "<_feed_override>", 0.0),
        ("M49", "<_speed_override>", 0.0),
        ("M49\nM51", "<_speed_override>", 1.0),
        ("M50 P0", "<_feed_override>", 0.0),
        ("M52", "<_adaptive_feed>", 1.0),
        ("M53 P0", "<_feed_hold>", 0.0),
        ("M70\nM53 P0\nM49\nM52\nM72", "<_feed_hold>", 1.0),
        ("M70\nM53 P0\nM49\nM52\nM72", "<_adaptive_feed>", 0.0),
        ("M7", "<_mist>", 1.0),
        ("M8\nM9", "<_flood>", 0.0),
        ("", "5399", 0.0),
        ("M66 P1", "5399", -1.0),
        ("M66 E1", "5399", -1.0),
    ] {
        assert_eq!(value(program, parameter), expected, "{program} {parameter}");
    }
}

#[test]
fn path_modes() {
    for (program, expected) in [
        ("G61", PathMode::ExactPath),
        ("G61.1", PathMode::ExactStop),
        ("G64", PathMode::Continuous),
        ("G64 P-1", PathMode::Continuous),
        ("G64 P0.1", PathMode::Tolerance { path: 1e-4, naive_cam: None }),
        ("G64 P0.1 Q-1", PathMode::Tolerance { path: 1e-4, naive_cam: None }),
        ("G61.1\nM70\nG64 P1\nM72", PathMode::ExactStop),
        ("G64 P0.1 Q0.2\nM70\nG61\nM72", PathMode::Tolerance { path: 1e-4, naive_cam: Some(2e-4) }),
    ] {
        let mut decoder = Decoder::new(program.as_bytes(), DecoderOptions::default());
        while decoder.next().is_some() {}
        assert_eq!(decoder.path_mode(), expected, "{program}");
    }
}

#[test]
fn errors_of_subroutines_leave_their_states() {
    // The state that M73 has saved belongs to the subroutine, and does not stay.
    let error = error("o1 sub\nM73\no1 endsub\no2 sub\nM72\no2 endsub\no1 call\no2 call\nM2");
    assert!(error.starts_with("M72 has nothing to restore"), "{error}");
}
