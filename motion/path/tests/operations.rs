//! Tests of cutting, reversing, mapping and linearising.

use super::*;
use crate::{
    Chords, Linearise, MapPath, Marks, OperationError, Plane, ProbeOutcome, Probing, Similarity,
    SplitAt, Switch, reversed,
};
use nalgebra::Rotation2;
use std::slice;

fn with_switches(shape: Shape, at: &[f64]) -> PathElement {
    let mut details = Details::default();
    for (number, at) in (1..).zip(at) {
        assert!(details.switches.add(Switch { number, on: true, at: *at }));
    }
    detailed(shape, details)
}

fn quarter() -> PathElement {
    element(arc([10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0], FRAC_PI_2))
}

/// Vector `cnc-split`; switches go with their part.
#[test]
fn split() {
    let whole = line([0.0, 30.0, 0.0], [40.0, 50.0, 0.0]);
    let [first, second] = with_switches(whole, &[0.1, 0.5, 0.75]).split(0.5).unwrap();
    assert_mm(first.end(), 20.0, 40.0, 0.0);
    assert_eq!(first.end(), second.start());
    assert_mm(second.end(), 40.0, 50.0, 0.0);
    let at = |element: &PathElement| {
        element.switches().iter().map(|s| (s.number, s.at)).collect::<Vec<_>>()
    };
    let (first, second) = (at(&first), at(&second));
    assert_eq!((first.len(), second.len()), (2, 1));
    assert!((first[0].1 - 0.2).abs() < 1e-12 && (first[1].1 - 1.0).abs() < 1e-12);
    assert!(second[0].0 == 3 && (second[0].1 - 0.5).abs() < 1e-12);
    for at in [0.0, 1.0, -0.5, f64::NAN] {
        assert!(matches!(quarter().split(at), Err(OperationError::SplitPlace(_))));
    }
}

#[test]
fn factors_that_scale_nothing() {
    for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(Similarity::scaling(factor), Err(OperationError::Factor(_))));
    }
}

/// Manual 3.3: the vector to move a program by has eight axes.
#[test]
fn extra_axes_are_moved() {
    let by = [10.0, 0.0, -2.5, 0.0, 1.0];
    let there = Similarity::translation(Vector3::new(0.001, 0.0, 0.0)).with_extra_axes(by);
    let extra = Some(ExtraAxes { start: [1.0, 2.0, 3.0, 4.0, 5.0], end: [0.0; 5] });
    let turning = detailed(quarter().shape, Details { extra, ..Details::default() });
    let moved = there.element(&turning).unwrap();
    assert_mm(moved.start(), 11.0, 0.0, 0.0);
    let expected = ExtraAxes { start: [11.0, 2.0, 0.5, 4.0, 6.0], end: by };
    assert_eq!(moved.extra(), Some(&expected));
    assert_eq!(there.element(&quarter()).unwrap().extra(), Some(&ExtraAxes { start: by, end: by }));
    // Turned, scaled and moved back, they are where they were.
    let back = Similarity::rotation(1.0).with_extra_axes(by.map(|value| -value));
    let all = there.then(&Similarity::scaling(2.0).unwrap()).then(&back);
    assert_eq!(all.element(&turning).unwrap().extra(), extra.as_ref());
    assert_eq!(all.element(&quarter()).unwrap().details, None);
}

#[test]
fn upright_arcs_are_not_turned() {
    let [start, center, end] = [0.0, 0.01, 0.02].map(|x| Point3::new(x, 0.0, 0.0));
    let upright = element(Shape::Arc(Arc::in_plane(Plane::Zx, start, end, center, PI)));
    let turned = Similarity::rotation(0.1).element(&upright);
    assert_eq!(turned, Err(OperationError::UprightArc(upright.place)));
    let moved = Similarity::translation(Vector3::new(0.0, 0.0, 1.0)).element(&upright).unwrap();
    assert_eq!(moved.start(), Point3::new(0.0, 0.0, 1.0));
    // Z to X: at the middle it is above or below, not at the side.
    let middle = upright.at(upright.length() / 2.0).position;
    assert!((middle.z.abs() - 0.01).abs() < 1e-12 && middle.y.abs() < 1e-12, "{middle}");
}

/// Sections stay active along each element on the way back; left becomes right.
#[test]
fn marks_on_the_way_back() {
    let step = |x: f64| element(line([x, 0.0, 0.0], [x + 1.0, 0.0, 0.0]));
    let mut path = [0.0, 1.0, 2.0, 3.0, 4.0].map(step);
    path[1].marks = Marks::CORRECTION_LEFT.with(Marks::LOOPS);
    path[2].marks = Marks::LOOPS_END;
    path[3].marks = Marks::CORRECTION_END;
    let back = reversed(&path);
    let marks: Vec<_> = back.iter().map(|element| element.marks).collect();
    let (none, ends) = (Marks::default(), Marks::CORRECTION_END.with(Marks::LOOPS_END));
    assert_eq!(marks, [none, Marks::CORRECTION_RIGHT, Marks::LOOPS, ends, none]);
    assert_eq!(reversed(&back), path);
}

type Item = Result<PathElement, OperationError>;

fn stream<const N: usize>(elements: [PathElement; N]) -> impl Iterator<Item = Item> {
    elements.into_iter().map(Ok)
}

fn all(stream: impl Iterator<Item = Item>) -> Vec<PathElement> {
    stream.collect::<Result<_, _>>().unwrap()
}

#[test]
fn one_element_of_a_stream_is_split() {
    let split = all(SplitAt::new(stream([quarter(), quarter(), quarter()]), 1, 0.25));
    assert_eq!(split.len(), 4);
    assert_eq!((&split[0], &split[3]), (&quarter(), &quarter()));
    assert!((split[1].length() - 0.25 * quarter().length()).abs() < 1e-15);
}

#[test]
fn a_stream_is_mapped_and_says_what_cannot_be() {
    let path = [Ok(quarter()), Err(OperationError::Factor(0.0))].into_iter();
    let mapped: Vec<_> = MapPath::new(path, Similarity::rotation(PI)).collect();
    assert_mm(mapped[0].as_ref().unwrap().start(), -10.0, 0.0, 0.0);
    assert!(mapped[1].is_err());
}

#[test]
fn lines_by_length() {
    let (start, end) = (Point3::origin(), Point3::new(0.1, 0.0, 0.0));
    let curve = cubic(Cubic::parabola(start, Point2::new(0.05, 0.1), end));
    let path = stream([with_switches(curve, &[0.5]), quarter()]);
    let lines = all(Linearise::new(path, Chords::Length(0.01)));
    // 147.9 mm in pieces of at most 10 mm, and the arc as it was.
    assert_eq!(lines.len(), 16);
    assert!(matches!(lines[15].shape, Shape::Arc(_)));
    assert_eq!(lines.iter().map(|line| line.switches().len()).sum::<usize>(), 1);
    assert_eq!(lines[7].switches().len(), 1);
    let arcs = Linearise::new(stream([quarter()]), Chords::Length(0.005)).with_arcs();
    assert_eq!(arcs.count(), 4);
}

fn shapes_and_curves() -> impl Strategy<Value = Shape> {
    prop_oneof![shapes(), cubics()]
}

/// The farthest that two shapes are apart at equal parts of their lengths.
fn apart(a: &Shape, b: &Shape) -> f64 {
    let at = |shape: &Shape, step: i32| shape.at(f64::from(step) / 20.0 * shape.length()).position;
    (0..=20).map(|step| (at(a, step) - at(b, step)).norm()).fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn reversing_twice_changes_nothing(shape in shapes_and_curves()) {
        let twice = shape.reversed().reversed();
        prop_assert!(apart(&twice, &shape) < 1e-11, "{}", apart(&twice, &shape));
        prop_assert!((twice.length() - shape.length()).abs() <= 1e-12 * shape.length());
        let back = shape.reversed();
        for part in [0.1, 0.5, 0.9] {
            let (there, here) = (back.at(part * back.length()), shape.at((1.0 - part) * shape.length()));
            prop_assert!((there.position - here.position).norm() < 1e-11);
        }
    }

    #[test]
    fn mapping_there_and_back_changes_nothing(shape in shapes_and_curves(), angle in -PI..PI, by in [-1.0..1.0, -1.0..1.0, -1.0..1.0], factor in 0.1..10.0) {
        let original = element(shape);
        let there = Similarity::rotation(angle)
            .then(&Similarity::translation(Vector3::from(by)))
            .then(&Similarity::scaling(factor).unwrap());
        let back = Similarity::scaling(1.0 / factor).unwrap()
            .then(&Similarity::translation(-Vector3::from(by)))
            .then(&Similarity::rotation(-angle));
        let mapped = there.element(&original).unwrap();
        prop_assert!((mapped.length() - factor * original.length()).abs() < 1e-11);
        // The point in between is where the map takes it.
        let s = 0.3 * original.length();
        let turned = Rotation2::new(angle) * original.at(s).position.xy().coords;
        let expected = (turned + Vector2::new(by[0], by[1])) * factor;
        prop_assert!((mapped.at(s * factor).position.xy().coords - expected).norm() < 1e-9);
        let restored = back.element(&mapped).unwrap();
        prop_assert!(apart(&restored.shape, &original.shape) < 1e-10);
    }

    #[test]
    fn sections_of_sections(shape in shapes_and_curves(), from in 0.0..0.4_f64, to in 0.6..1.0_f64) {
        let length = shape.length();
        let section = shape.section(from * length, to * length);
        // Where an arc's radii differ, by up to a thousandth here, its halves are not equally long.
        let uneven = if let Shape::Arc(arc) = &shape { (arc.end_radius() / arc.radius() - 1.0).abs() } else { 0.0 };
        prop_assert!((section.length() - (to - from) * length).abs() < (uneven + 1e-9) * length + 1e-12);
        for part in [0.0, 0.25, 0.5, 1.0] {
            let direct = shape.at((from + part * (to - from)) * length).position;
            prop_assert!((section.at(part * section.length()).position - direct).norm() < 1e-9);
        }
        let whole = shape.section(0.0, length);
        prop_assert_eq!((whole.start(), whole.end()), (shape.start(), shape.end()));
    }

    #[test]
    fn lines_end_on_the_curve_and_turn_little(shape in shapes_and_curves(), degrees in 2.0..20.0) {
        let limit = f64::to_radians(degrees);
        let lines = all(Linearise::new(stream([element(shape.clone())]), Chords::Angle(limit)).with_arcs());
        prop_assert_eq!(lines[0].start(), shape.start());
        prop_assert_eq!(lines[lines.len() - 1].end(), shape.end());
        let mut s = 0.0;
        for pair in lines.windows(2) {
            prop_assert_eq!(pair[0].end(), pair[1].start());
            let (a, b) = (pair[0].end_tangent(), pair[1].start_tangent());
            let angle = a.cross(&b).norm().atan2(a.dot(&b));
            // More lines do not make the angle of a cusp smaller.
            let smooth = pair.iter().all(|line| line.length() > 1e-5 * shape.length());
            prop_assert!(!smooth || angle < limit, "{angle} {limit}");
            s += pair[0].length();
        }
        s += lines[lines.len() - 1].length();
        prop_assert!(s <= shape.length() * (1.0 + 1e-12));
    }
}

/// Of a probing move neither what it waits for nor how it has ended gets lost, and two are not made of one.
#[test]
fn probing_moves() {
    let kind = ElementKind::Probe { probing: Probing::RELEASE, outcome: ProbeOutcome::Tripped };
    let probe = PathElement { kind, ..element(line([0.0; 3], [0.0, 0.0, -5.0])) };
    let ends = |element: &PathElement| (element.start() * 1e3, element.end() * 1e3);
    assert_eq!((probe.reversed().kind, probe.length()), (kind, 0.005));
    let (zero, down) = (Point3::origin(), Point3::new(0.0, 0.0, -5.0));
    assert_eq!(ends(&probe.reversed()), (down, zero));
    let path = || stream([probe.clone()]);
    let chords = Linearise::new(path(), Chords::Length(1e-3)).with_arcs();
    assert_eq!(all(chords), slice::from_ref(&probe));
    let moved = all(MapPath::new(path(), Similarity::translation(Vector3::z() * 5e-3)));
    let [moved] = &moved[..] else { panic!("{moved:?}") };
    assert_eq!((moved.kind, moved.end()), (kind, zero));
    let refused = OperationError::SplitProbe(probe.place);
    assert_eq!(SplitAt::new(path(), 0, 0.5).collect::<Vec<_>>(), [Err(refused)]);
    assert_eq!(refused.to_string(), "line 3 (N30): a probing move cannot be split");
    assert_eq!(all(SplitAt::new(path(), 1, 0.5)), slice::from_ref(&probe));
}
