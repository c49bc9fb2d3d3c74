//! Text output of an InterpCNC board: identity, status, inputs and outputs.

use super::super::session::{Session, no_clock};
use super::super::words::{self, on_off, right};
use super::HandBoard;
use crate::command::show;
use crate::command::{Failure, Status};
use crate::troubleshooting;
use std::ops::RangeInclusive;
use twin_drives::DriveError;
use twin_interpcnc::protocol::registers::{INPUTS, MAX_ANALOG, OUTPUTS, Status as Bits};
use twin_interpcnc::{BoardAxis, Exception, InterpCnc, Snapshot};

pub(super) fn scan(
    addresses: RangeInclusive<u8>,
    open: impl Fn(u8) -> Result<HandBoard, Failure>,
) -> Result<Status, Failure> {
    let mut table = show::table();
    table.set_header(["address", "line by its parameters", "recipes, command 78"]);
    let mut found = 0;
    for address in addresses {
        let HandBoard { session, mut board, .. } = open(address)?;
        match session.ask(board.identify(&no_clock)) {
            Ok(identity) => {
                let line = identity.line.map_or("unknown codes".to_owned(), |line| {
                    format!("{} baud, {}", line.baud, line.parity)
                });
                let recipes = if identity.has_recipes { "yes" } else { "no" };
                table.add_row([right(address), line.into(), recipes.into()]);
                found += 1;
            }
            Err(Failure::Drive(DriveError::Timeout { .. })) => {}
            // It answers and refuses the question.
            Err(Failure::Drive(error)) if error.fault::<Exception>().is_some() => {
                table.add_row([right(address), "unknown".into(), "unknown".into()]);
                found += 1;
            }
            // A device with another protocol or speed.
            Err(Failure::Drive(error @ DriveError::Protocol { .. })) => {
                stderr!("{error}");
            }
            Err(other) => return Err(other),
        }
    }
    if found == 0 {
        stderr!("no address answers: {}", troubleshooting::NOBODY);
        return Ok(Status::Unfit);
    }
    say!("{table}");
    Ok(Status::Fit)
}

pub(super) fn status(seen: &Snapshot) -> Result<(), Failure> {
    let (status, extended) = (seen.state.status, seen.extended);
    let facts = [
        (status.enable_open(), "ENABLE open"),
        (status.locked(), "locked"),
        (!status.locked(), "unlocked"),
        (status.has(Bits::HOMING_IN_PROGRESS), "homing"),
        (status.has(Bits::HOMING_ERROR), "homing has failed"),
        (status.probing(), "probing"),
        (status.probe_failed(), "probing has failed"),
        (status.has(Bits::EEPROM_BUSY), "EEPROM busy"),
        (status.has(Bits::EEPROM_ERROR), "EEPROM has failed"),
        (status.has(Bits::BUFFER_FROZEN), "buffer frozen"),
        (status.has(Bits::OVERRIDDEN), "speed overridden"),
    ];
    let said: Vec<_> = facts.into_iter().filter(|(is, _)| *is).map(|(_, what)| what).collect();
    say!("{}", said.join(", "));
    let mut table = show::table();
    table.set_header(["axis", "position, steps", "state"]);
    for (axis, position) in BoardAxis::ALL.into_iter().zip(seen.state.positions) {
        let facts = [
            (status.moving().contains(axis), "moving"),
            (!status.moving().contains(axis), "at rest"),
            (extended.homing().contains(axis), "homing"),
            (extended.homing_failed().contains(axis), "homing has failed"),
            (status.on_limit_switch().contains(axis), "on a limit switch"),
        ];
        let said: Vec<_> = facts.into_iter().filter(|(is, _)| *is).map(|(_, what)| what).collect();
        table.add_row([axis.to_string().into(), right(position), said.join(", ").into()]);
    }
    say!("{table}");
    if let Some(next) = next(status) {
        say!("next: {next}");
    }
    Ok(())
}

/// What a board in this state waits for.
fn next(status: Bits) -> Option<&'static str> {
    if status.enable_open() {
        Some(troubleshooting::RELEASE)
    } else if status.locked() {
        Some("`unlock`, then `home`: a locked board does not know where its axes are")
    } else if status.has(Bits::EEPROM_ERROR) {
        Some("`get` shows the parameters: are they right? `set` those that are not once more")
    } else if !status.on_limit_switch().is_empty() {
        Some("`jog` the axis off its limit switch, slowly")
    } else if status.has(Bits::HOMING_ERROR) {
        Some(
            "look at the home switch (`inputs`), then `unlock`, which clears that, and `home` again",
        )
    } else if status.probe_failed() {
        Some("`unlock`, which clears that")
    } else {
        None
    }
}

pub(super) fn inputs(session: &Session, board: &mut InterpCnc) -> Result<(), Failure> {
    let seen = session.ask(board.snapshot(&no_clock))?;
    let mut table = show::table();
    table.set_header(["input", "level"]);
    for number in 1..=INPUTS {
        let on = seen.inputs >> (number - 1) & 1 == 1;
        table.add_row([right(number), on_off(on).into()]);
    }
    for (number, value) in (1..).zip(seen.analog_inputs) {
        table.add_row([right(format!("analog {number}")), right(value)]);
    }
    match session.ask(board.counters(&no_clock)) {
        Ok((encoder, [a, b])) => {
            table.add_row([right("encoder"), right(encoder)]);
            table.add_row([right("pulses A"), right(a)]);
            table.add_row([right("pulses B"), right(b)]);
        }
        // Boards have them from V2.1D on.
        Err(Failure::Drive(error)) if error.fault::<Exception>().is_some() => {}
        Err(other) => return Err(other),
    }
    say!("{table}");
    Ok(())
}

/// What an output is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Output {
    /// Output 1 to 32, on or off.
    Digital(u8, bool),
    /// Analog output 1 or 2, 0 to 1023.
    Analog(u8, u16),
}

/// `N=on`, `N=off` or `A1=512`.
pub(super) fn output(text: &str) -> Result<Output, String> {
    if let Some(analog) = text.strip_prefix(['A', 'a']) {
        let (name, value) = analog.split_once('=').ok_or("expected A1=0 to A2=1023")?;
        let number = name.parse().ok().filter(|number| (1..=2).contains(number));
        let number = number.ok_or_else(|| format!("output A{name}: there are A1 and A2"))?;
        let value = value.parse().ok().filter(|value| *value <= MAX_ANALOG);
        let value = value.ok_or_else(|| format!("output A{name} takes 0 to {MAX_ANALOG}"))?;
        return Ok(Output::Analog(number, value));
    }
    let (name, on) = words::switch(text)?;
    let number = name.parse().ok().filter(|number| (1..=OUTPUTS).contains(number));
    let number =
        number.ok_or_else(|| format!("output {name}: there are 1 to {OUTPUTS}, A1 and A2"))?;
    Ok(Output::Digital(number, on))
}

pub(super) fn outputs(
    session: &Session,
    board: &mut InterpCnc,
    wanted: &[Output],
) -> Result<(), Failure> {
    for output in wanted {
        match *output {
            Output::Digital(number, on) => {
                session.ask(board.set_output(number, on, &no_clock))?;
            }
            Output::Analog(number, value) => {
                session.ask(board.set_analog_output(number, value, &no_clock))?;
            }
        }
    }
    let analog = session.ask(board.analog_outputs(&no_clock))?;
    let levels = session.ask(board.outputs(&no_clock))?;
    let mut table = show::table();
    table.set_header(["output", "level"]);
    for number in 1..=OUTPUTS {
        table.add_row([right(number), on_off(levels >> (number - 1) & 1 == 1).into()]);
    }
    for (number, value) in (1..).zip(analog) {
        table.add_row([right(format!("A{number}")), right(value)]);
    }
    say!("{table}");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Output, output};

    /// OUT1 to OUT32, and registers 4146 and 4147, 0 to 1023.
    #[test]
    fn outputs_are_switched_and_set() {
        assert_eq!(output("32=on"), Ok(Output::Digital(32, true)));
        assert_eq!(output("A1=1023"), Ok(Output::Analog(1, 1023)));
        assert_eq!(output("a2=0"), Ok(Output::Analog(2, 0)));
        let wrong = ["0=on", "33=on", "A3=1", "A0=1", "A1=1024", "A1=-1", "A1=on", "A1", "3=512"];
        for text in wrong {
            assert!(output(text).is_err(), "{text}");
        }
    }
}
