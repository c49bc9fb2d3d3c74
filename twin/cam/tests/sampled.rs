//! Tables and ends of passes, against closed forms.

use super::found::{LIFT, cam, using};
use crate::cam::check::{AxisLimits, CamCheck, CamUse};
use crate::cam::sample::{MOST, Sampling, reach, write};
use crate::cam::tune::ramp_wish;
use crate::finding::{Rule, Severity};
use twin_cam::tune::{RampGoal, ramp_in};
use twin_cam::{MasterMotion, SlaveLimits};
use twin_profile::RampType;
use twin_profile::State;

/// In the middle of the rise y′ = 15/8·h/w, y″ = 0 and y‴ = −30·h/w³; a quarter of it: y″ = 60·(s − 3·s² + 2·s³)·h/w².
#[test]
fn what_the_master_adds_is_in_the_table() {
    let file = cam(LIFT);
    let master = MasterMotion { velocity: 40.0, acceleration: 300.0, jerk: 7000.0 };
    let use_it = CamUse { master, ..using(&file, 40.0, AxisLimits::NONE) };
    let (h, w, v, a, j) = (100.0, 180.0_f64, 40.0_f64, 300.0, 7000.0);
    let near = |found: f64, expected: f64| {
        assert!((found - expected).abs() <= 1e-9 * expected.abs(), "{found} {expected}");
    };
    let [acceleration, jerk] = reach(&file, &use_it, 90.0);
    let slope = 15.0 / 8.0 * h / w;
    near(acceleration[0], -slope * a);
    near(acceleration[1], slope * a);
    let own = -30.0 * h / w.powi(3) * v.powi(3);
    near(jerk[0], own - slope * j);
    near(jerk[1], own + slope * j);
    let s = 0.25_f64;
    let second = 60.0 * (s - 3.0 * s * s + 2.0 * s.powi(3)) * h / (w * w);
    let slope = 30.0 * (s * s - 2.0 * s.powi(3) + s.powi(4)) * h / w;
    let third = 60.0 * (1.0 - 6.0 * s + 6.0 * s * s) * h / w.powi(3);
    let [acceleration, jerk] = reach(&file, &use_it, 45.0);
    near(acceleration[0], second * v * v - slope * a);
    near(acceleration[1], second * v * v + slope * a);
    near(jerk[1], third * v.powi(3) + 3.0 * second * v * a + slope * j);
    // Nothing of the table is beyond what the check says, and something reaches it.
    let mut bytes = Vec::new();
    write(&file, &use_it, Sampling::Step(0.5), &mut bytes).expect("written");
    let text = String::from_utf8(bytes).expect("text");
    let header = text.lines().next().expect("a header");
    let expected = "least_acceleration_mm_per_s2,greatest_acceleration_mm_per_s2,least_jerk_mm_per_s3,greatest_jerk_mm_per_s3";
    assert!(header.ends_with(expected), "{header}");
    let column = |index: usize| {
        let cell = move |row: &str| row.split(',').nth(index).and_then(|cell| cell.parse().ok());
        let cells: Vec<f64> = text.lines().skip(1).filter_map(cell).collect();
        assert_eq!(cells.len(), 721);
        cells
    };
    let bounds = CamCheck::new(&file, use_it).bounds;
    for (least, greatest, range) in [(5, 6, bounds.acceleration), (7, 8, bounds.jerk)] {
        let least = column(least).into_iter().fold(f64::INFINITY, f64::min);
        let greatest = column(greatest).into_iter().fold(f64::NEG_INFINITY, f64::max);
        let size = range.magnitude();
        assert!(least >= range.min - 1e-9 * size && least <= range.min + 1e-2 * size);
        assert!(greatest <= range.max + 1e-9 * size && greatest >= range.max - 1e-2 * size);
    }
}

/// 360 in steps of 360 / (MOST − 1) are MOST places; a step that is smaller by a hundredth makes more.
#[test]
fn too_many_places_are_refused() {
    #[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
    let most = (MOST - 1) as f64;
    assert_eq!(Sampling::Step(360.0 / most).check(0.0, 360.0), Ok(()));
    let error = Sampling::Step(360.0 / most * 0.99).check(0.0, 360.0).expect_err("too many");
    assert!(error.places > 100_000_000.0 && error.least == 360.0 / most, "{error}");
    let said = Sampling::Step(1e-12).check(0.0, 360.0).expect_err("too many").to_string();
    assert!(said.contains("3.6e14") || said.contains("360000000000001"), "{said}");
    assert!(said.contains("more than 100000000"), "{said}");
    assert_eq!(Sampling::Count(MOST).check(0.0, 360.0), Ok(()));
}

/// At 100 deg/s tappet 50 is passed after 0.5 s; with the master at factor −2 the cam goes from 360 down at 200 deg/s, so
/// 350, passed either way, is passed after 0.05 s and the tappets that are passed forwards only never.
#[test]
fn when_tappets_are_passed() {
    let file = cam(LIFT);
    let mut use_it = using(&file, 100.0, AxisLimits::NONE);
    let times = |use_it: CamUse| -> Vec<Option<f64>> {
        let check = CamCheck::new(&file, use_it);
        file.cam.tappets().iter().map(|tappet| check.passed_after(tappet)).collect()
    };
    let masters: Vec<_> = file.cam.tappets().iter().map(|tappet| tappet.master).collect();
    assert_eq!(masters, [30.0, 50.0, 200.0, 300.0, 350.0]);
    assert_eq!(times(use_it), [Some(0.3), Some(0.5), Some(2.0), Some(3.0), Some(3.5)]);
    use_it.coupling.input.master_scaling = -2.0;
    assert_eq!(times(use_it), [Some(1.65), None, None, Some(0.3), Some(0.05)]);
}

/// A slave that stays where a pass ends at 2 mm/deg and 10 deg/s loses 20 mm/s at once.
#[test]
fn the_end_of_a_pass_that_is_not_repeated() {
    let text = LIFT
        .replace(", period = 100", "")
        .replace("{ master = 360, slave = 0 }]", "{ master = 360, slave = 0, velocity = -2 }]");
    let file = cam(&text);
    assert!(!file.repeated);
    let use_it = using(&file, 10.0, AxisLimits::NONE);
    let check = CamCheck::new(&file, use_it);
    let stop = check.stop[0].expect("a jump");
    assert_eq!(stop.master, 360.0);
    assert!((stop.by - 20.0).abs() < 1e-9, "{stop:?}");
    assert_eq!(check.smoothness(), "C0");
    let [finding] = check.findings.as_slice() else { panic!("{:?}", check.findings) };
    assert_eq!((finding.rule, finding.severity), (Rule::CamContinuity, Severity::Warning));
    assert!(finding.message.contains("its velocity jumps by 20 mm/s"), "{}", finding.message);
    let motion = SlaveLimits { acceleration: 1e6, ..SlaveLimits::NONE };
    let limited = CamUse { limits: AxisLimits { motion, ..AxisLimits::NONE }, ..use_it };
    assert_eq!(CamCheck::new(&file, limited).findings[0].severity, Severity::Error);
    // Backwards it ends at its begin, where it rests.
    let mut back = use_it;
    back.coupling.input.master_scaling = -1.0;
    let check = CamCheck::new(&file, back);
    assert_eq!((check.stop, check.smoothness()), ([None; 2], "C2"));
    // What rests at its end, or goes on, has no such jump.
    let file = cam(LIFT);
    let once = CamUse { repeated: false, ..using(&file, 10.0, AxisLimits::NONE) };
    assert_eq!(CamCheck::new(&file, once).stop, [None; 2]);
    // An acceleration alone: C1, and a note.
    let text = LIFT.replace(
        "{ master = 360, slave = 0 }]",
        "{ master = 360, slave = 0, acceleration = 0.5 }]",
    );
    let file = cam(&text.replace(", period = 100", ""));
    let check = CamCheck::new(&file, using(&file, 10.0, AxisLimits::NONE));
    let [None, Some(stop)] = check.stop else { panic!("{:?}", check.stop) };
    assert!((stop.by + 50.0).abs() < 1e-9, "{stop:?}");
    assert_eq!((check.smoothness(), check.findings[0].severity), ("C1", Severity::Note));
}

/// From 350 onto a cam at 0: on an axis of the machine file that goes round in 360 it is 10 on, 2·√(10/1000) s at 1000 u/s²; on
/// another one 350 back, 350/100 + 100/1000 s.
#[test]
fn a_ramp_goes_round_by_the_shorter_way() {
    let file = cam(&LIFT.replace(", period = 100", ""));
    let motion = SlaveLimits { velocity: 100.0, acceleration: 1000.0, ..SlaveLimits::NONE };
    for (period, expected, ends) in
        [(Some(360.0), 2.0 * 0.01_f64.sqrt(), [350.0, 360.0]), (None, 3.6, [0.0, 350.0])]
    {
        let use_it = using(&file, 0.1, AxisLimits { motion, period, ..AxisLimits::NONE });
        let slave = State { position: 350.0, ..State::default() };
        let goal = (RampType::Trapezoid, RampGoal::Soonest);
        let found = ramp_in(&ramp_wish(&file, &use_it, 0.0, slave, goal)).expect("a ramp");
        assert!((found.duration_s - expected).abs() < 1e-4, "{found:?}");
        for (found, expected) in found.positions.into_iter().zip(ends) {
            assert!((found - expected).abs() < 1e-3, "{found} {expected}");
        }
    }
}
