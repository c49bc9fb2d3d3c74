//! Tests of corner rounding and smoothing, [`RoundPath`] and [`SmoothPath`].

use super::{
    Error, PROBE, VECTOR_TOLERANCE, assert_continuous, close, cut, m_function, numbered, polyline,
    taken,
};
use crate::prepare::{
    CornerError, Notice, Notices, RoundPath, Rounding, SmoothPath, Smoothing, Stage,
};
use crate::{Details, ElementKind, ExtraAxes, Marks, PathElement, Shape, Switch};
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
    round_all(elements, style).into_iter().map(Result::unwrap).collect()
}

fn with_radius(mut elements: Vec<PathElement>, radius: f64) -> Vec<PathElement> {
    for element in &mut elements {
        element.tool_radius = radius;
    }
    elements
}

/// Also one of length zero, which has tripped where it began.
#[test]
fn probing_moves_keep_their_corners() {
    for (index, empty) in [(0, false), (1, false), (1, true)] {
        let mut path = with_radius(polyline(&CORNER_60), 0.02);
        if empty {
            let at = path[0].end();
            path.insert(
                1,
                PathElement { shape: Shape::Line { start: at, end: at }, ..path[0].clone() },
            );
        }
        path[index].kind = PROBE;
        let path = numbered(path);
        assert_eq!(round(path.clone(), 0.0), path);
        let marked = marked(path.clone(), Marks::SMOOTHING).into_iter().map(Ok::<_, Error>);
        let smooth = SmoothPath::new(marked, Smoothing::default(), Notices::default());
        assert_eq!(smooth.map(Result::unwrap).collect::<Vec<_>>(), path);
    }
}

const CORNER_60: [[f64; 2]; 3] = [[0.0, 0.0], [100.0, 0.0], [150.0, 86.602_540_378_443_86]];

/// Vector `prep-round-60`: r 20 on 0/0 → 100/0 → 150/86.6.
#[test]
fn prep_round_60() {
    // Once as the adapter's distance, which then dominates D, and once as D.
    for (distance, programmed) in [(0.02, 0.0), (0.02, 0.005), (0.0, 0.02)] {
        let path = round(with_radius(polyline(&CORNER_60), programmed), distance);
        assert_eq!(path.len(), 3);
        assert_continuous(&path);
        assert!(close(path[0].end(), [80.0, 0.0, 0.0]));
        assert!(close(path[1].end(), [110.0, 17.320_508_076, 0.0]));
        let Shape::Arc(arc) = &path[1].shape else { panic!("{:?}", path[1]) };
        assert!(close(arc.center(), [80.0, 34.641_016_151, 0.0]));
        assert!((arc.radius() - 0.034_641_016_151).abs() <= VECTOR_TOLERANCE);
        assert!((arc.length() - 0.036_275_987_285).abs() <= VECTOR_TOLERANCE);
        assert!(arc.sweep() > 0.0, "counter-clockwise");
        // The marks are obeyed and gone.
        assert!(path.iter().all(|element| element.marks == Marks::default()));
    }
}

#[test]
fn rounded_corners_are_tangent_on_either_side() {
    for turn_deg in [-170, -90, -30, -1, 1, 30, 90, 170] {
        let turn = f64::from(turn_deg).to_radians();
        let end = [100.0 + 80.0 * turn.cos(), 80.0 * turn.sin()];
        let path = round(polyline(&[[0.0, 0.0], [100.0, 0.0], end]), 0.01);
        assert_eq!(path.len(), 3, "turn of {turn_deg}°");
        assert_continuous(&path);
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
    let mut path = polyline(&[[0.0, 0.0], [100.0, 0.0], [100.0, 30.0], [0.0, 30.0], [0.0, 0.0]]);
    path[0].marks = Marks::ROUNDING;
    path[3].marks = Marks::CORNERS_END;
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
    let path = round(polyline(&[[0.0, 0.0], [100.0, 0.0], [100.0, 30.0], [0.0, 30.0]]), 0.02);
    // Nothing is left of the line between the corners.
    assert_eq!(path.len(), 4);
    assert_continuous(&path);
    assert!(close(path[0].end(), [85.0, 0.0, 0.0]));
    assert!(close(path[1].end(), [100.0, 15.0, 0.0]));
    assert!(close(path[2].end(), [85.0, 30.0, 0.0]));
}

#[test]
fn what_stays_as_it_is() {
    let corner = || polyline(&[[0.0, 0.0], [100.0, 0.0], [100.0, 100.0]]);
    let rapid = |index: usize| {
        let mut path = corner();
        path[index].kind = ElementKind::Rapid;
        path
    };
    let plunge =
        vec![cut([0.0; 3], [0.1, 0.0, 0.0], 0.05), cut([0.1, 0.0, 0.0], [0.1, 0.0, -0.1], 0.05)];
    let back = polyline(&[[0.0, 0.0], [100.0, 0.0], [0.0, 0.0]]);
    let faint = polyline(&[[0.0, 0.0], [100.0, 0.0], [200.0, 0.9]]);
    let jump = {
        let mut path = polyline(&[[0.0, 0.0], [100.0, 0.0], [100.0, 50.0], [0.0, 50.0]]);
        path[1].kind = ElementKind::Jump;
        path
    };
    for path in [rapid(0), rapid(1), plunge, back, faint, jump] {
        let rounded = round(path.clone(), 0.02);
        let bare = |path: &[PathElement]| -> Vec<_> {
            path.iter().map(|element| (element.kind, element.shape.clone())).collect()
        };
        assert_eq!(bare(&rounded), bare(&path));
    }
    // No distance at all.
    assert_eq!(round(corner(), 0.0).len(), 2);
    // Corners outside the marks; a mark behind the last corner.
    let style = Rounding { distance: 0.02, angle_tolerance: 0.0 };
    let mut path = polyline(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 1.0], [2.0, 2.0]]);
    path[1].marks = Marks::ROUNDING;
    path[2].marks = Marks::CORNERS_END;
    let rounded = round_all(path.into_iter().map(Ok).collect(), style);
    let lines: Vec<_> = rounded.iter().flatten().map(|element| element.place.line).collect();
    assert_eq!(lines, [1, 2, 2, 3, 4]);
}

#[test]
fn without_marks_nothing_changes() {
    let path = polyline(&CORNER_60);
    let items: Vec<_> = path.into_iter().map(Ok).collect();
    let style = Rounding { distance: 0.02, angle_tolerance: 0.0 };
    assert_eq!(round_all(items.clone(), style), items);
}

/// Z and the extra axes go on linearly from cut to cut.
#[test]
fn height_and_extra_axes_go_on_linearly() {
    let extra = |start: f64, end: f64| {
        let wide = |p: f64| [p, 0.0, 0.0, 0.0, 0.0];
        let extra = Some(ExtraAxes { start: wide(start), end: wide(end) });
        Some(Box::new(Details { extra, ..Details::default() }))
    };
    let (a, b, c) = ([0.0, 0.0, 0.0], [0.1, 0.0, 0.01], [0.1, 0.1, 0.0]);
    let path = vec![
        PathElement { details: extra(0.0, 10.0), ..cut(a, b, 0.05) },
        PathElement { details: extra(10.0, 50.0), ..cut(b, c, 0.03) },
    ];
    let path = round(path, 0.02);
    assert_continuous(&path);
    assert!(close(path[0].end(), [80.0, 0.0, 8.0]));
    assert!(close(path[2].start(), [100.0, 20.0, 8.0]));
    let ends = path[1].extra().map(|extra| (extra.start[0], extra.end[0]));
    let Some((start, end)) = ends else { panic!("{path:?}") };
    assert!((start - 8.0).abs() < 1e-12 && (end - 18.0).abs() < 1e-12);
    assert_eq!(path[1].feed, 0.03);
}

/// They move behind the corner, with errors at their place among them.
#[test]
fn m_functions_move_behind_the_corner() {
    let mut lines = marked(polyline(&[[0.0, 0.0], [100.0, 0.0], [100.0, 100.0]]), Marks::ROUNDING);
    let corner = lines[0].end();
    let second = lines.remove(1);
    let zero = cut(corner.into(), corner.into(), 0.05);
    let items = vec![
        Ok(lines.remove(0)),
        Ok(m_function(corner)),
        Err(Error::Upstream(7)),
        Ok(zero),
        Ok(second),
    ];
    let style = Rounding { distance: 0.02, angle_tolerance: 0.0 };
    let rounded = round_all(items, style);
    assert_eq!(rounded[3], Err(Error::Upstream(7)));
    let path: Vec<_> = rounded.into_iter().flatten().collect();
    assert_eq!(path.len(), 5);
    assert_continuous(&path);
    assert!(matches!(path[1].shape, Shape::Arc(_)));
    assert_eq!(path[2].kind, ElementKind::MFunction { number: 8 });
    assert!(close(path[2].start(), [100.0, 20.0, 0.0]));
    assert_eq!((path[3].length(), path[3].start()), (0.0, path[2].start()));
}

/// The window is bounded: with very many of them in a row the corner stays.
#[test]
fn very_many_m_functions() {
    let lines = marked(polyline(&[[0.0, 0.0], [100.0, 0.0], [100.0, 100.0]]), Marks::ROUNDING);
    let corner = lines[0].end();
    let many = std::iter::repeat_with(|| Ok::<_, Error>(m_function(corner))).take(100_000);
    let items = std::iter::once(Ok(lines[0].clone())).chain(many).chain([Ok(lines[1].clone())]);
    let style = Rounding { distance: 0.02, angle_tolerance: 0.0 };
    let path: Vec<_> =
        RoundPath::new(items, style, Notices::default()).map(Result::unwrap).collect();
    assert_eq!(path.len(), 100_002);
    assert_continuous(&path);
}

fn switch(number: u8, at: f64) -> Switch {
    Switch { number, on: true, at }
}

fn switched(mut element: PathElement, switches: &[Switch]) -> PathElement {
    let details = element.details.get_or_insert_default();
    for switch in switches {
        assert!(details.switches.add(*switch));
    }
    element
}

#[test]
fn switches_on_what_is_cut_off_move_onto_the_arc() {
    let mut lines = polyline(&[[0.0, 0.0], [100.0, 0.0], [100.0, 100.0]]);
    let second = switched(lines.remove(1), &[switch(4, 0.1), switch(5, 0.6)]);
    let first = switched(lines.remove(0), &[switch(1, 0.4), switch(2, 0.78), switch(3, 0.9)]);
    let path = round(vec![first, second], 0.02);
    let found: Vec<Vec<_>> = path
        .iter()
        .map(|element| {
            element.switches().iter().map(|s| (s.number, (s.at * 1e9).round() / 1e9)).collect()
        })
        .collect();
    // 40 mm and 78 mm of 80; 90 mm is in the middle of the first half of the arc, 10 mm of the second.
    let expected: [&[_]; 3] = [&[(1, 0.5), (2, 0.975)], &[(3, 0.25), (4, 0.75)], &[(5, 0.5)]];
    assert_eq!(found, expected);
}

#[test]
fn switches_without_room_are_told() {
    let mut lines = marked(polyline(&[[0.0, 0.0], [100.0, 0.0], [100.0, 100.0]]), Marks::ROUNDING);
    let second = switched(lines.remove(1), &[switch(4, 0.1), switch(5, 0.15)]);
    let first = switched(lines.remove(0), &[switch(1, 0.85), switch(2, 0.9), switch(3, 0.95)]);
    let notices = Notices::default();
    let style = Rounding { distance: 0.02, angle_tolerance: 0.0 };
    let items = numbered(vec![first, second]).into_iter().map(Ok::<_, Error>);
    let path: Vec<_> = RoundPath::new(items, style, notices.clone()).map(Result::unwrap).collect();
    assert_eq!(path[1].switches().len(), 3);
    let lost: Vec<_> = taken(&notices).iter().map(ToString::to_string).collect();
    assert_eq!(
        lost,
        [4, 5].map(|number| format!(
            "line 2: switch {number} on lies on a piece of path that is gone, and what is left has no room for it"
        ))
    );
}

#[test]
fn impossible_distances_are_errors_at_their_place() {
    for distance in [-0.001, f64::NAN] {
        let path = marked(with_radius(polyline(&CORNER_60), distance), Marks::ROUNDING);
        let rounded = round_all(path.into_iter().map(Ok).collect(), Rounding::default());
        assert_eq!(rounded.len(), 3);
        let Err(Error::Corner(CornerError::Distance { place, distance: found })) = rounded[1]
        else {
            panic!("{rounded:?}");
        };
        assert_eq!((place.line, found.to_bits()), (1, distance.to_bits()));
    }
    // A negative distance of the adapter itself.
    let path = marked(polyline(&CORNER_60), Marks::ROUNDING);
    let style = Rounding { distance: -0.01, angle_tolerance: PI / 8.0 };
    let rounded = round_all(path.into_iter().map(Ok).collect(), style);
    assert_eq!(rounded.iter().filter(|item| item.is_err()).count(), 1);
}
