//! Resynchronisation of the driver: makes sure that an answer belongs to its command.
//!
//! An answer does not carry the code of its command ("Format des messages"). One that comes late, or twice, is taken
//! for the answer to the next command, and every later answer is then one behind. Questions with known answers reveal
//! this: PID and CID are the same in every drive ("Paramètres", 12 and 13) and differ from each other.

use tokio::time::sleep;

use super::requests::no_clock;
use crate::{
    Command, Fault, Mode, SmartDrive,
    protocol::{
        frame::{Answer, encode},
        parameters::{CID, PID},
    },
};
use twin_drives::{DriveError, Exchange, ProtocolFault};

/// The questions with known answers: parameter and value.
const KNOWN: [(u16, u16); 2] = [(PID, 0x5342), (CID, 0x0101)];
/// How often the known questions are asked until their answers agree.
const ROUNDS: u32 = 4;
/// How often a question is asked until its answer is sure.
const SURE_ROUNDS: u32 = 6;

/// Stops are never held up by questions; those that look whether they were heard are asked in step.
fn is_stop(command: &Command) -> bool {
    matches!(command, Command::Stop { .. } | Command::Mode(Some(Mode::Off)))
}

impl SmartDrive {
    /// The next answer of any drive may be one to something else.
    pub(crate) fn doubt_all(&mut self) {
        self.doubtful = u32::MAX;
    }

    /// The next answer of this drive may be one to something else.
    pub(crate) fn doubt(&mut self, address: u8) {
        self.doubtful |= 1_u32.checked_shl(address.into()).unwrap_or(0);
    }

    fn is_doubtful(&self, address: u8) -> bool {
        self.doubtful & 1_u32.checked_shl(address.into()).unwrap_or(0) != 0
    }

    /// Asks what is known until question and answer agree, if answers of this drive are doubtful.
    pub(crate) async fn resume_step(
        &mut self,
        at: &Exchange,
        command: &Command,
    ) -> Result<(), DriveError> {
        if !self.is_doubtful(at.address) || is_stop(command) {
            return Ok(());
        }
        // What may be sent again has other attempts.
        let mut timeouts = u32::from(!command.is_idempotent());
        'round: for round in 0..ROUNDS {
            if round > 0 {
                // Whatever has made them disagree may have more behind it.
                sleep(self.options().worst_latency.saturating_mul(round)).await;
            }
            for known in KNOWN {
                match self.asked_known(at, known).await {
                    Ok(true) => {}
                    Ok(false) | Err(DriveError::Protocol { .. }) => continue 'round,
                    Err(DriveError::Timeout { .. }) if timeouts > 0 => {
                        timeouts -= 1;
                        continue 'round;
                    }
                    Err(error) => return Err(error),
                }
            }
            // Nothing may be on its way that the last of them has left behind.
            if self.quiet(at).await? {
                self.doubtful &= !1_u32.checked_shl(at.address.into()).unwrap_or(0);
                return Ok(());
            }
        }
        Err(DriveError::Protocol { at: at.clone(), fault: ProtocolFault::OutOfStep })
    }

    /// Whether a question with a known answer gets that, and nothing lay in the input before it.
    async fn asked_known(
        &mut self,
        at: &Exchange,
        (parameter, value): (u16, u16),
    ) -> Result<bool, DriveError> {
        let clean = self.settle(at).await?;
        let frame = encode(at.address, &Command::Get { parameter });
        let (answer, _) = self.exchange(at, &frame, &no_clock).await?;
        Ok(clean && !answer.status.rejected() && answer.words().1 == value)
    }

    /// Whether the drive answers what it is asked now. If not, the next command to it first puts that right, and what
    /// it has answered last may be the answer to something else.
    ///
    /// # Errors
    /// If the port cannot be read or written.
    pub(crate) async fn witness(
        &mut self,
        address: u8,
        command: &Command,
    ) -> Result<bool, DriveError> {
        self.turn = !self.turn;
        let [pid, cid] = KNOWN;
        let known = match command {
            Command::Get { parameter: PID } => cid,
            Command::Get { parameter: CID } => pid,
            _ if self.turn => pid,
            _ => cid,
        };
        let at = self.at(address, command.action());
        let agrees = match self.asked_known(&at, known).await {
            Ok(agrees) => agrees,
            Err(DriveError::Timeout { .. } | DriveError::Protocol { .. }) => false,
            Err(error) => return Err(error),
        };
        if !agrees {
            self.doubt(address);
        }
        Ok(agrees)
    }

    /// The answer to a question that may be repeated, believed only if the drive answers what it is asked next as well:
    /// an answer to something else would leave its own for that.
    ///
    /// # Errors
    /// As [`SmartDrive::send`]; [`ProtocolFault::OutOfStep`] if answers cannot be distinguished.
    pub(crate) async fn ask_surely(
        &mut self,
        address: u8,
        command: Command,
    ) -> Result<Answer, DriveError> {
        for _ in 0..SURE_ROUNDS {
            let outcome = self.ask(address, command).await;
            let answered =
                outcome.as_ref().err().is_none_or(|error| Fault::rejection(error).is_some());
            if !answered || self.witness(address, &command).await? {
                return outcome;
            }
        }
        let at = self.at(address, command.action());
        Err(DriveError::Protocol { at, fault: ProtocolFault::OutOfStep })
    }
}
