//! Tests of the stream: order, errors and held-back elements.

use super::*;
use std::cell::Cell;
use twin_path::{ElementKind, ProbeOutcome, Probing};

fn zigzag(count: u32) -> Vec<PathElement> {
    let at = |index: u32| [f64::from(index) * 0.01, f64::from(index % 2) * 0.01, 0.0];
    (0..count)
        .map(|index| PathElement { place: Place::at(index + 1), ..line(at(index), at(index + 1)) })
        .collect()
}

#[test]
fn one_element_is_held_back() {
    let pulled = Cell::new(0);
    let path: Vec<_> =
        CheckVelocities::new(zigzag(6).into_iter().map(Ok::<_, Error>), PI).collect();
    let counted = path.into_iter().inspect(|_| pulled.set(pulled.get() + 1));
    let mut course = BlendedPath::new(counted, within(1e-4));
    assert_eq!(pulled.get(), 0);
    for handed_out in 1..=6 {
        assert_eq!(course.next().unwrap().unwrap().place().line, handed_out);
        assert_eq!(pulled.get(), (handed_out + 1).min(6));
    }
    assert_eq!((course.next(), course.next()), (None, None));
}

/// An error arrives behind the element before it, which ends as it is; the element behind begins as it is.
#[test]
fn errors_keep_their_place() {
    let mut path: Vec<_> = zigzag(4).into_iter().map(Ok).collect();
    path.insert(2, Err(Error::Upstream(3)));
    path.insert(0, Err(Error::Upstream(1)));
    path.push(Err(Error::Upstream(9)));
    let checked = CheckVelocities::new(path.into_iter(), PI);
    let results: Vec<_> = BlendedPath::new(checked, within(1e-4)).collect();
    let places: Vec<_> =
        results.iter().map(|result| result.as_ref().map(|element| element.place().line)).collect();
    let up = |number| Error::Upstream(number);
    assert_eq!(places, [Err(&up(1)), Ok(1), Ok(2), Err(&up(3)), Ok(3), Ok(4), Err(&up(9))]);
    let blends: Vec<_> = results
        .iter()
        .flatten()
        .map(|element| (element.head().is_some(), element.tail().is_some(), element.stops_at_end()))
        .collect();
    let (begins, ends) = ((false, true, false), (true, false, true));
    assert_eq!(blends, [begins, ends, begins, ends]);
}

/// Upstream ends although its last element would go on: nothing follows, so the course stops.
#[test]
fn the_end_is_a_stop() {
    let checked = CheckVelocities::new(zigzag(4).into_iter().map(Ok::<_, Error>), PI);
    let course: Vec<_> =
        BlendedPath::new(checked.take(2), within(1e-4)).map(Result::unwrap).collect();
    assert_eq!(course.len(), 2);
    assert!(course[1].end_velocity() > 0.0 && course[1].stops_at_end());
}

/// A move that a probe has ended.
const PROBE: ElementKind =
    ElementKind::Probe { probing: Probing::TOUCH, outcome: ProbeOutcome::Tripped };

/// Rapids, probing moves, M functions, dwells, jumps and elements without length go through as they are.
#[test]
fn what_is_no_cut_stops() {
    let path = zigzag(2);
    let here = Shape::Line { start: path[0].end(), end: path[0].end() };
    let away = Shape::Line { start: path[0].end(), end: Point3::new(0.5, 0.6, 0.7) };
    let between = [
        element(ElementKind::MFunction { number: 3 }, here.clone()),
        element(ElementKind::Dwell { time_ns: 5 }, here.clone()),
        element(ElementKind::Cut, here),
        element(ElementKind::Jump, away.clone()),
        element(ElementKind::Rapid, away.clone()),
        element(PROBE, away),
    ];
    for between in between {
        let kind = between.kind;
        let path = vec![path[0].clone(), between.clone(), path[1].clone()];
        let course = course(path, within(1e-4));
        assert_eq!(course.len(), 3);
        for element in &course {
            assert_eq!((element.head(), element.tail()), (None, None), "{kind:?}");
            assert!(element.stops_at_end(), "{kind:?}");
        }
        let [_, passed, _] = &course[..] else { panic!("{course:?}") };
        assert_eq!(passed.element().shape, between.shape);
        if kind != ElementKind::Rapid && kind != PROBE {
            assert_eq!((passed.length(), passed.breaks().collect()), (0.0, vec![0.0]));
            let at = passed.at(0.0);
            assert_eq!((at.position, at.first.norm()), (between.end(), 0.0));
        }
    }
}
