//! Tests of probing moves: their ends, and the program after them. LinuxCNC's rules define the errors: those of
//! its interpreter in `linuxcnc.rs`, those of its motion controller (a probe that trips, or does not, or has already)
//! here.

use super::*;
use crate::decode::{Rule, TextError};
use crate::rs274::{
    LengthUnit, ProbePath, ProbeTarget, Surroundings, Tool, ToolReference, ToolTable,
};
use ProbeOutcome::{NotTripped, Tripped, Unknown};
use std::sync::{Arc, Mutex};
use twin_path::Place;
use twin_path::{ProbeOutcome, ProbeTrip, Probing};

/// A floor that the tip touches where it is no higher than this, m, and lets go of a micrometre above.
#[derive(Debug)]
struct Floor(f64);

const SLACK: f64 = 1e-6;

impl ProbeTarget for Floor {
    fn trip(&mut self, path: &ProbePath) -> Option<f64> {
        let [from, to] = [path.start, path.end].map(|at| at.linear[2] - path.point_from_tip[2]);
        let touching = from < self.0 + SLACK / 2.0;
        let (there, height) = match path.trips {
            ProbeTrip::Touch => (touching, self.0),
            ProbeTrip::Release => (!touching, self.0 + SLACK),
        };
        if there {
            return Some(0.0);
        }
        let part = (height - from) / (to - from);
        (0.0..=1.0).contains(&part).then_some(part)
    }
}

/// A program among things of which `make` knows.
pub(super) fn among<T: ProbeTarget + 'static>(
    make: impl Fn() -> T + Send + Sync + 'static,
) -> DecoderOptions {
    DecoderOptions { surroundings: Some(Surroundings::new(make)), ..DecoderOptions::default() }
}

/// A program above a floor at `z_mm`.
pub(super) fn above(z_mm: f64) -> DecoderOptions {
    among(move || Floor(z_mm * 1e-3))
}

fn messages(diagnostics: &[Diagnostic]) -> Vec<String> {
    diagnostics.iter().map(ToString::to_string).collect()
}

/// What became of the probing moves.
fn outcomes(elements: &[PathElement]) -> Vec<(u32, Probing, ProbeOutcome)> {
    let of = |element: &PathElement| match element.kind {
        ElementKind::Probe { probing, outcome } => Some((element.place.line, probing, outcome)),
        _ => None,
    };
    elements.iter().filter_map(of).collect()
}

/// The move ends where it trips, with the feed of any other, and absolute coordinates that are not named stay there.
#[test]
fn the_path_goes_on_where_the_probe_trips() {
    let path = elements_with(above(-3.215), "G0 X10 Y20 Z5\nF120 G38.2 Z-10\nG1 X12\nG0 Z5\nM2");
    assert_eq!(ends(&path), "10 20 5 | 10 20 -3.215 | 12 20 -3.215 | 12 20 5");
    assert_eq!(outcomes(&path), [(2, Probing::TOUCH, Tripped)]);
    // 120 mm/min.
    assert!((path[1].feed - 0.002).abs() < 1e-18);
    assert_eq!(path[1].end(), path[2].start());
}

/// Along a slope the other axes stop with the one that touches: after 5 of 15 mm, a third of the way.
#[test]
fn all_axes_stop() {
    let path = elements_with(above(-5.0), "F100 G38.3 X25 Y-50 Z-15 A90\nG91 X1 A1\nM2");
    let part = 5.0 / 15.0;
    let round = |mm: f64| (mm * 1e6).round() / 1e6;
    let first = [25.0 * part, -50.0 * part, -15.0 * part].map(round);
    assert_eq!(ends_mm(&path)[0], first);
    let angles: Vec<f64> = path.iter().map(|element| element.extra().unwrap().end[0]).collect();
    assert!((angles[0] - 30.0).abs() < 1e-12, "{angles:?}");
    // The second one begins touching and stays where it is.
    assert_eq!(path[1].end(), path[0].end());
    assert_eq!(outcomes(&path)[1], (2, Probing::TRY_TOUCH, Tripped));
}

/// Touch, back off by so much, touch again more slowly: from the trip point, not from the programmed end.
#[test]
fn incremental_moves_begin_at_the_trip_point() {
    let program = "G91 F200 G38.2 Z-100\nG0 Z2\nG38.2 Z-5 F20\nG0 Z1\nG90 G0 Z7\nM2";
    let path = elements_with(above(-12.5), program);
    let heights: Vec<f64> = ends_mm(&path).iter().map(|end| end[2]).collect();
    assert_eq!(heights, [-12.5, -10.5, -12.5, -11.5, 7.0]);
    let feeds: Vec<f64> = path.iter().map(|element| element.feed * 6e4).collect();
    assert!((feeds[0] - 200.0).abs() < 1e-9 && (feeds[2] - 20.0).abs() < 1e-9, "{feeds:?}");
}

#[test]
fn modal_until_another_motion() {
    let path = elements_with(above(-1.0), "F100 G38.3 Z-5\nG0 Z3\nG38.3 Z0\nX4 Z-9\nG1 X8\nM2");
    assert_eq!(
        outcomes(&path),
        [
            (1, Probing::TRY_TOUCH, Tripped),
            (3, Probing::TRY_TOUCH, NotTripped),
            (4, Probing::TRY_TOUCH, Tripped)
        ]
    );
    let last = path.last().unwrap();
    assert_eq!(last.kind, ElementKind::Cut);
    assert_eq!(ends_mm(&path)[3], [0.444_444, 0.0, -1.0]);
}

#[test]
fn inches() {
    let path = elements_with(above(-12.7), "G20\nG38.2 Z-4 F10\nG91 G1 X1 Z.25\nG21 Z1\nM2");
    assert_eq!(ends(&path), "0 0 -12.7 | 25.4 0 -6.35 | 25.4 0 -5.35");
    // 10 in/min.
    assert!((path[0].feed - 0.254 / 60.0).abs() < 1e-15);
    let metric = elements_with(above(-12.7), "G38.2 Z-101.6 F254\nG20 G90 G1 Z-1\nM2");
    assert_eq!(ends(&metric), "0 0 -12.7 | 0 0 -25.4");
}

/// What is touched is in the machine frame. G92 behind a trip makes the surface the program's zero.
#[test]
fn work_offsets() {
    let mut options = above(-40.0);
    options.work_offsets[0] = at([0.1, 0.0, -0.03]);
    options.work_offsets[1] = at([0.0, 0.0, -0.05]);
    let program = "G0 X1 Z5\nF100 G38.2 Z-20\nG1 X2\nZ-11\nG0 Z5\nG38.2 Z-20\nG92 Z0\nG0 Z2\n\
                   G92.1 G55 Z15\nM2";
    let path = elements_with(options, program);
    // G55 does not have the 100 mm of G54 in X, but X is not named: it stays.
    assert_eq!(
        ends(&path),
        "101 0 -25 | 101 0 -40 | 102 0 -40 | 102 0 -41 | 102 0 -25 | 102 0 -40 | 102 0 -38 | 102 0 -35"
    );
}

/// It is the tip that touches, whichever point the path is that of.
#[test]
fn tool_length() {
    let tool = Tool { number: 3, offset: [0.0, 0.0, 0.05], diameter: 0.0 };
    let with = |reference| DecoderOptions {
        tools: Some(ToolTable::new([tool])),
        reference,
        start: at([0.0, 0.0, 0.1]),
        ..above(-4.0)
    };
    let program = "G43 H3\nG0 Z10\nF100 G38.2 Z-8\nG91 G1 Z1\nG49 G90 G0 Z20\nM2";
    let heights = |reference| -> Vec<f64> {
        let path = elements_with(with(reference), program);
        ends_mm(&path).iter().map(|end| end[2]).collect()
    };
    assert_eq!(heights(ToolReference::ControlPoint), [60.0, 46.0, 47.0, 20.0]);
    // Before each change of the length the tip jumps to where it is then.
    assert_eq!(heights(ToolReference::Tip), [10.0, -4.0, -3.0, 47.0, 20.0]);
}

/// In inverse time F says how long the whole move as programmed takes; 15 mm at F4 are 60 mm/min.
#[test]
fn inverse_time() {
    let path = elements_with(above(-5.0), "G93 G38.2 Z-15 F4\nM2");
    assert!((path[0].feed - 0.001).abs() < 1e-18);
    assert_eq!(ends(&path), "0 0 -5");
    let decoded = decode("G93 G38.2 Z-15\nM2");
    let missing = "line 1: with inverse time (G93) every block with feed motion needs its F";
    assert_eq!(messages(&decoded.errors), [missing]);
}

/// G38.4 and G38.5 are what G38.2 and G38.3 are, the other way round.
#[test]
fn away() {
    let program = "G1 F100 Z-2\nG38.4 Z9\nG91 G38.5 Z3\nG90 G1 Z-1\nG38.5 Z-2\nG38.5 Z2\nM2";
    let path = elements_with(above(0.5), program);
    let heights: Vec<f64> = ends_mm(&path).iter().map(|end| end[2]).collect();
    assert_eq!(heights, [-2.0, 0.501, 0.501, -1.0, -2.0, 0.501]);
    assert_eq!(
        outcomes(&path),
        [
            (2, Probing::RELEASE, Tripped),
            // Free from the beginning.
            (3, Probing::TRY_RELEASE, Tripped),
            (5, Probing::TRY_RELEASE, NotTripped),
            (6, Probing::TRY_RELEASE, Tripped),
        ]
    );
}

/// LinuxCNC: "G38.2 move finished without making contact." and "G38.4 move finished without breaking contact.", with
/// the machine at the end of the move.
#[test]
fn nothing_to_touch() {
    let program =
        "G0 Z5\nF100\nX3\n\n\n\nG38.2 Z1\nG38.3 Z.5\nG38.4 X8\nG1 Z-9\nG38.4 X9 M0\nX10\n";
    let decoded = decode_with(above(-1.0), program.as_bytes());
    assert_eq!(
        messages(&decoded.errors),
        [
            "line 7: G38.2 reaches its end without touching anything",
            "line 9: G38.4 begins where nothing is touched",
            "line 11: G38.4 reaches its end without coming free",
            "line 12: G38.4 reaches its end without coming free",
        ]
    );
    assert!(decoded.errors.iter().all(|error| error.error.rule() == Rule::Probe));
    let ends = ends_mm(&decoded.elements);
    // What has begun in the wrong state has not moved.
    assert_eq!(ends[2..5], [[3.0, 0.0, 1.0], [3.0, 0.0, 0.5], [3.0, 0.0, -9.0]]);
    assert_eq!(ends[5..], [[9.0, 0.0, -9.0], [10.0, 0.0, -9.0]]);
}

/// LinuxCNC: "Probe is already tripped when starting G38.2 or G38.3 move", but where its code tests this it leaves the
/// two out that need not succeed: they stop at once.
#[test]
fn touching_already() {
    let decoded = decode_with(above(3.0), b"F100 G1 Z1\nG38.2 Z-5\nG38.3 Z-5\nX4\nG1 X5\nM2");
    assert_eq!(
        messages(&decoded.errors),
        ["line 2: G38.2 begins where something is touched already"]
    );
    assert_eq!(ends(&decoded.elements), "0 0 1 | 0 0 1 | 0 0 1 | 5 0 1");
    // Also where moves that go nowhere are left out.
    let options = DecoderOptions { keep_empty_moves: false, ..above(3.0) };
    let path = elements_with(options, "F100 G1 Z1\nG38.3 Z-5\nM2");
    assert_eq!(outcomes(&path), [(2, Probing::TRY_TOUCH, Tripped)]);
}

#[test]
fn unknown_surroundings() {
    let decoded = decode("F100 G38.2 Z-5\nG38.5 Z3\nG1 X1\nM2");
    assert_eq!(decoded.errors, []);
    assert_eq!(
        messages(&decoded.warnings),
        [
            "line 1: G38.2 is assumed to reach its end: nothing is described that it could touch",
            "line 2: G38.5 is assumed to reach its end: nothing is described that it could touch",
        ]
    );
    assert!(decoded.warnings.iter().all(|warning| warning.error.rule() == Rule::Probe));
    assert_eq!(
        outcomes(&decoded.elements),
        [(1, Probing::TOUCH, Unknown), (2, Probing::TRY_RELEASE, Unknown)]
    );
    assert_eq!(ends(&decoded.elements), "0 0 -5 | 0 0 3 | 1 0 3");
}

/// The sentences, for the rules of LinuxCNC's interpreter.
#[test]
fn errors_of_the_block() {
    for (program, message) in [
        ("F100 G38.2", "line 1: G38.2 needs an axis word"),
        ("F100 G38.5 (Z1)", "line 1: G38.5 needs an axis word"),
        ("F100 G38.2 Z0", "line 1: G38.2 goes nowhere: its start and its end are the same"),
        ("F100 G91 G38.4 X0", "line 1: G38.4 goes nowhere: its start and its end are the same"),
        ("G38.3 Z-1", "line 1: motion without a feed: F has not been set, or not since G94"),
        ("G38.3 Z-1 F0", "line 1: motion without a feed: F is 0"),
        ("F100 G53 G38.2 Z-1", "line 1: G53 needs G0 or G1"),
        (
            "F100 G28 G38.2 Z-1",
            "line 1: G38.2 and another G word of this block both use its axis words: write them in two blocks",
        ),
        (
            "F100 G38.2 G38.3 Z-1",
            "line 1: G38.3 contradicts another G word of this block: they belong to one modal group",
        ),
        ("F100 G38.2 Z-1 P1", "line 1: P has no effect in this block"),
        ("F100 G38.2 Z-1 H1", "line 1: H has no effect in this block"),
        ("F100 G38.2 Z-1000001", "line 1: Z is -1000.001 m, outside -1000 m to 1000 m"),
    ] {
        let decoded = decode_with(above(1e9), format!("{program}\nM2").as_bytes());
        assert_eq!(messages(&decoded.errors)[..], [message], "{program}");
        assert_eq!(decoded.errors[0].error.rule(), Rule::Syntax, "{program}");
    }
}

/// Keeps what it is asked, and answers with what it is given.
#[derive(Debug)]
struct Asked {
    paths: Arc<Mutex<Vec<ProbePath>>>,
    answer: Option<f64>,
}

impl ProbeTarget for Asked {
    fn trip(&mut self, path: &ProbePath) -> Option<f64> {
        self.paths.lock().unwrap().push(*path);
        self.answer
    }
}

#[test]
fn what_the_target_is_asked() {
    let paths = Arc::new(Mutex::new(Vec::new()));
    let asked = Arc::clone(&paths);
    let mut options = among(move || Asked { paths: Arc::clone(&asked), answer: None });
    options.work_offsets[0] = at([0.0, 0.0, 0.001]);
    let tool = Tool { number: 2, offset: [0.0, 0.001, 0.02], diameter: 0.0 };
    options.tools = Some(ToolTable::new([tool]));
    elements_with(options, "G43 H2 G0 X0 Y0 Z0\nN7 G38.5 X8 A45 F60\nG1 X9\nG38.3 X7 F30\nM2");
    let rotary = [45.0, 0.0, 0.0];
    let path = |place, start, end, feed, trips| ProbePath {
        place,
        start,
        end,
        point_from_tip: [0.0, 0.001, 0.02],
        feed,
        trips,
    };
    let xs = |x: f64| [x, 0.001, 0.001 + 0.02];
    let found = paths.lock().unwrap();
    let expected = [
        path(
            Place { line: 2, block: Some(7) },
            at(xs(0.0)),
            Position { linear: xs(0.008), rotary },
            0.001,
            ProbeTrip::Release,
        ),
        path(
            Place { line: 4, block: None },
            Position { linear: xs(0.009), rotary },
            Position { linear: xs(0.007), rotary },
            0.0005,
            ProbeTrip::Touch,
        ),
    ];
    assert_eq!(found[..], expected);
}

/// Numbers outside 0 to 1 count as no trip, or as the start.
#[test]
fn strange_answers() {
    for (answer, outcome, end) in [
        (f64::NAN, NotTripped, 8.0),
        (f64::INFINITY, NotTripped, 8.0),
        (1.000_001, NotTripped, 8.0),
        (1.0, Tripped, 8.0),
        (0.25, Tripped, 2.0),
        (-0.0, Tripped, 0.0),
        (-3.0, Tripped, 0.0),
        (f64::NEG_INFINITY, Tripped, 0.0),
    ] {
        let asked = move || Asked { paths: Arc::default(), answer: Some(answer) };
        let path = elements_with(among(asked), "F100 G38.3 X8\nM2");
        assert_eq!(outcomes(&path), [(1, Probing::TRY_TOUCH, outcome)], "{answer}");
        assert_eq!(ends_mm(&path), [[end, 0.0, 0.0]], "{answer}");
    }
}

/// Every reading of a program asks a target of its own, with nothing left from another.
#[test]
fn readings_are_alike() {
    /// Trips a little later each time.
    #[derive(Debug)]
    struct Later(f64);
    impl ProbeTarget for Later {
        fn trip(&mut self, _: &ProbePath) -> Option<f64> {
            self.0 += 0.25;
            Some(self.0)
        }
    }
    let options = among(|| Later(0.0));
    let program = "F100 G38.2 Z-4\nG0 Z0\nG38.2 Z-4\nM2";
    let first = elements_with(options.clone(), program);
    let heights: Vec<f64> = ends_mm(&first).iter().map(|end| end[2]).collect();
    assert_eq!(heights, [-1.0, 0.0, -2.0]);
    assert_eq!(elements_with(options.clone(), program), first);
    assert_eq!(options, options.clone());
    assert_ne!(options, among(|| Later(0.0)));
    assert_eq!(format!("{:?}", options.surroundings), "Some(Surroundings { .. })");
}

/// A start in inches, and a probe that the rest of the program hangs on: what LinuxCNC users write to find a surface.
#[test]
fn a_surface_is_found() {
    let options =
        DecoderOptions { units: LengthUnit::Inch, start: at([0.0254, 0.0, 0.0508]), ..above(7.62) };
    let program = "G90 F10\nG38.2 Z-1\nG91 G0 Z.1\nF1 G38.2 Z-.2\nG90 G92 Z0\nG0 Z.5\nG0 X0\nM30";
    let path = elements_with(options, program);
    assert_eq!(ends(&path), "25.4 0 7.62 | 25.4 0 10.16 | 25.4 0 7.62 | 25.4 0 20.32 | 0 0 20.32");
}
