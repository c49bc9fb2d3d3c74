//! Tests of key figures, listing and shown blocks.

use super::*;
use crate::decode::Rule;
use crate::din66025::{Decoder, DecoderOptions, Item};
use nalgebra::Point3;
use std::f64::consts::PI;
use twin_path::Place;
use twin_path::{ElementKind, PathElement, Shape};

const PROGRAM: &str = "% sample
N10 G0 X100 Y0 F100
(nothing)
N20 G2 X200 Y0 R50
N30 G1 X200 Y-100 H1 O0.5 H-1 O0.75
N40 M3
N50 G92 X0 Y0 Z0
N60 G9 X0 Y0 I20 J0 K0 R0.5
N70 G6 X100 I50 J100
";

fn elements() -> Vec<PathElement> {
    let decoder = Decoder::new(PROGRAM.as_bytes(), DecoderOptions::default());
    let element = |item| match item {
        Ok(Item::Element(element)) => element,
        other => panic!("{other:?}"),
    };
    decoder.map(element).collect()
}

/// Lengths by closed forms and vector `cnc-parabola`; the ellipse's circumference, half axes 20 and 10, by its
/// elliptic integral: 96.884482205 mm.
#[test]
fn key_figures() {
    let mut info = ProgramInfo::default();
    for element in elements() {
        info.element(&element);
    }
    let expected = Counts {
        rapids: 1,
        lines: 1,
        arcs: 1,
        ellipses: 1,
        cubics: 1,
        jumps: 1,
        m_functions: 1,
        ..Counts::default()
    };
    assert_eq!(info.objects, expected);
    assert_eq!((info.objects.total(), info.blocks, info.switches), (7, 7, 2));
    assert!((info.rapid_length * 1e3 - 100.0).abs() < 1e-8);
    let cut_mm = 50.0 * PI + 100.0 + 96.884_482_205 + 147.894_285_754;
    assert!((info.cut_length * 1e3 - cut_mm).abs() < 1e-8, "{}", info.cut_length);
    assert!((info.length() * 1e3 - cut_mm - 100.0).abs() < 1e-8);
    let bounds = info.bounds.unwrap();
    assert!((bounds.min * 1e3 - Point3::new(0.0, -100.0, 0.0)).amax() < 1e-9, "{bounds:?}");
    assert!((bounds.max * 1e3 - Point3::new(200.0, 50.0, 0.0)).amax() < 1e-9, "{bounds:?}");
    assert_eq!(info.start, Some(Point3::origin()));
    assert_eq!(info.end, Some(Point3::new(0.1, 0.0, 0.0)));
}

#[test]
fn dwells_and_rules_are_counted() {
    let mut info = ProgramInfo::default();
    let at = Point3::origin();
    let dwell = ElementKind::Dwell { time_ns: 250_000_000 };
    let shape = Shape::Line { start: at, end: at };
    let place = |line| Place::at(line);
    info.element(&PathElement::new(place(1), dwell, shape.clone()));
    info.element(&PathElement::new(place(1), dwell, shape));
    assert_eq!((info.objects.dwells, info.dwell_ns, info.blocks), (2, 500_000_000, 1));
    assert_eq!(info.bounds, None);
    info.diagnostic(Rule::ArcGeometry, place(7));
    info.diagnostic(Rule::Syntax, place(8));
    info.diagnostic(Rule::ArcGeometry, place(9));
    let expected = [
        RuleCount { rule: Rule::ArcGeometry, count: 2, first: place(7) },
        RuleCount { rule: Rule::Syntax, count: 1, first: place(8) },
    ];
    assert_eq!(info.rules, expected);
}

/// Manual 6.2.2: no blank lines, no comments, variables substituted.
#[test]
fn blocks_are_shown_without_what_says_nothing() {
    let value = |name: &str| (name == "x").then_some(12.5);
    let shown = |line| shown_block(line, value);
    assert_eq!(shown("N10  G1\tX$x$ (go) Y$y$").as_deref(), Some("N10 G1 X12.5 Y$y$"));
    assert_eq!(shown("G1 X1 ; rest").as_deref(), Some("G1 X1"));
    assert_eq!(shown("G1 (open X1").as_deref(), Some("G1"));
    assert_eq!(shown("G1 X$ x$ X$open").as_deref(), Some("G1 X12.5 X$open"));
    for nothing in ["", "  \r\n", "(only a comment)", "; x"] {
        assert_eq!(shown(nothing), None, "{nothing:?}");
    }
}

/// Manual 7: number, line, type, start, end, dVel, dVelEnd.
#[test]
fn queue_rows() {
    let elements = elements();
    let rows: Vec<_> = (0..).zip(&elements).map(|(n, element)| QueueRow::new(n, element)).collect();
    let types: Vec<_> = rows.iter().map(|row| row.move_type.to_string()).collect();
    assert_eq!(types, ["LINPOS", "CLW", "LIN", "MCOMMAND", "INITPOS", "ELLCCLW", "SPLINE"]);
    let numbers: Vec<_> = rows.iter().map(|row| row.move_type.number()).collect();
    assert_eq!(numbers, [100, 2, 1, 120, 110, 9, 5].map(Some));
    let text = QueueRow { end_velocity: 0.0, ..rows[1] }.to_string();
    let columns: Vec<_> = text.split_whitespace().collect();
    let expected = "1 4 CLW 100.000 0.000 0.000 200.000 0.000 0.000 100.00 0.00";
    assert_eq!(columns.join(" "), expected);
}

#[test]
fn first_lines_of_a_program() {
    let lines = first_lines(PROGRAM.as_bytes(), SHOWN).unwrap();
    assert_eq!(lines.len(), 9);
    assert_eq!((lines[0].as_str(), lines[2].as_str()), ("% sample", "(nothing)"));
    assert_eq!(first_lines(PROGRAM.as_bytes(), 2).unwrap().len(), 2);
    let long = format!("{}\r\nend", "x".repeat(5000));
    let lines = first_lines(long.as_bytes(), SHOWN).unwrap();
    assert_eq!((lines[0].len(), lines[1].as_str(), lines.len()), (1024, "end", 2));
}
