//! Tests of the master motion found in a run.

use super::found::{Random, cam, using};
use super::tuned::uneven;
use crate::cam::check::AxisLimits;
use crate::cam::run::{RecordedRun, RunSample};
use crate::cam::tune::master_motion;

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
