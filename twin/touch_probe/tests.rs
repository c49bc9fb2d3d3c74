//! Tests of probing moves against closed forms: above a plane, and among the obstacles of a machine file.

use crate::check::{CheckOptions, Outcome, check};
use crate::finding::{Finding, Rule, Severity};
use crate::limit::Limits;
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ElementItem, ProgramFile};
use twin_gcode::rs274::{Position, ProbePath, ProbeTarget, Surroundings};
use twin_machine::Machine;
use twin_machine::probe_trip::{Clearance, RELEASE, TOUCH, TripSearch};
use twin_path::{ElementKind, PathElement, Place, ProbeOutcome, ProbeTrip, Probing};

/// Start at 0, 0, 20; Z from -60 to 120 mm.
const GANTRY3: &str = include_str!("../../tests/data/machines/gantry3.toml");

/// Jaws with their tops at Z−10, the fixed one from Y−20 to Y0, stock from Z−30 to Z0, 100 × 60 mm; a tool of 6 mm.
const VICE: &str = include_str!("../../machines/gantry3_vice.toml");

/// A machine file next to a tool table with one tool of 25 mm.
fn load(text: &str) -> Machine {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("tools.tbl"), "T1 P1 Z25 D6\n").unwrap();
    Machine::parse(&folder.path().join("machine.toml"), text)
        .unwrap_or_else(|problems| panic!("{problems:#?}"))
}

fn with_program<T>(text: &str, use_it: impl FnOnce(&ProgramFile) -> T) -> T {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.ngc");
    std::fs::write(&path, text).unwrap();
    use_it(&ProgramFile::new(&path, Some(Dialect::Rs274), ReadSettings::default()).unwrap())
}

fn checked(machine: &Machine, program: &str, physics: bool) -> Outcome {
    let options = CheckOptions { limits: Limits::Programmed, physics, ..CheckOptions::default() };
    with_program(program, |program| check(machine, program, options, &mut |_| {}).unwrap())
}

/// Everything below a plane: through `point` (m), with the unit vector `normal` out of it.
#[derive(Clone, Debug)]
struct Plane {
    point: [f64; 3],
    normal: [f64; 3],
}

impl Clearance for Plane {
    fn at(&mut self, at: &Position, _: &ProbePath) -> Option<f64> {
        let [x, y, z] =
            std::array::from_fn(|axis| (at.linear[axis] - self.point[axis]) * self.normal[axis]);
        Some(x + y + z)
    }
}

fn floor(z_mm: f64) -> Plane {
    Plane { point: [0.0, 0.0, z_mm * 1e-3], normal: [0.0, 0.0, 1.0] }
}

fn above(plane: Plane) -> Machine {
    let mut machine = load(GANTRY3);
    machine.conditions.rs274.surroundings =
        Some(Surroundings::new(move |_| TripSearch::new(plane.clone())));
    machine
}

fn elements(plane: Plane, text: &str) -> Vec<PathElement> {
    with_program(text, |program| {
        let items = program.prepared(&above(plane).conditions).unwrap();
        let element = |item| match item {
            ElementItem::Element(element) => Some(element),
            ElementItem::Diagnostic(_) => None,
            ElementItem::Io(error) => panic!("{error}"),
        };
        items.filter_map(element).collect()
    })
}

fn said(findings: &[Finding]) -> Vec<(Severity, u32, &str)> {
    assert!(findings.iter().all(|finding| finding.rule == Rule::Probe), "{findings:#?}");
    findings.iter().map(|found| (found.severity, found.line, found.message.as_str())).collect()
}

const TOUCH_OFF: &str = "G0 X10 Y20 Z30\nF600 G38.2 Z0\nG91 G0 Z2\nG38.5 Z-9 F60\nG38.3 Z-4\n\
                         G38.4 Z5\nM2\n";

#[test]
fn where_probes_trip_is_noted() {
    let outcome = checked(&above(floor(12.345)), TOUCH_OFF, false);
    assert_eq!(
        said(&outcome.findings),
        [
            (Severity::Note, 2, "probe touches at X 10.000 Y 20.000 Z 12.345 mm"),
            // It is free from the beginning, and does not move.
            (Severity::Note, 4, "probe comes free at X 10.000 Y 20.000 Z 14.345 mm"),
            (Severity::Note, 5, "probe touches at X 10.000 Y 20.000 Z 12.345 mm"),
            // A micrometre above.
            (Severity::Note, 6, "probe comes free at X 10.000 Y 20.000 Z 12.346 mm"),
        ]
    );
}

/// What is checked is what is shown: the path goes on from the trip point, and stops there.
#[test]
fn the_path_ends_where_the_probe_trips() {
    let mut path = elements(floor(12.345), TOUCH_OFF);
    // Behind each of them the path waits for the drives of the machine file.
    let waits = path.iter().filter(|element| matches!(element.kind, ElementKind::Dwell { .. }));
    assert_eq!(waits.count(), 4);
    path.retain(|element| element.kind.is_motion());
    let heights: Vec<f64> = path.iter().map(|element| element.end().z * 1e3).collect();
    for (found, expected) in heights.iter().zip([30.0, 12.345, 14.345, 14.345, 12.345, 12.346]) {
        assert!((found - expected).abs() < 2e-5, "{heights:?}");
    }
    let kind = ElementKind::Probe { probing: Probing::TOUCH, outcome: ProbeOutcome::Tripped };
    assert_eq!(path[1].kind, kind);
    assert!(path.iter().all(|element| element.end_velocity <= 0.0), "{path:#?}");
}

#[test]
fn what_does_not_trip_is_an_error() {
    let outcome = checked(&above(floor(-5.0)), "F600 G38.3 Z10\nG38.2 Z5\nG38.4 X5\nM2\n", false);
    assert_eq!(
        said(&outcome.findings),
        [
            (Severity::Error, 2, "G38.2 reaches its end without touching anything"),
            (Severity::Error, 3, "G38.4 begins where nothing is touched"),
        ]
    );
}

#[test]
fn unknown_surroundings_are_a_warning() {
    let outcome = checked(&load(GANTRY3), "F600 G38.2 Z10\nM2\n", false);
    let message = "G38.2 is assumed to reach its end: nothing is described that it could touch";
    assert_eq!(said(&outcome.findings), [(Severity::Warning, 1, message)]);
    assert_eq!(serde_json::to_value(Rule::Probe).unwrap(), Rule::Probe.name());
}

fn path(from: [f64; 3], to: [f64; 3], trips: ProbeTrip) -> ProbePath {
    let at = |linear| Position { linear, ..Position::default() };
    ProbePath {
        place: Place::at(1),
        start: at(from),
        end: at(to),
        point_from_tip: [0.0; 3],
        tool: 0,
        feed: 0.01,
        trips,
    }
}

/// A line meets a plane where (p − p₀)·n is zero, to within the nanometre of the search and the ten of touching, divided
/// by the sine of the angle between them.
#[test]
fn lines_meet_planes() {
    let normal = [0.6, 0.0, 0.8];
    let plane = Plane { point: [0.1, 0.0, 0.02], normal };
    for (from, to) in [
        ([0.3, 0.1, 0.2], [-0.3, 0.2, -0.2]),
        ([0.3, 0.1, 0.2], [0.29, 0.1, -0.9]),
        // Nearly along it.
        ([0.1, 0.0, 0.0201], [0.1 + 0.8, 0.5, 0.02 - 0.6 - 0.0001]),
    ] {
        let along: f64 = (0..3).map(|axis| (to[axis] - from[axis]) * normal[axis]).sum();
        let height: f64 = (0..3).map(|axis| (from[axis] - plane.point[axis]) * normal[axis]).sum();
        let expected = -height / along;
        let found = TripSearch::new(plane.clone()).trip(&path(from, to, ProbeTrip::Touch)).unwrap();
        let slack = (2e-9 + 1.1 * TOUCH) / along.abs();
        assert!((found - expected).abs() < slack, "{found} is not {expected}");
        // And back out of it.
        let back =
            TripSearch::new(plane.clone()).trip(&path(to, from, ProbeTrip::Release)).unwrap();
        let expected = (RELEASE - (height + along)) / -along;
        assert!((back - expected).abs() < slack, "{back} is not {expected}");
    }
}

/// Cannot be anywhere.
#[derive(Debug)]
struct Nowhere;

impl Clearance for Nowhere {
    fn at(&mut self, _: &Position, _: &ProbePath) -> Option<f64> {
        None
    }
}

#[test]
fn moves_that_do_not_trip() {
    let mut target = TripSearch::new(floor(0.0));
    let (up, down) = ([0.0, 0.0, 0.1], [0.0, 0.0, -0.1]);
    for (from, to, trips, expected) in [
        (up, [0.0, 0.0, 0.01], ProbeTrip::Touch, None),
        (up, up, ProbeTrip::Touch, None),
        (down, up, ProbeTrip::Touch, Some(0.0)),
        (down, [0.1, 0.0, -0.1], ProbeTrip::Release, None),
        (up, down, ProbeTrip::Release, Some(0.0)),
    ] {
        assert_eq!(target.trip(&path(from, to, trips)), expected, "{from:?} {to:?} {trips:?}");
    }
    assert_eq!(TripSearch::new(Nowhere).trip(&path(up, down, ProbeTrip::Touch)), None);
}

/// A rotary axis that lifts the machine by a millimetre a degree.
#[test]
fn rotary_axes_alone() {
    #[derive(Debug)]
    struct Lift;
    impl Clearance for Lift {
        fn at(&mut self, at: &Position, _: &ProbePath) -> Option<f64> {
            Some((at.rotary[0] - 30.0) * 1e-3)
        }
    }
    let mut turned = path([0.0; 3], [0.0; 3], ProbeTrip::Touch);
    turned.start.rotary[0] = 90.0;
    let found = TripSearch::new(Lift).trip(&turned).unwrap();
    assert!((found - 2.0 / 3.0).abs() < 1e-6, "{found}");
}

/// Down on the stock, then against the front of the fixed jaw, off and away.
const TOUCH_STOCK_AND_JAW: &str = "G0 Z30\nG0 X50 Y30\nG38.2 Z-20 F100\nG0 Z30\nG0 Y-60\nG0 Z-20\n\
                         G38.2 Y10 F60\nG91 G0 Y-5\nG90 G0 Z30\nM2\n";

#[test]
fn probes_stop_on_stock_and_jaws() {
    for physics in [false, true] {
        let outcome = checked(&load(VICE), TOUCH_STOCK_AND_JAW, physics);
        let said: Vec<_> =
            outcome.findings.iter().map(|one| (one.line, one.rule, &*one.message)).collect();
        assert!(outcome.findings.iter().all(|one| one.severity == Severity::Note), "{said:?}");
        for expected in [
            (3, Rule::Probe, "probe touches at X 50.000 Y 30.000 Z 0.000 mm"),
            (7, Rule::Probe, "probe touches at X 50.000 Y -23.000 Z -20.000 mm"),
        ] {
            assert!(said.contains(&expected), "{said:?}");
        }
        // Where the simulated machine is when it touches: as near as its drives follow (half a millimetre is allowed, and at
        // 100 mm/min it is less than a hundredth).
        let simulated = said.iter().filter(|one| one.2.starts_with("in the simulated"));
        let simulated: Vec<_> = simulated.map(|one| (one.0, place(one.2))).collect();
        if !physics {
            assert!(simulated.is_empty(), "{said:?}");
            continue;
        }
        let expected = [(3, [50.0, 30.0, 0.0]), (7, [50.0, -23.0, -20.0])];
        assert_eq!(simulated.len(), expected.len(), "{said:?}");
        for ((line, found), (wanted_line, wanted)) in simulated.iter().zip(expected) {
            assert_eq!(*line, wanted_line, "{said:?}");
            let near =
                found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 0.011);
            assert!(near, "{said:?}");
        }
    }
}

/// Numbers behind X, Y and Z.
fn place(text: &str) -> Vec<f64> {
    let words: Vec<_> = text.split_whitespace().collect();
    let behind = |letter: &str| {
        let at = words.iter().position(|word| *word == letter).unwrap();
        words[at + 1].parse().unwrap()
    };
    ["X", "Y", "Z"].map(behind).to_vec()
}

/// A touch does not permit going on: through what was touched, or into something else with stock at the tool.
#[test]
fn a_probe_is_a_tool_again_when_it_has_touched() {
    for (program, line) in [
        ("G0 Z30\nG0 X50 Y-60\nG0 Z-20\nG38.2 Y10 F60\nG0 Y40\nG0 Z30\nM2\n", 5),
        ("G0 Z30\nG0 X50 Y30\nG38.2 Z-20 F100\nG1 Z-12 F300\nG1 Y-40 F600\nG0 Z30\nM2\n", 5),
    ] {
        for physics in [false, true] {
            let outcome = checked(&load(VICE), program, physics);
            let hit = |unit: &str| {
                outcome.findings.iter().any(|one| {
                    one.rule == Rule::Collision
                        && one.severity == Severity::Error
                        && one.line == line
                        && one.unit == Some(unit)
                })
            };
            assert!(hit("mm"), "{program}: {:#?}", outcome.findings);
            assert_eq!(hit("N"), physics, "{program}: {:#?}", outcome.findings);
        }
    }
}

/// Without a tool of its own a machine probes with the tip of that of the tool table: G43 H1, 25 mm long.
#[test]
fn a_tool_of_the_table_probes_with_its_tip() {
    let bare = VICE
        .replace("length_mm = 60.0\n", "")
        .replace("diameter_mm = 6.0  ", "# ")
        .replace("holder_", "# ")
        .replace("[rs274]", "[rs274]\ntool_table = \"tools.tbl\"");
    let program = "T1 M6\nG43 H1\nG0 Z55\nG0 X50 Y30\nG38.2 Z-20 F100\nM2\n";
    let outcome = checked(&load(&bare), program, false);
    // Z0 of the program is the stock's top.
    let said: Vec<_> = outcome.findings.iter().map(|one| &*one.message).collect();
    assert!(
        said.iter().any(|one| one.starts_with("probe touches at X 50.000 Y 30.000 Z 25.000")),
        "{said:?}"
    );
}

#[test]
fn a_probe_that_finds_nothing_says_so() {
    let outcome =
        checked(&load(VICE), "G0 Z30\nG0 X200 Y30\nG38.2 Z10 F100\nG38.3 Z5\nM2\n", false);
    let [finding] = &outcome.findings[..] else { panic!("{:#?}", outcome.findings) };
    assert_eq!((finding.line, finding.rule, finding.severity), (3, Rule::Probe, Severity::Error));
}
