//! Tests of loop avoidance, [`AvoidLoops`].

use super::{
    Error, PROBE, VECTOR_TOLERANCE, arc, assert_continuous, assert_points, close, cut, element,
    line, m_function, numbered, polyline, random_path, taken,
};
use crate::prepare::{AvoidLoops, Notice, Notices};
use crate::{Details, ElementKind, Ellipse, ExtraAxes, Marks, PathElement, Shape, Switch};
use nalgebra::{Point2, Point3, Vector2};
use proptest::prelude::*;
use std::cell::Cell;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::num::NonZeroUsize;

fn marked(mut elements: Vec<PathElement>) -> Vec<PathElement> {
    if let Some(first) = elements.first_mut() {
        first.marks = first.marks.with(Marks::LOOPS);
    }
    if let Some(last) = elements.last_mut() {
        last.marks = last.marks.with(Marks::LOOPS_END);
    }
    elements
}

fn avoid(elements: Vec<PathElement>) -> (Vec<PathElement>, Vec<Notice>) {
    let notices = Notices::default();
    let items = marked(elements).into_iter().map(Ok::<_, Error>);
    let path: Vec<_> = AvoidLoops::new(items, notices.clone()).map(Result::unwrap).collect();
    assert_continuous(&path);
    assert!(path.iter().all(|element| element.marks == Marks::default()));
    (path, taken(&notices))
}

const LOOP: [[f64; 2]; 5] = [[0.0, 0.0], [100.0, 0.0], [100.0, 50.0], [50.0, 50.0], [50.0, -50.0]];

/// Vector `prep-avoidloop`: 0/0 → 100/0 → 100/50 → 50/50 → 50/−50.
#[test]
fn prep_avoidloop() {
    let (path, notices) = avoid(polyline(&LOOP));
    assert_points(&path, &[[0.0, 0.0], [50.0, 0.0], [50.0, -50.0]]);
    let lines: Vec<_> = path.iter().map(|element| element.place.line).collect();
    assert_eq!(lines, [1, 4]);
    let [Notice::LoopCut { place, resumed, length }] = notices[..] else { panic!("{notices:?}") };
    assert_eq!((place.line, resumed.line), (1, 4));
    assert!((length - 0.2).abs() <= VECTOR_TOLERANCE);
}

#[test]
fn only_between_the_marks() {
    let items: Vec<_> = polyline(&LOOP).into_iter().map(Ok::<_, Error>).collect();
    let same: Vec<_> = AvoidLoops::new(items.clone().into_iter(), Notices::default()).collect();
    assert_eq!(same, items);
    // Either mark within the loop: it begins before the first, or ends behind the last element that is looked at.
    for (index, mark) in [(1, Marks::LOOPS), (2, Marks::LOOPS_END)] {
        let mut path = polyline(&LOOP);
        path[0].marks = if index == 2 { Marks::LOOPS } else { Marks::default() };
        path[index].marks = mark;
        let items = path.into_iter().map(Ok::<_, Error>);
        assert_eq!(AvoidLoops::new(items, Notices::default()).count(), 4);
    }
}

/// Of several crossings the first along the element; what comes after may cross again.
#[test]
fn loops_in_loops() {
    let (path, notices) = avoid(polyline(&[
        [0.0, 0.0],
        [100.0, 0.0],
        [100.0, 50.0],
        [70.0, 50.0],
        [70.0, -20.0],
        [40.0, -20.0],
        [40.0, 30.0],
        [20.0, 30.0],
        [20.0, 10.0],
        [60.0, 10.0],
    ]));
    assert_points(&path, &[[0.0, 0.0], [40.0, 0.0], [40.0, 10.0], [60.0, 10.0]]);
    assert_eq!(notices.len(), 2);
}

#[test]
fn lines_and_arcs() {
    // Along +X, a three-quarter turn back across the line.
    let (path, _) = avoid(vec![
        cut([0.0; 3], [0.1, 0.0, 0.0], 0.05),
        arc([0.1, 0.03, 0.0], 0.03, -FRAC_PI_2, 1.5 * PI, 0.05),
        cut([0.07, 0.03, 0.0], [0.07, -0.05, 0.0], 0.05),
    ]);
    assert_points(&path, &[[0.0, 0.0], [70.0, 0.0], [70.0, -50.0]]);
    // Two circles of 50 mm, 60 mm apart: they cross 40 mm off the line of centres.
    let (path, _) = avoid(vec![
        arc([0.0; 3], 0.05, -PI, 1.2 * PI, 0.05),
        cut(arc([0.0; 3], 0.05, -PI, 1.2 * PI, 0.05).end().into(), [0.06, 0.05, 0.0], 0.05),
        arc([0.06, 0.0, 0.0], 0.05, FRAC_PI_2, PI, 0.05),
    ]);
    assert_eq!(path.len(), 2);
    assert!(close(path[0].end(), [30.0, -40.0, 0.0]) && close(path[1].end(), [60.0, -50.0, 0.0]));
    for (element, center) in path.iter().zip([0.0, 60.0]) {
        let Shape::Arc(arc) = &element.shape else { panic!("{element:?}") };
        assert!(close(arc.center(), [center, 0.0, 0.0]));
        assert!((arc.radius() - 0.05).abs() < 1e-12 && (arc.end_radius() - 0.05).abs() < 1e-12);
    }
}

/// A line across the upper half of an ellipse (a 50, b 30) at y = 24: x = ±50·√(1 − 0.64) = ±30.
#[test]
fn curves_are_cut_to_rounding() {
    let start = Point3::new(0.05, 0.0, 0.0);
    let ellipse = Ellipse::new(start, start, Point2::origin(), Vector2::new(0.05, 0.0), 0.03, TAU);
    let (path, _) = avoid(vec![
        cut([0.05, -0.1, 0.0], start.into(), 0.05),
        element(ElementKind::Cut, Shape::Ellipse(Box::new(ellipse)), 0.05),
        cut(start.into(), [0.05, 0.024, 0.0], 0.05),
        cut([0.05, 0.024, 0.0], [-0.1, 0.024, 0.0], 0.05),
    ]);
    assert_eq!(path.len(), 3);
    assert!(close(path[1].end(), [30.0, 24.0, 0.0]));
    assert!(matches!(path[1].shape, Shape::Ellipse(_)));
}

/// Touching is not crossing, nor is meeting at corners: contours stay closed, with a way in and out.
#[test]
fn what_is_no_loop() {
    let square = [[0.0, 0.0], [50.0, 0.0], [50.0, 50.0], [0.0, 50.0], [0.0, 0.0]];
    let mut with_ways = vec![[-20.0, -10.0]];
    with_ways.extend(square);
    with_ways.push([-10.0, -20.0]);
    // From the middle of a side, with the last bit cut twice, and off to the side.
    let overlapping = [
        [25.0, 0.0],
        [50.0, 0.0],
        [50.0, 50.0],
        [0.0, 50.0],
        [0.0, 0.0],
        [30.0, 0.0],
        [30.0, -20.0],
    ];
    // Down to a side and back.
    let touching = [[0.0, 0.0], [50.0, 0.0], [50.0, 30.0], [25.0, 0.0], [0.0, 30.0]];
    let back = [[0.0, 0.0], [50.0, 0.0], [0.0, 0.0], [0.0, 10.0]];
    for points in [&square[..], &with_ways, &overlapping, &touching, &back] {
        let path = polyline(points);
        let (after, notices) = avoid(path.clone());
        assert_eq!(notices, [], "{points:?}");
        assert_eq!(after, path);
    }
}

/// Through a corner of the other path is a crossing like any other.
#[test]
fn crossings_at_corners() {
    // The later path has a corner on the earlier line.
    let (path, _) = avoid(polyline(&[
        [0.0, 0.0],
        [100.0, 0.0],
        [100.0, 50.0],
        [50.0, 50.0],
        [50.0, 0.0],
        [40.0, -50.0],
    ]));
    assert_points(&path, &[[0.0, 0.0], [50.0, 0.0], [40.0, -50.0]]);
    // The earlier path has a corner on the later line.
    let (path, _) = avoid(polyline(&[
        [0.0, 0.0],
        [50.0, 0.0],
        [100.0, 10.0],
        [100.0, 50.0],
        [50.0, 50.0],
        [50.0, -50.0],
    ]));
    assert_points(&path, &[[0.0, 0.0], [50.0, 0.0], [50.0, -50.0]]);
}

/// Z apart, a positioning, a jump or an error in between: no loop.
#[test]
fn what_does_not_cross() {
    let raised = {
        let mut path = polyline(&LOOP);
        path[1] = cut([0.1, 0.0, 0.0], [0.1, 0.05, 0.001], 0.05);
        path[2] = cut([0.1, 0.05, 0.001], [0.05, 0.05, 0.001], 0.05);
        path[3] = cut([0.05, 0.05, 0.001], [0.05, -0.05, 0.001], 0.05);
        numbered(path)
    };
    let of_kind = |index: usize, kind| {
        let mut path = polyline(&LOOP);
        path[index].kind = kind;
        path
    };
    for path in [
        raised,
        of_kind(0, ElementKind::Rapid),
        of_kind(3, ElementKind::Rapid),
        of_kind(1, ElementKind::Jump),
    ] {
        let (after, notices) = avoid(path.clone());
        assert_eq!((after, notices), (path, vec![]));
    }
    let mut items: Vec<_> = marked(polyline(&LOOP)).into_iter().map(Ok).collect();
    items.insert(2, Err(Error::Upstream(1)));
    let after: Vec<_> = AvoidLoops::new(items.into_iter(), Notices::default()).collect();
    assert_eq!(after.len(), 5);
    assert_eq!(after[2], Err(Error::Upstream(1)));
    // A positioning within a loop goes with it.
    let (after, notices) = avoid(of_kind(2, ElementKind::Rapid));
    assert_eq!((after.len(), notices.len()), (2, 1));
}

/// M functions and dwells of a loop are done at the crossing, its switches too.
#[test]
fn nothing_is_lost_in_a_loop() {
    let switched = |mut element: PathElement, number: u8, at: f64| {
        let details = element.details.get_or_insert_default();
        assert!(details.switches.add(Switch { number, on: true, at }));
        element
    };
    let mut path = polyline(&LOOP);
    path[0] = switched(switched(path[0].clone(), 1, 0.25), 2, 0.75);
    path[2] = switched(path[2].clone(), 3, 0.5);
    path[3] = switched(switched(path[3].clone(), 4, 0.2), 5, 0.75);
    let dwell = ElementKind::Dwell { time_ns: 5 };
    let corner = [0.1, 0.05, 0.0];
    path.insert(2, line(dwell, corner, corner, 0.05));
    path.insert(2, m_function(corner.into()));
    let notices = Notices::default();
    let items = marked(path).into_iter().map(Ok::<_, Error>);
    let path: Vec<_> = AvoidLoops::new(items, notices.clone()).map(Result::unwrap).collect();
    assert_continuous(&path);
    let kinds: Vec<_> = path.iter().map(|element| element.kind).collect();
    let m = ElementKind::MFunction { number: 8 };
    assert_eq!(kinds, [ElementKind::Cut, m, dwell, ElementKind::Cut]);
    assert!(close(path[1].start(), [50.0, 0.0, 0.0]));
    let switches = |element: &PathElement| -> Vec<_> {
        element
            .switches()
            .iter()
            .map(|switch| (switch.number, (switch.at * 1e9).round() / 1e9))
            .collect()
    };
    assert_eq!(switches(&path[0]), [(1, 0.5)]);
    // 5 is 75 mm along 100, so 25 along the last 50. There is room for two more.
    let mut found = switches(&path[3]);
    found.sort_by_key(|(number, _)| *number);
    assert_eq!(found, [(2, 0.0), (3, 0.0), (5, 0.5)]);
    let lost: Vec<_> = taken(&notices).iter().map(Notice::rule).collect();
    assert_eq!(lost, ["switch-lost", "loop-cut"]);
}

/// What a probe feels is part of what the program does: a loop that it lies on stays.
#[test]
fn probing_moves_are_no_loops() {
    for index in 0..polyline(&LOOP).len() {
        let mut path = polyline(&LOOP);
        path[index].kind = PROBE;
        let notices = Notices::default();
        let items = marked(path.clone()).into_iter().map(Ok::<_, Error>);
        let found: Vec<_> = AvoidLoops::new(items, notices.clone()).map(Result::unwrap).collect();
        assert_eq!(found, path, "{index}");
        assert_eq!(taken(&notices), []);
    }
}

#[test]
fn extra_axes_go_on_from_the_crossing() {
    let extra = |start: f64, end: f64| {
        let wide = |p: f64| [p, 0.0, 0.0, 0.0, 0.0];
        let extra = Some(ExtraAxes { start: wide(start), end: wide(end) });
        Some(Box::new(Details { extra, ..Details::default() }))
    };
    let mut path = polyline(&LOOP);
    for (element, (start, end)) in
        path.iter_mut().zip([(0.0, 10.0), (10.0, 20.0), (20.0, 30.0), (30.0, 40.0)])
    {
        element.details = extra(start, end);
    }
    let (path, _) = avoid(path);
    let found: Vec<_> =
        path.iter().filter_map(|element| element.extra()).map(|e| (e.start[0], e.end[0])).collect();
    assert_eq!(found, [(0.0, 5.0), (5.0, 40.0)]);
}

/// `iStatus` is that behind the element taken in last.
#[test]
fn whether_it_looks_is_told() {
    let points: Vec<_> = (0..60).map(|x| [f64::from(x), 0.0]).collect();
    let mut path = polyline(&points);
    path[20].marks = Marks::LOOPS;
    path[39].marks = Marks::LOOPS_END;
    let window = NonZeroUsize::new(4).unwrap();
    let items = path.into_iter().map(Ok::<_, Error>);
    let mut stage = AvoidLoops::with_window(items, window, Notices::default());
    assert!(!stage.is_on());
    let on: Vec<_> = std::iter::from_fn(|| stage.next().map(|_| stage.is_on())).collect();
    let first = on.iter().position(|on| *on).unwrap();
    assert!((15..=20).contains(&first), "{first}");
    // 19 elements, of which the first ones are taken in together to fill the window.
    let count = on.iter().filter(|on| **on).count();
    assert!((15..=19).contains(&count) && on[first..first + count].iter().all(|on| *on), "{count}");
}

/// The window bounds the loops found and the elements held.
#[test]
fn the_window() {
    let cut_with = |window: usize| {
        let window = NonZeroUsize::new(window).unwrap();
        let items = marked(polyline(&LOOP)).into_iter().map(Ok::<_, Error>);
        AvoidLoops::with_window(items, window, Notices::default()).count()
    };
    assert_eq!([cut_with(1), cut_with(2), cut_with(3)], [4, 4, 2]);
    let pulled = Cell::new(0_u32);
    let stairs = (0..1000_u32).map(|n| {
        pulled.set(pulled.get() + 1);
        let [x, y] = [n.div_ceil(2), n / 2].map(f64::from);
        let [to_x, to_y] = [(n + 1).div_ceil(2), n.div_ceil(2)].map(f64::from);
        let marks = if n == 0 { Marks::LOOPS } else { Marks::default() };
        Ok::<_, Error>(PathElement { marks, ..cut([x, y, 0.0], [to_x, to_y, 0.0], 0.05) })
    });
    let window = NonZeroUsize::new(7).unwrap();
    let mut path = AvoidLoops::with_window(stairs, window, Notices::default());
    for handed_out in 1..=900 {
        assert!(path.next().is_some());
        assert!(pulled.get() <= handed_out + 7, "{} at {handed_out}", pulled.get());
    }
}

proptest! {
    /// What comes out goes from the same start to the same end without a break, and has nothing more to cut.
    #[test]
    fn no_loops_are_left(path in random_path(true)) {
        let ends = |path: &[PathElement]| {
            path.first().map(PathElement::start).zip(path.last().map(PathElement::end))
        };
        let (after, _) = avoid(path.clone());
        prop_assert_eq!(ends(&after), ends(&path));
        let length = |path: &[PathElement]| path.iter().map(PathElement::length).sum::<f64>();
        prop_assert!(length(&after) <= length(&path) + 1e-9);
        let (again, notices) = avoid(after.clone());
        prop_assert_eq!(notices, vec![]);
        prop_assert_eq!(again, after);
    }

    #[test]
    fn without_marks_it_is_the_identity(path in random_path(true)) {
        let items: Vec<_> = path.into_iter().map(Ok::<_, Error>).collect();
        let same: Vec<_> = AvoidLoops::new(items.clone().into_iter(), Notices::default()).collect();
        prop_assert_eq!(same, items);
    }
}
