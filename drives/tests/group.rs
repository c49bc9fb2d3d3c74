//! An axis group of devices of different families: started, reset, and without the one that fails.

use super::bench::{Bench, bim2ax, interpcnc, smartdrive};
use crate::{
    DriveError, ParameterId,
    axis::{AxisGroup, GroupPhase, GroupTask, SoftwareMaxima, StartStep},
};

/// One task of the group. `maxima` is what is wanted of the axes, a unit being 100 increments.
fn carry_out(
    task: GroupTask,
    benches: &mut [Bench],
    maxima: &SoftwareMaxima,
) -> Result<(), String> {
    let text = |error: DriveError| error.to_string();
    let (drive, step) = match task {
        GroupTask::Start { drive, step } => (&mut benches[drive], step),
        GroupTask::Lock { drive } => return benches[drive].drive.disable().map_err(text),
        GroupTask::RestoreRatios => return Ok(()),
    };
    match step {
        StartStep::Connecting => drive.drive.probe(&drive.clock).map(|_| ()).map_err(text),
        StartStep::Identity => drive.drive.identity().map(|_| ()).map_err(text),
        StartStep::Parameters => drive.drive.parameters().map(|_| ()).map_err(text),
        StartStep::Limits => {
            let limits = drive.drive.limits().map_err(text)?;
            let beyond = maxima.beyond(&limits[0], 100.0);
            let named = |(name, most, wanted): &(&str, f64, f64)| {
                format!("{name} {wanted} is beyond {most}")
            };
            beyond.first().map(named).map_or(Ok(()), Err)
        }
        StartStep::Enabling => drive.drive.enable().map_err(text),
        StartStep::Homed => drive.drive.homed().map(|_| ()).map_err(text),
    }
}

fn run(group: &mut AxisGroup, benches: &mut [Bench], maxima: &SoftwareMaxima) {
    while let Some(task) = group.task() {
        let outcome = carry_out(task, benches, maxima);
        group.report(outcome);
    }
}

#[test]
fn a_group_starts_without_the_drive_that_fails() {
    let mut benches = [interpcnc(), smartdrive(), bim2ax()];
    let names: Vec<_> = benches.iter().map(|bench| bench.drive.describe()).collect();
    let mut group = AxisGroup::new(names.clone());
    // 100 u/s are 10000 increments/s, which is as fast as the module is set to.
    let maxima = SoftwareMaxima { acceleration: 150.0, deceleration: 150.0, ..Default::default() };
    run(&mut group, &mut benches, &maxima);
    assert!(group.is_ready(), "{:?}", group.boot_error());
    for bench in &mut benches {
        bench.drive.sample(&bench.clock).unwrap();
    }
    group.reset(false);
    assert_eq!(group.phase(), GroupPhase::Resetting);
    run(&mut group, &mut benches, &SoftwareMaxima { velocity: 101.0, ..maxima });
    assert_eq!((group.state(), group.error_drive()), (1030, Some(2)));
    let expected = format!("{}: limits: velocity 101 is beyond 100", names[2]);
    assert_eq!(group.boot_error(), Some(expected.as_str()));
    let locked = benches[0].drive.sample(&benches[0].clock);
    assert!(matches!(locked, Err(DriveError::Locked { .. })), "{locked:?}");
    // Without that one the others work; it stays locked.
    group.disable(2, true);
    group.reset(true);
    run(&mut group, &mut benches, &SoftwareMaxima { velocity: 101.0, ..maxima });
    assert!(group.is_ready() && !group.takes_part(2));
    benches[0].drive.sample(&benches[0].clock).unwrap();
    assert!(benches[2].drive.sample(&benches[2].clock).is_err());
    let fast = ParameterId { station: 0, number: 0x0A };
    benches[2].drive.set_parameter(fast, 20_000).unwrap();
    group.enable_all();
    group.reset(true);
    run(&mut group, &mut benches, &SoftwareMaxima { velocity: 101.0, ..maxima });
    assert!(group.is_ready(), "{:?}", group.boot_error());
}
