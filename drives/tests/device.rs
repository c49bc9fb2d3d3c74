//! Tests of all families: identity, lock, homing, inputs, limits and parameters of a device.

use std::collections::HashSet;

use super::bench::{Bench, HOME, bim2ax, in_every_family, interpcnc, smartdrive};
use twin_drives::{DeviceLimits, Drive, DriveError, ParameterId, ParameterInfo, Values};

fn id(address: u8, number: u16) -> ParameterId {
    ParameterId { address, number }
}

/// Homes the first axis: it ends on the edge of the switch, of which the second knows as much as before.
///
/// `zero` is the position that the device gives the edge, `known` what is known of the homing of axes before.
fn homes(mut bench: Bench, zero: i64, known: Option<bool>) -> Bench {
    let drive = &mut bench.drive;
    drive.enable().unwrap();
    let start = drive.sample(&bench.clock).unwrap().position;
    assert_eq!(start, [0; 5]);
    assert_eq!(drive.homed().unwrap()[..2], [known; 2]);
    drive.begin_homing(&[Some(5000), None, None, None, None]).unwrap();
    // How long it takes depends on what else this machine has to do; while it moves it is not home.
    let under_way = drive.homed().unwrap();
    if drive.sample(&bench.clock).unwrap().moving {
        assert_eq!(under_way[..2], [Some(false), known]);
    }
    bench.rest();
    let drive = &mut bench.drive;
    assert_eq!(drive.homed().unwrap()[..2], [Some(true), known]);
    let home = drive.sample(&bench.clock).unwrap().position;
    assert!((home[0] - zero).abs() <= 1, "{home:?}");
    assert_eq!(home[1], 0);
    // Off the switch, and on it a little further back.
    let mut back = home;
    back[0] -= 20;
    drive.move_to(&back, &[300.0; 5]).unwrap();
    bench.rest();
    let drive = &mut bench.drive;
    assert_eq!(drive.sample(&bench.clock).unwrap().position, back);
    assert_eq!(drive.homed().unwrap()[..2], [Some(true), known], "it stays so");
    bench
}

/// Locks the device, which then refuses to sample as one that obeys, and unlocks it.
fn is_locked(bench: &mut Bench) {
    let drive = &mut bench.drive;
    drive.disable().unwrap();
    assert!(drive.sample(&bench.clock).is_err(), "it does not obey");
    drive.enable().unwrap();
    drive.sample(&bench.clock).unwrap();
}

/// A moment without supply is seen afterwards, and nothing like it before.
fn shows_a_restart(mut bench: Bench) {
    let drive = &mut bench.drive;
    drive.enable().unwrap();
    assert!(!drive.shows_restart().unwrap(), "it obeys, and is at 0");
    drive.move_to(&[300, 200, 0, 0, 0], &[900.0; 5]).unwrap();
    bench.rest();
    let drive = &mut bench.drive;
    assert!(!drive.shows_restart().unwrap());
    (bench.brown_out)();
    // A module needs some time to start.
    let seen = (0..1000).find_map(|_| {
        std::thread::sleep(std::time::Duration::from_millis(2));
        drive.shows_restart().ok()
    });
    assert_eq!(seen, Some(true));
    // Enabled again it is at 0, which is not a restart.
    drive.enable().unwrap();
    assert!(!drive.shows_restart().unwrap());
    assert_eq!(drive.probe(&bench.clock).unwrap().position[0], 0);
}

#[test]
fn a_device_that_was_without_supply_shows_it() {
    let mut bench = interpcnc();
    bench.drive.enable().unwrap();
    bench.drive.set_position(&[70, 0, 0, 0, 0]).unwrap();
    bench.drive.hard_stop().unwrap();
    // What has locked it was the driver.
    assert!(!bench.drive.shows_restart().unwrap() && bench.drive.hard_stop_keeps_position());
    in_every_family(interpcnc, shows_a_restart);
}

/// Descriptions are sound, and wrong requests are refused with a reason.
fn described(drive: &mut dyn Drive) -> Vec<ParameterInfo> {
    let all = drive.parameters().unwrap();
    let ids: HashSet<_> = all.iter().map(|info| info.id).collect();
    let names: HashSet<_> = all.iter().map(|info| (&info.name, info.axis)).collect();
    assert_eq!((ids.len(), names.len()), (all.len(), all.len()));
    for info in &all {
        let value = drive.parameter(info.id).unwrap();
        assert!(info.values.contain(value) || !info.writable || value == 0, "{info:?}: {value}");
        let set = drive.set_parameter(info.id, i64::MAX);
        let expected = if info.writable {
            matches!(set, Err(DriveError::ParameterValue { value: i64::MAX, .. }))
        } else {
            matches!(set, Err(DriveError::ReadOnly { .. }))
        };
        assert!(expected, "{info:?}: {set:?}");
    }
    for missing in [id(0, 9999), id(99, 26)] {
        let read = drive.parameter(missing);
        assert!(matches!(read, Err(DriveError::NoParameter { .. })), "{read:?}");
        let set = drive.set_parameter(missing, 0);
        assert!(matches!(set, Err(DriveError::NoParameter { .. })), "{set:?}");
    }
    all
}

/// Inputs 5 and 6, speed, acceleration, start-stop, slow, zero at the end; parameters of published sources.
fn set_homing(drive: &mut dyn Drive, zero: i64) {
    for (number, value) in
        [(29, 5), (30, 6), (12, 4000), (13, 200), (14, 400), (15, 200), (128, zero)]
    {
        drive.set_parameter(id(0, number), value).unwrap();
        assert_eq!(drive.parameter(id(0, number)).unwrap(), value);
    }
}

/// Parameter 128 of 0: the counter stays as it is, and is no position from the home.
#[test]
fn an_interpcnc_that_keeps_its_counters_is_not_home() {
    let mut bench = interpcnc();
    let drive = &mut bench.drive;
    drive.enable().unwrap();
    set_homing(&mut **drive, 0);
    drive.begin_homing(&[Some(5000), None, None, None, None]).unwrap();
    bench.rest();
    let home = bench.drive.homed();
    let Err(DriveError::NotArrived { target: 0, found, .. }) = home else { panic!("{home:?}") };
    assert!((found - i64::from(HOME)).abs() <= 100, "{found}");
    assert_eq!(bench.drive.homed().unwrap()[0], Some(false));
}

#[test]
fn an_interpcnc_says_who_it_is_and_homes() {
    let mut bench = interpcnc();
    let drive = &mut bench.drive;
    let text = drive.identity().unwrap().to_string();
    let rest = "line 115200 baud, no parity, recipes yes, firmware 5.30 or later";
    assert_eq!(text, format!("InterpCNC, address 1, address by parameter 103 1, {rest}"));
    drive.enable().unwrap();
    let none = drive.begin_homing(&[Some(5000), None, None, None, None]);
    assert!(matches!(none, Err(DriveError::Unsupported { .. })), "{none:?}");
    set_homing(&mut **drive, 1);
    let signals = drive.signals(&|| 5).unwrap();
    assert_eq!((signals.time_ns, signals.enable), (5, Some(true)));
    let homes_on = [signals.axes[0].home, signals.axes[1].home, signals.axes[2].home];
    assert_eq!(homes_on, [Some(false), Some(false), None]);
    let mut bench = homes(bench, 0, None);
    let signals = bench.drive.signals(&|| 0).unwrap();
    assert_eq!((signals.axes[0].home, signals.axes[1].home), (Some(true), Some(false)));
    assert_eq!(signals.inputs.levels(), 1 << 4);
    assert_eq!(signals.inputs.name(5), Some("IN5".to_owned()));
    bench.drive.set_output(3, true).unwrap();
    assert_eq!(bench.drive.signals(&|| 0).unwrap().outputs.get(3), Some(true));
    is_locked(&mut bench);
    assert_eq!(bench.drive.homed().unwrap()[..2], [Some(true), None], "nothing is lost at rest");
    bench.drive.hard_stop().unwrap();
    bench.drive.enable().unwrap();
    assert_eq!(bench.drive.homed().unwrap()[..2], [Some(false), None]);
    // The way to the switch is not gone again, and longer than what is allowed.
    bench.drive.move_to(&[3000, 0, 0, 0, 0], &[20e3; 5]).unwrap();
    bench.rest();
    bench.drive.begin_homing(&[Some(1000), None, None, None, None]).unwrap();
    bench.rest();
    // B11 says that homing has failed and not of which axis: what is not known to be homed is not.
    assert_eq!(bench.drive.homed().unwrap()[..2], [Some(false), Some(false)]);
}

#[test]
fn an_interpcnc_describes_its_parameters() {
    let mut bench = interpcnc();
    let all = described(&mut *bench.drive);
    assert_eq!(all.len(), 384);
    assert_eq!((all[53].name.as_str(), all[53].axis), ("home-speed-y", Some(1)));
    let limits = bench.drive.limits().unwrap();
    assert_eq!(limits[1], DeviceLimits { speed: Some(200e3), ..DeviceLimits::default() });
    assert_eq!(limits[2], DeviceLimits::default());
    bench.drive.save_parameters().unwrap();
}

#[test]
fn smartdrives_say_who_they_are_and_home() {
    let mut bench = smartdrive();
    let drive = &mut bench.drive;
    let identity = drive.identity().unwrap().to_string();
    let one = "firmware 1.2.0, PID 5342h, CID 101h";
    assert_eq!(identity, format!("SmartDRIVE, address 3, {one}; address 7, {one}"));
    drive.set_parameter(id(3, 100), -250).unwrap();
    assert_eq!(drive.parameter(id(3, 100)).unwrap(), -250);
    assert_eq!(drive.parameter(id(7, 100)).unwrap(), 0);
    let mut bench = homes(bench, -250, None);
    let signals = bench.drive.signals(&|| 9).unwrap();
    assert_eq!(signals.time_ns, 9);
    // DIR is the second of five inputs of each drive.
    assert_eq!((signals.inputs.levels(), signals.inputs.count()), (0b00010, 10));
    assert_eq!(signals.inputs.number("1.DIR"), Some(2));
    assert_eq!((signals.axes[0].negative_limit, signals.axes[0].home), (Some(false), None));
    bench.drive.set_output(6, true).unwrap();
    let outputs = bench.drive.signals(&|| 0).unwrap().outputs;
    assert_eq!((outputs.levels(), outputs.name(6)), (0b10_0000, Some("2.LED".to_owned())));
    is_locked(&mut bench);
    assert_eq!(bench.drive.homed().unwrap()[..2], [Some(false), None], "positions are gone");
}

#[test]
fn smartdrives_describe_their_parameters() {
    let mut bench = smartdrive();
    let drive = &mut *bench.drive;
    let all = described(drive);
    // 29 of each, with 11 divisors.
    assert_eq!(all.len(), 58);
    let divisor = all.iter().find(|info| info.id == id(7, 44)).unwrap();
    assert!(matches!(&divisor.values, Values::OneOf(values) if values.len() == 11));
    assert_eq!(divisor.axis, Some(1));
    // 500 rpm and 2000 rpm/s of 3200 µsteps a turn; no limits of positions.
    let limits = drive.limits().unwrap();
    let near = |found: Option<f64>, expected: f64| (found.unwrap() - expected).abs() < 1e-6;
    assert!(near(limits[0].speed, 3200.0 * 500.0 / 60.0), "{limits:?}");
    assert!(near(limits[1].deceleration, 3200.0 * 2000.0 / 60.0), "{limits:?}");
    assert_eq!((limits[0].lowest, limits[0].highest, limits[2].speed), (None, None, None));
    drive.set_parameter(id(7, 26), -1000).unwrap();
    drive.set_parameter(id(7, 28), 5000).unwrap();
    drive.set_parameter(id(7, 32), 0).unwrap();
    drive.set_position(&[0, 300, 0, 0, 0]).unwrap();
    let limits = drive.limits().unwrap();
    assert_eq!((limits[1].lowest, limits[1].highest), (Some(-700), Some(5300)));
    assert!(near(limits[1].deceleration, 3200.0 * 2000.0 / 60.0), "{limits:?}");
    drive.save_parameters().unwrap();
    assert_eq!(drive.parameter(id(7, 28)).unwrap(), 5000);
    assert_eq!(drive.limits().unwrap()[1].lowest, Some(-1000), "saving makes positions 0");
}

#[test]
fn a_module_says_who_it_is_and_homes() {
    let mut bench = bim2ax();
    let identity = bench.drive.identity().unwrap().to_string();
    assert!(identity.starts_with("BIM2AX-BOCM, firmware "), "{identity}");
    assert!(identity.ends_with(", current rating 2000 mA"), "{identity}");
    let mut bench = homes(bench, 0, Some(false));
    let signals = bench.drive.signals(&|| 3).unwrap();
    assert_eq!((signals.time_ns, signals.inputs.levels(), signals.inputs.count()), (3, 0b100, 6));
    assert_eq!(signals.inputs.name(6), Some("2.home cam".to_owned()));
    let [first, second, ..] = signals.axes;
    let shown = [first.home, second.home, first.positive_limit];
    assert_eq!(shown, [Some(true), Some(false), Some(false)]);
    is_locked(&mut bench);
    bench.drive.move_to(&[i64::from(HOME), 0, 0, 0, 0], &[100.0; 5]).unwrap();
    let moving = bench.drive.disable();
    assert!(matches!(moving, Err(DriveError::Moving { .. })), "{moving:?}");
    bench.drive.hard_stop().unwrap();
    assert_eq!(bench.drive.homed().unwrap()[..2], [Some(false); 2]);
}

#[test]
fn a_module_describes_its_parameters() {
    let mut bench = bim2ax();
    let drive = &mut *bench.drive;
    let all = described(drive);
    // $0 to $41, $62, $63.
    assert_eq!(all.len(), 0x42 + 2);
    let current = all.iter().find(|info| info.id.number == 5).unwrap();
    assert_eq!((&current.values, current.unit), (&Values::Between(60, 2000), "mA"));
    assert!(current.needs_restart);
    drive.set_parameter(id(0, 0x11), 2500).unwrap();
    drive.set_parameter(id(0, 0x13), -2400).unwrap();
    assert_eq!(drive.parameter(id(0, 0x13)).unwrap(), -2400);
    let limits = drive.limits().unwrap();
    let expected = DeviceLimits {
        speed: Some(10e3),
        acceleration: Some(20e3),
        deceleration: Some(20e3),
        lowest: Some(-2400),
        highest: Some(2500),
    };
    assert_eq!(limits[1], expected);
    drive.save_parameters().unwrap();
}
