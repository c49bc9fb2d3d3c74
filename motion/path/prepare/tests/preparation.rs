//! Tests of [`Preparation`]: the adapters in a row.

use super::{Error, assert_path, close, m_function, path, random_path, stairs, taken, through};
use crate::prepare::{
    CircularLimits, DEFAULT_LOOP_WINDOW, Incompatible, Notices, Preparation, Rounding, Sections,
    Smoothing, Stage, ToolRadiusOptions,
};
use crate::{ElementKind, Marks, PathElement, Shape};
use proptest::prelude::*;

const CIRCULAR: CircularLimits = CircularLimits { acceleration: 0.2, acceleration_jump: 0.1 };

fn run(preparation: Preparation, path: Vec<PathElement>) -> Vec<PathElement> {
    through(path, |items, notices| preparation.apply(items, &notices)).0
}

/// What the sections of elements with these marks find, one by one.
fn sections<const N: usize>(marks: [Marks; N]) -> [Result<(), Incompatible>; N] {
    let mut sections = Sections::default();
    marks.map(|marks| sections.pass(marks))
}

/// Correction, rounding and smoothing are not combinable with each other (manual 3.4).
#[test]
fn incompatible_stages() {
    let none = Marks::default();
    let cases = [
        (Marks::CORRECTION_LEFT, Marks::SMOOTHING, Stage::ToolRadius, Stage::Smoothing),
        (Marks::CORRECTION_RIGHT, Marks::ROUNDING, Stage::ToolRadius, Stage::Rounding),
        (Marks::SMOOTHING, Marks::ROUNDING, Stage::Smoothing, Stage::Rounding),
    ];
    for (one, other, first, second) in cases {
        let error = Err(Incompatible { first, second });
        assert_eq!(sections([one, none, other]), [Ok(()), Ok(()), error]);
        assert_eq!(sections([other, none, one]), [Ok(()), Ok(()), error]);
        assert_eq!(sections([one.with(other)]), [error]);
        assert!(!Sections::cannot_overlap(one.with(other)) && Sections::cannot_overlap(one));
    }
    let error = Incompatible { first: Stage::Smoothing, second: Stage::Rounding };
    assert_eq!(error.to_string(), "smoothing and rounding cannot be combined: D belongs to either");
}

/// Each acts from its start to its end (manual 6.2.3, 6.2.5, 6.2.6), and loop avoidance goes with all of them.
#[test]
fn stages_one_after_the_other() {
    let path = [
        Marks::CORRECTION_LEFT.with(Marks::LOOPS),
        Marks::CORRECTION_END,
        Marks::SMOOTHING,
        Marks::CORNERS_END,
        Marks::ROUNDING.with(Marks::CORNERS_END),
        Marks::CORRECTION_RIGHT,
    ];
    assert_eq!(sections(path), [Ok(()); 6]);
    // The end of a stage does not end another.
    let marks = [Marks::CORRECTION_LEFT.with(Marks::CORNERS_END), Marks::SMOOTHING];
    assert!(sections(marks)[1].is_err());
}

/// Each of a corrected corner (G41 … G40), a smoothed one (G51 … G50) and a rounded one (G52 … G50) is as if it were alone.
#[test]
fn sections_of_every_stage() {
    let corrected = "D10 0,0 G41 100,0 100,100 G40";
    let smoothed = "D10 100,0 G51 200,0 200,100 G50";
    let rounded = "D10 200,0 G52 300,0 300,100 G50";
    let behind = |section: &str| section.replacen("D10 ", "r", 1);
    let path = path(&format!("{corrected} {} {}", behind(smoothed), behind(rounded)));
    let marks = path.iter().fold(Marks::default(), |marks, element| marks.with(element.marks));
    let mut checked = Sections::default();
    assert!(path.iter().all(|element| checked.pass(element.marks).is_ok()));
    let together = run(Preparation::for_marks(marks), path);
    let cuts = |path: Vec<PathElement>| -> Vec<Shape> {
        path.into_iter().filter(|e| e.kind == ElementKind::Cut).map(|e| e.shape).collect()
    };
    let alone = |text, marks| cuts(run(Preparation::for_marks(marks), super::path(text)));
    let apart = [
        alone(corrected, Marks::CORRECTION_LEFT),
        alone(smoothed, Marks::SMOOTHING),
        alone(rounded, Marks::ROUNDING),
    ];
    assert_eq!(cuts(together), apart.concat());
    // Vector prep-toolcorr-inner: 0/10 to 90/10 to 90/100. 10 mm before the others' corners their curves begin.
    assert!(close(apart[0][0].end(), [90.0, 10.0, 0.0]));
    let (smooth, round) = (&apart[1][1], &apart[2][1]);
    assert!(close(smooth.start(), [190.0, 0.0, 0.0]) && matches!(smooth, Shape::Cubic(_)));
    assert!(close(round.start(), [290.0, 0.0, 0.0]) && matches!(round, Shape::Arc(_)));
}

#[test]
fn what_marks_ask_for() {
    let none = Preparation::default();
    assert_eq!(Preparation::for_marks(Marks::CORNERS_END), none);
    let loops = Some(DEFAULT_LOOP_WINDOW);
    let tool_radius = Some(ToolRadiusOptions::default());
    for mark in [Marks::CORRECTION_LEFT, Marks::CORRECTION_RIGHT] {
        let expected = Preparation { tool_radius, loops, ..none };
        assert_eq!(Preparation::for_marks(mark.with(Marks::LOOPS)), expected);
    }
    let (smoothing, rounding) = (Some(Smoothing::default()), Some(Rounding::default()));
    assert_eq!(Preparation::for_marks(Marks::SMOOTHING), Preparation { smoothing, ..none });
    assert_eq!(Preparation::for_marks(Marks::ROUNDING), Preparation { rounding, ..none });
    let both = Preparation::for_marks(Marks::ROUNDING.with(Marks::CORRECTION_LEFT));
    assert_eq!(both, Preparation { tool_radius, rounding, ..none });
}

/// Every stage with every other that it goes with.
fn combinations() -> Vec<Preparation> {
    let corners = [Marks::default(), Marks::CORRECTION_LEFT, Marks::SMOOTHING, Marks::ROUNDING];
    let mut all = Vec::new();
    for corner in corners.map(Preparation::for_marks) {
        for loops in [None, Some(DEFAULT_LOOP_WINDOW)] {
            let with = |circular| Preparation { loops, circular, ..corner };
            all.extend([None, Some(CIRCULAR)].map(with));
        }
    }
    all
}

/// A path with marks for all of them.
fn marked_for_all() -> Vec<PathElement> {
    path("D4 0,0 G41 G61 G51 G52 100,0 100,50 m 50,50 50,-50 0,-50 o0,-80:114 G40 G60 G50")
}

#[test]
fn every_combination() {
    for preparation in combinations() {
        let path = run(preparation, marked_for_all());
        let count = |is: &dyn Fn(&PathElement) -> bool| path.iter().filter(|e| is(e)).count();
        assert_eq!(count(&|element| matches!(element.kind, ElementKind::MFunction { .. })), 1);
        assert_eq!(count(&|e| e.kind == ElementKind::Rapid) > 0, preparation.tool_radius.is_some());
        let cubics = count(&|element| matches!(element.shape, Shape::Cubic(_)));
        assert_eq!(cubics > 0, preparation.smoothing.is_some());
        let arcs = count(&|element| matches!(element.shape, Shape::Arc(_)));
        assert_eq!(arcs > 1, preparation.rounding.is_some() || preparation.tool_radius.is_some());
        let slowest = path.iter().map(|element| element.feed).fold(f64::INFINITY, f64::min);
        assert_eq!(slowest < 0.05, preparation.circular.is_some() && arcs + cubics > 1);
        // A loop goes from line 1 to line 5 (the M function is 3).
        let lines: Vec<_> = path.iter().map(|element| element.place.line).collect();
        assert_eq!(lines.contains(&2), preparation.loops.is_none(), "{preparation:?}: {lines:?}");
    }
}

/// The order is the manual's: what correction makes can be a loop, and what loop avoidance leaves has a corner.
#[test]
fn corners_of_what_loop_avoidance_leaves() {
    let rounding = Some(Rounding { distance: 0.02, angle_tolerance: 0.0 });
    let loops = Some(DEFAULT_LOOP_WINDOW);
    let preparation = Preparation { loops, rounding, ..Preparation::default() };
    let path = run(preparation, path("0,0 G61 G52 100,0 100,50 50,50 50,-50"));
    assert_path(&path, "0,0 30,0 50,-20 50,-50");
}

#[test]
fn checked_to_the_end() {
    let notices = Notices::default();
    let rounding = Some(Rounding { distance: 0.02, angle_tolerance: 0.0 });
    let circular = Some(CIRCULAR);
    let preparation = Preparation { rounding, circular, ..Preparation::default() };
    let items = path("0,0 G52 100,0 100,100").into_iter().map(Ok::<_, Error>);
    let checked = preparation.check(items, 1e-6, &notices);
    let velocities: Vec<_> = checked.map(|element| element.unwrap().end_velocity).collect();
    // √(0.1·0.02) into and out of an arc of 20 mm; F 50 mm/s is above it.
    let limit = 0.002_f64.sqrt();
    assert!((velocities[0] - limit).abs() < 1e-9 && (velocities[1] - limit).abs() < 1e-9);
    assert_eq!((velocities.len(), velocities[2]), (3, 0.0));
    assert!(taken(&notices).is_empty());
}

#[test]
fn errors_keep_their_place() {
    for preparation in combinations() {
        let mut stairs = stairs(50);
        for element in &mut stairs {
            element.tool_radius = 0.01;
        }
        stairs[0].marks = marked_for_all()[0].marks;
        let mut items: Vec<_> = stairs.into_iter().map(Ok).collect();
        items.insert(25, Err(Error::Upstream(25)));
        let prepared: Vec<_> = preparation.apply(items.into_iter(), &Notices::default()).collect();
        let at = prepared.iter().position(Result::is_err).unwrap();
        assert_eq!(prepared[at], Err(Error::Upstream(25)));
        let line = |item: Option<&Result<PathElement, Error>>| {
            item.and_then(|item| item.as_ref().ok()).map(|element| element.place.line)
        };
        // Around a corner there is an arc of either neighbour's.
        assert!(matches!(line(prepared.get(at - 1)), Some(25 | 26)), "{preparation:?}");
        assert_eq!(line(prepared.get(at + 1)), Some(26), "{preparation:?}");
        assert_eq!(prepared.iter().filter(|item| item.is_err()).count(), 1);
    }
}

proptest! {
    #[test]
    fn chunks_do_not_matter(
        mut path in random_path(true),
        which in 0_usize..16,
        chunk in 1_usize..4,
        radius in 0.0..0.02,
    ) {
        let preparation = combinations()[which];
        for element in &mut path {
            element.tool_radius = radius;
        }
        if let Some(first) = path.first_mut() {
            first.marks = marked_for_all()[0].marks;
        }
        let whole = run(preparation, path.clone());
        let chunks = path.chunks(chunk).flat_map(<[PathElement]>::to_vec).map(Ok::<_, Error>);
        let mut prepared = preparation.apply(chunks, &Notices::default());
        let mut pieces = Vec::new();
        loop {
            let before = pieces.len();
            pieces.extend(prepared.by_ref().take(chunk).map(Result::unwrap));
            if pieces.len() == before {
                break;
            }
        }
        prop_assert_eq!(whole, pieces);
    }

    #[test]
    fn without_marks_all_of_it_is_the_identity(mut path in random_path(true), which in 0_usize..16, radius in 0.0..0.02, at in 0_usize..12) {
        let preparation = Preparation { circular: None, ..combinations()[which] };
        if let Some(element) = path.get_mut(at) {
            element.kind = ElementKind::Rapid;
            let end = element.end();
            path.insert(at + 1, m_function(end));
        }
        for element in &mut path {
            element.tool_radius = radius;
        }
        prop_assert_eq!(run(preparation, path.clone()), path);
    }
}
