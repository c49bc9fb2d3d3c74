//! The parameters of an InterpCNC board that are known, by names of ours, which backups have, too: the board has numbers only.
//! The vendor's names (`EE_…`) are understood.

use super::super::session::{Session, no_clock};
use super::super::words;
use crate::command::Failure;
use crate::command::emulate::PARITIES;
use std::time::Duration;
use twin_interpcnc::protocol::parameters as numbers;
use twin_interpcnc::{Assumptions, BAUD_RATES, BoardAxis, InterpCnc, Parity};

/// How long the EEPROM may take.
const STORING: Duration = Duration::from_secs(5);

/// A parameter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::command::drive) struct Known {
    /// Number, 0 to 383.
    pub(super) number: u16,
    /// Name.
    pub(super) name: String,
    /// Unit, or what the numbers mean.
    pub(super) unit: &'static str,
}

/// Number and unit, or what the numbers mean, of those that are there once.
const SINGLE: [(u16, &str); 21] = [
    (numbers::DEFAULT_ACCELERATION, "1000 steps/s²"),
    (numbers::DEFAULT_START_STOP, "steps/s"),
    (numbers::HOME_START_STOP, "steps/s"),
    (numbers::HOME_SLOW_SPEED, "steps/s"),
    (numbers::EMERGENCY_STOP_INPUT, "input, 0 = none"),
    (numbers::SPECIAL_POLARITY, "bits"),
    (numbers::HOME_POLARITY, "bits, X first"),
    (numbers::OUTPUTS_AT_START, "bits, OUT1 first"),
    (numbers::COUPLING, "0 = none, 1 = A with X, 2 = B with X"),
    (numbers::SET_WHEN_UNLOCKED, "bits, OUT1 first"),
    (numbers::UNLOCK_INPUT, "input, 0 = none"),
    (numbers::UNLOCK_POLARITY, "0 = NO, 1 = NC"),
    (numbers::RESET_WHEN_UNLOCKED, "bits, OUT1 first"),
    (numbers::SET_WHEN_LOCKED, "bits, OUT1 first"),
    (numbers::RESET_WHEN_LOCKED, "bits, OUT1 first"),
    (numbers::MODBUS_SPEED, "code"),
    (numbers::MODBUS_PARITY, "code"),
    (numbers::MODBUS_ADDRESS, "address"),
    (numbers::ZERO_AFTER_HOMING, "0 or 1"),
    (numbers::ANALOG_LOCKED, "0 to 1023"),
    (numbers::ANALOG_LOCKED + 1, "0 to 1023"),
];

/// All that are known, by number.
pub(super) fn known() -> Vec<Known> {
    let of_axes = BoardAxis::ALL.into_iter().flat_map(|axis| {
        let (minus, plus) = (numbers::limit_input(axis, false), numbers::limit_input(axis, true));
        [
            (numbers::home_direction(axis), "1 = positive"),
            (numbers::home_speed(axis), "steps/s"),
            (numbers::home_acceleration(axis), "1000 steps/s²"),
            (numbers::home_input(axis), "input, 0 = none"),
            (minus, "input, 0 = none"),
            (minus + 1, "0 = NO, 1 = NC"),
            (plus, "input, 0 = none"),
            (plus + 1, "0 = NO, 1 = NC"),
        ]
    });
    let all = SINGLE.into_iter().chain(of_axes);
    let named = |(number, unit)| Some(Known { number, name: numbers::name(number)?, unit });
    let mut all: Vec<Known> = all.filter_map(named).collect();
    all.sort_by_key(|parameter| parameter.number);
    all
}

/// A parameter by its name or number.
pub(super) fn find(text: &str) -> Result<Known, Failure> {
    let all = known();
    let number = match words::integer(text) {
        Some(number) => {
            let known = u16::try_from(number).ok().filter(|number| *number < numbers::PARAMETERS);
            let range = format!("they are 0 to {}", numbers::PARAMETERS - 1);
            Some(known.ok_or_else(|| words::unknown_number(number, &range))?)
        }
        None => numbers::named(text),
    };
    let found = all.iter().find(|one| number == Some(one.number));
    match (found, number) {
        (Some(found), _) => Ok(found.clone()),
        (None, Some(number)) => Ok(Known { number, name: "unknown".to_owned(), unit: "" }),
        (None, None) => {
            let names = all.iter().map(|one| one.name.as_str());
            Err(words::unknown_name("parameter", text, names))
        }
    }
}

pub(super) fn set(
    session: &Session,
    board: &mut InterpCnc,
    one: &Known,
    value: i64,
) -> Result<(), Failure> {
    let named = format!("{} (parameter {})", one.name, one.number);
    let values = numbers::values(one.number);
    words::check_value(&named, value, (&values, one.unit))?;
    let Ok(value) = u32::try_from(value) else {
        return Err(Failure::Usage(format!("{named} = {value}: it takes 0 to {}", u32::MAX)));
    };
    let assumed = board.options().assumptions;
    let of_line = of_the_line(one.number, value, &assumed).map_err(Failure::Usage)?;
    let old = session.ask(board.parameter(one.number, &no_clock))?;
    session.ask(board.set_parameter(one.number, value, STORING, &no_clock))?;
    let changed = words::changed(old, value, one.unit);
    say!("parameter {} ({}): {changed}", one.number, one.name);
    if let Some(then) = of_line {
        let when = if assumed.line_at_restart {
            "it acts when the board has been switched off and on; from then on"
        } else {
            "it acts now; from now on"
        };
        say!("{when} {then}");
    }
    Ok(())
}

/// How the board is spoken to after a parameter of its line is set; `None` for others.
///
/// # Errors
/// A speed that no board has, with those there are.
fn of_the_line(number: u16, value: u32, assumed: &Assumptions) -> Result<Option<String>, String> {
    Ok(Some(match number {
        numbers::MODBUS_SPEED => {
            let baud = assumed.baud_code.decode(value).filter(|baud| BAUD_RATES.contains(baud));
            let baud = baud.ok_or_else(|| {
                let codes = BAUD_RATES.iter().filter_map(|baud| assumed.baud_code.encode(*baud));
                let codes: Vec<_> = codes.map(|code| code.to_string()).collect();
                let codes = codes.join(", ");
                format!("modbus-speed (parameter {number}) = {value} is not a speed of the board: it takes {codes}")
            })?;
            format!("it is spoken to with --baud {baud}")
        }
        numbers::MODBUS_PARITY => {
            let parity = Parity::from_code(value);
            let known = PARITIES.iter().find(|(_, known)| Some(*known) == parity);
            let name = known.map_or("", |(name, _)| *name);
            format!("it is spoken to with --parity {name}")
        }
        numbers::MODBUS_ADDRESS => format!("it is spoken to with --address {value}"),
        _ => return Ok(None),
    }))
}

#[cfg(test)]
mod tests {
    use super::{known, of_the_line};
    use twin_interpcnc::{Assumptions, BaudCode};

    #[test]
    fn a_speed_that_no_board_has_is_refused_and_others_say_how_to_go_on() {
        let raw = Assumptions::default();
        assert_eq!(
            of_the_line(101, 9600, &raw),
            Ok(Some("it is spoken to with --baud 9600".into()))
        );
        let refused = of_the_line(101, 12_345, &raw).expect_err("no such speed");
        assert!(refused.contains("12345") && refused.contains("115200, 128000"), "{refused}");
        let hundreds = Assumptions { baud_code: BaudCode::Hundreds, ..raw };
        let said = of_the_line(101, 96, &hundreds).expect("a speed").expect("of the line");
        assert!(said.ends_with("--baud 9600"), "{said}");
        assert_eq!(of_the_line(12, 96, &raw), Ok(None));
    }

    #[test]
    fn every_parameter_has_a_number_and_a_name_of_its_own() {
        let all = known();
        assert!(all.windows(2).all(|pair| pair[0].number < pair[1].number), "{all:#?}");
        let mut names: Vec<_> = all.iter().map(|parameter| parameter.name.as_str()).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
        // Those that the manual numbers: pages 12, 24 and 3.
        let number = |name: &str| all.iter().find(|one| one.name == name).map(|one| one.number);
        assert_eq!(number("unlock-input"), Some(88));
        assert_eq!(number("modbus-speed"), Some(101));
        assert_eq!(number("modbus-address"), Some(103));
        assert_eq!(number("limit-plus-polarity-b"), Some(123));
        assert_eq!(
            super::find("EE_MODBUS_SPEED").ok().map(|one| one.name),
            Some("modbus-speed".into())
        );
        assert_eq!(all.len(), 21 + 5 * 8);
    }
}
