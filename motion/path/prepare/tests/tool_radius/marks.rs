//! Tests of the begin and end of tool radius correction, and of elements in between.

use super::{CORNER, correct, correct_with};
use crate::prepare::tests::{
    Error, Item, assert_continuous, assert_path, extras, path, switched, with_extra, words,
};
use crate::prepare::{
    Notice, Notices, Side, Stage, ToolRadius, ToolRadiusError, ToolRadiusOptions,
};
use crate::{Marks, PathElement, Shape};

fn run(items: impl IntoIterator<Item = Item>) -> Vec<Item> {
    let options = ToolRadiusOptions::default();
    ToolRadius::new(items.into_iter(), options, Notices::default()).collect()
}

/// The correction needs G41 or G42, G40 and D (manual 3.4): without D there is nothing to correct by.
#[test]
fn a_radius_of_zero_is_noticed_and_changes_nothing() {
    let elements = path("0,0 G41 100,0 100,100 G40 G42 0,100 0,0 G40");
    let (after, notices) = correct(elements.clone());
    let unmarked = |element| PathElement { marks: Marks::default(), ..element };
    assert_eq!(after, elements.clone().into_iter().map(unmarked).collect::<Vec<_>>());
    let at =
        |line: usize| Notice::NoRadius { place: elements[line].place, stage: Stage::ToolRadius };
    assert_eq!(notices, [at(0), at(2)]);
    let said = "line 1: tool radius correction has no effect, because D is 0 mm; put the radius as D into the block of G41 or G42";
    assert_eq!(notices[0].to_string(), said);
    assert_eq!(notices[0].rule(), "syntax");
    // A radius of the adapter's own is one.
    let options = ToolRadiusOptions { radius: 0.001, ..ToolRadiusOptions::default() };
    assert_eq!(correct_with(elements, options).1, []);
}

#[test]
fn ends_and_what_comes_between() {
    for (elements, expected) in [
        // Positionings are inserted at both ends (manual 6.2.3).
        ("D10 0,0 G41 100,0 100,100 G40", "0,0 r0,10 90,10 90,100 r100,100"),
        // A positioning that comes just before leads to the offset itself; one just after starts there.
        (
            "D10 -50,-50,20 r0,0,0 G41 100,0 100,100 G40 r200,200,20",
            "-50,-50,20 r0,10,0 90,10 90,100 r200,200,20",
        ),
        // A tool that goes straight down must neither come down at an angle nor on the contour; nor does what is done
        // before and behind it, M functions too.
        (
            "D10 0,0,50 r0,0,0 G41 100,0 100,100 G40 r100,100,50",
            "0,0,50 r0,10,50 r0,10,0 90,10 90,100 r90,100,50 r100,100,50",
        ),
        (
            "D10 -50,-50,50 r0,0 m r0,0,0 G41 100,0 100,100 G40 r100,100,50 m r200,200",
            "-50,-50,50 r0,10 m0,10 r0,10,0 90,10 90,100 r90,100,50 m90,100 r200,200",
        ),
        // From the end of one contour to the beginning of the next there is one positioning, also to the other side.
        (
            "D10 0,0 G41 100,0 100,100 G40 G42 0,100 G40",
            "0,0 r0,10 90,10 90,100 r100,110 0,110 r0,100",
        ),
        // The end of the program without G40: the path ends at the offset from the contour.
        ("D10 0,0 G41 100,0 100,100", "0,0 r0,10 90,10 90,100"),
        // Lifting and lowering the tool in between, and dwells: at the offset from the contour, too.
        (
            "D10 0,0 G42 100,0 r100,0,50 100,100 G40",
            "0,0 r0,-10 100,-10 110,0 r110,0,50 110,100 r100,100",
        ),
        // Behind a jump the offset begins anew; before it, the old one ends without a corner. As the last thing before
        // the end it leads where it leads.
        ("D10 0,0 G41 100,0 j0,50 100,50 G40", "0,0 r0,10 100,10 j0,60 100,60 r100,50"),
        ("D10 0,0 G41 100,0 j100,100 G40", "0,0 r0,10 100,10 j100,100"),
    ] {
        assert_path(&correct(path(elements)).0, expected);
    }
}

#[test]
fn what_stands_between_is_done_behind_the_corner() {
    for (side, at, index) in [("G41", "m90,10", 2), ("G42", "m110,0", 3)] {
        let elements = path(&format!("D10 0,0 {side} 100,0 m 100,0 100,100 G40"));
        let mut items: Vec<_> = elements.into_iter().map(Ok).collect();
        items[2] = items[2].clone().map(|zero| switched(zero, &[(1, 0.5)]));
        items.insert(2, Err(Error::Upstream(1)));
        let result = run(items);
        assert_eq!(result[index + 1], Err(Error::Upstream(1)));
        assert!(matches!(&result[index + 2], Ok(zero) if zero.switches().len() == 1));
        let path: Vec<_> = result.into_iter().flatten().collect();
        assert_continuous(&path);
        assert_path(&path[index..index + 2], &format!("{0} {at} {0}", &at[1..]));
    }
}

#[test]
fn extra_axes_rest_around_corners() {
    let elements = path("D10 0,0 G42 100,0 100,100 G40");
    let ends = [(0.0, 30.0), (30.0, 40.0)];
    let turned = elements.into_iter().zip(ends).map(|(it, ends)| with_extra(it, ends));
    let (found, _) = correct(turned.collect());
    let expected = [(0.0, 0.0), (0.0, 30.0), (30.0, 30.0), (30.0, 40.0), (40.0, 40.0)];
    assert_eq!(extras(&found), expected.map(Some));
}

fn errors(items: Vec<PathElement>) -> Vec<ToolRadiusError> {
    let result = run(items.into_iter().map(Ok));
    let path: Vec<_> = result.iter().flatten().cloned().collect();
    assert_continuous(&path);
    let error = |item| match item {
        Err(Error::ToolRadius(error)) => Some(error),
        _ => None,
    };
    result.into_iter().filter_map(error).collect()
}

/// Left to right needs an end in between (manual 6.2.3).
#[test]
fn the_side_may_not_change() {
    let elements = path("D10 0,0 G41 100,0 G42 100,100");
    let place = elements[1].place;
    let expected = ToolRadiusError::SideChange { place, from: Side::Left, to: Side::Right };
    assert_eq!(errors(elements.clone()), [expected]);
    let said =
        "line 2: tool radius correction to the right begins before that to the left has ended";
    assert_eq!(expected.to_string(), said);
    // The path comes back before the error; the element itself is not moved.
    let after: Vec<_> = run(elements.into_iter().map(Ok)).into_iter().flatten().collect();
    assert_path(&after, "0,0 r0,10 100,10 r100,0 100,100");
    // The same side once more is not a change.
    assert_eq!(errors(path("D10 0,0 G41 100,0 G41 100,100 G40")), []);
}

/// `iStatus` is that of the element taken in last, some way ahead of the one handed out.
#[test]
fn the_side_is_told() {
    let points = words((1..500).map(|x| [f64::from(x), 0.0]));
    for (mark, side) in [("G41", Side::Left), ("G42", Side::Right)] {
        let elements = path(&format!("D10 -100,0 r0,0 {mark} {points} G40 r500,0"));
        let items = elements.into_iter().map(Ok::<_, Error>);
        let options = ToolRadiusOptions { look_ahead: 8, ..ToolRadiusOptions::default() };
        let mut stage = ToolRadius::new(items, options, Notices::default());
        assert_eq!(stage.side(), None);
        let next = || stage.next().map(|item| item.map(|_| stage.side()).unwrap());
        let sides: Vec<_> = std::iter::from_fn(next).collect();
        let (on, off) = sides.split_at(sides.iter().position(Option::is_none).unwrap());
        assert!(on.len() > 400 && on.iter().all(|found| *found == Some(side)), "{on:?}");
        assert!(off.len() < 20 && off.iter().all(Option::is_none), "{off:?}");
    }
}

#[test]
fn the_radius_may_not_change() {
    for (before, after) in [(10, 20), (10, 0), (0, 10)] {
        let elements = path(&format!("0,0 D{before} G41 100,0 D{after} 100,100 G40"));
        let (place, from, to) =
            (elements[1].place, elements[0].tool_radius, elements[1].tool_radius);
        assert_eq!(errors(elements), [ToolRadiusError::RadiusChange { place, from, to }]);
    }
}

/// A probing move is not offset. Nor along Z: it would be done at the offset from the contour.
#[test]
fn probing_moves_are_refused() {
    for end in ["100,100", "100,0,-10"] {
        let elements = path(&format!("D10 0,0 G41 100,0 p{end} G40"));
        let probe = PathElement { marks: Marks::default(), ..elements[1].clone() };
        let found = run(elements.clone().into_iter().map(Ok));
        assert!(found.contains(&Ok(probe.clone())), "{found:#?}");
        assert_eq!(errors(elements), [ToolRadiusError::Probe(probe.place)]);
    }
    // Between contours they are where they are, and so is what comes before and behind.
    let elements = path("D10 0,0 G41 100,0 100,100 G40 p100,100,-10");
    let (found, _) = correct(elements.clone());
    assert_eq!(found.last(), elements.last());
}

#[test]
fn impossible_radii_and_planes() {
    for radius in [-0.001, f64::NAN, f64::INFINITY] {
        let found = errors(super::contour(path(CORNER), Marks::CORRECTION_LEFT, radius * 1e3));
        let [ToolRadiusError::Radius { radius: found, .. }] = found[..] else {
            panic!("{radius}: {found:?}");
        };
        assert_eq!(found.is_nan(), radius.is_nan());
    }
    let mut elements = path("D10 0,0 G41 100,0 100,100 G40");
    let (start, end) = (elements[1].start(), elements[1].end());
    let (plane, center) = (crate::Plane::Yz, nalgebra::center(&start, &end));
    let upright = crate::Arc::in_plane(plane, start, end, center, std::f64::consts::PI);
    elements[1].shape = Shape::Arc(upright);
    let place = elements[1].place;
    assert_eq!(errors(elements), [ToolRadiusError::Plane(place)]);
}
