//! Tests of probing moves: their ends, and the program after them. LinuxCNC's rules define the errors: those of
//! its interpreter in `linuxcnc.rs`, those of its motion controller (a probe that trips, or does not, or has already)
//! here.

use super::*;
use crate::decode::{Rule, TextError};
use crate::rs274::{
    LengthUnit, ProbePath, ProbeTarget, Surroundings, Tool, ToolReference, ToolTable,
};
use serde_json::Value;
use std::array;
use std::sync::{Arc, Mutex};
use twin_path::Place;
use twin_path::ProbeTrip;

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
    DecoderOptions {
        surroundings: Some(Surroundings::new(move |_| make())),
        ..DecoderOptions::default()
    }
}

/// A program above a floor at `z_mm`.
pub(super) fn above(z_mm: f64) -> DecoderOptions {
    among(move || Floor(z_mm * 1e-3))
}

fn messages(diagnostics: &[Diagnostic]) -> Vec<String> {
    diagnostics.iter().map(ToString::to_string).collect()
}

/// Line, word and outcome of each probing move.
fn outcomes(elements: &[PathElement]) -> String {
    let of = |element: &PathElement| match element.kind {
        ElementKind::Probe { probing, outcome } => {
            Some(format!("{} {probing} {outcome:?}", element.place.line))
        }
        _ => None,
    };
    elements.iter().filter_map(of).collect::<Vec<_>>().join(" | ")
}

/// The options of an example: floor, start and offsets in mm; tool 3 has 50 mm.
fn options_of(example: &Value) -> DecoderOptions {
    let place = |key: &str| {
        at(array::from_fn(|axis| example[key][axis].as_f64().unwrap_or_default() / 1e3))
    };
    let mut options = above(example["floor"].as_f64().unwrap());
    options.start = place("start");
    (options.work_offsets[0], options.work_offsets[1]) = (place("g54"), place("g55"));
    options.keep_empty_moves = example["keep_empty_moves"] != false;
    let tool = Tool { number: 3, offset: [0.0, 0.0, 0.05], ..Tool::default() };
    options.tools = Some(ToolTable::new([tool]));
    if example["tip"] == true {
        options.reference = ToolReference::Tip;
    }
    if example["inch"] == true {
        options.units = LengthUnit::Inch;
    }
    options
}

/// Moves end where they trip, with the feed of any other, and the program goes on from there: absolute coordinates that
/// are not named stay. Feeds of the probing moves are in mm/min.
#[test]
fn the_path_goes_on_where_the_probe_trips() {
    let examples: Vec<Value> = serde_json::from_str(include_str!("probe.json")).unwrap();
    for example in examples {
        let about = &example["about"];
        let path = elements_with(options_of(&example), example["program"].as_str().unwrap());
        assert_eq!(example["ends"], ends(&path), "{about}");
        assert!(path.windows(2).all(|pair| pair[0].end() == pair[1].start()), "{about}");
        assert_eq!(example["probes"], outcomes(&path), "{about}");
        let feeds: Vec<f64> = serde_json::from_value(example["feeds"].clone()).unwrap();
        let is_probe = |element: &&PathElement| matches!(element.kind, ElementKind::Probe { .. });
        assert_eq!(path.iter().filter(is_probe).count(), feeds.len(), "{about}");
        for (PathElement { feed, .. }, expected) in path.iter().filter(is_probe).zip(feeds) {
            assert!((feed - expected / 6e4).abs() < 1e-18, "{about}: {feed}, {expected} mm/min");
        }
    }
}

/// Along a slope the other axes stop with the one that touches: after 5 of 15 mm, a third of the way.
#[test]
fn all_axes_stop() {
    let path = elements_with(above(-5.0), "F100 G38.3 X25 Y-50 Z-15 A90\nG91 X1 A1\nM2");
    // The second one begins touching and stays where it is.
    assert_eq!(ends(&path), "8.333333 -16.666667 -5 | 8.333333 -16.666667 -5");
    assert_eq!(path[1].end(), path[0].end());
    assert!((path[0].extra().unwrap().end[0] - 30.0).abs() < 1e-12);
    assert_eq!(outcomes(&path), "1 G38.3 Tripped | 2 G38.3 Tripped");
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
    assert_eq!(outcomes(&decoded.elements), "1 G38.2 Unknown | 2 G38.5 Unknown");
    assert_eq!(ends(&decoded.elements), "0 0 -5 | 0 0 3 | 1 0 3");
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
    let tool = Tool { number: 2, offset: [0.0, 0.001, 0.02], ..Tool::default() };
    options.tools = Some(ToolTable::new([tool]));
    elements_with(options, "M61 Q2 G43 G0 X0 Y0 Z0\nN7 G38.5 X8 A45 F60\nG1 X9\nG38.3 X7 F30\nM2");
    let rotary = [45.0, 0.0, 0.0];
    let path = |place, start, end, feed, trips| ProbePath {
        place,
        start,
        end,
        point_from_tip: [0.0, 0.001, 0.02],
        tool: 2,
        feed,
        trips,
    };
    let xs = |x: f64| [x, 0.001, 0.001 + 0.02];
    let found = paths.lock().unwrap();
    let expected = [
        path(
            Place { block: Some(7), ..Place::at(2) },
            at(xs(0.0)),
            Position { rotary, ..at(xs(0.008)) },
            0.001,
            ProbeTrip::Release,
        ),
        path(
            Place::at(4),
            Position { rotary, ..at(xs(0.009)) },
            Position { rotary, ..at(xs(0.007)) },
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
        (f64::NAN, "1 G38.3 NotTripped", 8.0),
        (f64::INFINITY, "1 G38.3 NotTripped", 8.0),
        (1.000_001, "1 G38.3 NotTripped", 8.0),
        (1.0, "1 G38.3 Tripped", 8.0),
        (0.25, "1 G38.3 Tripped", 2.0),
        (-0.0, "1 G38.3 Tripped", 0.0),
        (-3.0, "1 G38.3 Tripped", 0.0),
        (f64::NEG_INFINITY, "1 G38.3 Tripped", 0.0),
    ] {
        let asked = move || Asked { paths: Arc::default(), answer: Some(answer) };
        let path = elements_with(among(asked), "F100 G38.3 X8\nM2");
        assert_eq!(outcomes(&path), outcome, "{answer}");
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
