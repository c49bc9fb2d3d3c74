//! Parameters and variables of a SmartDRIVE by name and number.

use super::super::session::{Session, no_clock};
use super::super::words::{self, right};
use super::axis::{Axis, Unit};
use crate::command::Failure;
use comfy_table::Cell;
use twin_drives::DriveError;
use twin_smartdrive::protocol::parameters::{self, ADDRESS, Entry, Kind, PARAMETERS, VARIABLES};

/// A parameter or a variable.
#[derive(Clone, Copy)]
pub(in crate::command::drive) enum Found {
    Parameter(&'static Entry),
    Variable(&'static Entry),
}

pub(super) fn find(text: &str) -> Result<Found, Failure> {
    if let Some(number) = words::integer(text) {
        let entry = PARAMETERS.iter().find(|entry| i64::from(entry.index) == number);
        return entry.map(Found::Parameter).ok_or_else(|| {
            let variable = VARIABLES.iter().find(|entry| i64::from(entry.index) == number);
            if let Some(variable) = variable {
                return Failure::Usage(format!(
                    "there is no parameter {number}; variable {number} is {}: say its name",
                    variable.name
                ));
            }
            let most = PARAMETERS.iter().map(|entry| entry.index).max().unwrap_or(0);
            words::unknown_number(number, &format!("they are some of 0 to {most}"))
        });
    }
    let parameter = parameters::named(&PARAMETERS, text).map(Found::Parameter);
    let variable = || parameters::named(&VARIABLES, text).map(Found::Variable);
    parameter.or_else(variable).ok_or_else(|| {
        let names = PARAMETERS.iter().chain(&VARIABLES).map(|entry| entry.name);
        words::unknown_name("parameter or variable", text, names)
    })
}

/// What somebody has written for a parameter: a whole number.
fn number(entry: &Entry, text: &str) -> Result<i64, String> {
    words::value(text).map_err(|not| {
        let fraction = text.parse().ok().filter(|_| entry.kind == Kind::Fraction);
        match fraction.and_then(parameters::to_q15) {
            Some(value) => format!(
                "{} ({}) = {text}: it is written in 32768ths, and {text} is {value}",
                entry.name, entry.index
            ),
            None => not,
        }
    })
}

/// All parameters, then all variables.
pub(super) fn all() -> Vec<Found> {
    let variables = VARIABLES.iter().map(Found::Variable);
    PARAMETERS.iter().map(Found::Parameter).chain(variables).collect()
}

/// Number, name, value, saved, factory, unit.
pub(super) fn row(session: &Session, axis: &mut Unit, found: Found) -> Result<Vec<Cell>, Failure> {
    let address = axis.address;
    let (entry, number, value, saved, factory) = match found {
        Found::Parameter(entry) => {
            let copies = session.ask(axis.bus.parameter(address, entry.index))?;
            let [saved, factory] = [copies.saved, copies.factory].map(|one| one.to_string());
            (entry, entry.index.to_string(), copies.working, saved, factory)
        }
        Found::Variable(entry) => {
            let value = session.ask(axis.bus.read(address, entry.index))?;
            let none = || "–".to_owned();
            (entry, format!("variable {}", entry.index), value, none(), none())
        }
    };
    let [number, saved, factory] = [number, saved, factory].map(right);
    Ok(vec![number, entry.name.into(), right(value), saved, factory, entry.unit.into()])
}

impl Axis {
    /// Sets a parameter or a variable.
    pub(super) fn set_parameter(&mut self, found: Found, value: &str) -> Result<(), Failure> {
        let address = self.unit.address;
        let (Found::Parameter(entry) | Found::Variable(entry)) = found;
        if !entry.writable {
            return Err(Failure::Usage(format!("{} ({}) is read-only", entry.name, entry.index)));
        }
        let value = number(entry, value).map_err(Failure::Usage)?;
        // Ceilings and steps of a turn count from now on, for what moves already, too.
        if matches!(found, Found::Parameter(_)) {
            self.at_rest("set")?;
        }
        let Self { session, unit, .. } = self;
        let named = format!("{} ({})", entry.name, entry.index);
        words::check_value(&named, value, (&entry.values(), entry.unit))?;
        let new_address = u8::try_from(value)
            .ok()
            .filter(|_| entry.index == ADDRESS && matches!(found, Found::Parameter(_)));
        if let Some(new) = new_address.filter(|new| *new != address) {
            // Two drives at one address can only be separated by their cables.
            match session.ask(unit.bus.state(new, &no_clock)) {
                Err(Failure::Drive(DriveError::Timeout { .. })) => {}
                Ok(_) | Err(Failure::Drive(DriveError::Protocol { .. })) => {
                    return Err(Failure::Usage(format!(
                        "{named} = {new}: another drive of the line answers at address {new} already"
                    )));
                }
                Err(other) => return Err(other),
            }
        }
        let (entry, old, new) = match found {
            Found::Parameter(entry) => {
                let old = session.ask(unit.bus.parameter(address, entry.index))?.working;
                (
                    entry,
                    old,
                    session.ask(unit.bus.set_parameter(address, entry.index, value))?.working,
                )
            }
            Found::Variable(entry) => {
                let wanted = u32::try_from(value)
                    .ok()
                    .filter(|_| entry.accepts(value))
                    .ok_or_else(|| Failure::Usage(format!("{} cannot be {value}", entry.name)))?;
                let old = session.ask(unit.bus.read(address, entry.index))?;
                (entry, old, session.ask(unit.bus.write_variable(address, entry.index, wanted))?)
            }
        };
        say!("{} ({}): {}", entry.name, entry.index, words::changed(old, new, entry.unit));
        if let Some(new) = new_address.filter(|new| *new != address) {
            say!(
                "from now on the drive is spoken to with --address {new}; `--address {new} save` makes it keep that when it is switched off"
            );
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{find, number};
    use twin_smartdrive::protocol::parameters::{PARAMETERS, named};

    /// "Annexe": 0.3 · 32768 = 9830.
    #[test]
    fn a_fraction_is_refused_with_its_32768ths() {
        let entry = |name| named(&PARAMETERS, name).expect("it is there");
        assert_eq!(number(entry("Cur_Idle"), "9830"), Ok(9830));
        let message = number(entry("Cur_Idle"), "0.3").unwrap_err();
        assert_eq!(message, "Cur_Idle (66) = 0.3: it is written in 32768ths, and 0.3 is 9830");
        for (name, text) in [("Cur_Idle", "1.5"), ("Cur_Idle", "half"), ("Trj_VelMax", "0.3")] {
            assert_eq!(number(entry(name), text), Err(format!("`{text}` is not a whole number")));
        }
    }

    #[test]
    fn the_number_of_a_variable_leads_to_its_name() {
        let message = find("75").err().map(|error| error.to_string());
        let expected = "there is no parameter 75; variable 75 is Pos_Actual: say its name";
        assert_eq!(message.as_deref(), Some(expected));
    }
}
