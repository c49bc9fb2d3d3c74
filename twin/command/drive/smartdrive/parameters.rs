//! Parameters and variables of a SmartDRIVE by name and number.

use super::super::session::{Session, no_clock};
use super::super::words::{self, right};
use super::axis::Axis;
use crate::command::{Failure, show};
use twin_drives::DriveError;
use twin_drives::smartdrive::parameters::{self, ADDRESS, Entry, PARAMETERS, VARIABLES};

/// A parameter or a variable.
#[derive(Clone, Copy)]
enum Found {
    Parameter(&'static Entry),
    Variable(&'static Entry),
}

fn find(text: &str) -> Result<Found, Failure> {
    if let Some(number) = words::integer(text) {
        let entry = PARAMETERS.iter().find(|entry| i64::from(entry.index) == number);
        return entry.map(Found::Parameter).ok_or_else(|| {
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

pub(super) fn get(session: &Session, axis: &mut Axis, name: Option<&str>) -> Result<(), Failure> {
    let wanted: Vec<Found> = if let Some(name) = name {
        vec![find(name)?]
    } else {
        let variables = VARIABLES.iter().map(Found::Variable);
        PARAMETERS.iter().map(Found::Parameter).chain(variables).collect()
    };
    let address = axis.address;
    let mut table = show::table();
    table.set_header(["number", "name", "value", "saved", "factory", "unit"]);
    for one in wanted {
        let (entry, number, value, saved, factory) = match one {
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
        table.add_row([
            right(number),
            entry.name.into(),
            right(value),
            right(saved),
            right(factory),
            entry.unit.into(),
        ]);
    }
    say!("{table}");
    Ok(())
}

pub(super) fn set(
    session: &Session,
    axis: &mut Axis,
    name: &str,
    value: i64,
) -> Result<(), Failure> {
    let address = axis.address;
    let found = find(name)?;
    let (Found::Parameter(entry) | Found::Variable(entry)) = found;
    if !entry.writable {
        return Err(Failure::Usage(format!("{} ({}) is read-only", entry.name, entry.index)));
    }
    let named = format!("{} ({})", entry.name, entry.index);
    words::check_value(&named, value, (&entry.values(), entry.unit))?;
    let new_address = u8::try_from(value)
        .ok()
        .filter(|_| entry.index == ADDRESS && matches!(found, Found::Parameter(_)));
    if let Some(new) = new_address.filter(|new| *new != address) {
        // Two at one address can be told apart by their cables alone.
        match session.ask(axis.bus.state(new, &no_clock)) {
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
            let old = session.ask(axis.bus.parameter(address, entry.index))?.working;
            (entry, old, session.ask(axis.bus.set_parameter(address, entry.index, value))?.working)
        }
        Found::Variable(entry) => {
            let wanted = u32::try_from(value)
                .ok()
                .filter(|_| entry.accepts(value))
                .ok_or_else(|| Failure::Usage(format!("{} cannot be {value}", entry.name)))?;
            let old = session.ask(axis.bus.read(address, entry.index))?;
            (entry, old, session.ask(axis.bus.write_variable(address, entry.index, wanted))?)
        }
    };
    say!("{} ({}): {old} -> {new} {}", entry.name, entry.index, entry.unit);
    if let Some(new) = new_address.filter(|new| *new != address) {
        say!(
            "from now on the drive is spoken to with --address {new}; `--address {new} save` makes it keep that when it is switched off"
        );
    }
    Ok(())
}
