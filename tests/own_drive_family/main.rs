//! Recipe of ARCHITECTURE.md for a drive family: a fourth one, written outside the crates with the rooms of the others.
//! Its line in the list of families is [`FAMILIES`]; a machine file with its kind is read, and its devices are emulated,
//! predicted, followed and stopped like any other.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "a test that cannot be set up has failed"
)]
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "small whole numbers"
)]

mod assumptions;
mod client;
mod drive;
mod emulator;
mod family;
mod prediction;
mod protocol;

use emulator::EmulatedOwn;
use family::{OwnEntry, OwnFamily};
use protocol::{Refusal, State};
use std::f64::consts::PI;
use std::path::Path;
use std::time::{Duration, Instant};
use twin::attached::Attached;
use twin::emulated::connect;
use twin_drives::family::Family;
use twin_drives::{Control, DriveError, IncrementMotion, SetpointStream};
use twin_machine::{FAMILIES, Machine};

const GANTRY3: &str = include_str!("../../machines/gantry3.toml");

/// The portal with a device of the fourth family, whose line in the list this is.
fn machine() -> Machine {
    let families: Vec<&'static dyn Family> = [FAMILIES, &[&OwnFamily]].concat();
    Machine::parse_with(Path::new("machine.toml"), &text(), &families)
        .unwrap_or_else(|problems| panic!("{problems:#?}"))
}

fn text() -> String {
    let kind = "kind = \"own\"\n[drives.assumptions]\nwatchdog = \"50000\"\n[[unused]]\n";
    let mut text = GANTRY3.replace("kind = \"interpcnc\"\nport = \"/dev/ttyUSB0\"\n", kind);
    text = text.replace("[[unused]]\n", "");
    for (board, own) in [("X", "left"), ("Y", "right"), ("Z", "lift")] {
        let key = |name: &str| format!("drive_axis = \"{name}\"");
        text = text.replace(&key(board), &key(own));
    }
    text
}

/// To [`STROKE`] steps within a second, all axes.
struct Plan(Instant);

const STROKE: f64 = 4000.0;

impl SetpointStream for Plan {
    fn now_ns(&self) -> i64 {
        i64::try_from(self.0.elapsed().as_nanos()).unwrap()
    }

    fn at(&self, time_ns: i64) -> IncrementMotion {
        let angle = PI * (time_ns as f64 * 1e-9).clamp(0.0, 1.0);
        let motion = (0.5 * STROKE * (1.0 - angle.cos()), 0.5 * STROKE * PI * angle.sin());
        IncrementMotion::of([motion; 3].into_iter())
    }

    fn horizon_ns(&self) -> i64 {
        250_000_000
    }
}

#[expect(clippy::disallowed_methods, reason = "these tests run in real time")]
fn plan() -> Plan {
    Plan(Instant::now())
}

fn connected() -> (EmulatedOwn, Attached) {
    let mut connected = connect(&machine()).unwrap();
    let (Some((emulator, attached)), None) = (connected.pop(), connected.pop()) else {
        panic!("one device")
    };
    (*emulator.into().expect("the emulator of the family"), attached)
}

#[test]
fn a_machine_file_names_the_family() {
    let machine = machine();
    let [device] = &machine.drives[..] else { panic!("one device") };
    assert_eq!((device.family_name(), device.axis_name(2)), ("Own", "lift".to_owned()));
    let entry: &OwnEntry = device.device.of().unwrap();
    assert_eq!(entry.assumptions.watchdog, Duration::from_millis(50));
    let indices: Vec<_> =
        machine.axes.iter().map(|axis| axis.drive.as_ref().unwrap().index).collect();
    assert_eq!(indices, [0, 1, 2]);
    // Without its line in the list the family is unknown.
    let problems = Machine::parse(Path::new("machine.toml"), &text()).unwrap_err();
    let named = "expected \"interpcnc\", \"smartdrive\" or \"bim2ax\"";
    assert!(problems.iter().any(|problem| problem.message.contains(named)), "{problems:?}");
}

#[test]
fn the_device_is_predicted() {
    let machine = machine();
    let mut prediction = machine.drives[0].device.prediction(&[]);
    assert_eq!(prediction.axis_count(), 0);
    // 120 bytes of 10 bits at 115200 baud and 1 ms: 11.4 ms behind the plan.
    let motion = prediction.advance(&plan(), 500_000_000);
    let behind = 0.5 * STROKE * (1.0 - (PI * (0.5 - 0.001 - 1200.0 / 115_200.0)).cos());
    assert!((motion.position[0] - behind).abs() < 1e-3, "{motion:?}, {behind}");
}

#[test]
fn a_plan_is_followed_to_its_end() {
    let (emulator, mut attached) = connected();
    let (drive, plan) = (&mut attached.drive, plan());
    assert_eq!((drive.axis_count(), drive.identity().unwrap().family), (3, "Own"));
    let locked = drive.follow(&plan).unwrap_err();
    assert_eq!(locked.fault(), Some(&Refusal::Locked), "{locked}");
    drive.enable().unwrap();
    let mut on_the_way = 0;
    loop {
        let sample = drive.follow(&plan).unwrap();
        let [position, ..] = sample.position;
        assert!((0..=4000).contains(&position), "{position}");
        on_the_way += usize::from((1..4000).contains(&position));
        if position == 4000 && !sample.moving {
            break;
        }
    }
    assert!(on_the_way > 2, "{on_the_way} samples");
    let end = State { position: [4000; 3], moving: false, enabled: true };
    assert_eq!(emulator.stop().unwrap(), end);
}

/// The connection is lost on the way: client and device notice, each by itself.
#[test]
fn a_lost_connection_ends_at_rest() {
    let (emulator, mut attached) = connected();
    let (drive, plan) = (&mut attached.drive, plan());
    drive.enable().unwrap();
    while drive.follow(&plan).unwrap().position[0] == 0 {}
    drive.move_to(&[1_000_000; 5], &[1000.0; 5]).unwrap();
    emulator.control(Control::Disconnect(true)).unwrap();
    let lost = drive.follow(&plan).unwrap_err();
    assert!(matches!(lost, DriveError::Timeout { .. }), "{lost}");
    assert!(drive.soft_stop().is_err());
    // The deadline is far longer than the watchdog and its ramp.
    let stands = emulator.look().unwrap();
    assert!(!stands.moving && stands.enabled && stands.position[0] < 100_000, "{stands:?}");
    emulator.control(Control::Disconnect(false)).unwrap();
    drive.soft_stop().unwrap();
    let sample = drive.sample(&plan).unwrap();
    assert_eq!((sample.moving, sample.position[..3].to_vec()), (false, stands.position.to_vec()));
    drive.hard_stop().unwrap();
    assert!(matches!(drive.sample(&plan), Err(DriveError::Locked { .. })));
}
