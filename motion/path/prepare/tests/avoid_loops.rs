//! Tests of loop avoidance, [`AvoidLoops`].

use super::{
    Error, assert_path, close, cut, element, ends, extras, length, line, path, random_path, stairs,
    switched, switches, through, with_extra, words,
};
use crate::prepare::{AvoidLoops, Notice, Notices};
use crate::{ElementKind, Ellipse, Marks, PathElement, Shape};
use nalgebra::{Point2, Point3, Vector2};
use proptest::prelude::*;
use std::cell::Cell;
use std::f64::consts::TAU;
use std::num::NonZeroUsize;

fn marked(elements: Vec<PathElement>) -> Vec<PathElement> {
    super::marked(elements, Marks::LOOPS, Marks::LOOPS_END)
}

fn avoid(elements: Vec<PathElement>) -> (Vec<PathElement>, Vec<Notice>) {
    let (path, notices) = through(marked(elements), AvoidLoops::new);
    assert!(path.iter().all(|element| element.marks == Marks::default()));
    (path, notices)
}

const LOOP: &str = "0,0 100,0 100,50 50,50 50,-50";

/// What is reported of the loop of vector `prep-avoidloop`.
#[test]
fn a_loop_is_reported() {
    let (path, notices) = avoid(path(LOOP));
    let lines: Vec<_> = path.iter().map(|element| element.place.line).collect();
    assert_eq!(lines, [1, 4]);
    let [Notice::LoopCut { place, resumed, length }] = notices[..] else { panic!("{notices:?}") };
    assert_eq!((place.line, resumed.line), (1, 4));
    assert!((length - 0.2).abs() <= 1e-11);
}

/// Either mark within the loop: it begins before the first, or ends behind the last element that is looked at.
#[test]
fn only_between_the_marks() {
    for elements in ["0,0 100,0 G61 100,50 50,50 50,-50", "0,0 G61 100,0 100,50 50,50 G60 50,-50"] {
        assert_eq!(through(path(elements), AvoidLoops::new).0.len(), 4);
    }
}

/// Of several crossings the first along the element; one through a corner of either path is like any other.
#[test]
fn crossings_are_cut() {
    for (elements, expected, loops) in [
        ("0,0 100,0 100,50 70,50 70,-20 40,-20 40,30 20,30 20,10 60,10", "0,0 40,0 40,10 60,10", 2),
        ("0,0 100,0 100,50 50,50 50,0 40,-50", "0,0 50,0 40,-50", 1),
        ("0,0 50,0 100,10 100,50 50,50 50,-50", "0,0 50,0 50,-50", 1),
        // Along +X, a three-quarter turn back across the line.
        ("0,0 100,0 o100,30:270 70,-50", "0,0 70,0 70,-50", 1),
    ] {
        let (after, notices) = avoid(path(elements));
        assert_path(&after, expected);
        assert_eq!(notices.len(), loops);
    }
}

/// Two circles of 50 mm, 60 mm apart: they cross 40 mm off the line of centres.
#[test]
fn arcs_that_cross_stay_arcs() {
    let (path, _) = avoid(path("-50,0 o0,0:216 60,50 o60,0:180"));
    assert_path(&path, "-50,0 30,-40 60,-50");
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

#[test]
fn what_is_no_loop() {
    for elements in [
        // Touching is not crossing, nor is meeting at corners: contours stay closed, with a way in and out.
        "0,0 50,0 50,50 0,50 0,0",
        "-20,-10 0,0 50,0 50,50 0,50 0,0 -10,-20",
        // From the middle of a side, with the last bit cut twice, and off to the side.
        "25,0 50,0 50,50 0,50 0,0 30,0 30,-20",
        // Down to a side and back.
        "0,0 50,0 50,30 25,0 0,30",
        "0,0 50,0 0,0 0,10",
        // Z apart; a positioning or a jump.
        "0,0 100,0 100,50,1 50,50 50,-50",
        "0,0 r100,0 100,50 50,50 50,-50",
        "0,0 100,0 100,50 50,50 r50,-50",
        "0,0 100,0 j100,50 50,50 50,-50",
        // What a probe feels is part of what the program does: a loop that it lies on stays.
        "0,0 p100,0 100,50 50,50 50,-50",
        "0,0 100,0 p100,50 50,50 50,-50",
        "0,0 100,0 100,50 p50,50 50,-50",
        "0,0 100,0 100,50 50,50 p50,-50",
    ] {
        let path = path(elements);
        assert_eq!(avoid(path.clone()), (path, vec![]), "{elements}");
    }
    let mut items: Vec<_> = marked(path(LOOP)).into_iter().map(Ok).collect();
    items.insert(2, Err(Error::Upstream(1)));
    let after: Vec<_> = AvoidLoops::new(items.into_iter(), Notices::default()).collect();
    assert_eq!((after.len(), &after[2]), (5, &Err(Error::Upstream(1))));
    // A positioning within a loop goes with it.
    let (after, notices) = avoid(path("0,0 100,0 100,50 r50,50 50,-50"));
    assert_eq!((after.len(), notices.len()), (2, 1));
}

#[test]
fn nothing_is_lost_in_a_loop() {
    let mut path = path("0,0 100,0 100,50 m 50,50 50,-50");
    for (index, on) in
        [(0, &[(1, 0.25), (2, 0.75)][..]), (3, &[(3, 0.5)]), (4, &[(4, 0.2), (5, 0.75)])]
    {
        path[index] = switched(path[index].clone(), on);
    }
    let (dwell, corner) = (ElementKind::Dwell { time_ns: 5 }, path[2].end().into());
    path.insert(3, line(dwell, corner, corner, 0.05));
    let (path, notices) = avoid(path);
    let kinds: Vec<_> = path.iter().map(|element| element.kind).collect();
    let m = ElementKind::MFunction { number: 8 };
    assert_eq!(kinds, [ElementKind::Cut, m, dwell, ElementKind::Cut]);
    assert!(close(path[1].start(), [50.0, 0.0, 0.0]));
    assert_eq!(switches(&path[0]), [(1, 0.5)]);
    // 5 is 75 mm along 100, so 25 along the last 50. There is room for two more.
    assert_eq!(switches(&path[3]), [(2, 0.0), (3, 0.0), (5, 0.5)]);
    let lost: Vec<_> = notices.iter().map(Notice::rule).collect();
    assert_eq!(lost, ["switch-lost", "loop-cut"]);
}

#[test]
fn extra_axes_go_on_from_the_crossing() {
    let ends = [(0.0, 10.0), (10.0, 20.0), (20.0, 30.0), (30.0, 40.0)];
    let turned = path(LOOP).into_iter().zip(ends).map(|(it, ends)| with_extra(it, ends));
    let (path, _) = avoid(turned.collect());
    assert_eq!(extras(&path), [(0.0, 5.0), (5.0, 40.0)].map(Some));
}

/// `iStatus` is that behind the element taken in last.
#[test]
fn whether_it_looks_is_told() {
    let points = |range: std::ops::Range<u8>| words(range.map(|x| [f64::from(x), 0.0]));
    let [before, within, behind] = [0..21, 21..41, 41..60].map(points);
    let path = path(&format!("{before} G61 {within} G60 {behind}"));
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

#[test]
fn the_window() {
    let cut_with = |window: usize| {
        let window = NonZeroUsize::new(window).unwrap();
        let stage = |items, notices| AvoidLoops::with_window(items, window, notices);
        through(marked(path(LOOP)), stage).0.len()
    };
    assert_eq!([cut_with(1), cut_with(2), cut_with(3)], [4, 4, 2]);
    let pulled = Cell::new(0_u32);
    let mut stairs = stairs(1000);
    stairs[0].marks = Marks::LOOPS;
    let stairs = stairs.into_iter().map(Ok::<_, Error>);
    let stairs = stairs.inspect(|_| pulled.set(pulled.get() + 1));
    let window = NonZeroUsize::new(7).unwrap();
    let mut path = AvoidLoops::with_window(stairs, window, Notices::default());
    for handed_out in 1..=900 {
        assert!(path.next().is_some());
        assert!(pulled.get() <= handed_out + 7, "{} at {handed_out}", pulled.get());
    }
}

proptest! {
    #[test]
    fn no_loops_are_left(path in random_path(true)) {
        let (after, _) = avoid(path.clone());
        prop_assert_eq!(ends(&after), ends(&path));
        prop_assert!(length(&after) <= length(&path) + 1e-9);
        let (again, notices) = avoid(after.clone());
        prop_assert_eq!(notices, vec![]);
        prop_assert_eq!(again, after);
    }
}
