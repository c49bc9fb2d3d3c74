//! Tests of corner rounding and smoothing, [`RoundPath`] and [`SmoothPath`].

use super::{
    Error, assert_continuous, assert_path, extras, m_function, path, switched, switches, taken,
    with_extra,
};
use crate::prepare::{
    CornerError, Notice, Notices, RoundPath, Rounding, SmoothPath, Smoothing, Stage,
};
use crate::{Marks, PathElement, Shape};
use std::f64::consts::PI;

mod random;
mod smooth;

fn round_all(
    elements: Vec<Result<PathElement, Error>>,
    style: Rounding,
) -> Vec<Result<PathElement, Error>> {
    RoundPath::new(elements.into_iter(), style, Notices::default()).collect()
}

/// The elements with every corner between them marked for `begin`.
fn marked(mut elements: Vec<PathElement>, begin: Marks) -> Vec<PathElement> {
    if let Some(first) = elements.first_mut() {
        first.marks = first.marks.with(begin);
    }
    if let Some(last) = elements.last_mut() {
        last.marks = last.marks.with(Marks::CORNERS_END);
    }
    elements
}

fn round(elements: Vec<PathElement>, distance: f64) -> Vec<PathElement> {
    let elements = marked(elements, Marks::ROUNDING).into_iter().map(Ok).collect();
    let style = Rounding { distance, angle_tolerance: 0.01 };
    let path: Vec<_> = round_all(elements, style).into_iter().map(Result::unwrap).collect();
    assert_continuous(&path);
    path
}

const CORNER: &str = "0,0 100,0 100,100";

/// Also one of length zero, which has tripped where it began.
#[test]
fn probing_moves_keep_their_corners() {
    for elements in
        ["D20 0,0 p100,0 150,87", "D20 0,0 100,0 p150,87", "D20 0,0 100,0 p100,0 150,87"]
    {
        let path = path(elements);
        assert_eq!(round(path.clone(), 0.0), path);
        let marked = marked(path.clone(), Marks::SMOOTHING).into_iter().map(Ok::<_, Error>);
        let smooth = SmoothPath::new(marked, Smoothing::default(), Notices::default());
        assert_eq!(smooth.map(Result::unwrap).collect::<Vec<_>>(), path);
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
        for pair in path.windows(2) {
            let kink = (pair[0].end_tangent() - pair[1].start_tangent()).norm();
            assert!(kink < 1e-9, "turn of {turn_deg}°: kink of {kink}");
        }
        let Shape::Arc(arc) = &path[1].shape else { panic!("{:?}", path[1]) };
        assert!((arc.sweep() - turn).abs() < 1e-12);
    }
}

/// Smoothing and rounding need G51 or G52, G50 and D (manual 3.4): without D no corner can be cut. One notice a section.
#[test]
fn a_distance_of_zero_is_noticed() {
    let mut path = path("0,0 G52 100,0 100,30 0,30 0,0 G50");
    let notices = Notices::default();
    let items = path.clone().into_iter().map(Ok::<_, Error>);
    let rounded = RoundPath::new(items, Rounding::default(), notices.clone());
    assert_eq!(rounded.count(), 4);
    let place = path[0].place;
    assert_eq!(taken(&notices), [Notice::NoRadius { place, stage: Stage::Rounding }]);
    path[0].marks = Marks::SMOOTHING;
    let items = path.into_iter().map(Ok::<_, Error>);
    let smoothed = SmoothPath::new(items, Smoothing::default(), notices.clone());
    assert_eq!(smoothed.count(), 4);
    let messages: Vec<_> = taken(&notices).iter().map(ToString::to_string).collect();
    assert_eq!(
        messages,
        [
            "line 1: smoothing has no effect, because D is 0 mm; put the distance as D into the block of G51"
        ]
    );
}

/// No more than half of either line goes (manual 6.2.6), so that the next corner has the other half.
#[test]
fn half_of_the_shorter_line_is_the_most() {
    // Nothing is left of the line between the corners.
    assert_path(&round(path("0,0 100,0 100,30 0,30"), 0.02), "0,0 85,0 100,15 85,30 0,30");
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
    let style = Rounding { distance: 0.02, angle_tolerance: 0.0 };
    let path = path("0,0 1000,0 G52 1000,1000 2000,1000 G50 2000,2000");
    let rounded = round_all(path.into_iter().map(Ok).collect(), style);
    let lines: Vec<_> = rounded.iter().flatten().map(|element| element.place.line).collect();
    assert_eq!(lines, [1, 2, 2, 3, 4]);
}

/// Z and the extra axes go on linearly from cut to cut.
#[test]
fn height_and_extra_axes_go_on_linearly() {
    let mut path = path("0,0 100,0,10 100,100,0");
    for (element, (start, end)) in path.iter_mut().zip([(0.0, 10.0), (10.0, 50.0)]) {
        *element = with_extra(element.clone(), start, end);
    }
    path[1].feed = 0.03;
    let path = round(path, 0.02);
    assert_path(&path, "0,0 80,0,8 100,20,8 100,100,0");
    let Some((start, end)) = extras(&path)[1] else { panic!("{path:?}") };
    assert!((start - 8.0).abs() < 1e-12 && (end - 18.0).abs() < 1e-12);
    assert_eq!(path[1].feed, 0.03);
}

/// They move behind the corner, with errors at their place among them.
#[test]
fn m_functions_move_behind_the_corner() {
    let elements = marked(path("0,0 100,0 m 100,0 100,100"), Marks::ROUNDING);
    let mut items: Vec<_> = elements.into_iter().map(Ok).collect();
    items.insert(2, Err(Error::Upstream(7)));
    let style = Rounding { distance: 0.02, angle_tolerance: 0.0 };
    let rounded = round_all(items, style);
    assert_eq!(rounded[3], Err(Error::Upstream(7)));
    let path: Vec<_> = rounded.into_iter().flatten().collect();
    assert_continuous(&path);
    assert_path(&path, "0,0 80,0 100,20 m100,20 100,20 100,100");
    assert!(matches!(path[1].shape, Shape::Arc(_)));
}

/// The window is bounded: with very many of them in a row the corner stays.
#[test]
fn very_many_m_functions() {
    let lines = marked(path(CORNER), Marks::ROUNDING);
    let corner = lines[0].end();
    let many = std::iter::repeat_with(|| Ok::<_, Error>(m_function(corner))).take(100_000);
    let items = std::iter::once(Ok(lines[0].clone())).chain(many).chain([Ok(lines[1].clone())]);
    let style = Rounding { distance: 0.02, angle_tolerance: 0.0 };
    let path: Vec<_> =
        RoundPath::new(items, style, Notices::default()).map(Result::unwrap).collect();
    assert_eq!(path.len(), 100_002);
    assert_continuous(&path);
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
    let notices = Notices::default();
    let style = Rounding { distance: 0.02, angle_tolerance: 0.0 };
    let items = marked(lines, Marks::ROUNDING).into_iter().map(Ok::<_, Error>);
    let path: Vec<_> = RoundPath::new(items, style, notices.clone()).map(Result::unwrap).collect();
    assert_eq!(path[1].switches().len(), 3);
    let lost: Vec<_> = taken(&notices).iter().map(ToString::to_string).collect();
    assert_eq!(
        lost,
        [4, 5].map(|number| format!(
            "line 2: switch {number} on lies on a removed part of the path, and the remaining path is too short for it"
        ))
    );
}

#[test]
fn impossible_distances_are_errors_at_their_place() {
    for distance in [-0.001, f64::NAN] {
        let mut path = marked(path(CORNER), Marks::ROUNDING);
        for element in &mut path {
            element.tool_radius = distance;
        }
        let rounded = round_all(path.into_iter().map(Ok).collect(), Rounding::default());
        assert_eq!(rounded.len(), 3);
        let Err(Error::Corner(CornerError::Distance { place, distance: found })) = rounded[1]
        else {
            panic!("{rounded:?}");
        };
        assert_eq!((place.line, found.to_bits()), (1, distance.to_bits()));
    }
    // A negative distance of the adapter itself.
    let path = marked(path(CORNER), Marks::ROUNDING);
    let style = Rounding { distance: -0.01, angle_tolerance: PI / 8.0 };
    let rounded = round_all(path.into_iter().map(Ok).collect(), style);
    assert_eq!(rounded.iter().filter(|item| item.is_err()).count(), 1);
}
