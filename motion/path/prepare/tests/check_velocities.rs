//! Tests of transition velocities, [`CheckVelocities`].

use super::{Error, arc, cut, line, path, stairs};
use crate::Place;
use crate::prepare::{CheckError, CheckVelocities, CornerError, Limit, ToolRadiusError};
use crate::{AxisMask, Details, ElementKind, ExtraAxes, PathElement};
use std::cell::Cell;
use std::f64::consts::{FRAC_PI_2, PI};

fn check(
    elements: Vec<Result<PathElement, Error>>,
    angle_tolerance: f64,
) -> Vec<Result<f64, Error>> {
    CheckVelocities::new(elements.into_iter(), angle_tolerance)
        .map(|element| element.map(|element| element.end_velocity))
        .collect()
}

fn end_velocities<const N: usize>(elements: [PathElement; N], angle_tolerance: f64) -> Vec<f64> {
    let elements = elements.into_iter().map(Ok).collect();
    check(elements, angle_tolerance).into_iter().map(Result::unwrap).collect()
}

/// The angle of vector `cnc-transition`, one in space, and those of which acos(1 − 5e-15) = 1e-7 knows only a tenth.
#[test]
fn angles() {
    let flat = |turn: f64, side: f64| [0.1 + turn.cos(), side * turn.sin(), 0.0];
    for (end, turn, within) in [
        ([0.2, 0.02, 0.0], 11.309_932_5_f64.to_radians(), 0.000_000_5_f64.to_radians()),
        ([0.1, 0.0, 0.1], FRAC_PI_2, 0.01 * FRAC_PI_2),
        (flat(1e-7, 1.0), 1e-7, 2e-9),
        (flat(PI - 1e-7, 1.0), PI - 1e-7, 2e-9),
        (flat(1e-7, -1.0), 1e-7, 2e-9),
        (flat(PI - 1e-7, -1.0), PI - 1e-7, 2e-9),
    ] {
        let corner = [0.1, 0.0, 0.0];
        let path = || [cut([0.0; 3], corner, 0.05), cut(corner, end, 0.03)];
        assert_eq!(end_velocities(path(), turn + within), [0.03, 0.0], "turn {turn}");
        assert_eq!(end_velocities(path(), turn - within), [0.0, 0.0], "turn {turn}");
    }
}

/// What [`crate::prepare::LimitCircularVelocities`] has set stays, where it is the smallest.
#[test]
fn a_limit_on_the_transition_is_kept() {
    let at = |x: f64| [x, 0.0, 0.0];
    let limited = |end_velocity| PathElement { end_velocity, ..cut(at(0.0), at(0.1), 0.05) };
    for (limit, expected) in [(0.02, 0.02), (0.04, 0.03), (0.0, 0.0), (f64::INFINITY, 0.03)] {
        let path = [limited(limit), cut(at(0.1), at(0.2), 0.03)];
        assert_eq!(end_velocities(path, 0.0), [expected, 0.0]);
    }
    for limit in [-0.01, f64::NAN] {
        let results = check(vec![Ok(limited(limit))], 0.0);
        assert!(matches!(results[..], [Err(Error::Check(CheckError::EndVelocity { .. }))]));
    }
    // At the end of the path and before an error it is a stop, whatever was set.
    let end = vec![Ok(limited(0.02)), Err(Error::Upstream(1)), Ok(limited(0.02))];
    assert_eq!(check(end, 0.0), [Ok(0.0), Err(Error::Upstream(1)), Ok(0.0)]);
}

/// M functions and dwells; rapids and jumps at both ends; elements of length zero; probes that trip.
#[test]
fn where_the_path_stops() {
    for (elements, expected) in [
        ("0,0 100,0 m 200,0", &[0.0; 3][..]),
        ("0,0 100,0 p200,0 300,0", &[0.0; 3]),
        ("0,0 100,0 r200,0 r300,0 400,0 500,0", &[0.0, 0.0, 0.0, 0.05, 0.0]),
        ("0,0 100,0 j0,0 100,0 100,0 200,0", &[0.0; 5]),
    ] {
        let items = path(elements).into_iter().map(Ok).collect();
        let found: Vec<_> = check(items, PI).into_iter().map(Result::unwrap).collect();
        assert_eq!(found, expected, "{elements}");
    }
    let mut dwelling = path("0,0 100,0 100,0 200,0");
    dwelling[1].kind = ElementKind::Dwell { time_ns: 1_000_000 };
    assert!(check(dwelling.into_iter().map(Ok).collect(), PI).iter().all(|end| *end == Ok(0.0)));
}

/// Their path has another unit than that of the tool; among themselves they turn as lines do.
#[test]
fn motions_of_extra_axes_alone() {
    let at = |x: f64| [x, 0.0, 0.0];
    let extra = |start: [f64; 2], end: [f64; 2]| {
        let wide = |[p, q]: [f64; 2]| [p, q, 0.0, 0.0, 0.0];
        let extra = Some(ExtraAxes { start: wide(start), end: wide(end) });
        let details = Some(Box::new(Details { extra, ..Details::default() }));
        PathElement { details, ..cut(at(0.1), at(0.1), 0.05) }
    };
    let path = [
        cut(at(0.0), at(0.1), 0.05),
        extra([0.0, 0.0], [10.0, 0.0]),
        extra([10.0, 0.0], [30.0, 0.0]),
        extra([30.0, 0.0], [40.0, 10.0]),
        cut(at(0.1), at(0.2), 0.05),
    ];
    let limit = 40_f64.to_radians();
    assert_eq!(end_velocities(path.clone(), limit), [0.0, 0.05, 0.0, 0.0, 0.0]);
    let limit = 50_f64.to_radians();
    assert_eq!(end_velocities(path, limit), [0.0, 0.05, 0.05, 0.0, 0.0]);
}

/// With the S profile Z begins and ends at rest (manual 3.2): what turns is the motion in X and Y.
#[test]
fn z_with_the_s_profile() {
    let smooth = |mut element: PathElement| {
        element.details = Some(Box::new(Details { s_profile: AxisMask::Z, ..Details::default() }));
        element
    };
    let (a, b) = ([0.1, 0.0, 0.1], [0.2, 0.0, 0.1]);
    let ramp = || cut([0.0; 3], a, 0.05);
    assert_eq!(end_velocities([ramp(), cut(a, b, 0.05)], 0.1), [0.0, 0.0]);
    assert_eq!(end_velocities([smooth(ramp()), cut(a, b, 0.05)], 0.0), [0.05, 0.0]);
    // Nothing but Z: at rest at both ends.
    let plunge = || cut([0.0, 0.0, 0.1], [0.0; 3], 0.05);
    let on = || cut([0.0; 3], [0.0, 0.0, -0.1], 0.05);
    assert_eq!(end_velocities([plunge(), on()], 0.0), [0.05, 0.0]);
    assert_eq!(end_velocities([smooth(plunge()), on()], 0.0), [0.0, 0.0]);
}

#[test]
fn segments_in_line_do_not_stop_even_without_tolerance() {
    // Sums of 0.1 mm: neighbouring directions differ in the last digits.
    let at = |n: u32| {
        let n = f64::from(n);
        [0.3 + n * 1e-4, 0.7 * (0.3 + n * 1e-4), 0.1]
    };
    let elements = (0..1000).map(|n| Ok(cut(at(n), at(n + 1), 0.05))).collect();
    let velocities = check(elements, 0.0);
    assert_eq!(velocities.iter().filter(|v| **v == Ok(0.05)).count(), 999);
}

#[test]
fn arcs_count_with_their_tangents() {
    let start_of_arc = [0.1, 0.0, 0.0];
    // Counter-clockwise about a centre on the left: goes on in +x, ends in +y.
    let path = [
        cut([0.0; 3], start_of_arc, 0.05),
        arc([0.1, 0.05, 0.0], 0.05, -FRAC_PI_2, FRAC_PI_2, 0.04),
        cut([0.15, 0.05, 0.0], [0.15, 0.1, 0.0], 0.05),
        // The same arc the other way about begins in −x: a reversal.
        arc([0.15, 0.15, 0.0], 0.05, -FRAC_PI_2, -FRAC_PI_2, 0.04),
    ];
    assert_eq!(end_velocities(path, 1e-6), [0.04, 0.04, 0.0, 0.0]);
}

#[test]
fn errors_keep_their_place_and_the_path_stops_before_them() {
    let mut elements: Vec<_> = path("0,0 100,0 200,0 300,0").into_iter().map(Ok).collect();
    for (index, number) in [(2, 3), (2, 2), (0, 1)] {
        elements.insert(index, Err(Error::Upstream(number)));
    }
    let upstream = |number| Err(Error::Upstream(number));
    let expected = [upstream(1), Ok(0.05), Ok(0.0), upstream(2), upstream(3), Ok(0.0)];
    assert_eq!(check(elements, 0.0), expected);
    assert_eq!(check(Vec::new(), 0.0), []);
}

/// `SMC_CV_ACC_DEC_VEL_NONPOSITIVE`, error 1100.
#[test]
fn limits_must_be_positive_and_finite() {
    let good = || cut([0.0; 3], [0.1, 0.0, 0.0], 0.05);
    for value in [0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let cases = [
            (Limit::Feed, PathElement { feed: value, ..good() }),
            (Limit::Acceleration, PathElement { acceleration: value, ..good() }),
            (Limit::Deceleration, PathElement { deceleration: value, ..good() }),
        ];
        for (limit, element) in cases {
            let results = check(vec![Ok(good()), Ok(element)], 0.0);
            let [Ok(0.0), Err(Error::Check(error))] = results[..] else { panic!("{results:?}") };
            let CheckError::NonPositiveLimit { place, limit: found, value: reported } = error
            else {
                panic!("{value} as {limit:?}: {error:?}");
            };
            assert_eq!((place, found), (good().place, limit));
            assert_eq!(reported.to_bits(), value.to_bits());
        }
    }
}

/// Programs are in mm (manual 3.2), and so are the messages about them.
#[test]
fn messages_are_in_millimetres() {
    let place = Place { block: Some(10), ..Place::at(3) };
    let limit = |limit, value| CheckError::NonPositiveLimit { place, limit, value };
    let errors: [Error; 7] = [
        limit(Limit::Feed, 0.0).into(),
        limit(Limit::Deceleration, -0.1).into(),
        CheckError::EndVelocity { place, value: -0.003 }.into(),
        CheckError::Length { place, length: f64::INFINITY }.into(),
        CornerError::Distance { place, distance: -0.0041 }.into(),
        ToolRadiusError::Radius { place, radius: -0.003 }.into(),
        ToolRadiusError::RadiusChange { place, from: 0.005, to: 0.0041 }.into(),
    ];
    let messages = [
        "the velocity (F) is 0 mm/s, it must be positive and finite",
        "the deceleration (E-) is -100 mm/s², it must be positive and finite",
        "the velocity at the end is -3 mm/s, it must not be negative",
        "the length of the path is inf mm, which cannot be travelled",
        "corners cannot be cut -4.1 mm before them",
        "a path cannot be corrected by a tool radius of -3 mm",
        "the tool radius changes from 5 mm to 4.1 mm within tool radius correction; end it with G40 before",
    ];
    for (error, message) in errors.iter().zip(messages) {
        assert_eq!(error.to_string(), format!("line 3 (N10): {message}"));
    }
}

#[test]
fn lengths_must_be_finite() {
    for x in [f64::NAN, f64::INFINITY, 1e200] {
        for kind in [ElementKind::Cut, ElementKind::Rapid, ElementKind::Jump] {
            let results = check(vec![Ok(line(kind, [0.0; 3], [x, 0.0, 0.0], 0.05))], 0.0);
            let [Err(Error::Check(CheckError::Length { .. }))] = results[..] else {
                panic!("{kind:?} to {x}: {results:?}");
            };
        }
    }
}

#[test]
fn holds_one_element_back() {
    let pulled = Cell::new(0);
    let stairs = stairs(10).into_iter().inspect(|_| pulled.set(pulled.get() + 1));
    let mut checked = CheckVelocities::new(stairs.map(Ok::<_, Error>), 0.0);
    for handed_out in 1..10 {
        assert!(checked.next().is_some());
        assert_eq!(pulled.get(), handed_out + 1);
    }
}
