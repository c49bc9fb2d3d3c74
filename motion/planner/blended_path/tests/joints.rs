//! Tests of blending at single joints.

use super::*;
use std::f64::consts::FRAC_PI_2;
use twin_path::AxisMask;

/// With the two directions a and b the derivative is a + (b − a)(3w² − 2w³), w from 0 to 1; its integral is the way.
#[test]
fn corner_in_closed_form() {
    for turn in [0.01, 0.3, FRAC_PI_2, 2.0, 2.9] {
        let [along, away] = turned(turn);
        let course = course(corner(turn, [0.1, 0.2]), within(1e-4));
        let blend = course[0].tail().unwrap();
        let d = blend.half_width();
        assert!(std::sync::Arc::ptr_eq(blend, course[1].head().unwrap()));
        for part in 0..=20 {
            let w = f64::from(part) / 20.0;
            let way = (2.0 * w - 1.0) * d;
            let found = blend.at(way);
            let weight = w * w * (3.0 - 2.0 * w);
            let integral = w * w * w * (1.0 - 0.5 * w) * 2.0 * d;
            let start = course[0].element().end() - along * d;
            let position = start + along * (2.0 * d * w) + (away - along) * integral;
            assert!((found.position - position).norm() < 1e-15);
            assert!((found.first - (along + (away - along) * weight)).norm() < 1e-12);
            let second = (away - along) * (6.0 * w * (1.0 - w) / (2.0 * d));
            assert!((found.second - second).norm() < 1e-12 / d);
            let third = (away - along) * (6.0 * (1.0 - 2.0 * w) / (4.0 * d * d));
            assert!((found.third - third).norm() < 1e-11 / (d * d));
        }
    }
}

/// As [`corner_in_closed_form`], with 10w³ − 15w⁴ + 6w⁵: its integral is w⁴·(5/2 − 3w + w²).
#[test]
fn corner_of_a_septic_in_closed_form() {
    for turn in [0.01, 0.3, FRAC_PI_2, 2.0, 2.9] {
        let [along, away] = turned(turn);
        let options = BlendOptions { order: Order::Jerk, ..within(1e-4) };
        let course = course(corner(turn, [0.1, 0.2]), options);
        let blend = course[0].tail().unwrap();
        let d = blend.half_width();
        let off = 0.3125 * d * (0.5 * turn).sin();
        assert!(off <= 1e-4 && (off > 0.9e-4 || d > 0.05 - 1e-15), "{off}");
        for part in 0..=20 {
            let w = f64::from(part) / 20.0;
            let found = blend.at((2.0 * w - 1.0) * d);
            let step = away - along;
            let weight = w * w * w * (10.0 - w * (15.0 - 6.0 * w));
            let integral = w.powi(4) * (2.5 - w * (3.0 - w)) * 2.0 * d;
            let start = course[0].element().end() - along * d;
            let position = start + along * (2.0 * d * w) + step * integral;
            assert!((found.position - position).norm() < 1e-15);
            assert!((found.first - (along + step * weight)).norm() < 1e-12);
            let left = 1.0 - w;
            let second = step * (30.0 * (w * left).powi(2) / (2.0 * d));
            assert!((found.second - second).norm() < 1e-11 / d);
            let third = step * (60.0 * w * left * (left - w) / (4.0 * d * d));
            assert!((found.third - third).norm() < 1e-10 / (d * d));
            let fourth = step * (60.0 * (1.0 - 6.0 * w * left) / (8.0 * d * d * d));
            let found = blend.fourth((2.0 * w - 1.0) * d);
            assert!((found - fourth.xy()).norm() < 1e-9 / (d * d * d));
        }
    }
}

/// 0.375·d·sin(θ/2) in the middle, and nearly the whole tolerance there where the lines are long enough.
#[test]
fn width_of_a_corner() {
    for turn in [1e-6, 1e-3, 0.1, 1.0, 2.0, 2.9] {
        for tolerance in [1e-6, 1e-4, 1e-2, 1.0] {
            let course = course(corner(turn, [0.1, 0.03]), within(tolerance));
            let d = course[0].tail().unwrap().half_width();
            let middle = course[0].element().end();
            let off = (course[0].at(course[0].length()).position - middle).norm();
            let closed = 0.375 * d * (0.5 * turn).sin();
            assert!((off - closed).abs() < 1e-12 * d + 1e-15, "{off} {closed}");
            let room = tolerance / (0.375 * (0.5 * turn).sin());
            assert!(d <= room && d < 0.015 + 1e-15);
            assert!(d > 0.015 - 1e-15 || d > 0.9 * room, "{d} of {room}");
            assert!(deviation(&course, 1000)[0] <= tolerance);
        }
    }
}

/// From a line into an arc: Δκ/4 times the largest 3x/8 + 3x³/4 − x⁵/8 − x², in powers of which the deviation is d².
#[test]
fn width_of_a_line_into_an_arc() {
    let (radius, tolerance) = (0.02, 1e-7);
    let path = || {
        let arc = arc(Plane::Xy, [0.0; 3], [0.0, radius], 1.5, 0.0);
        vec![line([-0.1, 0.0, 0.0], [0.0; 3]), arc]
    };
    let found = course(path(), within(tolerance));
    let off = |x: f64| x * (0.375 + x * (x * (0.75 - 0.125 * x * x) - 1.0));
    let largest = (0..1000).map(|part| off(f64::from(part) * 1e-3)).fold(0.0, f64::max);
    let d = found[0].tail().unwrap().half_width();
    let expected = (tolerance * 4.0 * radius / largest).sqrt();
    assert!(d > 0.93 * expected && d < 1.005 * expected, "{d} {expected}");
    let [space, _] = deviation(&found, 5000);
    assert!(space <= tolerance && space > 0.85 * tolerance, "{space}");

    // A step of the acceleration that is not asked for stays and is reported.
    let left = course(path(), only_velocity(tolerance));
    assert_eq!((left[0].tail(), left[1].head()), (None, None));
    let joint = left[0].joint();
    assert!(!joint.stop && joint.angle == 0.0 && joint.tangent_jump == 0.0);
    assert!((joint.curvature_jump - 1.0 / radius).abs() < 1e-9 / radius);
    assert_eq!(found[0].joint(), Joint::default());
}

#[test]
fn without_tolerance_nothing_is_blended() {
    for tolerance in [0.0, -1.0, f64::NAN] {
        let course = course(corner(1.2, [0.1, 0.1]), within(tolerance));
        assert_eq!((course[0].tail(), course[1].head()), (None, None));
        let joint = course[0].joint();
        assert!((joint.angle - 1.2).abs() < 1e-12 && !joint.stop);
        assert!((joint.tangent_jump - 2.0 * 0.6_f64.sin()).abs() < 1e-12);
        assert!(!course[0].stops_at_end() && course[1].stops_at_end());
        for (element, s) in [(&course[0], 0.1), (&course[0], 0.03), (&course[1], 0.0)] {
            assert_eq!(element.at(s), original(element, s));
        }
    }
}

/// In line, and arcs that were cut in two: nothing to blend, anywhere in the machine and at any length.
#[test]
fn rounding_is_no_step() {
    for (far, length) in [(0.0, 1e-6), (1.0, 0.1), (1.0, 1e-6), (1e6, 1e3), (10.0, 1e-9)] {
        let at = |part: f64| [far + part * length, far - 0.3 * part * length, part * length];
        let lines = vec![line(at(0.0), at(0.3)), line(at(0.3), at(1.0))];
        let whole = arc(Plane::Zx, [far; 3], [far + length, far], 2.0, 0.4 * length);
        let [start, end] = whole.split(0.3).unwrap();
        for path in [lines, vec![start, end]] {
            let course = course(path, within(1e-5));
            assert_eq!(course[0].tail(), None, "{far} {length} {:?}", course[0].tail());
            assert_eq!(course[0].joint(), Joint::default());
        }
    }
}

#[test]
fn what_folds_back_must_stop() {
    for turn in [2.95, 3.0, PI - 1e-9, PI] {
        for tolerance in [1e-6, 1.0] {
            let course = course(corner(turn, [0.1, 0.1]), within(tolerance));
            assert_eq!(course[0].tail(), None);
            assert!(course[0].joint().stop && course[0].stops_at_end());
            assert!((course[0].joint().angle - turn).abs() < 1e-12);
            assert!(course[0].end_velocity() > 0.0);
        }
    }
    // A little less, and it is a tenth as fast in the middle as the parameter.
    let course = course(corner(2.94, [0.1, 0.1]), within(1e-5));
    let slowest = course[0].tail().unwrap().at(0.0).first.norm();
    assert!((slowest - 1.47_f64.cos()).abs() < 1e-12 && slowest >= 0.1);
}

/// Of a queue file: a path in two parts.
#[test]
fn what_does_not_meet_must_stop() {
    let path = |gap: f64| {
        vec![line([0.0; 3], [0.1, 0.0, 0.0]), line([0.1 + gap, 0.0, 0.0], [0.1, 0.2, 0.0])]
    };
    for (gap, stops) in [(1e-3, true), (1e-8, true), (1e-10, false), (1e-14, false)] {
        let course = course(path(gap), within(1e-5));
        assert_eq!((course[0].stops_at_end(), course[0].tail().is_none()), (stops, stops), "{gap}");
    }
    let parted = |gap: f64| {
        let [a, b] = [[0.0; 3], [0.1, 0.0, 0.0]];
        vec![with_p(line(a, b), 0.0, 10.0), with_p(line(b, [0.1; 3]), 10.0 + gap, 20.0)]
    };
    assert!(course(parted(1e-3), within(1e-5))[0].stops_at_end());
    assert!(!course(parted(0.0), within(1e-5))[0].stops_at_end());
}

/// Straight on in space, while P starts, stops and turns round: its own tolerance says how wide.
#[test]
fn steps_of_an_extra_axis() {
    let path = |ways: [f64; 2]| {
        let [a, b, c] = [0.0, 0.1, 0.2].map(|x| [x, 0.0, 0.0]);
        let [first, second] = ways;
        vec![
            with_p(line(a, b), 2.0, 2.0 + first),
            with_p(line(b, c), 2.0 + first, 2.0 + first + second),
        ]
    };
    for (ways, step) in [([0.0, 10.0], 100.0), ([10.0, -10.0], 200.0), ([1.0, 3.0], 20.0)] {
        let options = BlendOptions { extra_tolerance: 0.05, ..within(1e-6) };
        let found = course(path(ways), options);
        let d = found[0].tail().unwrap().half_width();
        let expected = f64::min(0.05 / (0.1875 * step), 0.05);
        assert!(d <= expected && d > 0.95 * expected, "{d} {expected}");
        let [space, u] = deviation(&found, 1000);
        assert!(space < 1e-15 && u <= 0.05, "{space} {u}");
        for extra_tolerance in [0.0, -1.0, f64::NAN] {
            let left = course(path(ways), BlendOptions { extra_tolerance, ..options });
            assert_eq!(left[0].tail(), None);
            let joint = left[0].joint();
            assert!((joint.extra_slope_jump - step).abs() < 1e-9 && joint.tangent_jump == 0.0);
            assert!(!joint.stop);
        }
    }
    // A corner that P passes evenly needs no tolerance of P.
    let mut even = corner(1.0, [0.1, 0.1]);
    even = even.into_iter().zip([7.0, 9.0]).map(|(e, p)| with_p(e, p, p + 2.0)).collect();
    let exact = BlendOptions { extra_tolerance: 0.0, ..within(1e-5) };
    assert!(course(even, exact)[0].tail().is_some());
}

/// The first block that names an extra axis: before it the axis is where that block finds it.
#[test]
fn an_extra_axis_that_is_named_late() {
    let mut path = corner(0.5, [0.1, 0.1]);
    let second = path.pop().unwrap();
    path.push(with_p(second, 3.0, 8.0));
    let course = course(path, within(1e-4));
    let blend = course[0].tail().unwrap();
    let [before, after] =
        [-1.0, 1.0].map(|side| blend.at(side * blend.half_width()).extra.unwrap());
    assert_eq!((before.position[0], before.first[0], before.second[0]), (3.0, 0.0, 0.0));
    let expected = original(&course[1], blend.half_width()).extra.unwrap();
    assert!((after.position[0] - expected.position[0]).abs() < 1e-14);
    assert_eq!(course[0].at(0.0).extra, None);
}

/// Only P moves, and turns its speed; its F is in u/s, its length a thousandth of its way.
#[test]
fn extra_axes_alone() {
    let here = [0.1, 0.2, 0.3];
    let pair = |q: f64| {
        let mut path =
            vec![with_p(line(here, here), 0.0, 10.0), with_p(line(here, here), 10.0, 20.0)];
        let extra = ExtraAxes { start: [10.0, 0.0, 0.0, 0.0, 0.0], end: [20.0, q, 0.0, 0.0, 0.0] };
        path[1].details = Some(Box::new(Details { extra: Some(extra), ..Details::default() }));
        path
    };
    let found = course(pair(10.0), within(1e-5));
    let blend = found[0].tail().unwrap();
    // A corner of 45° in u.
    let off = blend.at(0.0).extra.unwrap().position;
    let expected = 0.1875 * blend.half_width() * 1e3 * 0.5_f64.sqrt();
    assert!((off[1] - expected).abs() < 1e-9 && off[1] <= 0.01 && off[1] > 0.009, "{off:?}");
    assert_eq!(blend.at(0.0).position, Point3::from(here));
    let exact = BlendOptions { extra_tolerance: 0.0, ..within(1e-5) };
    let joint = course(pair(10.0), exact)[0].joint();
    assert!((joint.angle - 0.25 * PI).abs() < 1e-12 && joint.tangent_jump == 0.0);
    // There and back.
    let back = vec![with_p(line(here, here), 0.0, 10.0), with_p(line(here, here), 10.0, 0.0)];
    assert!(course(back, within(1e-5))[0].joint().stop);
}

/// Z with the S profile ends without slope: the tangent is not a unit vector, and a step remains without a turn.
#[test]
fn steps_of_the_speed_alone() {
    let mut path =
        vec![line([0.0; 3], [0.04, 0.0, 0.03]), line([0.04, 0.0, 0.03], [0.1, 0.0, 0.03])];
    let details = Details { s_profile: AxisMask::Z, ..Details::default() };
    path[0].details = Some(Box::new(details));
    let left = course(path.clone(), within(0.0))[0].joint();
    assert!(left.angle < 1e-12 && (left.tangent_jump - 0.2).abs() < 1e-12, "{left:?}");
    let found = course(path, within(1e-5));
    assert!(found[0].tail().is_some());
    assert!(deviation(&found, 2000)[0] <= 1e-5);
}

/// Elements from a picometre to a thousand kilometres, alone and in company.
#[test]
fn extreme_lengths() {
    let lengths = [1e-300, 1e-161, 1e-30, 1e-15, 1e-12, 1e-9, 1e-3, 1.0, 1e6, 1e99];
    for a in lengths {
        for b in lengths {
            for (origin, bent) in [(0.0, false), (0.0, true), (1.0, false)] {
                let at = Point3::new(origin, origin, 0.0);
                let second = if bent {
                    arc(Plane::Xy, at.coords.into(), [0.0, b], 1.3, 0.1 * b)
                } else {
                    line(at.into(), (at + Vector3::new(0.2, 1.0, 0.0) * b).into())
                };
                let path = vec![line((at - Vector3::x() * a).into(), at.into()), second];
                for element in course(path, within(1e-5)) {
                    let breaks: Vec<_> = element.breaks().collect();
                    assert!(breaks.windows(2).all(|pair| pair[0] < pair[1]), "{breaks:?}");
                    for part in [0.0, 0.2, 0.5, 0.7, 1.0, f64::NAN, f64::INFINITY, -1.0] {
                        let at = element.at(part * element.length());
                        let numbers = [at.position.coords, at.first, at.second, at.third];
                        assert!(numbers.iter().flatten().all(|n| n.is_finite()), "{a} {b} {at:?}");
                    }
                    assert!(deviation(&[element], 50)[0] <= 1e-5);
                }
            }
        }
    }
    // At a picometre there is a blend still, where the coordinates have digits for it.
    let tiny = vec![line([-1e-12, 0.0, 0.0], [0.0; 3]), line([0.0; 3], [0.0, 1.0, 0.0])];
    assert_eq!(course(tiny, within(1e-5))[0].tail().unwrap().half_width(), 0.5e-12);
}

/// What preparation makes of an element is asked in one place.
#[test]
fn delegates() {
    let mut path = corner(0.5, [0.1, 0.1]);
    path.push(PathElement { place: Place::at(7), kind: ElementKind::Rapid, ..path[1].clone() });
    let course = course(path, within(1e-4));
    let [first, second, third] = &course[..] else { panic!("{course:?}") };
    assert_eq!((first.feed(), first.acceleration(), first.deceleration()), (0.05, 0.1, 0.2));
    assert_eq!((first.rapid(), third.rapid(), third.place().line), (false, true, 7));
    assert!(!first.stops_at_end() && second.stops_at_end() && third.stops_at_end());
    assert_eq!(first.end_velocity(), 0.05);
    assert_eq!(first.clone().into_element(), *first.element());
}
