//! What can be asked of a drive, each in a call.

use std::time::Duration;

use tokio::time::{sleep, timeout};

use super::{
    Alarms, Command, Init, IoUpdate, LoadSource, Mode, SmartDrive, TrajectoryFlags,
    frame::Answer,
    parameters::{Entry, parameter_at, variable_at},
};
use crate::{Clock, DriveError, Stamp};

/// Time between two looks at a drive that takes its time.
const LOOK: Duration = Duration::from_millis(5);

/// What a drive says about itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveState {
    /// Position counter, µsteps.
    pub position: i32,
    /// Number of the mode, 31 while it changes.
    pub mode: u8,
    /// Whether homing is running.
    pub homing: bool,
    /// Alarms, shown to PING only; the drive is off while there are any.
    pub alarms: Alarms,
    /// State of the trajectory; nothing while there are alarms.
    pub flags: TrajectoryFlags,
}

impl DriveState {
    /// The state in an answer whose data are the position and whose TAG is that of the trajectory, or of alarms.
    pub(crate) fn from_answer(answer: Answer) -> Self {
        let alarm = answer.status.alarm();
        let (alarms, flags) = if alarm {
            (Alarms(answer.tag), TrajectoryFlags::NONE)
        } else {
            (Alarms::default(), TrajectoryFlags::from_tag(answer.tag))
        };
        Self {
            position: answer.number(),
            mode: answer.status.mode(),
            homing: answer.status.sequence_busy(),
            alarms,
            flags,
        }
    }

    /// Whether the motor moves, is going to, or homing runs.
    pub fn moving(&self) -> bool {
        let ends = [TrajectoryFlags::DONE, TrajectoryFlags::LIMITED, TrajectoryFlags::STALLED];
        let obeys = self.mode == Mode::Remote.number();
        let pending = obeys && !ends.iter().any(|end| self.flags.contains(*end));
        self.homing || self.flags.contains(TrajectoryFlags::IN_MOTION) || pending
    }
}

/// The three copies of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParameterValue {
    /// In the flash memory.
    pub saved: i64,
    /// In use.
    pub working: i64,
    /// From the factory.
    pub factory: i64,
}

/// Inputs and outputs: 7 LIMN, 6 LIMP, 5 OFF, 4 DIR, 3 GO, 2 LED, 1 BRK, 0 RDY.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IoState {
    /// Levels.
    pub levels: u8,
    /// Active edges caught.
    pub active: u8,
    /// Inverse edges caught.
    pub reverse: u8,
}

fn no_clock() -> i64 {
    0
}

/// The 32 bits of two words.
fn join(low: u16, high: u16) -> u32 {
    u32::from(high) << 16 | u32::from(low)
}

impl SmartDrive {
    async fn ask(&mut self, address: u8, command: Command) -> Result<Answer, DriveError> {
        self.send(address, &command, &no_clock).await.map(|(answer, _)| answer)
    }

    /// PING: position, mode, alarms and state of the trajectory; asked again once if no proper answer comes.
    ///
    /// # Errors
    /// As [`SmartDrive::send`].
    pub async fn state(
        &mut self,
        address: u8,
        clock: &dyn Clock,
    ) -> Result<(DriveState, Stamp), DriveError> {
        let (answer, stamp) = self.send(address, &Command::Ping, clock).await?;
        Ok((DriveState::from_answer(answer), stamp))
    }

    /// Addresses at which a drive answers, among `addresses`; the others cost a deadline each.
    ///
    /// # Errors
    /// If the port cannot be read or written.
    pub async fn scan(
        &mut self,
        addresses: impl Iterator<Item = u8>,
    ) -> Result<Vec<(u8, DriveState)>, DriveError> {
        let mut found = Vec::new();
        for address in addresses {
            match self.state(address, &no_clock).await {
                Ok((state, _)) => found.push((address, state)),
                Err(DriveError::Timeout { .. } | DriveError::Protocol { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(found)
    }

    /// MODE, `None` for the configured one; returns when the drive is in it. The position is 0 then, and moves are
    /// cancelled; alarms are cleared unless their causes are still there.
    ///
    /// # Errors
    /// As [`SmartDrive::send`]; if the drive does not change in time, or is in alarm again.
    pub async fn set_mode(&mut self, address: u8, mode: Option<Mode>) -> Result<(), DriveError> {
        let command = Command::Mode(mode);
        self.ask(address, command).await?;
        let found = self.changed(address, &command).await?;
        match mode {
            Some(mode) if mode.number() != found => Err(DriveError::Mode {
                at: self.at(address, command.action()),
                expected: mode.number(),
                found,
            }),
            _ => Ok(()),
        }
    }

    /// Waits until a mode no longer changes; the number of the new one.
    pub(crate) async fn changed(
        &mut self,
        address: u8,
        command: &Command,
    ) -> Result<u8, DriveError> {
        let patience = self.options().mode_change;
        let mut mode = Mode::Changing.number();
        let changing = async {
            loop {
                let state = match self.state(address, &no_clock).await {
                    Ok((state, _)) => state,
                    // Whether a drive answers meanwhile is not documented.
                    Err(DriveError::Timeout { .. } | DriveError::Protocol { .. }) => continue,
                    Err(error) => return Err(error),
                };
                mode = state.mode;
                if !state.alarms.is_empty() {
                    return Ok(Some(state.alarms));
                }
                if mode != Mode::Changing.number() {
                    return Ok(None);
                }
                sleep(LOOK).await;
            }
        };
        let outcome = timeout(patience, changing).await;
        let at = self.at(address, command.action());
        match outcome {
            Ok(Ok(None)) => Ok(mode),
            Ok(Ok(Some(alarms))) => Err(DriveError::Alarm { at, alarms }),
            Ok(Err(error)) => Err(error),
            Err(_) => Err(DriveError::Mode { at, expected: Mode::Remote.number(), found: mode }),
        }
    }

    /// READ: a variable.
    ///
    /// # Errors
    /// As [`SmartDrive::send`]; [`crate::DriveError::Rejected`] if there is no such variable.
    pub async fn read(&mut self, address: u8, variable: u16) -> Result<i64, DriveError> {
        let number = self.ask(address, Command::Read { variable }).await?.number();
        Ok(variable_at(variable).map_or(number.into(), |entry| entry.value(number.cast_unsigned())))
    }

    /// WRITE: changes a variable; its value afterwards.
    ///
    /// # Errors
    /// As [`SmartDrive::send`]; [`crate::DriveError::Rejected`] if there is no such variable or it cannot be written.
    pub async fn write_variable(
        &mut self,
        address: u8,
        variable: u16,
        value: u32,
    ) -> Result<i64, DriveError> {
        let number = self.ask(address, Command::Write { variable, value }).await?.number();
        Ok(variable_at(variable).map_or(number.into(), |entry| entry.value(number.cast_unsigned())))
    }

    /// GET: the three copies of a parameter, 32-bit ones in two steps.
    ///
    /// # Errors
    /// As [`SmartDrive::send`]; [`crate::DriveError::Rejected`] if there is no such parameter.
    pub async fn parameter(
        &mut self,
        address: u8,
        index: u16,
    ) -> Result<ParameterValue, DriveError> {
        let low = self.ask(address, Command::Get { parameter: index }).await?;
        let entry = parameter_at(index).filter(|(_, is_high)| !is_high).map(|(entry, _)| entry);
        let high = match entry {
            Some(entry) if entry.kind.is_long() => {
                Some(self.ask(address, Command::Get { parameter: index + 1 }).await?)
            }
            _ => None,
        };
        Ok(copies(entry, low, high))
    }

    /// SET: changes the working value of a parameter, 32-bit ones in two steps; the copies afterwards.
    ///
    /// # Errors
    /// As [`SmartDrive::send`]; [`crate::DriveError::Value`] if the parameter cannot have this value, or the drive does
    /// not show it afterwards; [`crate::DriveError::Rejected`] if the drive does not have the parameter.
    pub async fn set_parameter(
        &mut self,
        address: u8,
        index: u16,
        value: i64,
    ) -> Result<ParameterValue, DriveError> {
        let [a, b, c, d, ..] = value.to_le_bytes();
        let (low, high) = (u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]));
        let command = Command::Set { parameter: index, value: low };
        let entry = parameter_at(index).filter(|(_, is_high)| !is_high).map(|(entry, _)| entry);
        let (least, most) = entry.map_or((0, 0xFFFF), |entry| (entry.low, entry.high));
        let beyond = |at| {
            #[expect(clippy::cast_precision_loss, reason = "for a message")]
            let (value, low, high) = (value as f64, least as f64, most as f64);
            let what = entry.map_or("parameter", |entry| entry.name);
            DriveError::Value { at, what, value, low, high }
        };
        let possible = entry.map_or((least..=most).contains(&value), |entry| entry.accepts(value));
        if !possible {
            return Err(beyond(self.at(address, command.action())));
        }
        let first = self.ask(address, command).await?;
        let second = match entry {
            Some(entry) if entry.kind.is_long() => {
                Some(self.ask(address, Command::Set { parameter: index + 1, value: high }).await?)
            }
            _ => None,
        };
        let now = copies(entry, first, second);
        if now.working == value { Ok(now) } else { Err(beyond(self.at(address, command.action()))) }
    }

    /// SAVE: saves all working values; returns when the drive is back in its mode, at position 0.
    ///
    /// # Errors
    /// As [`SmartDrive::set_mode`].
    pub async fn save(&mut self, address: u8) -> Result<(), DriveError> {
        self.ask(address, Command::Save).await?;
        self.changed(address, &Command::Save).await.map(|_| ())
    }

    /// LOAD: takes all working values from the saved ones or the factory's; returns when the drive is back in its mode,
    /// at position 0.
    ///
    /// # Errors
    /// As [`SmartDrive::set_mode`].
    pub async fn load(&mut self, address: u8, source: LoadSource) -> Result<(), DriveError> {
        self.ask(address, Command::Load(source)).await?;
        self.changed(address, &Command::Load(source)).await.map(|_| ())
    }

    /// RESET: restarts the drive, which is silent for its bootloader's 250 ms and its start; or holds it in the
    /// bootloader.
    ///
    /// # Errors
    /// As [`SmartDrive::send`].
    pub async fn reset(&mut self, address: u8, bootloader: bool) -> Result<(), DriveError> {
        self.ask(address, Command::Reset { bootloader }).await.map(|_| ())
    }

    /// IOUPDATE: switches outputs, clears captures; levels and captures, these as they were before.
    ///
    /// # Errors
    /// As [`SmartDrive::send`].
    pub async fn io(&mut self, address: u8, update: IoUpdate) -> Result<IoState, DriveError> {
        let [levels, _, active, reverse] = self.ask(address, Command::IoUpdate(update)).await?.data;
        Ok(IoState { levels, active, reverse })
    }

    /// START: runs at `speed` rpm with sign, at `rate` rpm/s (0: the largest). It runs until it is told otherwise:
    /// prefer [`SmartDrive::go_to`].
    ///
    /// # Errors
    /// As [`SmartDrive::send`].
    pub async fn start(
        &mut self,
        address: u8,
        speed: i16,
        rate: u16,
    ) -> Result<DriveState, DriveError> {
        let answer = self.ask(address, Command::Start { speed, rate }).await?;
        Ok(DriveState::from_answer(answer))
    }

    /// STOP: to rest at `rate` rpm/s (0: the largest).
    ///
    /// # Errors
    /// As [`SmartDrive::send`].
    pub async fn stop(&mut self, address: u8, rate: u16) -> Result<DriveState, DriveError> {
        let answer = self.ask(address, Command::Stop { rate }).await?;
        Ok(DriveState::from_answer(answer))
    }

    /// GOTO: to `target` µsteps, with at most these rpm and rpm/s (0: the largest), or the largest of both.
    ///
    /// # Errors
    /// As [`SmartDrive::send`]; [`crate::DriveError::Rejected`] if the target is outside the drive's limits.
    pub async fn go_to(
        &mut self,
        address: u8,
        target: i32,
        profile: Option<(u16, u16)>,
    ) -> Result<DriveState, DriveError> {
        let answer = self.ask(address, Command::GoTo { target, profile }).await?;
        Ok(DriveState::from_answer(answer))
    }

    /// STEP: by `distance` µsteps, as [`SmartDrive::go_to`]. Never sent twice.
    ///
    /// # Errors
    /// As [`SmartDrive::go_to`].
    pub async fn step(
        &mut self,
        address: u8,
        distance: i32,
        profile: Option<(u16, u16)>,
    ) -> Result<DriveState, DriveError> {
        let answer = self.ask(address, Command::Step { distance, profile }).await?;
        Ok(DriveState::from_answer(answer))
    }

    /// TRJINIT: makes the position or an encoder 0, or begins homing and returns.
    ///
    /// # Errors
    /// As [`SmartDrive::send`].
    pub async fn init(&mut self, address: u8, init: Init) -> Result<DriveState, DriveError> {
        let answer = self.ask(address, Command::TrajectoryInit(init)).await?;
        Ok(DriveState::from_answer(answer))
    }

    /// Homes and returns when it is done; the position then.
    ///
    /// # Errors
    /// As [`SmartDrive::send`]; [`crate::DriveError::Alarm`], [`crate::DriveError::Mode`] or
    /// [`crate::DriveError::NotHomed`] if it fails.
    pub async fn home(&mut self, address: u8) -> Result<i32, DriveError> {
        self.init(address, Init::Homing).await?;
        self.homed(address).await
    }

    /// Waits until homing that has begun is over; the position then.
    pub(crate) async fn homed(&mut self, address: u8) -> Result<i32, DriveError> {
        let at = self.at(address, Command::TrajectoryInit(Init::Homing).action());
        let patience = self.options().homing;
        let running = async {
            loop {
                let (state, _) = self.state(address, &no_clock).await?;
                if !state.homing {
                    return Ok(state);
                }
                sleep(LOOK).await;
            }
        };
        let outcome = timeout(patience, running).await;
        match outcome {
            Ok(Ok(state)) if !state.alarms.is_empty() => {
                Err(DriveError::Alarm { at, alarms: state.alarms })
            }
            // One that has started anew meanwhile says that it is done, too.
            Ok(Ok(state)) if state.mode != Mode::Remote.number() => {
                let (expected, found) = (Mode::Remote.number(), state.mode);
                Err(DriveError::Mode { at, expected, found })
            }
            Ok(Ok(state)) if state.flags.contains(TrajectoryFlags::DONE) => Ok(state.position),
            Ok(Err(error)) => Err(error),
            Ok(Ok(_)) | Err(_) => Err(DriveError::NotHomed { at }),
        }
    }
}

/// The copies of a parameter from the answers with its words.
fn copies(entry: Option<&Entry>, low: Answer, high: Option<Answer>) -> ParameterValue {
    let value = |low: u16, high: u16| {
        let bits = join(low, high);
        entry.map_or(bits.into(), |entry| entry.value(bits))
    };
    let (saved, working) = low.words();
    let (saved_high, working_high) = high.map_or((0, 0), |high| high.words());
    ParameterValue {
        saved: value(saved, saved_high),
        working: value(working, working_high),
        factory: value(low.tag, high.map_or(0, |answer| answer.tag)),
    }
}
