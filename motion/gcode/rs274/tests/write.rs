//! Tests of programs written from paths: what a decoder, and LinuxCNC, make of them.

use super::corpus;
use super::moves::{Move, as_linuxcnc, as_move};
use super::oracle::{is_installed, linuxcnc};
use super::random::programs;
use super::*;
use crate::din66025;
use crate::rs274::{Control, ProgramWriter, WriteError, WriteOptions};
use nalgebra::Point3;
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use std::fs;
use twin_path::{
    Arc, Cubic, Details, ExtraAxes, Marks, Place, Plane, ProbeOutcome, Probing, Shape, Switch,
    Switches,
};

fn writer_options(control: impl Into<Option<Control>>) -> WriteOptions {
    WriteOptions { control: control.into(), ..WriteOptions::default() }
}

fn write_for(
    control: impl Into<Option<Control>>,
    elements: &[PathElement],
) -> Result<String, WriteError> {
    let mut writer = ProgramWriter::new(Vec::new(), writer_options(control))?;
    for element in elements {
        writer.write(element)?;
    }
    Ok(String::from_utf8(writer.finish()?).unwrap())
}

/// Decodes with speeds, which the writer needs.
fn with_speeds(program: &str) -> Vec<PathElement> {
    elements_with(DecoderOptions { keep_words: true, ..DecoderOptions::default() }, program)
}

/// The blocks of `program` as they are written for a control.
#[track_caller]
fn rewritten(control: impl Into<Option<Control>>, program: &str) -> String {
    let text = write_for(control, &with_speeds(program)).unwrap();
    let blocks = text.split_once("G54\n").unwrap().1;
    blocks.trim_end_matches("M2\n").trim_end_matches("M30\n%\n").to_owned()
}

/// First difference of two paths by more than a micrometre, 0.0001° or 0.0001 mm/min. Moves that go nowhere do not
/// matter.
fn difference(a: &[PathElement], b: &[PathElement]) -> Option<String> {
    let moving = |elements: &[PathElement]| -> Vec<PathElement> {
        let goes = |it: &&PathElement| match it.kind {
            ElementKind::Dwell { time_ns } => time_ns > 0,
            kind => !kind.is_motion() || it.length() > 1e-7,
        };
        elements.iter().filter(goes).cloned().collect()
    };
    let (a, b) = (moving(a), moving(b));
    let numbers = |it: &PathElement| {
        let places = [0.0, 0.25, 0.5, 0.75, 1.0].map(|part| {
            let point = it.at(part * it.shape.length()).position * 1e3;
            let extra = it.extra_at(part * it.length()).map(|extra| extra.position);
            let extra = extra.unwrap_or_default().map(|angle| 10.0 * angle);
            (point, extra)
        });
        let numbers = places
            .into_iter()
            .flat_map(|(point, extra)| point.iter().copied().chain(extra).collect::<Vec<f64>>());
        let feed = if it.kind == ElementKind::Rapid { 0.0 } else { it.feed * 6e5 };
        numbers.chain([feed]).collect::<Vec<f64>>()
    };
    if a.len() != b.len() {
        return Some(format!("{} and {} elements", a.len(), b.len()));
    }
    a.iter().zip(&b).find_map(|(a, b)| {
        let mut pairs = numbers(a).into_iter().zip(numbers(b));
        let differs = a.kind != b.kind
            || a.m_parameters() != b.m_parameters()
            || pairs.any(|(a, b)| (a - b).abs() > 1e-3 + 1e-9 * a.abs());
        differs.then(|| format!("{a:?}\n{b:?}"))
    })
}

/// Asserts that `program` comes back as the same path.
#[track_caller]
fn assert_round_trip(control: impl Into<Option<Control>>, program: &str) {
    let path = with_speeds(program);
    let text = write_for(control, &path).unwrap();
    assert_eq!(difference(&path, &with_speeds(&text)), None, "\n{text}");
}

const HEADER: &str = "(known work offsets and tool lengths are in the numbers)\n\
    G21 G17 G90 G94 G91.1\nG40 G49 G80 G54\n";

#[test]
fn a_program_for_grbl() {
    let path = with_speeds(
        "G20 G90\nF10 M3 S1000\nM8\nG0 X1 Y2\nG1 Z-.1\nG3 X2 Y3 I0 J1\nG18 G2 X2 Z-.1 I.5 K0 P2\n\
         G17 G81 X0 Y0 Z-1 R.5\nG80 G4 P.25\nM30",
    );
    // Two full circles in place of P2; then the drilling cycle.
    let expected = "M3 S1000\nM8\nG0 X25.4 Y50.8\nG1 Z-2.54 F254\nG3 X50.8 Y76.2 I0 J25.4\n\
        G18 G2 X50.8 Z-2.54 I12.7 K0\nX50.8 Z-2.54 I12.7 K0\n";
    let text = write_for(Control::Grbl, &path).unwrap();
    let cycle = "G0 Z12.7\nX0 Y0\nG1 Z-25.4\nG0 Z12.7\nG4 P0.25\nM5\nM9\nM2\n";
    assert_eq!(text, format!("{HEADER}{expected}{cycle}"));
}

#[test]
fn a_program_for_fanuc() {
    let path = with_speeds(
        "T2 M6\nM3 S1234.5\nG0 X10 Y0 Z5 A30\nG1 Z-1.2345 F100\nG3 X10 Y0 I-10 J0 P2\n\
         G4 P.5\nG1 X20 S900\nM2",
    );
    let expected = "%\nO0001\n(KNOWN WORK OFFSETS AND TOOL LENGTHS ARE IN THE NUMBERS)\n\
        G21\nG17 G90 G94 G40 G49 G80 G54\nM6 T2\nM3 S1235\nG0 X10. Y0. Z5. A30.\n\
        G1 Z-1.235 F100.\nG3 X10. Y0. I-10. J0.\nX10. Y0. I-10. J0.\nG4 P500\nG1 X20. S900\n\
        M5\nM30\n%\n";
    // 1.2345 is 1.2344999… in binary.
    let expected = expected.replace("1.235", "1.234");
    assert_eq!(write_for(Control::Fanuc, &path).unwrap(), expected);
}

/// F is that of the circle of a helix for Fanuc, and counts degrees as mm for grblHAL, FluidNC and Fanuc.
#[test]
fn feeds_of_the_controls() {
    // A full circle of 6π mm that rises by 8π mm: 10π mm of path.
    let helix = format!("F100 G3 X0 Y0 Z{} I3", 8.0 * PI);
    assert!(rewritten(Control::Fanuc, &helix).ends_with("F60.\n"));
    assert!(rewritten(Control::Grbl, &helix).ends_with("F100\n"));
    // 30 mm and 40°: 50 of both, in the time of 30 mm.
    let both = "G1 X30 A40 F60";
    for control in [Control::GrblHal, Control::FluidNc] {
        assert_eq!(rewritten(control, both), "G1 X30 A40 F100\n");
    }
    assert_eq!(rewritten(Control::LinuxCnc, both), "G1 X30 A40 F60\n");
    assert_eq!(rewritten(Control::LinuxCnc, "G1 A40 F60"), "G1 A40 F60\n");
    assert_eq!(rewritten(Control::GrblHal, "G1 A40 F60"), "G1 A40 F60\n");
}

/// The speed S of a laser without M3 in its block.
#[test]
fn speeds_in_moves() {
    let program = "M4 S0\nG1 X10 F600 S500\nX20\nG4 P1\nX30 S0\nG0 X0 S7\nM5\n";
    let expected = "M4 S0\nG1 X10 F600 S500\nX20\nG4 P1\nX30 S0\nG0 X0 S7\nM5\n";
    assert_eq!(rewritten(Control::Grbl, program), expected);
    // A compensated move comes with the block behind it, and keeps its speed.
    let program = "M4 S0\nF600 G41.1 D2 G1 X10 Y1 S1\nX20 S2\nY20 S3\nG40 X0 S4\n";
    let speeds = with_speeds(program).into_iter().filter(|it| it.kind == ElementKind::Cut);
    let speeds: Vec<_> = speeds.map(|it| it.details.unwrap().spindle.unwrap().speed).collect();
    // The second move begins with an arc around its corner.
    assert_eq!(speeds, [1.0, 2.0, 2.0, 3.0, 4.0]);
    // Without the option elements have no details, which would slow planning down.
    assert!(elements("M3 S5\nG1 X1 F1").iter().skip(1).all(|element| element.details.is_none()));
}

#[test]
fn m_functions() {
    let program = "M0\nM1\nT3 M6\nM61 Q2\nM7\nM9\nM19 R90 P1\nM60\nM62 P1\nM65 P0\nM66 P2 L3 Q5\nM66 E1 L0\n\
        M67 E0 Q1.25\nM68 E1 Q-2\nM101 P1.5 Q2\n";
    let expected = program.replace("T3 M6", "M6 T3").replace("M66 E1 L0", "M66 E1 L0 Q0");
    assert_eq!(rewritten(None, program), expected);
    assert_round_trip(None, program);
    for (control, program, message) in [
        (Control::Grbl, "M7", "line 1: a program for grbl cannot contain M7"),
        (Control::GrblHal, "M19", "line 1: a program for grblHAL cannot contain M19"),
        (Control::FluidNc, "M60", "line 1: a program for FluidNC cannot contain M60"),
        (Control::FluidNc, "M66 P0 L3 Q1", "line 1: a program for FluidNC cannot contain M66"),
        (Control::Fanuc, "M62 P1", "line 1: a program for Fanuc cannot contain M62"),
        (Control::Fanuc, "M101", "line 1: a program for Fanuc cannot contain M101"),
        (Control::Fanuc, "M19 R5", "line 1: M19 of RS274 cannot take the parameter K of the path"),
        (Control::Mach3, "M68 E0 Q1", "line 1: a program for Mach3 cannot contain M68"),
        (Control::Mach3, "F1 G38.2 X1", "line 1: a program for Mach3 cannot contain G38.2"),
        (Control::Grbl, "G0 X1 B2", "line 1: a program for grbl cannot contain B"),
        (Control::LinuxCnc, "M47", "line 1: a program for LinuxCNC cannot contain M47"),
        (
            Control::Mach3,
            "G0 X1 U2",
            "line 1: a program for Mach3 cannot contain U (another name of A)",
        ),
        (Control::Grbl, "G0 W2", "line 1: a program for grbl cannot contain W"),
        (Control::Mach3, "M3 S9\nG33 Z1 K1", "line 2: a program for Mach3 cannot contain G33"),
        (
            Control::Fanuc,
            "M3 S9\nG33 Z1 K1",
            "line 2: a program for Fanuc cannot contain G33 (the pitch is F, not K)",
        ),
    ] {
        let error = write_for(control, &with_speeds(program)).unwrap_err().to_string();
        assert!(error.starts_with(message), "{error}");
    }
    assert_eq!(rewritten(Control::Fanuc, "M19"), "M19\n");
}

/// Moves behind a probing move would go on from elsewhere on the machine.
#[test]
fn probing_moves() {
    assert_eq!(
        rewritten(Control::Grbl, "G38.3 Z-5 F100\nM5\nG4 P1"),
        "G38.3 Z-5 F100\nM5\nG4 P1\n"
    );
    let behind = write_for(None, &with_speeds("G38.2 Z-5 F100\nG91 G0 Z1")).unwrap_err();
    let expected = "line 2: the position depends on where G38.2 ends on the machine";
    assert_eq!(behind.to_string(), expected);
}

/// A pass of G76 is G33, with the pitches of LinuxCNC's own calls (`START_SPEED_FEED_SYNC` of `rs274 -g`).
#[test]
fn threads() {
    let program = "M3 S100\nG0 X20 Z5\nG33 Z-5 K1.5\nG0 X25\nG76 P1 Z-10 I-1 J.2 K.4 E1 L2";
    let pass = |out: &str, deep: &str, taper: &str, back: &str| {
        format!("X{out}\nX{deep}\nG33 Z-9 K1\nX{taper} Z-10 K1.077033\nG0 X{back}\nX25 Z-5\n")
    };
    let second = "X23.6\nG33 Z-9 K1\nX24 Z-10 K1.077033\nG0 X25\n";
    let expected = format!(
        "M3 S100\nG0 X20 Z5\nG33 Z-5 K1.5\nG0 X25\n{}{second}",
        pass("25.2", "23.8", "24.2", "25.2")
    );
    assert_eq!(rewritten(None, program), format!("{expected}M5\n"));
    // With another speed at the start of a face LinuxCNC's pitch is the same.
    let face = "G96 S100 D3000 M3\nG0 X20 Z5\nG33 X10 K1.5";
    assert!(rewritten(None, face).contains("G33 X10 K1.5"), "{}", rewritten(None, face));
    if is_installed() {
        let text = write_for(None, &with_speeds(program)).unwrap();
        let texts = [format!("{program}\nM2\n"), text];
        let [original, written] = linuxcnc(&texts, &[]).try_into().expect("two");
        let ends = |moves: &[Move]| -> Vec<_> {
            let mut ends: Vec<_> =
                moves.iter().map(|it| (it.kind.clone(), it.points.clone())).collect();
            ends.dedup_by_key(|(_, points)| points.clone());
            ends
        };
        assert_eq!((original.stopped, written.stopped), (None, None));
        assert_eq!(ends(&original.moves), ends(&written.moves));
    }
    let error = write_for(None, &with_speeds("M3 S100\nG33.1 Z-5 K1")).unwrap_err();
    assert!(error.to_string().contains("rigid tapping (G33.1)"), "{error}");
    // LinuxCNC's tapping cycles have a floating chuck.
    assert_round_trip(None, "M3 S100 F80\nG84 X1 Z-5 R1");
}

/// U, V and W, which LinuxCNC has.
#[test]
fn parallel_axes() {
    for program in [
        "G0 X1 U2 V3\nG1 W5 F100\nX5 Y1 U3 A30\nG53 G0 V0",
        // F is that of U, V and W where X, Y and Z stay.
        "G1 U30 A40 F60\nV40\nG17.1 G81 U1 V2 W-3 R1",
        "G20 F10 G1 U1 V2\nB5\nM2",
    ] {
        assert_round_trip(None, program);
    }
    assert_eq!(rewritten(Control::GrblHal, "G0 X1 U2"), "G0 X1 U2\n");
}

fn cut(shape: Shape) -> PathElement {
    let place = Place::at(7);
    PathElement { feed: 0.1, ..PathElement::new(place, ElementKind::Cut, shape) }
}

fn line_to(x: f64) -> Shape {
    Shape::Line { start: Point3::origin(), end: Point3::new(x, 0.0, 0.0) }
}

/// Everything that words cannot express.
#[test]
fn errors() {
    let softmotion = write_for(Control::SoftMotion, &[]).unwrap_err();
    assert!(softmotion.to_string().contains("--format din66025"), "{softmotion}");
    let line = cut(line_to(1e-3));
    let mut switches = Switches::default();
    assert!(switches.add(Switch { number: 1, on: true, at: 0.5 }));
    let detailed = |details| PathElement { details: Some(Box::new(details)), ..line.clone() };
    let probe = ElementKind::Probe { probing: Probing::TOUCH, outcome: ProbeOutcome::Tripped };
    let jump = PathElement { kind: ElementKind::Jump, ..cut(line_to(2e-3)) };
    let half = |kind| {
        let end = Point3::new(2e-3, 0.0, 0.0);
        let arc = Arc::new(Point3::origin(), end, Point3::new(1e-3, 0.0, 0.0), PI);
        PathElement { kind, ..cut(Shape::Arc(arc)) }
    };
    for (path, message) in [
        (vec![detailed(Details { switches, ..Details::default() })], "switches on the way (H)"),
        (vec![PathElement { marks: Marks::LOOPS, ..line.clone() }], "use --prepare"),
        (vec![PathElement { kind: probe, ..line.clone() }], "without its programmed end"),
        (vec![line.clone(), jump], "a jump of the position"),
        (vec![line.clone(), line.clone()], "a gap of 1 mm"),
        (vec![half(ElementKind::Rapid)], "a rapid along a curve"),
        (vec![PathElement { feed: 0.0, ..line.clone() }], "F cannot be 0"),
        (vec![PathElement { feed: f64::INFINITY, ..line }], "F cannot be inf"),
        (vec![cut(line_to(1e7))], "X cannot be 10000000000"),
        (vec![cut(line_to(f64::NAN))], "X cannot be NaN"),
    ] {
        let error = write_for(None, &path).unwrap_err().to_string();
        assert!(error.starts_with("line 7: ") && error.contains(message), "{error}");
    }
}

/// Arcs that a control could take for full circles, or full circles for nothing.
#[test]
fn arcs_near_full_circles() {
    let around = |radius: f64, sweep: f64| {
        let at = |angle: f64| Point3::new(radius * angle.cos(), radius * angle.sin(), 0.0);
        cut(Shape::Arc(Arc::new(at(0.3), at(0.3 + sweep), Point3::origin(), sweep)))
    };
    for control in [Control::Grbl, Control::Fanuc, Control::LinuxCnc] {
        for radius in [1e-5, 1e-3, 0.05, 2.0, 900.0] {
            for small in [0.0, 1e-12, 1e-9, 1e-8, 3e-7, 1e-6, 2e-5, 1e-3, 0.7] {
                for turns in [0.0, 1.0, 2.0, 5.0] {
                    for sweep in [TAU * turns + small, TAU * turns - small] {
                        let arc = around(radius, sweep);
                        let text = write_for(control, std::slice::from_ref(&arc)).unwrap();
                        let start = at(arc.start().coords.into());
                        let options = DecoderOptions { start, ..DecoderOptions::default() };
                        let decoded = decode_with(options, text.as_bytes());
                        assert_eq!(decoded.errors, [], "{text}");
                        let length: f64 = decoded.elements.iter().map(PathElement::length).sum();
                        let angle = (length - arc.length()).abs() / radius;
                        // The rounding of start, end and centre.
                        let limit = 3e-6 + 1e-6 * (1.0 + turns) * TAU;
                        assert!(angle * radius < limit, "{radius} {sweep}: {angle}\n{text}");
                    }
                }
            }
        }
    }
}

/// Splines and arcs with different radii are lines within the tolerance.
#[test]
fn curves_are_lines_within_the_tolerance() {
    let at = |x: f64, y: f64| Point3::new(x, y, 0.0) / 1e3;
    let spline = Cubic::new([0.0, 0.1, -0.03, -0.02], [0.0, -0.08, 0.3, -0.21], 0.0, 0.01);
    let uneven = Arc::new(at(10.0, 0.0), at(-10.2, 0.0), at(0.0, 0.0), PI);
    for shape in [Shape::Cubic(Box::new(spline)), Shape::Arc(uneven)] {
        let mut curve = cut(shape);
        let start = curve.start();
        curve.feed = 0.02;
        let lead = cut(Shape::Line { start: Point3::origin(), end: start });
        let text = write_for(Control::Grbl, &[lead, curve.clone()]).unwrap();
        let lines: Vec<_> = elements(&text).split_off(usize::from(start != Point3::origin()));
        assert!((8..400).contains(&lines.len()), "{}", lines.len());
        let (mut s, length) = (0.0, curve.length());
        for line in &lines {
            assert!((line.feed - 0.02).abs() < 1e-9);
            // The curve along the line, by length.
            let to = (0..=2000).map(|step| s + f64::from(step) * 1e-5).take_while(|s| *s <= length);
            let near = |s: &f64| (curve.at(*s).position - line.end()).norm();
            let end = to.min_by(|a, b| near(a).total_cmp(&near(b))).unwrap();
            for part in [0.25, 0.5, 0.75] {
                let point = curve.at(s + (end - s) * part).position - line.start();
                let along = (line.end() - line.start()).normalize();
                assert!((point - along * point.dot(&along)).norm() < 1.2e-5);
            }
            s = end;
        }
        assert!((lines.last().unwrap().end() - curve.end()).norm() < 1e-6);
    }
}

#[test]
fn round_trips() {
    let everything = "G20 F30 G0 X1 Y1 Z.5\nM3 S2000\nG1 Z-.125\nG2 X2 Y2 R1.1\nG3 X1.5 Y1.5 I-.25 J-.25\n\
        G18 G3 X2.5 Z-.125 I.5 K0 Y2\nG19 G2 Y3 Z.875 J0 K1 X1\nG17 G3 X0 Y0 I-.5 J-1.5 P3 Z2\n\
        G93 G1 X1 F2\nG94 F12.3456 X3\nG21 G91 G81 X1.23456 Y2 Z-3 R1 L3\nG90 G83 X7 Z-5 R1 Q.7\n\
        G80 G0 X0 Y0\nG93 G1 X1 A90 F30\nG94 F100 A0 B1.23456\nG4 P.001\nM5";
    for control in [None, Some(Control::LinuxCnc)] {
        assert_round_trip(control, everything);
    }
    let path = with_speeds(everything);
    for control in [Control::GrblHal, Control::FluidNc, Control::Mach3] {
        let text = write_for(control, &path).unwrap();
        assert_eq!(decode(&text).errors, [], "{text}");
    }
}

/// The elements of a program of DIN 66025.
fn of_din_66025(program: &str) -> Vec<PathElement> {
    let items = din66025::Decoder::with_jumps(
        std::io::Cursor::new(program),
        din66025::DecoderOptions::default(),
    );
    items
        .map(|item| match item.unwrap() {
            din66025::Item::Element(element) => element,
            din66025::Item::Warning(warning) => panic!("{warning}"),
        })
        .collect()
}

/// A path of another dialect goes to no place that its blocks do not lead to: Z0 could be in the work.
#[test]
fn din_66025_is_written_too() {
    for (program, expected) in [
        (
            "N10 G92 X5 Y5\nN20 G0 X10 Y10 F100 E1000 E-1000\nN30 G1 X20 F20\nN40 G2 X40 Y10 I10 J0\nN50 M3 K90\n",
            "(begins at X5 Y5 Z0)\nG0 X10 Y10\nG1 X20 F1200\nG2 X40 Y10 I10 J0\nM3 S90\n",
        ),
        // A rapid has all of X and Y, and Z comes before the first cut.
        (
            "N10 G92 X5 Y6 Z7\nN20 G0 X10 F100 E1000 E-1000\nN30 G1 X20 F20\nN40 Z1\n",
            "(begins at X5 Y6 Z7)\nG0 X10 Y6\nZ7\nG1 X20 F1200\nZ1\n",
        ),
        // A cut begins where the path does, from above; zero is where the machine is.
        (
            "N10 G92 X5 Y6 Z7\nN20 G1 X10 F20 E1000 E-1000\n",
            "(begins at X5 Y6 Z7)\nG0 X5 Y6\nZ7\nG1 X10 F1200\n",
        ),
        ("N20 G1 X10 Z-1 F20 E1000 E-1000\n", "(begins at X0 Y0 Z0)\nG1 X10 Z-1 F1200\n"),
        (
            "N10 G0 Z5 F100 E1000 E-1000\nN20 X10\nN30 G1 Z-1 F20\n",
            "(begins at X0 Y0 Z0)\nG0 Z5\nX10\nG1 Z-1 F1200\n",
        ),
    ] {
        let text = write_for(Control::Grbl, &of_din_66025(&format!("% x\n{program}"))).unwrap();
        assert_eq!(text, format!("{HEADER}{expected}M2\n"));
    }
}

proptest! {
    /// Programs that are written are read as the same path.
    #[test]
    fn random_paths_come_back(lines in programs()) {
        let options = DecoderOptions { keep_words: true, ..DecoderOptions::default() };
        let decoded = decode_with(options, lines.join("\n").as_bytes());
        let path = &decoded.elements[..decoded.sound];
        for control in [Control::LinuxCnc, Control::Grbl, Control::Fanuc] {
            let mut writer = ProgramWriter::new(Vec::new(), writer_options(control)).unwrap();
            // What cannot be written ends the path.
            let count = path.iter().take_while(|element| writer.write(element).is_ok()).count();
            let text = String::from_utf8(writer.finish().unwrap()).unwrap();
            let back = decode(&text);
            prop_assert_eq!(&back.errors, &[], "\n{}", text);
            let straight = |it: &PathElement| !matches!(it.shape, Shape::Cubic(_));
            let path = &path[..count];
            let is_whole = decoded.errors.is_empty() && count == decoded.elements.len();
            if is_whole && control == Control::LinuxCnc && path.iter().all(straight) {
                prop_assert_eq!(difference(path, &back.elements), None, "\n{}", text);
            }
            if let (Some(end), Some(back)) = (path.last(), back.elements.last()) {
                prop_assert!((end.end() - back.end()).norm() < 1.5e-6, "\n{}", text);
            }
        }
    }
}

/// LinuxCNC makes the moves of the original of every program that is written.
#[test]
fn the_corpus_as_linuxcnc_reads_it() {
    let Some(corpus) = corpus::corpus() else { return };
    if !is_installed() {
        return;
    }
    let (mut names, mut texts, mut expected, mut refused) = (vec![], vec![], vec![], vec![]);
    for (name, ..) in corpus::programs("within") {
        let options = DecoderOptions { keep_words: true, ..as_linuxcnc() };
        let mut decoded = decode_with(options, &fs::read(corpus.join(name)).unwrap());
        // LinuxCNC is run with four tools.
        decoded.elements.retain(|it| it.kind != ElementKind::MFunction { number: 6 });
        match write_for(Control::LinuxCnc, &decoded.elements) {
            Ok(text) => {
                names.push(name);
                texts.push(text);
                expected.push(decoded.elements);
            }
            Err(error) => refused.push(format!("{name}: {error}")),
        }
    }
    println!("{} programs are not written: {refused:#?}", refused.len());
    let mut count = 0;
    for ((name, path), verdict) in names.iter().zip(&expected).zip(linuxcnc(&texts, &[])) {
        assert_eq!(verdict.stopped, None, "{name}");
        count += assert_same(name, path, &verdict.moves);
    }
    assert!(count > 100_000 && names.len() > 10 * refused.len(), "{count}");
}

/// Asserts that `moves` are those of `path`, but for lines in place of uneven arcs; their number.
fn assert_same(name: &str, path: &[PathElement], moves: &[Move]) -> usize {
    // Positions that are named again move nothing; the path has no fewer of them.
    let mut at = (vec![0.0; 3], [0.0; 5]);
    let moving: Vec<_> = moves
        .iter()
        .filter(|one| {
            let to = (one.points.clone(), one.extra);
            let stays = at == to && matches!(one.kind.as_str(), "rapid" | "feed");
            if one.seconds.is_none() {
                at = to;
            }
            !stays
        })
        .collect();
    let empty = moves.len() - moving.len();
    let (mut moves, mut count, mut left_out) = (moving.into_iter(), 0, 0);
    for element in path {
        // Moves between points with the same four decimals are left out.
        let rounded = |point: Point3<f64>| point.map(|metres| (metres * 1e7).round());
        let extra = element.extra().map_or(0.0, ExtraAxes::length);
        let stays = rounded(element.start()) == rounded(element.end()) && extra < 5e-5;
        let goes = !stays || element.length() > 1e-6 || !element.kind.is_motion();
        left_out += usize::from(!goes);
        let Some(expected) = as_move(element).filter(|_| goes) else { continue };
        let is_last =
            |one: &Move| one.points.iter().zip(&expected.points).all(|(a, b)| (a - b).abs() < 1e-4);
        let mut one = moves.next().unwrap_or_else(|| panic!("{name}: {element:?}"));
        // LinuxCNC takes larger differences in programs in inches.
        let has_lines = matches!(
            &element.shape,
            Shape::Arc(arc) if (arc.radius() - arc.end_radius()).abs() > 2.8e-5
        );
        while has_lines && !is_last(one) {
            one = moves.next().unwrap();
        }
        let is_curve = !matches!(element.shape, Shape::Line { .. });
        let is_short = is_curve && one.kind == "feed";
        let same = Move { line: one.line, kind: one.kind.clone(), ..expected.clone() };
        // LinuxCNC's script has the F before a thread; the spindle makes its feed.
        let spindle = element.details.as_ref().and_then(|details| details.spindle);
        let is_thread = spindle.is_some_and(|spindle| spindle.synchronized);
        let same = is_last(one)
            && (is_short || one.kind == expected.kind)
            && one.seconds == same.seconds
            && one.extra.iter().zip(same.extra).all(|(a, b)| (a - b).abs() < 1e-4)
            && (is_thread
                || one.feed.zip(same.feed).is_none_or(|(a, b)| (a - b).abs() < 2e-4 + 1e-9 * a));
        assert!(same, "{name}: {one:?}, {expected:?}");
        count += 1;
    }
    assert_eq!(moves.next(), None, "{name}");
    assert!(empty <= left_out, "{name}: {empty} moves that go nowhere, {left_out} in the path");
    count
}

#[test]
fn planes() {
    for plane in [Plane::Xy, Plane::Zx, Plane::Yz] {
        let at = |first: f64, second: f64, height: f64| {
            Point3::from(plane.join([first, second, height].map(|mm| mm / 1e3)))
        };
        let arc =
            Arc::in_plane(plane, at(0.0, 0.0, 0.0), at(4.0, 0.0, 1.0), at(2.0, 0.0, 0.0), -PI);
        let path = [cut(Shape::Arc(arc))];
        for control in [Control::Grbl, Control::Fanuc, Control::Mach3, Control::FluidNc] {
            let text = write_for(control, &path).unwrap();
            let read = elements(&text);
            let same = Shape::Arc(match &read[0].shape {
                Shape::Arc(arc) => arc.clone(),
                shape => panic!("{shape:?}"),
            });
            for s in [0.0, 1e-3, 3e-3] {
                assert!((same.at(s).position - path[0].at(s).position).norm() < 1e-9, "{text}");
            }
        }
    }
}

/// A control refuses nothing of what is written for it.
#[test]
fn nothing_is_refused_of_the_corpus() {
    let Some(corpus) = corpus::corpus() else { return };
    let mut counts = [0; Control::ALL.len()];
    for (name, ..) in corpus::programs("within") {
        let program = fs::read(corpus.join(name)).unwrap();
        let options = DecoderOptions { keep_words: true, ..DecoderOptions::default() };
        let path = decode_with(options, &program).elements;
        for (control, count) in Control::ALL.into_iter().zip(&mut counts) {
            let Ok(text) = write_for(control, &path) else { continue };
            let options = DecoderOptions { control: Some(control), ..DecoderOptions::default() };
            let decoded = decode_with(options, text.as_bytes());
            // Axes that an option of the firmware adds.
            let refused = decoded.errors.iter().find(|one| {
                let text = one.to_string();
                !(control == Control::GrblHal && text.contains("N_AXIS"))
            });
            assert!(refused.is_none(), "{name} for {control}: {refused:?}");
            *count += 1;
        }
    }
    // LinuxCNC, grbl, grblHAL, FluidNC, Fanuc, Mach3, SoftMotion.
    assert!(counts.iter().take(6).all(|count| *count > 25), "{counts:?}");
    assert_eq!(counts[6], 0);
}

/// M0 replaces M6 on controls without it.
#[test]
fn tools_are_changed_by_hand() {
    assert_eq!(rewritten(Control::Grbl, "T2 M6\nG0 X1\nM2"), "M0 (tool 2)\nG0 X1\n");
    // Its number alone is nobody's work.
    assert_eq!(rewritten(Control::Grbl, "M61 Q2\nG0 X1\nM2"), "G0 X1\n");
}

/// An axis is named when its position is not known, though the path does not move it.
#[test]
fn positions_that_blocks_name_are_written() {
    for (program, expected) in [
        ("G0 Z20\nG0 X0 Y0\nG0 Z2\nG1 Z-1 F100\nX0\nM2", "G0 Z20\nX0 Y0\nZ2\nG1 Z-1 F100\n"),
        ("G81 X0 Y0 Z-1 R1 F60\nM2", "G0 Z1\nX0 Y0\nG1 Z-1 F60\nG0 Z1\n"),
    ] {
        assert_eq!(rewritten(Control::Grbl, program), expected, "{program}");
    }
}

/// Positions by G91 are relative to one that the program has to set first.
#[test]
fn moves_from_unknown_positions_are_refused() {
    for program in ["G91 G0 Z5\nM2", "G53 G0 Z0\nG91 G0 Z5\nM2", "G28\nG91 G1 F60 X1\nM2"] {
        let error = write_for(Control::Grbl, &with_speeds(program)).unwrap_err().to_string();
        assert!(error.contains("a move by G91 from a position that no block has named"), "{error}");
    }
    // Other paths of DIN 66025 have M functions that end a program of RS274.
    let error = write_for(
        Control::Grbl,
        &[PathElement { kind: ElementKind::MFunction { number: 30 }, ..cut(line_to(0.0)) }],
    );
    assert!(error.unwrap_err().to_string().contains("cannot contain M30"));
}

/// Positions of the machine are G53: nobody knows where they are in the coordinates of the work.
#[test]
fn positions_of_the_machine() {
    for (program, expected) in [
        ("G0 X1 Y2 Z3\nG28 G91 Z0\nG90 G0 X5\nZ0\nM2", "G0 X1 Y2 Z3\nG53 G0 Z0\nX5\nZ0\n"),
        ("G53 G0 Z0\nG0 X0 Y0\nG28\nX0\nM2", "G53 G0 Z0\nX0 Y0\nG53 G0 X0 Y0 Z0\nX0\n"),
    ] {
        assert_eq!(rewritten(Control::Grbl, program), expected, "{program}");
    }
    let error = write_for(None, &with_speeds("F60 G28\nG2 X2 I1\nM2")).unwrap_err().to_string();
    assert!(error.contains("an arc from a position in the machine frame"), "{error}");
}
