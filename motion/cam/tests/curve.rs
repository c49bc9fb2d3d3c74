//! Tests of curves: evaluation, tables and repetition.

use super::{curve, knots, samples};
use crate::{
    CamError, Curve, Equidistant, Interpolation, Joints, Knot, PairTable, TableScale, VariableType,
};
use proptest::prelude::*;

/// A table in the axes' own units.
fn equidistant(values: &[f64], periodic: bool, interpolation: Interpolation) -> Equidistant {
    Equidistant {
        variable: VariableType::Lreal,
        start: 0.0,
        end: 360.0,
        periodic,
        slave: TableScale::IDENTITY,
        interpolation,
        values: values.to_vec(),
    }
}

fn pairs(pairs: &[[f64; 2]], periodic: bool, interpolation: Interpolation) -> PairTable {
    PairTable {
        variable: VariableType::Lreal,
        master: TableScale::IDENTITY,
        slave: TableScale::IDENTITY,
        periodic,
        interpolation,
        pairs: pairs.to_vec(),
    }
}

#[test]
fn beyond_the_ends_the_slave_stays() {
    let cam = curve(&[
        Knot { master: 10.0, slave: 5.0, velocity: 1.0, acceleration: 0.5 },
        Knot { master: 20.0, slave: 7.0, velocity: -1.0, acceleration: 0.5 },
    ]);
    let ends = [(9.0, 5.0), (-1e300, 5.0), (20.5, 7.0), (f64::INFINITY, 7.0)];
    for (master, slave) in ends {
        let found = cam.at(master);
        assert!((found.position - slave).abs() < 1e-12, "{master}");
        assert_eq!([found.velocity, found.acceleration, found.jerk], [0.0; 3], "{master}");
    }
    assert!((cam.at(20.0).velocity + 1.0).abs() < 1e-12, "the end itself belongs to the curve");
}

#[test]
fn repeated_curves_go_on_where_they_ended() {
    // A straight cam 0..100 → 0..50: the slave is half the master, for ever.
    let line = |master: f64| Knot { velocity: 0.5, ..Knot::at_rest(master, master / 2.0) };
    let cam = curve(&[line(0.0), line(100.0)]);
    for master in [-1234.5, -100.0, -0.25, 0.0, 99.0, 100.0, 230.0, 1e6 + 0.5] {
        let found = cam.repeated(master);
        assert!((found.position - master / 2.0).abs() < 1e-9, "{master}: {}", found.position);
        assert!((found.velocity - 0.5).abs() < 1e-12);
    }
    assert_eq!(cam.wrap(230.0), (30.0, 2.0));
    assert_eq!(cam.wrap(-1.0), (99.0, -1.0));
    // What rounds onto the end belongs to the next pass.
    assert_eq!(cam.wrap(-1e-300), (0.0, 0.0));
}

#[test]
fn points_must_make_a_curve() {
    let at = Knot::at_rest;
    assert_eq!(Curve::polynomial(&[]), Err(CamError::TooFewPoints { found: 0 }));
    assert_eq!(Curve::polynomial(&[at(0.0, 0.0)]), Err(CamError::TooFewPoints { found: 1 }));
    assert_eq!(
        Curve::polynomial(&[at(0.0, 0.0), at(2.0, 0.0), at(2.0, 1.0)]),
        Err(CamError::NotAscending { index: 3, master: 2.0, before: 2.0 })
    );
    let infinite = Curve::polynomial(&[at(0.0, 0.0), at(1.0, f64::INFINITY)]);
    assert_eq!(infinite, Err(CamError::Beyond { index: 2 }));
    // Finite points whose polynomial is not.
    let steep = [at(0.0, -1e79), at(1e-300, 1e79)];
    assert_eq!(Curve::polynomial(&steep), Err(CamError::Beyond { index: 2 }));
    // The terms of its jerk are 60, 360 and 360 times rise / width³: 7.8e80, and a tenth of it.
    for (rise, fits) in [(1.0, false), (0.1, true)] {
        let found = Curve::polynomial(&[at(0.0, 0.0), at(1e-26, rise)]);
        assert_eq!(found.is_ok(), fits, "{found:?}");
    }
}

/// Parabolas come back exactly from cubics through their points, at the ends too.
#[test]
fn cubic_tables_hold_parabolas() {
    let parabola = |x: f64| 0.01 * x * x - 2.0 * x + 3.0;
    let masters = [0.0, 10.0, 35.0, 70.0, 90.0, 200.0];
    let points: Vec<_> = masters.iter().map(|x| [*x, parabola(*x)]).collect();
    let curve = pairs(&points, false, Interpolation::Cubic).curve().expect("a curve");
    for master in samples(&curve, 50) {
        let found = curve.at(master);
        assert!((found.position - parabola(master)).abs() < 1e-10, "{master}");
        assert!((found.velocity - (0.02 * master - 2.0)).abs() < 1e-11, "{master}");
    }
    // Catmull and Rom: (10 − 0) / 240 at 120, and 1/2·(y0 + y1) + (t0 − t1)·h/8 half way.
    let table = equidistant(&[0.0, 5.0, 10.0, -4.0], false, Interpolation::Cubic);
    let curve = table.curve().expect("a curve");
    assert!((curve.at(120.0).velocity - 10.0 / 240.0).abs() < 1e-15);
    assert!((curve.at(240.0).velocity + 9.0 / 240.0).abs() < 1e-15);
    let middle = 7.5 + (10.0 + 9.0) / 240.0 * 120.0 / 8.0;
    assert!((curve.at(180.0).position - middle).abs() < 1e-12);
}

#[test]
fn periodic_tables_close() {
    for interpolation in [Interpolation::Linear, Interpolation::Cubic] {
        let curve = equidistant(&[0.0, 10.0, 0.0, -10.0], true, interpolation).curve();
        let curve = curve.expect("a curve");
        assert_eq!((curve.start(), curve.end(), curve.rise()), (0.0, 360.0, 0.0));
        assert!(curve.jumps(true).position.by.abs() < 1e-12);
        if interpolation == Interpolation::Cubic {
            assert!(curve.jumps(true).velocity.by.abs() < 1e-12, "one tangent at the seam");
            // (10 − (−10)) / 180.
            assert!((curve.at(0.0).velocity - 20.0 / 180.0).abs() < 1e-12);
        }
    }
    // A cam that gains 100 in a pass.
    let points = [[0.0, 0.0], [30.0, 40.0], [90.0, 60.0], [120.0, 100.0]];
    let curve = pairs(&points, true, Interpolation::Cubic).curve().expect("a curve");
    assert_eq!(curve.rise(), 100.0);
    let jumps = curve.jumps(true);
    assert!(jumps.velocity.by.abs() < 1e-12 && jumps.acceleration.by.abs() > 1e-3);
}

#[test]
fn tables_of_few_points() {
    let two = pairs(&[[0.0, 0.0], [10.0, 5.0]], false, Interpolation::Cubic);
    let curve = two.curve().expect("a curve");
    assert!((curve.at(4.0).position - 2.0).abs() < 1e-15);
    let one = equidistant(&[5.0], true, Interpolation::Linear).curve().expect("at rest");
    assert_eq!((one.at(100.0).position, one.rise()), (5.0, 0.0));
    assert!(equidistant(&[5.0], false, Interpolation::Linear).curve().is_err());
}

#[test]
fn tables_refuse_what_they_cannot_hold() {
    let table = |variable, value| {
        let pairs = vec![[0.0, 0.0], [1.0, value]];
        let plain = TableScale::IDENTITY;
        let (master, slave) = (plain, plain);
        let interpolation = Interpolation::Linear;
        PairTable { variable, master, slave, periodic: false, interpolation, pairs }.curve()
    };
    for (variable, most) in [
        (VariableType::Int, 32_767.0),
        (VariableType::Uint, 65_535.0),
        (VariableType::Dint, 2_147_483_647.0),
        (VariableType::Udint, 4_294_967_295.0),
    ] {
        assert!(table(variable, most).is_ok(), "{variable:?}");
        let (kind, (min, max)) = (variable.name(), variable.limits());
        let refused = CamError::OutsideType { index: 2, value: most + 1.0, kind, min, max };
        assert_eq!(table(variable, most + 1.0), Err(refused));
        assert!(table(variable, min - 1.0).is_err());
    }
    assert!(table(VariableType::Real, 1e39).is_err());
    assert!(table(VariableType::Lreal, 1e39).is_ok());
    // The manual's own example counts to 65536 in a UINT (digest 9.8).
    assert!(table(VariableType::Uint, 127.0 / 127.0 * 65_536.0).is_err());
    let mut flat = equidistant(&[0.0, 1.0], false, Interpolation::Linear);
    flat.slave = TableScale { table_max: 0.0, ..TableScale::IDENTITY };
    let error = flat.curve().expect_err("no scale");
    assert!(error.to_string().ends_with("(error 628)"), "{error}");
}

#[test]
fn numbers_of_types() {
    for (kind, number) in VariableType::ALL.into_iter().zip(1..) {
        assert_eq!((kind.number(), VariableType::from_number(number)), (number, Some(kind)));
    }
    assert_eq!((VariableType::from_number(0), VariableType::from_number(7)), (None, None));
    assert_eq!(Interpolation::from_number(3), Some(Interpolation::Cubic));
    assert_eq!(Interpolation::from_number(2), None);
}

proptest! {
    /// Values, first and second derivatives are those of the points from both sides: C2.
    #[test]
    fn points_are_kept(knots in knots()) {
        let curve = curve(&knots);
        let size = curve.extremes();
        for knot in &knots {
            let found = curve.at(knot.master);
            let near = |a: f64, b: f64, size: f64| (a - b).abs() <= 1e-11 * (1.0 + size);
            prop_assert!(near(found.position, knot.slave, size.position.magnitude()));
            prop_assert!(near(found.velocity, knot.velocity, size.velocity.magnitude()));
            prop_assert!(near(found.acceleration, knot.acceleration, size.acceleration.magnitude()));
        }
        let jumps = curve.jumps(false);
        prop_assert!(jumps.position.by.abs() <= 1e-11 * size.position.magnitude());
        prop_assert!(jumps.velocity.by.abs() <= 1e-11 * (1.0 + size.velocity.magnitude()));
        prop_assert!(jumps.acceleration.by.abs() <= 1e-11 * (1.0 + size.acceleration.magnitude()));
    }

    /// Each derivative is that of the one before, by central differences.
    #[test]
    fn derivatives_belong_together(knots in knots(), share in 0.01..0.99_f64, piece in 0..64_usize) {
        let curve = curve(&knots);
        let joints: Vec<_> = curve.joints().collect();
        let piece = piece % (joints.len() - 1);
        let width = joints[piece + 1] - joints[piece];
        let (master, h) = (joints[piece] + share * width, width * 1e-4);
        let [before, here, after] = [-h, 0.0, h].map(|by| curve.at(master + by));
        let extremes = curve.extremes();
        // The error of a difference is h²/6 times the third derivative of what is differentiated.
        let close = |low: f64, high: f64, slope: f64, size: f64| {
            ((high - low) / (2.0 * h) - slope).abs() <= 1e-5 * size / width + 1e-6 * size
        };
        prop_assert!(close(before.position, after.position, here.velocity, extremes.position.magnitude() + width * extremes.velocity.magnitude()));
        prop_assert!(close(before.velocity, after.velocity, here.acceleration, extremes.velocity.magnitude() + width * extremes.acceleration.magnitude()));
        prop_assert!(close(before.acceleration, after.acceleration, here.jerk, extremes.acceleration.magnitude() + width * extremes.jerk.magnitude()));
    }

    /// The table of cells finds the piece that halving finds.
    #[test]
    fn the_right_piece_is_found(knots in knots(), share in 0.0..1.0_f64) {
        let whole = curve(&knots);
        let master = whole.start() + share * (whole.end() - whole.start());
        let index = knots.partition_point(|knot| knot.master <= master).clamp(1, knots.len() - 1);
        let alone = curve(&knots[index - 1..=index]);
        prop_assert_eq!(whole.at(master), alone.at(master));
    }
}

/// A thousand short pieces next to a long one: cells hold many of them.
#[test]
fn pieces_of_very_different_widths() {
    let mut points = vec![[-1000.0, 0.0]];
    points.extend((0..=1000_i32).map(|i| [f64::from(i) * 1e-6, f64::from(i * i % 17)]));
    let curve = pairs(&points, false, Interpolation::Linear).curve().expect("a curve");
    for pair in points.windows(2) {
        let middle = f64::midpoint(pair[0][0], pair[1][0]);
        let expected = f64::midpoint(pair[0][1], pair[1][1]);
        assert!((curve.at(middle).position - expected).abs() < 1e-6, "{middle}");
    }
}

/// A quintic from rest to rest against its chord: w³(10 − 15w + 6w²) − w has its extremes where 30w²(1 − w)² = 1.
#[test]
fn the_largest_distance_of_curves() {
    let lift = curve(&[Knot::at_rest(0.0, 0.0), Knot::at_rest(180.0, 100.0)]);
    let line = pairs(&[[0.0, 0.0], [180.0, 100.0]], false, Interpolation::Linear);
    let line = line.curve().expect("a curve");
    let w = (1.0 - (1.0 - 4.0 / 30.0_f64.sqrt()).sqrt()) / 2.0;
    let expected = 100.0 * (w.powi(3) * (10.0 - 15.0 * w + 6.0 * w * w) - w).abs();
    let found = lift.largest_distance(&line);
    assert!((found.value - expected).abs() < 1e-10, "{found:?} {expected}");
    let mirrored = (found.master - 180.0 * w).abs().min((found.master - 180.0 * (1.0 - w)).abs());
    assert!(mirrored < 1e-6, "{found:?}");
    assert_eq!(lift.largest_distance(&lift).value, 0.0);
}

/// Lines of slope 1 and 2, from 0 over 60 to 120: y′ jumps by 1 at 60, and by −2 + 1 where it begins again; whichever way, and however far away, the master goes.
#[test]
fn jumps_are_reported_where_they_are_passed() {
    let knots = [(0.0, 0.0), (60.0, 60.0), (120.0, 180.0)];
    let knots = knots.map(|(master, slave)| Knot::at_rest(master, slave));
    let curve = Curve::linear(&knots).expect("a curve");
    let joints = Joints::of(&curve, true);
    let rises = |from: f64, to: f64| {
        let [position, velocity] = joints.passed(from, to);
        assert_eq!(position, None);
        velocity.map(|joint| (joint.place, joint.rises[1]))
    };
    for (from, to, expected) in [
        (59.0, 60.0, Some((60.0, 1.0))),
        (60.0, 61.0, None),
        (61.0, 60.0, Some((60.0, 1.0))),
        (60.0, 59.0, None),
        (119.0, 121.0, Some((120.0, -1.0))),
        (1.0, -1.0, Some((0.0, -1.0))),
        (-61.0, -59.0, Some((-60.0, 1.0))),
        (1259.5, 1260.5, Some((1260.0, 1.0))),
        (10.0, 50.0, None),
        (30.0, 30.0, None),
    ] {
        assert_eq!(rises(from, to), expected, "{from} {to}");
    }
    // More than a pass has all of them.
    assert!(rises(10.0, 1e12).is_some_and(|(_, rise)| rise.abs() == 1.0));
    // Once, the slave stays where the curve ends: y′ is gone there, and comes where it begins.
    let once = Joints::of(&curve, false);
    let rise =
        |from: f64, to: f64| once.passed(from, to)[1].map(|joint| (joint.place, joint.rises[1]));
    assert_eq!(rise(119.0, 121.0), Some((120.0, -2.0)));
    assert_eq!(rise(1.0, -1.0), Some((0.0, 1.0)));
    assert_eq!(rise(121.0, 1e9), None);
    let smooth = Curve::polynomial(&[Knot::at_rest(0.0, 0.0), Knot::at_rest(9.0, 5.0)]);
    let smooth = smooth.expect("a curve");
    assert!(Joints::of(&smooth, false).is_empty());
    assert_eq!(Joints::of(&smooth, false).passed(-1.0, 10.0), [None; 2]);
}
