//! Tests of the master motion found in a run, and of the smallest peak from there.

use super::found::{Random, cam, using};
use super::tuned::{Plant, VELOCITY, recorded, uneven};
use crate::cam::check::{AxisLimits, CamUse};
use crate::cam::run::{RecordedRun, RunSample};
use crate::cam::tune::{
    Constrained, Least, corrected, fit_run, master_motion, minimise, wanted, wants,
};
use twin_cam::Quantity;
use twin_cam::tune::Free;
use twin_machine::cam_file::CamFile;

/// A run every 2 ms of a master, with noise of it.
fn driven(count: i32, noise: f64, master: impl Fn(f64) -> f64) -> RecordedRun {
    let mut random = Random(3);
    let sample = |index: i32| {
        let time_s = f64::from(index) * 0.002;
        let master = master(time_s) + noise * random.normal();
        let line = 2 + u64::from(index.unsigned_abs());
        RunSample { line, time_s, master, slave: 0.0, outputs: Vec::new() }
    };
    RecordedRun { groups: Vec::new(), samples: (0..count).map(sample).collect() }
}

/// Half a second at 600 deg/s² up to 300 deg/s, one second of it, and down again.
fn trapezoid(time: f64) -> f64 {
    match time {
        time if time < 0.5 => 300.0 * time * time,
        time if time < 1.5 => 75.0 + 300.0 * (time - 0.5),
        time => 375.0 + 300.0 * (time - 1.5) - 300.0 * (time - 1.5).powi(2),
    }
}

#[test]
fn a_run_shows_how_its_master_goes() {
    let file = cam(&uneven());
    let use_it = using(&file, 1.0, AxisLimits::NONE);
    let shown = |run: &RecordedRun| master_motion(&file, &use_it, run).expect("it moves");
    for (noise, of_velocity, of_pull) in [(0.0, 1e-9, 1e-6), (0.01, 2e-3, 0.1)] {
        let motion = shown(&driven(1001, noise, trapezoid));
        assert!((motion.velocity / 300.0 - 1.0).abs() < of_velocity, "{noise}: {motion:?}");
        assert!((motion.acceleration / 600.0 - 1.0).abs() < of_pull, "{noise}: {motion:?}");
        assert_eq!(motion.jerk, 0.0);
        // Evenly, and what begins again at 0 after a turn.
        for turn in [f64::INFINITY, 360.0] {
            let even = |time: f64| {
                let at = 5.0 + 250.0 * time;
                if turn.is_finite() { at.rem_euclid(turn) } else { at }
            };
            let motion = shown(&driven(1501, noise, even));
            assert!((motion.velocity / 250.0 - 1.0).abs() < of_velocity, "{noise}: {motion:?}");
            assert_eq!(motion.acceleration, 0.0, "{noise}");
        }
    }
    let still = driven(100, 0.01, |_| 90.0);
    assert_eq!(master_motion(&file, &use_it, &still), None);
}

const PLANT: Plant = Plant { lag: 0.005, gain: 1.02, shift: 3.0 };

/// One run of the machine, and what is proposed: the slave's scaling as small as 0.9, and the slave a little lower.
fn tuned(file: &CamFile, use_it: &CamUse) -> (CamUse, CamUse, Constrained) {
    let run = recorded(file, &use_it.coupling, &PLANT, 0.0);
    let free = Free { master_scaling: false, ..Free::ALL };
    let fit = fit_run(file, &wanted(use_it), &run, free, 0.05, [None; 4]).expect("a fit");
    let (corrected, deviation) = corrected(file, use_it, &fit);
    let least = Least {
        quantity: Quantity::Jerk,
        sought: [None, None, Some([-9.0, 9.0]), Some([0.9, 1.1])],
    };
    let (mut after, found) = minimise(file, &corrected, &least).expect("a peak");
    after.coupling.wanted = wants(&deviation, &corrected, &after);
    (corrected, after, found)
}

/// f(m − 1.8) · 1.02 + 3 is undone first, so that the scaling goes from 1/1.02 down to 0.9; the slave then does 0.9 · 1.02 of the
/// cam, which is what is wanted of it from now on: another run changes nothing.
#[test]
fn the_smallest_peak_of_a_slave_that_was_measured() {
    let file = cam(&uneven());
    let first = using(&file, VELOCITY, AxisLimits::NONE);
    let (_, second, found) = tuned(&file, &first);
    let input = &second.coupling.input;
    for (value, truth) in [
        (input.master_offset, 1.8),
        (found.from[3], 1.0 / 1.02),
        (input.slave_scaling, 0.9),
        (input.slave_offset, -3.0 / 1.02),
        // From rest to rest y‴ is 60 · h/w³ at most: 30 mm in 60 deg.
        (found.before, 60.0 * 30.0 / 60.0_f64.powi(3) * VELOCITY.powi(3) / 1.02),
        (found.after, 60.0 * 30.0 / 60.0_f64.powi(3) * VELOCITY.powi(3) * 0.9),
    ] {
        assert!((value / truth - 1.0).abs() < 1e-8, "{value} is not {truth}");
    }
    let want = second.coupling.wanted.expect("what is wanted");
    for (value, truth) in want.into_iter().zip([0.0, 1.0, 0.0, 0.9 * 1.02]) {
        assert!((value - truth).abs() < 1e-8, "{value} is not {truth}");
    }
    let (corrected, third, _) = tuned(&file, &second);
    assert_eq!(corrected, second);
    assert_eq!(third, second);
}
