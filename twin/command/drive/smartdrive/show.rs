//! Text output of SmartDRIVE devices: status and inputs.

use super::super::session::Session;
use super::super::words::{on_off, right};
use super::axis::Unit;
use crate::command::Failure;
use crate::command::show;
use twin_smartdrive::{Command, DriveState, IoUpdate, Mode, TrajectoryFlags};

/// Names of the pins, bit 0 first: three outputs, then the inputs.
const PINS: [&str; 8] = ["RDY", "BRK", "LED", "GO", "DIR", "OFF", "LIMP", "LIMN"];
/// The limit switches among them.
const LIMP: usize = 6;
const LIMN: usize = 7;
/// How many of them are outputs.
const OUTPUTS: usize = 3;

/// What a mode is.
pub(super) fn mode(number: u8) -> String {
    match Mode::from_number(number) {
        Some(Mode::Off) => "0, off".to_owned(),
        Some(Mode::Remote) => "3, obeys the bus".to_owned(),
        Some(mode) => format!("{number}, {mode:?}"),
        None if number == Mode::Changing.number() => "changing".to_owned(),
        None => number.to_string(),
    }
}

/// Whether the motor turns or homing runs. One that has had no move yet has nothing that is done, either.
pub(super) fn turns(state: &DriveState) -> bool {
    state.homing || state.flags.contains(TrajectoryFlags::IN_MOTION)
}

/// Each drive, and the levels of its pins where they have been asked for. A drive forgets that a limit switch has stopped it
/// with the next command; its inputs still show that it is on one.
pub(super) fn status(found: &[(u8, DriveState, Option<u8>)]) -> Result<(), Failure> {
    let mut table = show::table();
    table.set_header(["address", "mode", "position, µsteps", "state"]);
    for (address, state, levels) in found {
        let flags = state.flags;
        let on = |pin: usize| levels.is_some_and(|levels| levels >> pin & 1 == 1);
        let facts = [
            (!state.alarms.is_empty(), format!("alarm: {}", state.alarms)),
            (state.homing, "homing".to_owned()),
            (turns(state), "moving".to_owned()),
            (!turns(state), "at rest".to_owned()),
            (state.busy, "busy".to_owned()),
            (state.signalled, "signalled".to_owned()),
            (flags.contains(TrajectoryFlags::TRIGGERED), "triggered".to_owned()),
            (flags.contains(TrajectoryFlags::STALLED), "stalled".to_owned()),
            (flags.contains(TrajectoryFlags::LIMITED_P), "stopped by LIMP".to_owned()),
            (flags.contains(TrajectoryFlags::LIMITED_N), "stopped by LIMN".to_owned()),
            (on(LIMP), "on LIMP".to_owned()),
            (on(LIMN), "on LIMN".to_owned()),
        ];
        let said: Vec<_> = facts.into_iter().filter(|(is, _)| *is).map(|(_, what)| what).collect();
        let said = said.join(", ");
        table.add_row([
            right(address),
            mode(state.mode).into(),
            right(state.position),
            said.into(),
        ]);
    }
    say!("{table}");
    Ok(())
}

/// What a drive in this state waits for.
pub(super) fn next(state: &DriveState) -> Option<&'static str> {
    let flags = state.flags;
    if !state.alarms.is_empty() {
        Some(
            "remove the cause of the alarm, then `unlock`, which clears it, then `home`: the position is lost",
        )
    } else if state.mode == Mode::Off.number() {
        Some("`unlock`, which makes the position 0, then `home`")
    } else if flags.contains(TrajectoryFlags::STALLED) {
        Some("free the axis, then `home`: the position may be lost")
    } else if flags.contains(TrajectoryFlags::LIMITED_P) {
        Some("`jog` backwards, off the limit switch")
    } else if flags.contains(TrajectoryFlags::LIMITED_N) {
        Some("`jog` forwards, off the limit switch")
    } else {
        None
    }
}

pub(super) fn inputs(session: &Session, axis: &mut Unit) -> Result<(), Failure> {
    let seen = session.ask(axis.bus.io(axis.address, IoUpdate::default()))?;
    let mut table = show::table();
    table.set_header(["input", "level", "caught, active", "caught, inverse"]);
    for (place, name) in PINS.iter().enumerate().skip(OUTPUTS) {
        let bit = |word: u8| on_off(word >> place & 1 == 1);
        table.add_row([*name, bit(seen.levels), bit(seen.active), bit(seen.reverse)]);
    }
    say!("{table}");
    Ok(())
}

pub(super) fn outputs(
    session: &Session,
    axis: &mut Unit,
    switches: &[(String, bool)],
) -> Result<(), Failure> {
    let mut update = IoUpdate::default();
    for (name, on) in switches {
        let outputs = PINS.iter().take(OUTPUTS);
        let place = outputs.clone().position(|output| output.eq_ignore_ascii_case(name));
        let Some(place) = place else {
            return Err(Failure::Usage(format!("output {name}: there are RDY, BRK and LED")));
        };
        let mask = 1 << place;
        if *on {
            update.set |= mask;
        } else {
            update.clear |= mask;
        }
    }
    let seen = session.ask(axis.bus.io(axis.address, update))?;
    let mut table = show::table();
    table.set_header(["output", "level"]);
    for (place, name) in PINS.iter().enumerate().take(OUTPUTS) {
        table.add_row([*name, on_off(seen.levels >> place & 1 == 1)]);
    }
    say!("{table}");
    let command = Command::IoUpdate(update);
    let wrong = update.set & !seen.levels | update.clear & seen.levels;
    if wrong == 0 {
        return Ok(());
    }
    Err(Failure::Usage(format!("{}: {} was not obeyed", axis.at(), command.name())))
}
