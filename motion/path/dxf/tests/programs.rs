//! Tests of sections, order, programs and heights.
#![expect(clippy::float_cmp, reason = "rounded before")]

use super::*;

fn with(options: ImportOptions, entities: &[&str]) -> Import {
    import(drawing(entities).as_bytes(), &options).unwrap()
}

/// Starts and ends of the cuts, mm in X and Y.
fn ends_mm(program: &Program) -> Vec<[f64; 4]> {
    let cuts = program.elements.iter().filter(|element| element.kind == ElementKind::Cut);
    let mm = |metres: f64| (metres * 1e9).round() / 1e6;
    cuts.map(|cut| {
        let (start, end) = (cut.start(), cut.end());
        [mm(start.x), mm(start.y), mm(end.x), mm(end.y)]
    })
    .collect()
}

/// A square in disorder, one side drawn backwards, and a line elsewhere in between.
const SQUARE: [&str; 5] = [
    "LINE 8 a 10 0 20 0 11 10 21 0",
    "LINE 8 a 10 10 20 10 11 0 21 10",
    "LINE 8 b 10 100 20 0 11 50 21 0",
    "LINE 8 a 10 10 20 10 11 10 21 0",
    "LINE 8 a 10 0 20 10 11 0 21 0",
];

#[test]
fn sections_are_joined() {
    let import = with(ImportOptions::default(), &SQUARE);
    let [program] = &import.programs[..] else { panic!("{import:?}") };
    assert_eq!((program.name.as_str(), program.sections), ("drawing", 2));
    let expected = [
        [0.0, 0.0, 10.0, 0.0],
        [10.0, 0.0, 10.0, 10.0],
        [10.0, 10.0, 0.0, 10.0],
        [0.0, 10.0, 0.0, 0.0],
        [100.0, 0.0, 50.0, 0.0],
    ];
    assert_eq!(ends_mm(program), expected);
    // The square needs no rapid: it begins where the program does. The line's place is its own in the file.
    let kinds: Vec<_> = program.elements.iter().map(|element| element.kind).collect();
    assert_eq!(kinds.iter().filter(|kind| **kind == ElementKind::Rapid).count(), 1);
    let lines: Vec<_> = program.elements.iter().map(|element| element.place.line).collect();
    let first = lines[0];
    assert_eq!(lines, [0, 3, 1, 4, 2, 2].map(|n| first + n * 12));
    assert_eq!(drawing(&SQUARE).lines().nth(first as usize - 1), Some("LINE"));
}

#[test]
fn one_program_per_layer_or_section() {
    let programs = |split, entities: &[&str]| {
        let import = with(ImportOptions { split, ..ImportOptions::default() }, entities);
        let programs = import.programs.iter();
        let named = programs.map(|program| format!("{}: {}", program.name, program.sections));
        named.collect::<Vec<_>>()
    };
    assert_eq!(programs(Split::Layers, &SQUARE), ["a: 1", "b: 1"]);
    assert_eq!(programs(Split::Sections, &SQUARE), ["section 1 (a): 1", "section 2 (b): 1"]);
    // Layers are not joined with one another when each has its own program.
    let touching = ["LINE 8 a 10 0 20 0 11 1 21 0", "LINE 8 b 10 1 20 0 11 2 21 0"];
    assert_eq!(programs(Split::Whole, &touching), ["drawing: 1"]);
    assert_eq!(programs(Split::Layers, &touching), ["a: 1", "b: 1"]);
}

/// From (60, 0): first the line, from its nearer end; then the square, from its nearest corner.
#[test]
fn nearest_first() {
    let options = ImportOptions {
        order: Order::Nearest,
        start: Point3::new(0.11, 0.0, 0.0),
        ..ImportOptions::default()
    };
    let import = with(options, &SQUARE);
    let ends = ends_mm(&import.programs[0]);
    assert_eq!(ends[0], [100.0, 0.0, 50.0, 0.0]);
    assert_eq!((ends[1], ends[4]), ([10.0, 0.0, 10.0, 10.0], [0.0, 0.0, 10.0, 0.0]));
    let start = Point3::new(0.04, -0.05, 0.0);
    let import = with(ImportOptions { start, ..options }, &SQUARE);
    assert_eq!(ends_mm(&import.programs[0])[0], [50.0, 0.0, 100.0, 0.0]);
}

#[test]
fn gaps_are_joined_up_to_the_tolerance() {
    let gap = ["LINE 10 0 20 0 11 10 21 0", "LINE 10 10.05 20 0 11 20 21 0"];
    let sections = |join_tolerance| {
        let import = with(ImportOptions { join_tolerance, ..ImportOptions::default() }, &gap);
        (import.programs[0].sections, ends_mm(&import.programs[0]).len())
    };
    assert_eq!(sections(4e-5), (2, 2));
    // Bridged by a line of its own.
    assert_eq!(sections(6e-5), (1, 3));
    // Less than a micrometre: the ends become one.
    let near = ["LINE 10 0 20 0 11 10 21 0", "ARC 10 10.0002 20 5 40 5 50 270 51 0"];
    let import = with(ImportOptions::default(), &near);
    let cuts = cuts(&import);
    assert_eq!((cuts.len(), cuts[0].end()), (2, cuts[1].start()));
}

#[test]
fn heights() {
    let heights = Some(Heights { safe: 0.005, cut: -0.001, plunge_feed: 0.01 });
    let import = with(ImportOptions { heights, ..ImportOptions::default() }, &SQUARE);
    let elements = &import.programs[0].elements;
    // X and Z of the ends, mm; with an r where it is not a cut.
    let step = |element: &PathElement| {
        let [x, z] = [element.end().x, element.end().z].map(|at| (at * 1e9).round() / 1e6);
        format!("{}{x},{z}", if element.kind == ElementKind::Cut { "" } else { "r" })
    };
    let steps: Vec<_> = elements.iter().map(step).collect();
    let expected = "r0,5 0,-1 10,-1 10,-1 0,-1 0,-1 r0,5 r100,5 100,-1 50,-1 r50,5";
    assert_eq!(steps.join(" "), expected);
    assert!((elements[1].feed - 0.01).abs() < 1e-15 && (elements[2].feed - 0.1).abs() < 1e-15);
    for pair in elements.windows(2) {
        assert_eq!(pair[0].end(), pair[1].start());
    }
}
