//! What a person would look at when a drive does not do what it should.

use std::io::ErrorKind;
use twin_drives::bim2ax::bits::message;
use twin_drives::{DriveError, ProtocolFault};

/// After an emergency stop.
pub(crate) const RELEASE: &str =
    "release the emergency stop (close the ENABLE input), then `unlock`, then `home`";

/// Where nobody answers.
pub(crate) const NOBODY: &str = "is the device powered, are A and B of the line swapped, are baud rate and parity those of \
                                 the device?";

/// What to look at, or to do next, after an error; actions are those of `twin drive`. None where the error says it all.
pub(crate) fn advice(error: &DriveError) -> Option<&'static str> {
    Some(match error {
        DriveError::Timeout { at, .. } if at.station == 0 => {
            "is the module powered, and does its software run? Is it at this offset (--map), or is its emulator \
             running? A slow bus needs a longer --deadline"
        }
        DriveError::Timeout { .. } => {
            "is the device powered? Are A and B of the line swapped, and is its end terminated? Is this its address \
             (`scan` asks all), and are baud rate and parity those of the device? A slow adapter needs a longer \
             --deadline"
        }
        DriveError::Protocol { fault: ProtocolFault::Garbled, .. } => {
            "are baud rate and parity those of the device? Do two devices have this address, or does the adapter hear \
             what it sends (--echo of InterpCNC)? Is the line terminated?"
        }
        DriveError::Protocol { .. } => "is there another master on the line?",
        DriveError::Transport { source, .. } => return port(source.kind()),
        DriveError::Locked { .. } => {
            "`unlock`, then `home`: a board that has been locked or without power does not know where its axes are"
        }
        DriveError::EnableOpen { .. } => RELEASE,
        DriveError::Alarm { .. } => {
            "remove the cause, then `unlock`, which clears the alarm and makes the position 0, then `home`"
        }
        DriveError::Mode { .. } => {
            "the drive has been off or has started anew, and has lost its position: `unlock`, then `home`"
        }
        DriveError::Stalled { .. } => "free the axis, then `unlock`, then `home`",
        DriveError::NotHomed { .. } | DriveError::HomingFailed { .. } => {
            "does `inputs` show the home switch when it is pressed by hand? Is it in this direction, and near enough?"
        }
        DriveError::LimitSwitch { .. } => "`jog` the axis off its limit switch, slowly",
        DriveError::Unfinished { .. } => {
            "if nothing was in the way it needs a longer --timeout, or a higher speed"
        }
        DriveError::AxisMessages { messages, .. } => return of_axis(*messages),
        DriveError::ByteOrder { .. } => "--little-endian, or `byte_order` of the machine file",
        _ => return None,
    })
}

fn port(kind: ErrorKind) -> Option<&'static str> {
    match kind {
        ErrorKind::NotFound => Some(
            "`ls /dev/serial/by-id /dev/ttyUSB* /dev/ttyACM*` shows the serial ports there are; `twin emulate` makes one",
        ),
        ErrorKind::PermissionDenied => {
            Some("may this user open it? On most systems the group `dialout` may, see `ls -l`")
        }
        _ => None,
    }
}

/// What the messages of a module's axis ask for.
pub(crate) fn of_axis(messages: u16) -> Option<&'static str> {
    let any = |bits: u16| messages & bits != 0;
    if any(message::POWER_ABSENT | message::PHASE_OPEN | message::PHASE_SHORT) {
        Some(
            "look at the supply and the wiring of the motor, then `unlock` the axis, then `home` it",
        )
    } else if any(message::PHASES_OFF) {
        Some("`unlock` the axis, which gives its motor current, then `home` it")
    } else if any(message::PLUS_SWITCH | message::MINUS_SWITCH) {
        Some("`jog` the axis off its end switch, slowly")
    } else if any(message::HARD_STOPPED) || messages & message::HOMED == 0 {
        Some("`home` the axis")
    } else {
        None
    }
}
