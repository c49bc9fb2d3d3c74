//! Tests of tappet passages in recorded runs: a master that begins again, is noisy, or has gaps.

use super::found::{Random, cam, using};
use super::outputs::{VELOCITY, late, message, recorded};
use crate::cam::check::AxisLimits;
use crate::cam::run::RecordedRun;
use crate::cam::tune::{TuneError, run_dead_time};
use std::borrow::Cow;
use twin_cam::tune::Estimate;

/// What a run tells of a cam with these tappets.
fn told_of(tappets: &str, run: &RecordedRun) -> Result<Estimate, TuneError> {
    let file = cam(&format!(
        "name = \"t\"\nkind = \"tappets\"\nmaster = {{ min = 0, max = 360, unit = \"deg\" }}\n\
         slave = {{ min = 0, max = 1, period = 1 }}\ntappets = [{tappets}]\n"
    ));
    let use_it = using(&file, VELOCITY, AxisLimits::NONE);
    run_dead_time(&file, &use_it, run).map(|(found, _)| found)
}

/// Beside the place where the master begins again.
const AT_THE_END: &str =
    r#"{ group = 1, master = 359, action = "on" }, { group = 1, master = 1, action = "off" }"#;

/// Whether it is recorded from 0 to 360, from −180 to 180 or on and on, forwards or backwards, a master says the same.
#[test]
fn a_master_that_begins_again_goes_on() {
    let dead = 0.004;
    for (lowest, sign) in
        [(None, 1.0), (Some(0.0), 1.0), (Some(-180.0), 1.0), (Some(0.0), -1.0), (None, -1.0)]
    {
        let [on, off] = if sign > 0.0 { [359.0, 1.0] } else { [359.0, 361.0] };
        let mut run = recorded(&[1], 0.0005, 20_000, |time| vec![late(time, [on, off], [dead; 2])]);
        for sample in &mut run.samples {
            let whole = sign * sample.master;
            let within = |lowest: f64| (whole - lowest).rem_euclid(360.0) + lowest;
            sample.master = lowest.map_or(whole, within);
        }
        // Backwards it comes to 1 first, which is 359 of the way.
        let tappets = if sign > 0.0 {
            AT_THE_END.to_owned()
        } else {
            AT_THE_END.replace("359", "X").replace("master = 1,", "master = 359,").replace('X', "1")
        };
        let found =
            told_of(&tappets, &run).unwrap_or_else(|error| panic!("{lowest:?} {sign}: {error}"));
        assert!(found.holds(dead) && found.half_width < 0.0004, "{lowest:?} {sign}: {found:?}");
        let whole = run.unwound(360.0);
        assert_eq!(matches!(whole, Cow::Owned(_)), lowest.is_some());
        // Also where it begins again: 300 everywhere.
        for index in 0..whole.samples.len() {
            let velocity = whole.velocity(index);
            assert!((velocity - sign * VELOCITY).abs() < 1e-6, "{index}: {velocity}");
        }
    }
}

/// More than half a turn from sample to sample, on and on, is no end of a period.
#[test]
fn a_master_that_is_fast_does_not_begin_again() {
    let run = recorded(&[], 250.0 / VELOCITY, 40, |_| Vec::new());
    assert!(matches!(run.unwound(360.0), Cow::Borrowed(_)));
}

/// Of 0.5 deg, measured where the master stands, goes evenly, and begins again: 0.5 deg.
#[test]
fn noise_of_the_master_is_measured() {
    for (sigma, seed) in [(0.0, 1), (0.5, 2), (4.0, 3)] {
        let mut random = Random(seed);
        let mut run = recorded(&[], 0.002, 8000, |_| Vec::new());
        for sample in &mut run.samples {
            let place = (VELOCITY * sample.time_s.min(8.0)).rem_euclid(360.0);
            sample.master = place + sigma * random.normal();
        }
        let found = run.noise();
        assert!((found - sigma).abs() <= 0.05 * sigma + 1e-9, "{sigma}: {found}");
    }
}

const TURNED: &str = r#"{ group = 1, master = 100, action = "invert" }"#;

/// The master stands a degree behind a tappet that inverts, for six seconds, and its noise goes over the tappet again and again. What
/// the tappet has switched did not see that, or did.
#[test]
fn noise_beside_a_tappet_is_no_passage() {
    let stops = (720.0 + 101.0) / VELOCITY;
    let moving = |time: f64| if time < stops { time } else { (time - 6.0).max(stops) };
    let mut random = Random(11);
    let mut run = recorded(&[1], 0.002, 6500, |time| {
        let passes = ((VELOCITY * (moving(time - 0.002)) - 100.0) / 360.0 + 1.0).floor();
        vec![passes.rem_euclid(2.0) >= 1.0]
    });
    for sample in &mut run.samples {
        sample.master = VELOCITY * moving(sample.time_s) + 0.5 * random.normal();
    }
    let crossed = |pair: &[crate::cam::run::RunSample]| {
        let [from, to] = pair else { return false };
        (from.master < 820.0) != (to.master < 820.0)
    };
    assert!(run.samples.windows(2).filter(|pair| crossed(pair)).count() > 40);
    let found = told_of(TURNED, &run).unwrap_or_else(|error| panic!("{error}"));
    assert!((found.value - 0.002).abs() < 0.002, "{found:?}");

    // It stands on it, and the output follows a noise of its own.
    let mut bounces = run.clone();
    for (index, sample) in bounces.samples.iter_mut().enumerate() {
        let stands = (stops..stops + 6.0).contains(&sample.time_s);
        sample.master -= if sample.time_s >= stops { 1.0 } else { 0.0 };
        if stands && index % 3 == 0 {
            sample.outputs = vec![random.share() < 0.5];
        }
    }
    told_of(TURNED, &bounces).expect_err("nothing to be told from that");
}

/// Nothing was recorded for two turns and more, ten times; what was switched meanwhile says nothing, and the rest is right.
#[test]
fn gaps_of_a_run_say_nothing() {
    let mut run = recorded(&[1], 0.002, 20_000, |time| vec![late(time, [60.0, 200.0], [0.007; 2])]);
    run.samples.retain(|sample| sample.time_s.rem_euclid(4.0) < 1.3);
    let found = message(&run).unwrap_or_else(|error| panic!("{error}"));
    assert!(found.holds(0.007) && found.half_width < 0.002, "{found:?}");
}
