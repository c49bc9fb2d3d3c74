//! Troubleshooting hints for drive errors: the next check or step.

use std::io::{self, ErrorKind};
use twin_bim2ax as bim2ax;
use twin_bim2ax::protocol::bits::{message, uc};
use twin_drives::{Action, DriveError, Exchange, ProtocolFault};
use twin_smartdrive as smartdrive;
use twin_smartdrive::RejectCode;

/// Hint after an emergency stop.
pub(crate) const RELEASE: &str =
    "release the emergency stop (close the ENABLE input), then `unlock`, then `home`";

/// Hint on a module whose EEPROM has a checksum fault.
pub(crate) const CHECK_SUM: &str = "`restore FILE` gives it the parameters of a backup; without one `set` each of both axes; then `reset`, and \
                                    `get` to see what it has; until then nothing moves";

/// Hint after a failure of the drives while this computer did not speak to them.
pub(crate) const STANDSTILL: &str = "nobody spoke to the drives meanwhile: look first for what stopped this process (Ctrl-Z, a debugger), \
                                     let the computer not sleep during a run, and keep heavy work off it";

/// Hint where no device answers.
pub(crate) const NOBODY: &str = "is the device powered, are A and B of the line swapped, are baud rate and parity those of \
                                 the device?";

/// Hint after a drive error: the next check or step, in commands of `twin drive`. None where the error says it all.
pub(crate) fn advice(error: &DriveError) -> Option<&'static str> {
    Some(match error {
        DriveError::Device { at, .. } => return of_fault(error, at),
        DriveError::Timeout { at, .. } if at.address == 0 => {
            "is the module powered, and does its software run? Is it at this offset (--map), or is its emulator \
             running? A slow bus needs a longer --deadline"
        }
        DriveError::Timeout { .. } => {
            "is the device powered? Are A and B of the line swapped, and is its end terminated? Is this its address \
             (`scan` asks all), and are baud rate and parity those of the device? A slow adapter needs a longer \
             --deadline"
        }
        DriveError::Protocol { at, .. } if at.address == 0 => {
            "is another master at the module, or does something disturb its bus? Is it at this offset (--map, or `map_offset` \
             of the machine file), and are its numbers in this byte order (--little-endian, or `byte_order`)?"
        }
        DriveError::Protocol { fault: ProtocolFault::Garbled, .. } => {
            "are baud rate and parity those of the device? Do two devices have this address, or does the adapter hear \
             what it sends (--echo of InterpCNC)? Is the line terminated?"
        }
        DriveError::Protocol { .. } => "is there another master on the line?",
        DriveError::Transport { at, source } => return port(at, source),
        DriveError::Locked { .. } => {
            "`unlock`, then `home`: a board that has been locked or without power does not know where its axes are"
        }
        DriveError::EnableOpen { .. } => RELEASE,
        DriveError::Mode { .. } => {
            "the drive has been off or has started anew, and has lost its position: `unlock`, then `home`"
        }
        DriveError::Stalled { .. } => "free the axis, then `unlock`, then `home`",
        DriveError::NotHomed { .. } | DriveError::HomingFailed { .. } => {
            "does `inputs` show the home switch when it is pressed by hand? Is it in this direction, and near enough?"
        }
        DriveError::LimitSwitch { .. } => "`jog` the axis off its limit switch, slowly",
        DriveError::Unfinished { at, .. } => return Some(unfinished(at)),
        DriveError::EncoderDiffers { .. } => {
            "something holds the axis, it goes faster than its motor can, or its encoder does not count as it is said to (`[drives.encoder]` \
             of the machine file, parameters of a module; the other way round?). Where it is is not known any more: free it, then `home`. \
             An absolute encoder of a module keeps its own zero: store its offset at home (parameters $30, $31)"
        }
        DriveError::Unsupported { what, .. } if what.starts_with("encoder") => {
            "without `[drives.encoder]` in the machine file the run begins, and held shafts are not seen"
        }
        DriveError::NotArrived { .. } => {
            "something else has stopped it: `twin drive … stop` in another window, another master, a limit or a switch. `status` \
             reports what the device says now"
        }
        _ => return None,
    })
}

/// What to look at after a fault that a device reports in the terms of its family.
fn of_fault(error: &DriveError, at: &Exchange) -> Option<&'static str> {
    match error.fault() {
        Some(smartdrive::Fault::Rejected(RejectCode::BadParams)) if is_move(at) => {
            return Some(
                "is the target within `get Trj_PosMin` and `get Trj_PosMax` (both 0: no limits), and are speed and rates within \
                 `get Trj_VelMax`, `get Trj_AccMax` and `get Trj_DecMax`?",
            );
        }
        Some(smartdrive::Fault::Rejected(_)) | None => {}
        Some(smartdrive::Fault::Alarm(_)) => {
            return Some(
                "remove the cause, then `unlock`, which clears the alarm and makes the position 0, then `home`",
            );
        }
    }
    Some(match error.fault()? {
        bim2ax::Fault::Identity { .. } => {
            "is the module plugged in and powered, is it at this offset (--map, or `map_offset` of the machine file), or is its \
             emulator running? FFh is what an empty bus says. Axes that were moving go on to their targets: use the \
             emergency stop where they may not"
        }
        bim2ax::Fault::CardMessages { .. } if error.takes_writes_only() => CHECK_SUM,
        bim2ax::Fault::Encoder { .. } => {
            "look at the encoder, its cable and its plug, then `reset` the module, which clears the fault, and `home` the axis; \
             `get encoder-definition-1` (or -2) shows its kind"
        }
        bim2ax::Fault::AxisMessages { messages, .. } => return of_axis(*messages),
        bim2ax::Fault::ByteOrder => "--little-endian, or `byte_order` of the machine file",
        _ => return None,
    })
}

/// As [`advice`], where the deadline is a key of the machine file and no option: in `twin run`.
pub(crate) fn advice_in_run(error: &DriveError) -> Option<&'static str> {
    Some(match error {
        DriveError::Timeout { at, .. } if at.address == 0 => {
            "is the module powered, and does its software run? Is it at this offset (`map_offset` of the machine file), or is \
             its emulator running? A slow bus needs a larger `answer_deadline_ms` of its [[drives]]"
        }
        DriveError::Timeout { .. } => {
            "is the device powered? Are A and B of the line swapped, and is its end terminated? Is this its address \
             (`scan` asks all), and are baud rate and parity those of the device? If it has answered before: was it off for a \
             moment? `status` shows it, and then it has to be homed. A slow adapter needs a larger `answer_deadline_ms` of its [[drives]]"
        }
        other => return advice(other),
    })
}

/// What has not ended in time, by what it was.
fn unfinished(at: &Exchange) -> &'static str {
    match at.action {
        Action::Order { bits: uc::HOME, .. } => {
            "it homes at its start-stop speed, whatever its fast speed is: if nothing was in the way, it needs a longer \
             --timeout, or a higher `start-stop-speed-1` (or -2), which acts after `reset`"
        }
        Action::Atb { name: "TRJINIT", .. } => {
            "if nothing was in the way it needs a longer --timeout, or a higher `App_VelEnterHome`"
        }
        _ => {
            "was something in the way? Does `status` change from one look to the next? A device whose status stays as it is has to \
             be switched off and on, then `unlock`, then `home`"
        }
    }
}

/// A command that has a target.
fn is_move(at: &Exchange) -> bool {
    matches!(at.action, Action::Atb { name: "GOTO" | "STEP", .. })
}

fn port(at: &Exchange, error: &io::Error) -> Option<&'static str> {
    // Both others have addresses from 1.
    let is_module = at.address == 0;
    if at.action != Action::Open {
        return Some(
            "the port is gone: is the adapter plugged in (`dmesg` shows when it came and went), or has the emulator ended? \
             Axes that were moving go on to their targets: use the emergency stop where they may not. When it is back, \
             `status` shows what the drive knows, and `home` finds what it has lost",
        );
    }
    match error.kind() {
        ErrorKind::ResourceBusy if !is_module => Some(
            "end the other program (Ctrl-C in its window brings its axes to rest); no stop gets through while it runs: if it does \
             not end, use the emergency stop",
        ),
        ErrorKind::NotFound if is_module => Some(
            "a BIM2AX is at no serial port: --port is the memory file that `twin emulate bim2ax --link PATH` makes, or a device \
             like /dev/uio0 (`ls /dev/uio*`), for which --map, or `map_offset` of the machine file, says where the module is",
        ),
        ErrorKind::NotFound => Some(
            "`ls /dev/serial/by-id /dev/ttyUSB* /dev/ttyACM*` shows the serial ports there are; `twin emulate` makes one",
        ),
        ErrorKind::PermissionDenied if is_module || !at.port.starts_with("/dev/tty") => {
            Some("may this user read and write it? `ls -l` shows whose it is, and which group may")
        }
        ErrorKind::PermissionDenied => {
            Some("may this user open it? On most systems the group `dialout` may, see `ls -l`")
        }
        _ => None,
    }
}

/// Hint on the message bits of a module's axis.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Limits that somebody else has changed since they were looked at.
    #[test]
    fn a_refused_target_tells_which_parameters_to_look_at() {
        let refused = |action, reason| {
            let at = Exchange { port: "bus".into(), address: 2, action };
            advice(&DriveError::device(at, smartdrive::Fault::Rejected(reason)))
        };
        let go_to = Action::Atb { code: 0x63, name: "GOTO" };
        let message = refused(go_to, RejectCode::BadParams).expect("something to look at");
        assert!(message.contains("`get Trj_PosMin` and `get Trj_PosMax`"), "{message}");
        let ping = Action::Atb { code: 0x00, name: "PING" };
        assert_eq!(refused(ping, RejectCode::BadParams), None);
    }
}
