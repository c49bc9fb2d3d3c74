//! Actions on a module with a wrong check sum of its EEPROM: a new one, or one that has failed. It takes parameters, and
//! nothing else (8.1).

use super::super::action::Action;
use super::super::family::Family;
use super::super::session::no_clock;
use super::super::words;
use super::Module;
use super::parameters::set_unseen;
use super::show::positions;
use crate::command::{Failure, Status};
use crate::troubleshooting::CHECK_SUM;
use twin_bim2ax::Fault;
use twin_bim2ax::protocol::bits::card;
use twin_drives::{Action as Doing, DriveError, Exchange};

impl Module {
    /// Does an action with such a module, or says why it cannot be done.
    pub(super) fn with_checksum_fault(&mut self, action: &Action<Self>) -> Result<Status, Failure> {
        match action {
            Action::Status => {
                let (seen, _) = self.session.ask(self.card.driver.positions(&no_clock))?;
                positions(&seen)?;
                say!("the check sum of its EEPROM is wrong: it takes parameters, and no orders");
                say!("next: {CHECK_SUM}");
                Ok(Status::Fit)
            }
            Action::Set { parameter, value } => {
                let value = words::value(value).map_err(Failure::Usage)?;
                let parameter = Self::find(parameter)?;
                set_unseen(&self.session, &mut self.card.driver, parameter, value)?;
                Ok(Status::Fit)
            }
            Action::Reset => self.reset(),
            _ => {
                let port = std::sync::Arc::clone(&self.card.port);
                let at = Exchange { port, address: 0, action: Doing::Identify };
                let fault = Fault::CardMessages { messages: card::CHECKSUM };
                Err(DriveError::device(at, fault).into())
            }
        }
    }
}
