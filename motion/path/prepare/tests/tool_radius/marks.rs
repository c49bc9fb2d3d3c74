//! Tests of the begin and end of tool radius correction, and of elements in between.

use super::{CORNER, LEFT, RIGHT, assert_points, contour, correct};
use crate::prepare::tests::{
    Error, PROBE, assert_continuous, close, cut, line, m_function, polyline,
};
use crate::prepare::{
    Notice, Notices, Side, Stage, ToolRadius, ToolRadiusError, ToolRadiusOptions,
};
use crate::{Details, ElementKind, ExtraAxes, Marks, PathElement, Shape, Switch};

fn run(items: Vec<Result<PathElement, Error>>) -> Vec<Result<PathElement, Error>> {
    ToolRadius::new(items.into_iter(), ToolRadiusOptions::default(), Notices::default()).collect()
}

fn rapid(from: [f64; 3], to: [f64; 3]) -> PathElement {
    line(ElementKind::Rapid, from, to, 0.5)
}

fn path(elements: Vec<PathElement>) -> Vec<PathElement> {
    correct(elements, ToolRadiusOptions::default()).0
}

#[test]
fn without_marks_nothing_changes() {
    let mut items: Vec<_> = polyline(&CORNER).into_iter().map(Ok).collect();
    items.insert(0, Ok(rapid([0.1; 3], [0.0; 3])));
    items.insert(2, Err(Error::Upstream(1)));
    items.insert(3, Ok(m_function([0.1, 0.0, 0.0].into())));
    items.push(Ok(rapid([0.1, 0.1, 0.0], [0.0; 3])));
    assert_eq!(run(items.clone()), items);
}

#[test]
fn a_radius_of_zero_changes_nothing() {
    let mut elements = contour(polyline(&CORNER), LEFT, 0.0);
    let items = elements.clone().into_iter().map(Ok).collect();
    for element in &mut elements {
        element.marks = Marks::default();
    }
    let expected: Vec<_> = elements.into_iter().map(Ok).collect();
    assert_eq!(run(items), expected);
}

/// The correction needs G41 or G42, G40 and D (manual 3.4): without D there is nothing to correct by.
#[test]
fn a_radius_of_zero_is_noticed() {
    let back = [[100.0, 100.0], [0.0, 100.0], [0.0, 0.0]];
    let contours = [contour(polyline(&CORNER), LEFT, 0.0), contour(polyline(&back), RIGHT, 0.0)];
    let elements = crate::prepare::tests::numbered(contours.concat());
    let (_, notices) = correct(elements.clone(), ToolRadiusOptions::default());
    let at =
        |line: usize| Notice::NoRadius { place: elements[line].place, stage: Stage::ToolRadius };
    assert_eq!(notices, [at(0), at(2)]);
    assert_eq!(
        notices[0].to_string(),
        "line 1: tool radius correction has no effect, because D is 0 mm; put the radius as D into the block of \
         G41 or G42"
    );
    assert_eq!(notices[0].rule(), "syntax");
    // A radius of the adapter's own is one.
    let options = ToolRadiusOptions { radius: 0.001, ..ToolRadiusOptions::default() };
    assert_eq!(correct(contour(polyline(&CORNER), LEFT, 0.0), options).1, []);
}

/// Positionings are inserted at both ends (manual 6.2.3).
#[test]
fn ramps_are_inserted() {
    let path = path(contour(polyline(&CORNER), LEFT, 10.0));
    assert_points(&path, &[[0.0, 0.0], [0.0, 10.0], [90.0, 10.0], [90.0, 100.0], [100.0, 100.0]]);
    let kinds: Vec<_> = path.iter().map(|element| element.kind).collect();
    assert_eq!(kinds, [ElementKind::Rapid, ElementKind::Cut, ElementKind::Cut, ElementKind::Rapid]);
    assert!(path.iter().all(|element| element.marks == Marks::default()));
}

/// A positioning that comes just before leads to the offset itself; one just after starts there.
#[test]
fn positionings_are_led_to_the_offset() {
    let mut elements = contour(polyline(&CORNER), LEFT, 10.0);
    elements.insert(0, rapid([-0.05, -0.05, 0.02], [0.0; 3]));
    elements.push(rapid([0.1, 0.1, 0.0], [0.2, 0.2, 0.02]));
    let path = path(elements);
    assert_eq!(path.len(), 4);
    assert!(close(path[0].start(), [-50.0, -50.0, 20.0]) && close(path[0].end(), [0.0, 10.0, 0.0]));
    assert!(
        close(path[3].start(), [90.0, 100.0, 0.0]) && close(path[3].end(), [200.0, 200.0, 20.0])
    );
}

/// A tool that goes straight down must neither come down at an angle nor on the contour.
#[test]
fn the_tool_goes_down_and_up_beside_the_contour() {
    let mut elements = contour(polyline(&CORNER), LEFT, 10.0);
    elements.insert(0, rapid([0.0, 0.0, 0.05], [0.0; 3]));
    elements.push(rapid([0.1, 0.1, 0.0], [0.1, 0.1, 0.05]));
    let path = path(elements);
    assert_eq!(path.len(), 6);
    assert!(close(path[0].start(), [0.0, 0.0, 50.0]));
    assert!(close(path[0].end(), [0.0, 10.0, 50.0]));
    assert!(close(path[1].end(), [0.0, 10.0, 0.0]));
    assert!(close(path[4].start(), [90.0, 100.0, 0.0]));
    assert!(close(path[4].end(), [90.0, 100.0, 50.0]));
    assert!(close(path[5].end(), [100.0, 100.0, 50.0]));
}

/// G0, then M3 and down, then the contour; up and M5, then G0: all of it away from the contour.
#[test]
fn what_stands_before_and_behind_is_done_beside() {
    let mut elements = contour(polyline(&CORNER), LEFT, 10.0);
    elements.insert(0, rapid([-0.05, -0.05, 0.05], [0.0, 0.0, 0.05]));
    elements.insert(1, m_function([0.0, 0.0, 0.05].into()));
    elements.insert(2, rapid([0.0, 0.0, 0.05], [0.0; 3]));
    elements.push(rapid([0.1, 0.1, 0.0], [0.1, 0.1, 0.05]));
    elements.push(m_function([0.1, 0.1, 0.05].into()));
    elements.push(rapid([0.1, 0.1, 0.05], [0.2, 0.2, 0.05]));
    let path = path(elements);
    let ends: Vec<_> = path.iter().map(|element| element.end() * 1e3).collect();
    let expected = [
        [0.0, 10.0, 50.0],
        [0.0, 10.0, 50.0],
        [0.0, 10.0, 0.0],
        [90.0, 10.0, 0.0],
        [90.0, 100.0, 0.0],
        [90.0, 100.0, 50.0],
        [90.0, 100.0, 50.0],
        [200.0, 200.0, 50.0],
    ];
    assert_eq!(ends.len(), expected.len());
    for (end, expected) in ends.iter().zip(expected) {
        assert!((end - nalgebra::Point3::from(expected)).norm() < 1e-9, "{end}");
    }
}

/// From the end of one contour to the beginning of the next there is one positioning, also to the other side.
#[test]
fn contours_may_follow_each_other() {
    let mut elements = contour(polyline(&CORNER), LEFT, 10.0);
    let on = polyline(&[[100.0, 100.0], [0.0, 100.0]]);
    elements.extend(contour(on, RIGHT, 10.0));
    let path = path(elements);
    assert_points(
        &path,
        &[
            [0.0, 0.0],
            [0.0, 10.0],
            [90.0, 10.0],
            [90.0, 100.0],
            [100.0, 110.0],
            [0.0, 110.0],
            [0.0, 100.0],
        ],
    );
}

/// The end of the program without G40: the path ends at the offset from the contour.
#[test]
fn a_program_may_end_without_the_end_mark() {
    let mut elements = contour(polyline(&CORNER), LEFT, 10.0);
    elements[1].marks = Marks::default();
    assert_points(&path(elements), &[[0.0, 0.0], [0.0, 10.0], [90.0, 10.0], [90.0, 100.0]]);
}

#[test]
fn what_stands_between_is_done_behind_the_corner() {
    for (side, at, index) in [(LEFT, [90.0, 10.0, 0.0], 2), (RIGHT, [110.0, 0.0, 0.0], 3)] {
        let mut elements = contour(polyline(&CORNER), side, 10.0);
        let corner = elements[0].end();
        let second = elements.remove(1);
        let mut switched = cut(corner.into(), corner.into(), 0.05);
        let details = switched.details.get_or_insert_default();
        assert!(details.switches.add(Switch { number: 1, on: true, at: 0.5 }));
        let items = vec![
            Ok(elements.remove(0)),
            Ok(m_function(corner)),
            Err(Error::Upstream(1)),
            Ok(switched),
            Ok(second),
        ];
        let result = run(items);
        assert!(matches!(&result[index], Ok(m) if m.kind == ElementKind::MFunction { number: 8 }));
        assert_eq!(result[index + 1], Err(Error::Upstream(1)));
        assert!(matches!(&result[index + 2], Ok(zero) if zero.switches().len() == 1));
        let path: Vec<_> = result.into_iter().flatten().collect();
        assert_continuous(&path);
        assert!(close(path[index].start(), at) && close(path[index + 1].end(), at));
    }
}

/// Lifting and lowering the tool in between, and dwells: at the offset from the contour, too.
#[test]
fn moves_along_z_alone() {
    let mut elements = contour(polyline(&CORNER), RIGHT, 10.0);
    elements.insert(1, rapid([0.1, 0.0, 0.0], [0.1, 0.0, 0.05]));
    elements[2].shape =
        Shape::Line { start: [0.1, 0.0, 0.05].into(), end: [0.1, 0.1, 0.05].into() };
    let path = path(elements);
    assert!(close(path[3].start(), [110.0, 0.0, 0.0]) && close(path[3].end(), [110.0, 0.0, 50.0]));
    assert!(close(path[4].end(), [110.0, 100.0, 50.0]));
}

/// Behind a jump the offset begins anew; before it, the old one ends without a corner.
#[test]
fn jumps() {
    let mut elements =
        contour(polyline(&[[0.0, 0.0], [100.0, 0.0], [0.0, 50.0], [100.0, 50.0]]), LEFT, 10.0);
    elements[1].kind = ElementKind::Jump;
    let path = path(elements);
    assert_points(
        &path,
        &[[0.0, 0.0], [0.0, 10.0], [100.0, 10.0], [0.0, 60.0], [100.0, 60.0], [100.0, 50.0]],
    );
    assert_eq!(path[2].kind, ElementKind::Jump);
    // As the last thing before the end it leads where it leads.
    let mut elements = contour(polyline(&CORNER), LEFT, 10.0);
    elements[1].kind = ElementKind::Jump;
    let path = super::correct(elements, ToolRadiusOptions::default()).0;
    assert_points(&path, &[[0.0, 0.0], [0.0, 10.0], [100.0, 10.0], [100.0, 100.0]]);
}

#[test]
fn extra_axes_rest_around_corners() {
    let extra = |start: f64, end: f64| {
        let wide = |p: f64| [p, 0.0, 0.0, 0.0, 0.0];
        let extra = Some(ExtraAxes { start: wide(start), end: wide(end) });
        Some(Box::new(Details { extra, ..Details::default() }))
    };
    let mut elements = contour(polyline(&CORNER), RIGHT, 10.0);
    elements[0].details = extra(0.0, 30.0);
    elements[1].details = extra(30.0, 40.0);
    let found: Vec<_> = path(elements)
        .iter()
        .map(|element| element.extra().map(|extra| (extra.start[0], extra.end[0])))
        .collect();
    let expected = [(0.0, 0.0), (0.0, 30.0), (30.0, 30.0), (30.0, 40.0), (40.0, 40.0)];
    assert_eq!(found, expected.map(Some));
}

fn errors(items: Vec<PathElement>) -> Vec<ToolRadiusError> {
    let result = run(items.into_iter().map(Ok).collect());
    let path: Vec<_> = result.iter().flatten().cloned().collect();
    assert_continuous(&path);
    result
        .into_iter()
        .filter_map(|item| match item {
            Err(Error::ToolRadius(error)) => Some(error),
            _ => None,
        })
        .collect()
}

/// Left to right needs an end in between (manual 6.2.3).
#[test]
fn the_side_may_not_change() {
    let mut elements = contour(polyline(&CORNER), LEFT, 10.0);
    elements[1].marks = RIGHT;
    let place = elements[1].place;
    let expected = ToolRadiusError::SideChange { place, from: Side::Left, to: Side::Right };
    assert_eq!(errors(elements.clone()), [expected]);
    assert_eq!(
        expected.to_string(),
        "line 2: tool radius correction to the right begins before that to the left has ended"
    );
    // The path comes back before the error; the element itself is not moved.
    let path: Vec<_> = run(elements.into_iter().map(Ok).collect()).into_iter().flatten().collect();
    assert_points(&path, &[[0.0, 0.0], [0.0, 10.0], [100.0, 10.0], [100.0, 0.0], [100.0, 100.0]]);
    // The same side once more is not a change.
    let mut elements = contour(polyline(&CORNER), LEFT, 10.0);
    elements[1].marks = elements[1].marks.with(LEFT);
    assert_eq!(errors(elements), []);
}

/// `iStatus` is that of the element taken in last, some way ahead of the one handed out.
#[test]
fn the_side_is_told() {
    let points: Vec<_> = (0..500).map(|x| [f64::from(x), 0.0]).collect();
    for (mark, side) in [(LEFT, Side::Left), (RIGHT, Side::Right)] {
        let mut elements = vec![rapid([-0.1, 0.0, 0.0], [0.0; 3])];
        elements.extend(contour(polyline(&points), mark, 10.0));
        elements.push(rapid([0.499, 0.0, 0.0], [0.5, 0.0, 0.0]));
        let items = elements.into_iter().map(Ok::<_, Error>);
        let options = ToolRadiusOptions { look_ahead: 8, ..ToolRadiusOptions::default() };
        let mut stage = ToolRadius::new(items, options, Notices::default());
        assert_eq!(stage.side(), None);
        let sides: Vec<_> =
            std::iter::from_fn(|| stage.next().map(|item| item.map(|_| stage.side()).unwrap()))
                .collect();
        let (on, off) = sides.split_at(sides.iter().position(Option::is_none).unwrap());
        assert!(on.len() > 400 && on.iter().all(|found| *found == Some(side)), "{on:?}");
        assert!(off.len() < 20 && off.iter().all(Option::is_none), "{off:?}");
    }
}

#[test]
fn the_radius_may_not_change() {
    for (before, after) in [(0.01, 0.02), (0.01, 0.0), (0.0, 0.01)] {
        let mut elements = contour(polyline(&CORNER), LEFT, 0.0);
        elements[0].tool_radius = before;
        elements[1].tool_radius = after;
        let place = elements[1].place;
        let expected = ToolRadiusError::RadiusChange { place, from: before, to: after };
        assert_eq!(errors(elements), [expected]);
    }
}

/// A probing move is not offset. Nor along Z: it would be done at the offset from the contour.
#[test]
fn probing_moves_are_refused() {
    for upright in [false, true] {
        let mut elements = contour(polyline(&CORNER), LEFT, 10.0);
        if upright {
            let at = elements[1].start();
            let end = at + nalgebra::Vector3::new(0.0, 0.0, -0.01);
            elements[1].shape = Shape::Line { start: at, end };
        }
        elements[1].kind = PROBE;
        let probe = PathElement { marks: Marks::default(), ..elements[1].clone() };
        let place = probe.place;
        let items = elements.clone().into_iter().map(Ok::<_, Error>);
        let path = ToolRadius::new(items, ToolRadiusOptions::default(), Notices::default());
        let found: Vec<_> = path.filter_map(Result::ok).collect();
        assert!(found.contains(&probe), "{found:#?}");
        assert_eq!(errors(elements), [ToolRadiusError::Probe(place)]);
    }
    // Between contours they are where they are, and so is what comes before and behind.
    let mut path = contour(polyline(&CORNER), LEFT, 10.0);
    let end = path.last().unwrap().end();
    let down = end + nalgebra::Vector3::new(0.0, 0.0, -0.01);
    let shape = Shape::Line { start: end, end: down };
    path.push(PathElement { marks: Marks::default(), kind: PROBE, shape, ..path[0].clone() });
    let (found, _) = correct(path.clone(), ToolRadiusOptions::default());
    assert_eq!(found.last(), path.last());
}

#[test]
fn impossible_radii_and_planes() {
    for radius in [-0.001, f64::NAN, f64::INFINITY] {
        let elements = contour(polyline(&CORNER), LEFT, radius * 1e3);
        let found = errors(elements);
        let [ToolRadiusError::Radius { radius: found, .. }] = found[..] else {
            panic!("{radius}: {found:?}");
        };
        assert_eq!(found.is_nan(), radius.is_nan());
    }
    let mut elements = contour(polyline(&CORNER), LEFT, 10.0);
    let (start, end) = (elements[1].start(), elements[1].end());
    let upright = crate::Arc::in_plane(
        crate::Plane::Yz,
        start,
        end,
        nalgebra::center(&start, &end),
        std::f64::consts::PI,
    );
    elements[1].shape = Shape::Arc(upright);
    let place = elements[1].place;
    assert_eq!(errors(elements), [ToolRadiusError::Plane(place)]);
}
