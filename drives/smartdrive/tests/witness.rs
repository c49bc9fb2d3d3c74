//! The second reading of the manual, in Python, against emulator and driver. Without Python there is no witness, which
//! is said.

use std::time::Duration;

use super::{emulated, patient, peer::Peer, refusal, rest};
use crate::{
    Alarms, Init, IoState, IoUpdate, LoadSource, Mode, ParameterValue, RejectCode, SmartDrive,
    TrajectoryFlags,
    emulator::{DeviceOptions, Event, HomingOptions, Input, Wire},
    protocol::parameters::{Entry, PARAMETERS, VARIABLES},
};
use twin_drives::no_clock;

/// The other reading as `face`.
fn witness(face: &[&str]) -> Option<Peer> {
    Some(Peer::start(Peer::reference("tests/reference")?.args(face)))
}

/// Requests the device has had since it was asked last, but those whose answers are known: how often the driver makes sure
/// that answers belong to its questions is its own affair.
fn requests(device: &mut Peer) -> String {
    let all = device.have("requests");
    let known = ["GET PAR=12", "GET PAR=13"];
    let others: Vec<_> = all.split(" | ").filter(|request| !known.contains(request)).collect();
    others.join(" | ")
}

/// Where the home switch is.
const HOME: Input = Input::Off;

/// What the master wants done at the module.
fn event(wish: &str) -> Event {
    let (action, what) = wish.split_once(' ').unwrap();
    let alarms = || Alarms(1 << what.parse::<u16>().unwrap());
    let input = || match what {
        "GO" => Input::Go,
        "DIR" => Input::Dir,
        "OFF" => Input::Off,
        "LIMP" => Input::LimP,
        "LIMN" => Input::LimN,
        "HOME" => HOME,
        other => panic!("{other}"),
    };
    match action {
        "press" => Event::Input { input: input(), level: true },
        "release" => Event::Input { input: input(), level: false },
        "alarm" => Event::Fault { alarms: alarms(), present: true },
        "stall" => Event::Stall,
        "clear" => Event::Fault { alarms: alarms(), present: false },
        other => panic!("{other}"),
    }
}

/// Parts of the manual on which another master and the device on `wire` agree; `None` without Python.
fn agreed(device: DeviceOptions, wire: Wire, parts: &[&str]) -> Option<Vec<String>> {
    let (bus, _) = emulated(vec![device], wire);
    let face = [&["master", bus.path().to_str().unwrap()], parts].concat();
    let mut master = witness(&face)?;
    let mut agreed = Vec::new();
    loop {
        let line = master.line();
        match line.split_once(' ') {
            None => break,
            Some(("agreed", part)) => agreed.push(part.to_owned()),
            Some(_) => {
                bus.control(event(&line).to(0)).unwrap();
                master.say("done");
            }
        }
    }
    master.end();
    Some(agreed)
}

#[test]
fn another_master_drives_the_emulated_device() {
    let homing = HomingOptions { input: HOME, ..HomingOptions::default() };
    let device = DeviceOptions { homing, stall_is_alarm: false, ..DeviceOptions::default() };
    let Some(agreed) = agreed(device, Wire::default(), &[]) else { return };
    let parts = "frames modes parameters variables storage moves origins stops bootloader";
    assert_eq!(agreed.join(" "), parts);
}

/// A device confirms within 50 ms, and some adapters repeat what the master says.
#[test]
fn another_master_hears_its_echo_and_waits_as_long_as_devices_may_take() {
    let wire = Wire { response: Duration::from_millis(50), echo: true, ..Wire::default() };
    let parts = ["echo", "frames", "storage", "bootloader"];
    let Some(agreed) = agreed(DeviceOptions::default(), wire, &parts) else { return };
    assert_eq!(agreed, ["frames", "storage", "bootloader"]);
}

/// The driver on the wire to another device.
fn open(device: &mut Peer) -> SmartDrive {
    SmartDrive::open(&device.line(), &patient(1..=1)).unwrap()
}

#[tokio::test]
async fn another_device_understands_every_command() {
    let Some(mut device) = witness(&["device"]) else { return };
    let mut driver = open(&mut device);
    assert_eq!(driver.state(1, &no_clock).await.unwrap().0.mode, 0);
    assert_eq!(requests(&mut device), "PING");

    for mode in Mode::ALL {
        driver.set_mode(1, Some(mode)).await.unwrap();
        let pings = " | PING".repeat(3);
        assert_eq!(requests(&mut device), format!("MODE MOD={}{pings}", mode.number()));
    }
    driver.set_mode(1, None).await.unwrap();
    assert!(requests(&mut device).starts_with("MODE MOD=255 | "));
    assert_eq!(refusal(&driver.go_to(1, 1, None).await), RejectCode::BadMode);
    assert_eq!(requests(&mut device), "GOTO DST=1");
    driver.set_mode(1, Some(Mode::Remote)).await.unwrap();
    requests(&mut device);

    // What is asked for, what the device hears, and where it ends.
    driver.go_to(1, 3200, None).await.unwrap();
    assert_eq!(rest(&mut driver).await, 3200);
    assert!(requests(&mut device).starts_with("GOTO DST=3200 | PING"));
    driver.go_to(1, -6400, Some((300, 1000))).await.unwrap();
    assert_eq!(rest(&mut driver).await, -6400);
    assert!(requests(&mut device).starts_with("GOTO DST=-6400 VEL=300 ACC=1000 | PING"));
    driver.step(1, 200, None).await.unwrap();
    assert_eq!(rest(&mut driver).await, -6200);
    assert!(requests(&mut device).starts_with("STEP DST=200 | PING"));
    driver.step(1, i32::MIN + 6200, Some((32_767, 0))).await.unwrap();
    assert_eq!(rest(&mut driver).await, i32::MIN);
    assert!(requests(&mut device).starts_with("STEP DST=-2147477448 VEL=32767 ACC=0 | PING"));
    driver.init(1, Init::Position).await.unwrap();
    for (speed, rate) in [(600, 0), (-600, 500), (i16::MIN, u16::MAX), (i16::MAX, 1)] {
        let before = driver.start(1, speed, rate).await.unwrap();
        let (after, _) = driver.state(1, &no_clock).await.unwrap();
        assert!(after.moving() && after.flags.contains(TrajectoryFlags::DONE));
        assert_eq!(after.position > before.position, speed > 0);
    }
    let heard = "TRJINIT INI=1 | START VEL=600 ACC=0 | PING | START VEL=-600 ACC=500 | PING | \
        START VEL=-32768 ACC=65535 | PING | START VEL=32767 ACC=1 | PING";
    assert_eq!(requests(&mut device), heard);
    for (rate, heard) in [(0, "STOP DEC=0"), (2000, "STOP DEC=2000")] {
        driver.start(1, 1, 0).await.unwrap();
        requests(&mut device);
        driver.stop(1, rate).await.unwrap();
        rest(&mut driver).await;
        assert!(requests(&mut device).starts_with(heard));
    }
    for init in Init::ALL {
        driver.init(1, init).await.unwrap();
        assert_eq!(requests(&mut device), format!("TRJINIT INI={}", init.number()));
        if init == Init::Homing {
            assert!(driver.state(1, &no_clock).await.unwrap().0.homing);
            driver.homed(1).await.unwrap();
            requests(&mut device);
        }
    }
    driver.set_parameter(1, 100, -123).await.unwrap();
    assert_eq!(driver.home(1).await.unwrap(), -123);
    requests(&mut device);
    driver.broadcast(&crate::Command::Stop { rate: 0 }).await.unwrap();
    driver.state(1, &no_clock).await.unwrap();
    assert_eq!(requests(&mut device), "STOP DEC=0 to all | PING");

    driver.set_parameter(1, 30, 600).await.unwrap();
    driver.save(1).await.unwrap();
    driver.load(1, LoadSource::Saved).await.unwrap();
    driver.load(1, LoadSource::Factory).await.unwrap();
    let expected = ParameterValue { saved: 600, working: 1200, factory: 1200 };
    assert_eq!(driver.parameter(1, 30).await.unwrap(), expected);
    let heard = requests(&mut device);
    let heard: Vec<_> = heard.split(" | ").filter(|request| *request != "PING").collect();
    let order = ["SET PAR=30 NEW=600", "SAVE", "LOAD SRC=0", "LOAD SRC=65535", "GET PAR=30"];
    assert_eq!(heard, order);
    // One that is deaf until the bootloader's time is over; then one that stays in it.
    driver.set_parameter(1, 30, 700).await.unwrap();
    requests(&mut device);
    driver.reset(1, false).await.unwrap();
    driver.changed(1, &crate::Command::Ping).await.unwrap();
    assert!(requests(&mut device).starts_with("RESET BL=0 | PING"));
    assert_eq!(driver.parameter(1, 30).await.unwrap().working, 600);
    driver.reset(1, true).await.unwrap();
    assert_eq!(requests(&mut device), "GET PAR=30 | RESET BL=1");
    device.end();
}

/// `index:access:low:high` for each entry.
fn rows(entries: &[Entry]) -> Vec<String> {
    let row = |entry: &Entry| {
        let access = if entry.writable { "RW" } else { "RO" };
        format!("{}:{access}:{}:{}", entry.index, entry.low, entry.high)
    };
    entries.iter().map(row).collect()
}

#[tokio::test]
async fn another_device_has_the_same_tables_and_outputs() {
    let Some(mut device) = witness(&["device"]) else { return };
    let mut driver = open(&mut device);
    assert_eq!(device.have("parameters"), rows(&PARAMETERS).join(" "));
    // The manual prints two variables with index 85: the other reading has neither.
    let certain: Vec<_> =
        VARIABLES.into_iter().filter(|entry| !(85..=86).contains(&entry.index)).collect();
    let mut theirs: Vec<_> = device.have("variables").split(' ').map(str::to_owned).collect();
    theirs.sort_by_key(|row| row.split(':').next().unwrap().parse::<u16>().unwrap());
    assert_eq!(theirs, rows(&certain));

    for entry in PARAMETERS.iter().filter(|entry| entry.writable && entry.index != 2) {
        let before = driver.parameter(1, entry.index).await.unwrap();
        for value in [entry.low, entry.high] {
            let expected = ParameterValue { working: value, ..before };
            assert_eq!(driver.set_parameter(1, entry.index, value).await.unwrap(), expected);
            assert_eq!(driver.parameter(1, entry.index).await.unwrap(), expected);
        }
    }
    requests(&mut device);
    driver.set_parameter(1, 26, -100_000).await.unwrap();
    assert_eq!(requests(&mut device), "SET PAR=26 NEW=31072 | SET PAR=27 NEW=65534");
    assert_eq!(refusal(&driver.set_parameter(1, 121, 0).await), RejectCode::NotAvailable);
    assert_eq!(refusal(&driver.parameter(1, 1).await), RejectCode::NotAvailable);

    for (index, word, expected) in
        [(78, "-600", -600), (78, "0xFDA8", -600), (44, "-70000", -70_000), (81, "32767", 32_767)]
    {
        assert_eq!(device.have(&format!("variable {index} {word}")), "done");
        assert_eq!(driver.read(1, index).await.unwrap(), expected);
    }
    assert_eq!(refusal(&driver.read(1, 46).await), RejectCode::NotAvailable);
    assert_eq!(refusal(&driver.write_variable(1, 75, 0).await), RejectCode::BadParams);
    requests(&mut device);
    assert_eq!(driver.write_variable(1, 130, 0xFFFF).await.unwrap(), 0xFFFF);
    device.have("press GO");
    device.have("release LIMN");
    let update = IoUpdate { clear: 1, set: 2, clear_active: 4, clear_reverse: 8 };
    let seen = driver.io(1, update).await.unwrap();
    assert_eq!(seen, IoState { levels: 0b0000_1110, active: 0b1000, reverse: 0b1000_0000 });
    let heard = "WRITE VAR=130 NEW=65535 | IOUPDATE CLR=1 SET=2 CACT=4 CREV=8";
    assert_eq!(requests(&mut device), heard);
    device.end();
}

#[tokio::test]
async fn the_driver_understands_every_answer_of_another_device() {
    let Some(mut device) = witness(&["device"]) else { return };
    let mut driver = open(&mut device);
    driver.set_mode(1, Some(Mode::Remote)).await.unwrap();
    // The reasons in the order of the manual.
    for (number, reason) in [
        (0, RejectCode::Generic),
        (1, RejectCode::Working),
        (2, RejectCode::BadMode),
        (3, RejectCode::BadParams),
        (4, RejectCode::NotAvailable),
    ] {
        device.have(&format!("refuse {number}"));
        assert_eq!(refusal(&driver.step(1, 1, None).await), reason);
    }
    // Bits of the diagram, and what the manual says they are; with echo and without, in either layout.
    let flags = [
        (0, TrajectoryFlags::DONE),
        (8, TrajectoryFlags::IN_MOTION),
        (9, TrajectoryFlags::TRIGGERED),
        (10, TrajectoryFlags::STALLED),
        (11, TrajectoryFlags::LIMITED),
        (12, TrajectoryFlags::LIMITED_P),
        (13, TrajectoryFlags::LIMITED_N),
    ];
    for condition in ["layout diagram", "echo on", "layout table", "echo off"] {
        device.have(condition);
        for (bit, flag) in flags {
            device.have(&format!("flags {}", 1 << bit));
            let (state, _) = driver.state(1, &no_clock).await.unwrap();
            assert_eq!(state.flags, flag, "{condition}, bit {bit}");
        }
    }
    let alarms = [
        (0, Alarms::POWER_DRIVER),
        (1, Alarms::OVERTEMPERATURE),
        (2, Alarms::OVERVOLTAGE),
        (3, Alarms::UNDERVOLTAGE),
        (4, Alarms::CURRENT_PROBES),
        (5, Alarms::STALL),
        (6, Alarms::OSCILLATOR),
        (11, Alarms::HOMING),
    ];
    for (bit, alarm) in alarms {
        device.have(&format!("alarm {}", 1 << bit));
        let (state, _) = driver.state(1, &no_clock).await.unwrap();
        assert_eq!((state.alarms, state.mode), (alarm, 0));
        assert_eq!(driver.read(1, 68).await.unwrap(), 1 << bit);
        assert_eq!(refusal(&driver.go_to(1, 0, None).await), RejectCode::BadMode);
        driver.set_mode(1, Some(Mode::Remote)).await.unwrap();
        assert!(driver.state(1, &no_clock).await.unwrap().0.alarms.is_empty());
    }
    device.end();
}
