//! Tests of the texts of drive errors.

use std::{io, time::Duration};

use twin_bim2ax as bim2ax;
use twin_drives::{Action, Axes, DriveError, Exchange, ParameterId, ProtocolFault, Values};
use twin_interpcnc as interpcnc;
use twin_smartdrive as smartdrive;
use twin_smartdrive::{Alarms, RejectCode};

fn at() -> Exchange {
    let action = Action::Command { number: 80, name: "independent move" };
    Exchange { port: "/dev/ttyUSB0".into(), address: 7, action }
}

#[test]
fn every_message_names_port_station_and_command() {
    let id = ParameterId { address: 7, number: 44 };
    let errors = [
        DriveError::Transport { at: at(), source: io::ErrorKind::BrokenPipe.into() },
        DriveError::Timeout { at: at(), deadline: Duration::from_millis(250) },
        DriveError::Protocol { at: at(), fault: ProtocolFault::Garbled },
        DriveError::device(at(), interpcnc::Exception(3)),
        DriveError::device(at(), smartdrive::Fault::Rejected(RejectCode::Working)),
        DriveError::device(at(), smartdrive::Fault::Alarm(Alarms::STALL)),
        DriveError::Mode { at: at(), expected: 3, found: 0 },
        DriveError::Stalled { at: at() },
        DriveError::NotHomed { at: at() },
        DriveError::Parameter { at: at(), name: "PID", unit: "", expected: 21_314, found: 0 },
        DriveError::Value { at: at(), what: "speed", value: 0.5, unit: "rpm", low: 1.0, high: 2.0 },
        DriveError::NotSwitched { at: at(), on: true },
        DriveError::Locked { at: at() },
        DriveError::EnableOpen { at: at() },
        DriveError::NotLocked { at: at() },
        DriveError::LimitSwitch { at: at(), axes: Axes::Letters(0b101) },
        DriveError::Moving { at: at(), axes: Axes::Letters(1) },
        DriveError::Unfinished { at: at(), patience: Duration::from_secs(3) },
        DriveError::NotArrived { at: at(), axis: Axes::Numbers(2), target: 5, found: 4 },
        DriveError::HomingFailed { at: at(), axes: Axes::Letters(3) },
        DriveError::device(
            at(),
            bim2ax::Fault::HomeCount {
                axis: Axes::Numbers(1),
                counted_on: false,
                before: 5,
                found: 4,
            },
        ),
        DriveError::EncoderDiffers {
            at: at(),
            axis: Axes::Letters(1),
            counter: 5,
            encoder: 4,
            unit: "steps",
            tolerance: 3,
            points: Some(9),
        },
        DriveError::device(at(), bim2ax::Fault::Encoder { axis: 1, messages: 2 }),
        DriveError::EepromFailed { at: at() },
        DriveError::ParameterDiffers { at: at(), number: 4, unit: "", expected: 5, found: 4 },
        DriveError::NotKept { at: at(), address: 4360, written: 5, found: 4 },
        DriveError::NotWritten { at: at(), axis: Axes::Letters(4), written: 5, found: 4 },
        DriveError::device(at(), bim2ax::Fault::Identity { expected: 0x4E, found: 0xFF }),
        DriveError::device(at(), bim2ax::Fault::NotRunning),
        DriveError::device(at(), bim2ax::Fault::ByteOrder),
        DriveError::device(at(), bim2ax::Fault::AxisMessages { axis: 1, messages: 0x4000 }),
        DriveError::device(at(), bim2ax::Fault::CardMessages { messages: 8 }),
        DriveError::Range {
            at: at(),
            register: 4103,
            value: 3e9,
            unit: "steps",
            low: 0.0,
            high: 1.0,
        },
        DriveError::Unsupported { at: at(), what: "homing" },
        DriveError::NoParameter { at: at(), id },
        DriveError::ReadOnly { at: at(), id },
        DriveError::ParameterValue { at: at(), id, value: 7, values: Values::Between(0, 6) },
        DriveError::Setting { at: at(), setting: "station", value: 248, low: 1, high: 247 },
    ];
    for error in errors {
        let text = error.to_string();
        assert!(text.contains("/dev/ttyUSB0, address 7: command 80 (independent move)"), "{text}");
        assert_eq!(*error.at(), at());
    }
}

#[test]
fn errors_say_what_they_are_about() {
    let id = ParameterId { address: 7, number: 44 };
    let values = Values::OneOf(vec![1, 2, 4]);
    let read_only = ParameterId { address: 0, number: 9 };
    let unasked = Exchange { action: Action::Nothing, ..at() };
    for (error, end) in [
        (
            DriveError::ParameterValue { at: at(), id, value: 3, values },
            "parameter 44 at address 7 = 3 is impossible (1, 2, 4)",
        ),
        (DriveError::ReadOnly { at: at(), id: read_only }, ": parameter 9 is read-only"),
        (DriveError::LimitSwitch { at: at(), axes: Axes::Letters(0b01010) }, "axes YA"),
        // What needs no asking names no command.
        (
            DriveError::Unsupported { at: unasked, what: "homing" },
            "address 7: the device has no homing",
        ),
    ] {
        let text = error.to_string();
        assert!(text.starts_with("/dev/ttyUSB0, address 7: ") && text.ends_with(end), "{text}");
    }
}

#[test]
fn axes_are_named_as_their_family_does() {
    let (found, target) = (4, 5);
    for (axes, moving, elsewhere) in [
        (Axes::Letters(0b10101), "still moving, axes XZB", "axes XZB is at 4 instead of 5 steps"),
        (Axes::Letters(0b100), "still moving, axis Z", "axis Z is at 4 instead of 5 steps"),
        (Axes::Numbers(3), "still moving, axes 1, 2", "axes 1, 2 is at 4 instead of 5 µsteps"),
        (Axes::Numbers(0b10), "still moving, axis 2", "axis 2 is at 4 instead of 5 µsteps"),
        (Axes::Only, "still moving", "the axis is at 4 instead of 5 µsteps"),
    ] {
        let text = DriveError::Moving { at: at(), axes }.to_string();
        assert_eq!(text, format!("{}: {moving}", at()));
        let text = DriveError::NotArrived { at: at(), axis: axes, target, found }.to_string();
        assert_eq!(text, format!("{}: {elsewhere}", at()));
    }
}
