//! Tests of `check` and `limit` on the same program and machine: gaps, and decelerations that are limits of their own.

use crate::check::{CheckOptions, check};
use crate::finding::{Finding, Rule};
use crate::limit::{
    ControllerProfile, LimitRules, LimitSummary, Limits, Profile, ProfileItem, Summing, Windows,
};
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use std::path::Path;
use twin_machine::Machine;

/// X: 400 mm/s, 3000 mm/s².
const GANTRY3: &str = include_str!("../../tests/data/machines/gantry3.toml");

fn summary_of(
    machine: &Machine,
    profile: impl Iterator<Item = ProfileItem>,
) -> (LimitSummary, Vec<Finding>) {
    let (mut summing, mut findings) = (Summing::new(&machine.axes), Vec::new());
    for item in profile {
        match item {
            ProfileItem::Sample(sample) => summing.include(&sample),
            ProfileItem::Finding(finding) => findings.push(finding),
            ProfileItem::Io(error) => panic!("{error}"),
        }
    }
    (summing.finish(Windows::default(), |_| None), findings)
}

/// Durations of a program in `check` and in `limit`, s, with the summary and the findings of `limit`.
fn both(machine: &Machine, text: &str, limits: Limits) -> ([f64; 2], LimitSummary, Vec<Finding>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.cnc");
    std::fs::write(&path, text).unwrap();
    let program =
        ProgramFile::new(&path, Some(Dialect::Din66025), ReadSettings::default()).unwrap();
    let options = CheckOptions { limits, ..CheckOptions::default() };
    let outcome = check(machine, &program, options, &mut |_| {}).unwrap();
    let expected = [Rule::Gap, Rule::FeedReduced, Rule::ProgrammedPlan];
    let found = &outcome.findings;
    assert!(found.iter().all(|one| expected.contains(&one.rule)), "{found:#?}");
    let (summary, findings) = match limits {
        Limits::Axes => {
            let profile = Profile::new(&program, machine, LimitRules::default()).unwrap();
            summary_of(machine, profile)
        }
        Limits::Programmed => {
            summary_of(machine, ControllerProfile::new(&program, machine).unwrap())
        }
    };
    let checked = twin_number::seconds(outcome.duration_ns);
    ([checked, summary.duration_s], summary, findings)
}

/// The example of manual 3.2: X crosses 50 mm in 2·√(50/3000) s while the path waits.
#[test]
fn limit_counts_the_time_of_gaps_as_check_does() {
    let machine = Machine::parse(Path::new("gantry3.toml"), GANTRY3).unwrap();
    let text =
        "% example\nN10 G92 X100 Y100\nN20 G1 X100 Y100 F100\nN30 G92 X50 Y100\nN40 G1 X60\n";
    for limits in [Limits::Axes, Limits::Programmed] {
        let ([checked, limited], summary, findings) = both(&machine, text, limits);
        assert!((checked - limited).abs() < 1e-9, "{limits:?}: {checked} and {limited}");
        assert!(limited > 2.0 * (50.0_f64 / 3000.0).sqrt() + 0.1, "{limits:?}: {limited}");
        let [note] = &findings[..] else { panic!("{findings:#?}") };
        assert_eq!((note.rule, note.line, note.block), (Rule::Gap, 4, Some(30)));
        let fastest = (50.0_f64 * 3000.0).sqrt() * 1e-3;
        let [x, ..] = &summary.peaks[..] else { panic!("three axes") };
        assert!((x.velocity.value - fastest).abs() < 2e-3, "{x:?}");
        let [least, most] = x.position.unwrap();
        assert!((least - 0.05).abs() < 1e-6 && (most - 0.1).abs() < 1e-6, "{x:?}");
    }
}

/// X goes 100 mm with 400 mm/s, 3000 mm/s² and its own deceleration d: L/v + v/2·(1/a + 1/d). `check` finds nothing.
#[test]
fn decelerations_are_limits_of_their_own() {
    for deceleration in [1500.0_f64, 6000.0] {
        let own = format!("name = \"X\"\nmax_deceleration_mm_per_s2 = {deceleration}");
        let mut machine =
            Machine::parse(Path::new("own.toml"), &GANTRY3.replacen("name = \"X\"", &own, 1))
                .unwrap();
        for axis in &mut machine.axes {
            axis.simulated.effort_limit = f64::INFINITY;
        }
        let text = "% line\nN10 G1 X100 F1000 E9000 E-9000\n";
        let ([checked, limited], summary, findings) = both(&machine, text, Limits::Axes);
        let least = 100.0 / 400.0 + 200.0 * (1.0 / 3000.0 + 1.0 / deceleration);
        for takes in [checked, limited] {
            assert!((least..least + 3e-3).contains(&takes), "{takes}, at least {least}");
        }
        assert!(findings.is_empty(), "{findings:#?}");
        let [x, ..] = &summary.peaks[..] else { panic!("three axes") };
        assert!((x.acceleration.value - 3.0).abs() < 1e-3, "{x:?}");
        let slowing = x.deceleration.unwrap().value;
        assert!((slowing - deceleration * 1e-3).abs() < 1e-3, "{x:?}");
    }
}
