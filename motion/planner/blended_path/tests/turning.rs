//! Tests of the path's direction for a tool that turns with it.

use super::random::{WEIGHTS, options, path};
use super::*;
use crate::blended_path::Bearing;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, TAU};

fn turning(tolerance: f64) -> BlendOptions {
    BlendOptions { turning: true, order: Order::Jerk, ..within(tolerance) }
}

fn bearing(element: &BlendedElement, s: f64) -> Bearing {
    element.bearing(s, &element.at(s)).unwrap()
}

/// The way from one angle to the other, rad.
fn between(from: f64, to: f64) -> f64 {
    (to - from + PI).rem_euclid(TAU) - PI
}

fn turns(course: &[BlendedElement]) -> Vec<f64> {
    let turns = course.iter().filter(|element| element.is_turn());
    turns.map(|turn| bearing(turn, turn.length()).along - bearing(turn, 0.0).along).collect()
}

/// The course stops at corners that it does not round, and turns there.
fn stopping(path: Vec<PathElement>, options: BlendOptions) -> Vec<BlendedElement> {
    let checked = CheckVelocities::new(path.into_iter().map(Ok::<_, Error>), 0.01);
    BlendedPath::new(checked, options).map(Result::unwrap).collect()
}

#[test]
fn nobody_asks() {
    let course = course(corner(1.0, [0.1, 0.1]), within(1e-5));
    assert_eq!(course.len(), 2);
    assert!(course.iter().all(|element| element.bearing(0.0, &element.at(0.0)).is_none()));
}

/// θ = φ + s/r; on a helix s·sweep/length.
#[test]
fn on_circles_the_direction_turns_evenly() {
    for (sweep, rise) in [(5.0, 0.0), (-3.0, 0.0), (4.0, 0.03)] {
        let course =
            course(vec![arc(Plane::Xy, [0.02, 0.0, 0.1], [0.0, 0.0], sweep, rise)], turning(1e-5));
        let [element] = &course[..] else { panic!("{course:?}") };
        let rate = sweep / element.length();
        for part in [0.0, 0.2, 0.9, 1.0] {
            let s = part * element.length();
            let Bearing { along, first, second, third } = bearing(element, s);
            let start = FRAC_PI_2 * sweep.signum();
            assert!(between(along, start + rate * s).abs() < 1e-12);
            assert!((first - rate).abs() < 1e-11 * rate.abs());
            assert!(second.abs() < 1e-10 * rate * rate);
            assert!(third.abs() < 1e-9 * rate.abs().powi(3));
        }
    }
}

#[test]
fn corners_are_turned_at_rest() {
    for turn in [0.02, 1.0, -2.0, 3.0, PI, -3.1] {
        let mut path = corner(turn, [0.1, 0.1]);
        path[1].place = Place::at(7);
        let path: Vec<_> = path.into_iter().map(|line| with_p(line, 5.0, 5.0)).collect();
        let course = stopping(path, turning(1e-5));
        let [before, spot, after] = &course[..] else { panic!("{course:?}") };
        assert!(before.stops_at_end() && spot.stops_at_end() && spot.is_turn());
        assert!((spot.length() - 1e-3 * turn.abs().to_degrees()).abs() < 1e-9);
        assert_eq!(spot.place().line, 7);
        for part in [0.0, 0.3, 1.0] {
            let s = part * spot.length();
            let at = spot.at(s);
            assert_eq!(at.position, after.at(0.0).position);
            assert_eq!([at.first, at.second, at.third], [Vector3::zeros(); 3]);
            assert_eq!(at.extra.unwrap().position[0], 5.0);
            let Bearing { along, first, second, third } = bearing(spot, s);
            assert!((along - part * turn).abs() < 1e-12);
            assert!((first * spot.length() - turn).abs() < 1e-12);
            assert_eq!([second, third], [0.0; 2]);
        }
        assert!(between(bearing(after, 0.0).along, turn).abs() < 1e-12);
    }
}

/// What is rounded needs no turn; what is not within the tolerance of 0 does, whatever the angle tolerance.
#[test]
fn rounded_corners_need_no_turn() {
    for turn in [0.02, 1.0, 2.8] {
        assert_eq!(turns(&course(corner(turn, [0.1, 0.1]), turning(1e-5))), Vec::<f64>::new());
        let exact = course(corner(turn, [0.1, 0.1]), turning(0.0));
        let [found] = turns(&exact)[..] else { panic!("{exact:?}") };
        assert!((found - turn).abs() < 1e-12 && exact[0].stops_at_end());
    }
    assert_eq!(turns(&stopping(corner(0.0, [0.1, 0.1]), turning(1e-5))), Vec::<f64>::new());
}

/// Straight down, along +y, up, a pause, along −x: as it was on the way down and up.
#[test]
fn straight_up_or_down_it_stays() {
    let points =
        [[0.1, 0.0, 0.1], [0.1, 0.0, 0.0], [0.1, 0.1, 0.0], [0.1, 0.1, 0.1], [0.0, 0.1, 0.1]];
    let mut path: Vec<_> = points.windows(2).map(|pair| line(pair[0], pair[1])).collect();
    path.insert(3, element(ElementKind::Dwell { time_ns: 1 }, line(points[3], points[3]).shape));
    for course in [stopping(path.clone(), turning(1e-5)), course(path, turning(1e-5))] {
        let along = |index: usize| bearing(&course[index], 0.5 * course[index].length()).along;
        // Down, along, up, the pause, the turn, back.
        assert_eq!(course.len(), 6);
        for (index, element) in course.iter().enumerate().take(4) {
            assert!((along(index) - FRAC_PI_2).abs() < 1e-12);
            assert!(element.tail().is_none() && element.stops_at_end());
        }
        let [turn] = turns(&course)[..] else { panic!("{course:?}") };
        assert!((turn - FRAC_PI_2).abs() < 1e-12 && course[4].is_turn());
        assert!((along(5) - PI).abs() < 1e-12);
    }
}

/// Down one steep slope and up the next: in space hardly a corner, seen from above a reversal.
#[test]
fn what_folds_seen_from_above_stops() {
    let path =
        vec![line([0.0, 0.0, 0.0], [0.01, 0.0, 0.1]), line([0.01, 0.0, 0.1], [0.0, 0.0, 0.2])];
    let [turn] = turns(&course(path, turning(1e-5)))[..] else { panic!("one turn") };
    assert!((turn - PI).abs() < 1e-9);
}

/// Up and over in the plane of Z and X, nearly a whole circle: the direction turns round twice, and nothing of the length is lost.
#[test]
fn upright_arcs_are_cut() {
    for (plane, sweep) in [(Plane::Zx, 6.0), (Plane::Zx, -6.0), (Plane::Yz, 6.0)] {
        let whole = arc(plane, [0.01, 0.01, 0.02], [0.0, 0.0], sweep, 0.0);
        let length = whole.length();
        let course = course(vec![whole], turning(1e-5));
        assert_eq!(turns(&course).len(), 2);
        assert!(turns(&course).iter().all(|turn| (turn - PI).abs() < 1e-9));
        let parts: f64 = course.iter().map(|part| part.element().path_length()).sum();
        assert!((parts - length).abs() < 1e-12);
        for part in course.iter().filter(|part| !part.is_turn()) {
            let at = |share: f64| bearing(part, share * part.length());
            assert!((0..=10).all(|tenth| at(0.1 * f64::from(tenth)) == at(0.5)));
            assert_eq!([at(0.5).first, at(0.5).second, at(0.5).third], [0.0; 3]);
        }
    }
    // With a rise it turns fast, but it does turn.
    let helix = arc(Plane::Zx, [0.01, 0.01, 0.02], [0.0, 0.0], 6.0, 0.01);
    assert_eq!(course(vec![helix], turning(1e-5)).len(), 1);
}

/// Behind an error the path goes on in another direction: not without a turn.
#[test]
fn turns_behind_errors() {
    let mut path: Vec<_> = corner(1.0, [0.1, 0.1]).into_iter().map(Ok).collect();
    path.insert(1, Err(Error::Upstream(3)));
    let checked = CheckVelocities::new(path.into_iter(), PI);
    let found: Vec<_> = BlendedPath::new(checked, turning(1e-5)).collect();
    let kinds: Vec<_> =
        found.iter().map(|next| next.as_ref().map(BlendedElement::is_turn)).collect();
    assert_eq!(kinds, [Ok(false), Err(&Error::Upstream(3)), Ok(true), Ok(false)]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The direction never steps; where the path does not stop its first derivative does not either, nor the second if that is
    /// asked for.
    #[test]
    fn without_steps(path in path(), options in options(), jerk in any::<bool>()) {
        let order = if jerk { Order::Jerk } else { Order::Acceleration };
        let course = course(path, BlendOptions { turning: true, order, ..options });
        for pair in course.windows(2) {
            let [a, b] = pair else { unreachable!() };
            let (before, after) = (bearing(a, a.length()), bearing(b, 0.0));
            let step = between(before.along, after.along);
            prop_assert!(step.abs() < 2e-8, "{step}: {a:?} {b:?}");
            let Some(blend) = a.tail() else { continue };
            let d = blend.half_width();
            let outer = |element: &BlendedElement, s: f64| {
                let at = original(element, s);
                Bearing::at(&at, element.element().shape.fourth_at(s))
            };
            let sides = [
                (Some(before), after),
                (outer(a, a.length() - d), bearing(a, a.length() - d)),
                (outer(b, d), bearing(b, d)),
            ];
            for (from, to) in sides {
                // Straight up or down on both sides.
                let Some(from) = from else { continue };
                let flat = 1e-3 + a.at(a.length() - d).first.xy().norm().min(b.at(d).first.xy().norm());
                let scale = 1e-6 / flat / flat;
                prop_assert!(between(from.along, to.along).abs() < scale);
                let most = from.first.abs().max(to.first.abs()) + 1.0 / d;
                prop_assert!((from.first - to.first).abs() < scale * most);
                if jerk {
                    let most = from.second.abs().max(to.second.abs()) + most * most;
                    prop_assert!((from.second - to.second).abs() < scale * most);
                }
            }
        }
    }

    /// Each derivative is that of the one before, wherever differences tell.
    #[test]
    fn derivatives_are_differences(path in path(), options in options(), part in 0.05..0.95) {
        let course = course(path, BlendOptions { turning: true, order: Order::Jerk, ..options });
        let mut reported = 0;
        for element in &course {
            let breaks: Vec<_> = element.breaks().collect();
            for span in breaks.windows(2) {
                let width = span[1] - span[0];
                let s = span[0] + part * width;
                let values = |s: f64| {
                    let Bearing { along, first, second, .. } = bearing(element, s);
                    [along, first, second]
                };
                let differ = |h: f64| {
                    let mut found = [0.0; 3];
                    for (weight, step) in WEIGHTS.iter().zip(1..) {
                        let by = h * f64::from(step);
                        let (right, left) = (values(s + by), values(s - by));
                        found[0] += between(left[0], right[0]) * weight / h;
                        found[1] += (right[1] - left[1]) * weight / h;
                        found[2] += (right[2] - left[2]) * weight / h;
                    }
                    found
                };
                let h = 0.01 * width;
                let (coarse, fine) = (differ(h), differ(0.5 * h));
                let here = bearing(element, s);
                for (order, found) in [here.first, here.second, here.third].into_iter().enumerate() {
                    let unit = values(s).map(f64::abs)[order].min(1.0) + 1e-3;
                    let size = found.abs().max(1e-3 * unit / width);
                    // What is near a cusp or an upright place bends too much.
                    if (coarse[order] - fine[order]).abs() > 1e-7 * fine[order].abs() {
                        continue;
                    }
                    reported += 1;
                    prop_assert!((found - fine[order]).abs() < 1e-4 * size, "{order}: {found} {fine:?} {element:?}");
                }
            }
        }
        prop_assert!(reported > 0 || course.is_empty() || course.iter().all(|element| element.length() < 1e-3));
    }
}
