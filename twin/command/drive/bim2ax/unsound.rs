//! A module the check sum of whose EEPROM is wrong: a new one, or one that has failed. It takes parameters, and nothing
//! else (8.1).

use super::super::session::{Session, no_clock};
use super::module::Module;
use super::motion::standing;
use super::parameters::set_unseen;
use super::show::{positions, unsound_scan};
use super::{Action, restarted};
use crate::advice::CHECK_SUM;
use crate::command::{Failure, Status};
use twin_drives::bim2ax::Fault;
use twin_drives::bim2ax::bits::card;
use twin_drives::{Action as Doing, DriveError, Exchange};

pub(super) fn carry_out(
    session: &Session,
    module: &mut Module,
    action: &Action,
) -> Result<Status, Failure> {
    match action {
        Action::Scan => unsound_scan()?,
        Action::Status => {
            let (seen, _) = session.ask(module.driver.positions(&no_clock))?;
            positions(&seen)?;
            say!("the check sum of its EEPROM is wrong: it takes parameters, and no orders");
            say!("next: {CHECK_SUM}");
        }
        Action::Set { parameter, value } => {
            set_unseen(session, &mut module.driver, parameter, *value)?;
        }
        Action::Reset => {
            standing(session, module, "reset")?;
            session.ask(module.driver.reset())?;
            return restarted(session, module);
        }
        _ => {
            let at = Exchange {
                port: std::sync::Arc::clone(&module.port),
                station: 0,
                action: Doing::Identify,
            };
            let unsound = Fault::CardMessages { messages: card::CHECKSUM };
            return Err(DriveError::device(at, unsound).into());
        }
    }
    Ok(Status::Fit)
}
