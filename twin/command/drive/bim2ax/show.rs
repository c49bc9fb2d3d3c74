//! Text output of a BIM2AX module: identity, positions, status and inputs.

use super::super::session::{Session, no_clock};
use super::super::words::{self, on_off};
use super::card::{Card, of};
use crate::command::{Failure, show};
use crate::troubleshooting;
use twin_bim2ax::protocol::bits::{card, encoder_message, message};
use twin_bim2ax::protocol::zone::Positions;
use twin_bim2ax::{Identity, ModuleAxis, describe_messages};

pub(super) fn scan(identity: &Identity) -> Result<(), Failure> {
    let axes = [(card::AXIS_1, "1"), (card::AXIS_2, "2")];
    let declared = axes.into_iter().filter(|(bit, _)| identity.card_messages & bit != 0);
    let declared: Vec<_> = declared.map(|(_, axis)| axis).collect();
    let rating = match identity.rating_ma {
        -1 => "unknown".to_owned(),
        rating => format!("{rating} mA"),
    };
    let mut table = show::table();
    table.set_header(["module", "version", "rating", "axes declared"]);
    table.add_row([
        "BIM2AX-BOCM".to_owned(),
        identity.version.to_string(),
        rating,
        declared.join(", "),
    ]);
    say!("{table}");
    Ok(())
}

/// A module that takes parameters and nothing else.
pub(super) fn checksum_fault_scan() -> Result<(), Failure> {
    let mut table = show::table();
    table.set_header(["module", "version", "rating", "state"]);
    table.add_row(["BIM2AX-BOCM", "unknown", "unknown", "check sum of its EEPROM is wrong"]);
    say!("{table}");
    Ok(())
}

/// Positions and messages of the axes.
pub(super) fn positions(seen: &Positions) -> Result<(), Failure> {
    let mut table = show::table();
    table.set_header(["axis", "position, µsteps", "state"]);
    for axis in ModuleAxis::ALL {
        let (position, messages) = of(seen, axis);
        let mut said = describe_messages(messages);
        // An axis at rest and homed.
        if messages & message::HOMED != 0 {
            let others = messages & !(message::HOMED | message::ON_CAM) != 0;
            said = if others { format!("home, {said}") } else { "home".to_owned() };
        }
        let number = axis.number().to_string();
        table.add_row([number.into(), words::right(position), said.into()]);
    }
    say!("{table}");
    Ok(())
}

pub(super) fn status(seen: &Positions) -> Result<(), Failure> {
    positions(seen)?;
    for axis in ModuleAxis::ALL {
        let (_, messages) = of(seen, axis);
        if messages & message::MOVING == 0
            && let Some(next) = troubleshooting::of_axis(messages)
        {
            say!("next for axis {}: {next}", axis.number());
        }
    }
    Ok(())
}

pub(super) fn inputs(session: &Session, module: &mut Card) -> Result<(), Failure> {
    let (seen, _) = session.ask(module.driver.positions(&no_clock))?;
    let mut table = show::table();
    table.set_header(["axis", "+ end switch", "- end switch", "home cam"]);
    for axis in ModuleAxis::ALL {
        let (_, messages) = of(&seen, axis);
        let bits = [message::PLUS_SWITCH, message::MINUS_SWITCH, message::ON_CAM];
        let [plus, minus, cam] = bits.map(|bit| on_off(messages & bit != 0).to_owned());
        table.add_row([axis.number().to_string(), plus, minus, cam]);
    }
    say!("{table}");
    encoders(session, module)
}

/// The encoders that the module has recognised.
fn encoders(session: &Session, module: &mut Card) -> Result<(), Failure> {
    const KINDS: [(u16, &str); 3] = [
        (encoder_message::INCREMENTAL, "incremental"),
        (encoder_message::SSI, "SSI"),
        (encoder_message::ENDAT, "EnDat"),
    ];
    let (seen, _) = session.ask(module.driver.encoder_points(&no_clock))?;
    let mut table = show::table();
    table.set_header(["axis", "encoder", "points", "state"]);
    let mut any = false;
    for axis in ModuleAxis::ALL {
        let (points, messages) = of(&seen, axis);
        let Some((_, kind)) = KINDS.iter().find(|(bit, _)| messages & bit != 0) else { continue };
        let facts = [
            (encoder_message::FAULT, "fault"),
            (encoder_message::ALARM, "alarm"),
            (encoder_message::DIVISOR_ZERO, "divisor is 0"),
        ];
        let said: Vec<_> = facts.iter().filter(|(bit, _)| messages & bit != 0).collect();
        let said: Vec<_> = said.into_iter().map(|(_, what)| *what).collect();
        let number = axis.number().to_string();
        table.add_row([
            number.into(),
            (*kind).into(),
            words::right(points),
            said.join(", ").into(),
        ]);
        any = true;
    }
    if any {
        say!("{table}");
    }
    Ok(())
}
