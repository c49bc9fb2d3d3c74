//! Parameters of all families to a file and back.

use super::bench::{Bench, in_every_family, interpcnc, quick_interpcnc, smartdrive};
use twin_drives::{
    Drive, ParameterId, ParameterInfo, Values,
    backup::{plan, read, write_parameters},
};

/// Another value that the parameter takes.
fn other(info: &ParameterInfo, value: i64) -> i64 {
    let candidates = match &info.values {
        Values::Between(low, high) => vec![value + 1, value - 1, *low, *high],
        Values::OneOf(values) => values.clone(),
    };
    candidates
        .into_iter()
        .find(|candidate| *candidate != value && info.values.contain(*candidate))
        .unwrap()
}

fn values(drive: &mut dyn Drive, all: &[ParameterInfo]) -> Vec<i64> {
    let ids: Vec<_> = all.iter().map(|info| info.id).collect();
    drive.parameter_values(&ids).unwrap()
}

/// Every parameter is changed, put back, and as before.
fn survive(mut bench: Bench) {
    let drive = &mut *bench.drive;
    let all = drive.parameters().unwrap();
    let before = values(drive, &all);
    let mut file = Vec::new();
    assert_eq!(write_parameters(drive, "f", &mut file).unwrap(), all.len());
    let backup = read("f", &mut file.as_slice()).unwrap();
    let found = backup.entries.iter().map(|entry| (entry.id, entry.value));
    let expected = all.iter().map(|info| info.id).zip(before.iter().copied());
    assert!(found.eq(expected));
    let nothing = plan(drive, &backup).unwrap();
    assert!(nothing.is_empty() && nothing.same == all.len(), "{nothing}");
    let writable: Vec<_> = all
        .iter()
        .zip(&before)
        .filter(|(info, value)| info.writable && !info.of_the_line && info.values.contain(**value))
        .collect();
    // All of them, and then some, saved.
    for (save, every) in [(false, 1), (true, 19)] {
        let changed = || writable.iter().step_by(every);
        for (info, value) in changed() {
            drive.set_parameter(info.id, other(info, **value)).unwrap();
        }
        let plan_of_all = plan(drive, &backup).unwrap();
        let planned: Vec<_> = plan_of_all.changes.iter().map(|change| change.id).collect();
        let expected: Vec<_> = changed().map(|(info, _)| info.id).collect();
        assert_eq!(planned, expected);
        assert_eq!(plan(drive, &backup).unwrap(), plan_of_all, "a plan changes nothing");
        plan_of_all.carry_out(drive, save).unwrap();
        assert_eq!(values(drive, &all), before);
    }
}

#[test]
fn the_parameters_of_every_family_survive() {
    in_every_family(quick_interpcnc, survive);
}

/// A file of another device's family is refused, and the address of a drive stays what it is.
#[test]
fn files_of_others_are_refused_and_addresses_stay() {
    let (mut board, mut bus) = (interpcnc(), smartdrive());
    let mut file = Vec::new();
    write_parameters(&mut *bus.drive, "f", &mut file).unwrap();
    let backup = read("drives.txt", &mut file.as_slice()).unwrap();
    let error = plan(&mut *board.drive, &backup).unwrap_err().to_string();
    let expected = "drives.txt:3: these are parameters of SmartDRIVE, the device is InterpCNC";
    assert_eq!(error, expected);
    let text = String::from_utf8(file).unwrap().replace("3 2 3 #", "3 2 9 #");
    let readdressed = read("f", &mut text.as_bytes()).unwrap();
    let plan = plan(&mut *bus.drive, &readdressed).unwrap();
    assert!(plan.is_empty());
    assert_eq!((plan.of_the_line.len(), plan.of_the_line[0].to), (1, 9));
    plan.carry_out(&mut *bus.drive, true).unwrap();
    assert_eq!(bus.drive.parameter(ParameterId { address: 3, number: 2 }).unwrap(), 3);
}
