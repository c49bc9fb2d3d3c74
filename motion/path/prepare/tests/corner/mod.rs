//! Tests of corner rounding and smoothing, [`RoundPath`] and [`SmoothPath`].

use super::{
    Error, Item, assert_continuous, assert_path, ends, extras, length, path, random_path, switched,
    switches, through, with_extra, with_many,
};
use crate::prepare::{
    CornerError, Notice, Notices, RoundPath, Rounding, SmoothPath, Smoothing, Stage,
};
use crate::{Marks, PathElement, Shape};
use proptest::prelude::*;
use std::f64::consts::PI;

mod smooth;

fn round_all(items: Vec<Item>, style: Rounding) -> Vec<Item> {
    RoundPath::new(items.into_iter(), style, Notices::default()).collect()
}

fn rounded(path: Vec<PathElement>, style: Rounding) -> (Vec<PathElement>, Vec<Notice>) {
    through(path, |items, notices| RoundPath::new(items, style, notices))
}

fn smoothed(path: Vec<PathElement>, style: Smoothing) -> (Vec<PathElement>, Vec<Notice>) {
    through(path, |items, notices| SmoothPath::new(items, style, notices))
}

/// The elements with every corner between them marked for `begin`.
fn marked(elements: Vec<PathElement>, begin: Marks) -> Vec<PathElement> {
    super::marked(elements, begin, Marks::CORNERS_END)
}

fn round(elements: Vec<PathElement>, distance: f64) -> Vec<PathElement> {
    rounded(marked(elements, Marks::ROUNDING), Rounding { distance, angle_tolerance: 0.01 }).0
}

fn assert_tangent(path: &[PathElement]) {
    for pair in path.windows(2) {
        let kink = (pair[0].end_tangent() - pair[1].start_tangent()).norm();
        assert!(kink < 1e-9, "kink of {kink} between {:?} and {:?}", pair[0], pair[1]);
    }
}

/// Heights go on linearly along each piece, so that only X and Y are without a kink.
fn assert_tangent_in_plane(path: &[PathElement]) {
    for pair in path.windows(2) {
        let [a, b] = [pair[0].end_tangent(), pair[1].start_tangent()]
            .map(|tangent| tangent.xy().normalize());
        assert!((a - b).norm() < 1e-9, "between {:?} and {:?}", pair[0], pair[1]);
    }
}

const STYLE: Rounding = Rounding { distance: 0.02, angle_tolerance: 0.0 };

const CORNER: &str = "0,0 100,0 100,100";

#[test]
fn probing_moves_keep_their_corners() {
    for elements in
        ["D20 0,0 p100,0 150,87", "D20 0,0 100,0 p150,87", "D20 0,0 100,0 p100,0 150,87"]
    {
        let path = path(elements);
        assert_eq!(round(path.clone(), 0.0), path);
        let marked = marked(path.clone(), Marks::SMOOTHING);
        assert_eq!(smoothed(marked, Smoothing::default()).0, path);
    }
}

/// The adapter's distance, which then dominates D, or D; the marks are obeyed and gone.
#[test]
fn the_distance_dominates_the_radius() {
    for (distance, elements) in
        [(0.02, CORNER), (0.02, "D5 0,0 100,0 100,100"), (0.0, "D20 0,0 100,0 100,100")]
    {
        let path = round(path(elements), distance);
        assert_path(&path, "0,0 80,0 100,20 100,100");
        assert!(path.iter().all(|element| element.marks == Marks::default()));
    }
}

#[test]
fn rounded_corners_are_tangent_on_either_side() {
    for turn_deg in [-170, -90, -30, -1, 1, 30, 90, 170] {
        let turn = f64::from(turn_deg).to_radians();
        let end = [100.0 + 80.0 * turn.cos(), 80.0 * turn.sin()];
        let path = round(path(&format!("0,0 100,0 {},{}", end[0], end[1])), 0.01);
        assert_eq!(path.len(), 3, "turn of {turn_deg}°");
        assert_tangent(&path);
        let Shape::Arc(arc) = &path[1].shape else { panic!("{:?}", path[1]) };
        assert!((arc.sweep() - turn).abs() < 1e-12);
    }
}

/// Smoothing and rounding need G51 or G52, G50 and D (manual 3.4): without D no corner can be cut. One notice a section.
#[test]
fn a_distance_of_zero_is_noticed() {
    let mut path = path("0,0 G52 100,0 100,30 0,30 0,0 G50");
    let (place, stage) = (path[0].place, Stage::Rounding);
    let (after, notices) = rounded(path.clone(), Rounding::default());
    assert_eq!((after.len(), notices), (4, vec![Notice::NoRadius { place, stage }]));
    path[0].marks = Marks::SMOOTHING;
    let (after, notices) = smoothed(path, Smoothing::default());
    let messages: Vec<_> = notices.iter().map(ToString::to_string).collect();
    let message = "line 1: smoothing has no effect, because D is 0 mm; put the distance as D into the block of G51";
    assert_eq!((after.len(), messages), (4, vec![message.to_owned()]));
}

/// No more than half of either line goes (manual 6.2.6), so that the next corner has the other half: nothing is left of the
/// line between the corners.
#[test]
fn half_of_the_shorter_line_is_the_most() {
    let path = path("0,0 100,0 100,30 0,30");
    for path in [round(path.clone(), 0.02), smooth::smooth(path, 0.02)] {
        assert_path(&path, "0,0 85,0 100,15 85,30 0,30");
    }
}

#[test]
fn what_stays_as_it_is() {
    for elements in [
        "0,0 r100,0 100,100",
        "0,0 100,0 r100,100",
        "0,0 100,0 100,0,-100",
        "0,0 100,0 0,0",
        "0,0 100,0 200,0.9",
        "0,0 100,0 j100,50 0,50",
    ] {
        assert_path(&round(path(elements), 0.02), elements);
    }
    // No distance at all.
    assert_eq!(round(path(CORNER), 0.0).len(), 2);
    // Corners outside the marks; a mark behind the last corner.
    let path = path("0,0 1000,0 G52 1000,1000 2000,1000 G50 2000,2000");
    let lines: Vec<_> = rounded(path, STYLE).0.iter().map(|element| element.place.line).collect();
    assert_eq!(lines, [1, 2, 2, 3, 4]);
}

#[test]
fn height_and_extra_axes_go_on_linearly() {
    let mut path = path("0,0 100,0,10 100,100,0");
    for (element, ends) in path.iter_mut().zip([(0.0, 10.0), (10.0, 50.0)]) {
        *element = with_extra(element.clone(), ends);
    }
    path[1].feed = 0.03;
    let path = round(path, 0.02);
    assert_path(&path, "0,0 80,0,8 100,20,8 100,100,0");
    let Some((start, end)) = extras(&path)[1] else { panic!("{path:?}") };
    assert!((start - 8.0).abs() < 1e-12 && (end - 18.0).abs() < 1e-12);
    assert_eq!(path[1].feed, 0.03);
}

#[test]
fn m_functions_move_behind_the_corner() {
    let elements = marked(path("0,0 100,0 m 100,0 100,100"), Marks::ROUNDING);
    let mut items: Vec<_> = elements.into_iter().map(Ok).collect();
    items.insert(2, Err(Error::Upstream(7)));
    let rounded = round_all(items, STYLE);
    assert_eq!(rounded[3], Err(Error::Upstream(7)));
    let path: Vec<_> = rounded.into_iter().flatten().collect();
    assert_continuous(&path);
    assert_path(&path, "0,0 80,0 100,20 m100,20 100,20 100,100");
    assert!(matches!(path[1].shape, Shape::Arc(_)));
}

/// The window is bounded: with very many of them in a row the corner stays.
#[test]
fn very_many_m_functions() {
    let many = with_many(marked(path(CORNER), Marks::ROUNDING), 100_000);
    assert_eq!(rounded(many, STYLE).0.len(), 100_002);
}

/// The corner with switches on either line.
fn switched_corner(first: &[(u8, f64)], second: &[(u8, f64)]) -> Vec<PathElement> {
    let lines = path(CORNER).into_iter().zip([first, second]);
    lines.map(|(line, switches)| switched(line, switches)).collect()
}

#[test]
fn switches_on_what_is_cut_off_move_onto_the_arc() {
    let lines = switched_corner(&[(1, 0.4), (2, 0.78), (3, 0.9)], &[(4, 0.1), (5, 0.6)]);
    let found: Vec<_> = round(lines, 0.02).iter().map(switches).collect();
    // 40 mm and 78 mm of 80; 90 mm is in the middle of the first half of the arc, 10 mm of the second.
    let expected = [vec![(1, 0.5), (2, 0.975)], vec![(3, 0.25), (4, 0.75)], vec![(5, 0.5)]];
    assert_eq!(found, expected);
}

#[test]
fn switches_without_room_are_told() {
    let lines = switched_corner(&[(1, 0.85), (2, 0.9), (3, 0.95)], &[(4, 0.1), (5, 0.15)]);
    let (path, notices) = rounded(marked(lines, Marks::ROUNDING), STYLE);
    assert_eq!(path[1].switches().len(), 3);
    let lost: Vec<_> = notices.iter().map(ToString::to_string).collect();
    let said = "on lies on a removed part of the path, and the remaining path is too short for it";
    assert_eq!(lost, [4, 5].map(|number| format!("line 2: switch {number} {said}")));
}

#[test]
fn impossible_distances_are_errors_at_their_place() {
    for distance in [-0.001, f64::NAN] {
        let mut path = marked(path(CORNER), Marks::ROUNDING);
        for element in &mut path {
            element.tool_radius = distance;
        }
        let found = round_all(path.into_iter().map(Ok).collect(), Rounding::default());
        let [_, Err(Error::Corner(CornerError::Distance { place, distance: at }))] = found[..2]
        else {
            panic!("{found:?}");
        };
        assert_eq!((found.len(), place.line, at.to_bits()), (3, 1, distance.to_bits()));
    }
    // A negative distance of the adapter itself.
    let path = marked(path(CORNER), Marks::ROUNDING);
    let style = Rounding { distance: -0.01, angle_tolerance: PI / 8.0 };
    let rounded = round_all(path.into_iter().map(Ok).collect(), style);
    assert_eq!(rounded.iter().filter(|item| item.is_err()).count(), 1);
}

proptest! {
    /// No turn at either end of what has been inserted (it belongs to the block of the element before).
    #[test]
    fn random_corners_are_tangent(
        lines in random_path(false), curves in random_path(true), distance in 0.001..0.05, edge_distance in 0.001..0.05,
    ) {
        let angle_tolerance = 1e-3;
        let (rounded, _) = rounded(marked(lines.clone(), Marks::ROUNDING), Rounding { distance, angle_tolerance });
        let style = Smoothing { edge_distance, angle_tolerance };
        let (smoothed, _) = smoothed(marked(curves.clone(), Marks::SMOOTHING), style);
        // Nothing is longer than before.
        prop_assert!(length(&rounded) <= length(&lines) + 1e-9);
        for (after, before) in [(rounded, lines), (smoothed, curves)] {
            prop_assert_eq!(ends(&after), ends(&before));
            let inserted = after.windows(3).filter(|triple| triple[0].place == triple[1].place);
            inserted.for_each(assert_tangent_in_plane);
        }
    }
}
