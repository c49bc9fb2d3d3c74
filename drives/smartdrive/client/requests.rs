//! Requests to a drive, one method each.

use std::time::Duration;

use tokio::time::{sleep, timeout};

use crate::{
    Alarms, Command, Fault, Init, IoUpdate, Mode, SmartDrive, TrajectoryFlags,
    protocol::frame::Answer,
};
pub(crate) use twin_drives::no_clock;
use twin_drives::{Clock, DriveError, Stamp};

/// Time between two looks at a drive that takes its time.
pub(crate) const LOOK: Duration = Duration::from_millis(5);

/// State that a drive reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveState {
    /// Position counter, µsteps.
    pub position: i32,
    /// Number of the mode, 31 while it changes.
    pub mode: u8,
    /// Whether homing is running.
    pub homing: bool,
    /// `STA_SIGNALLED`, a state of its sequencer: the manual says no more.
    pub signalled: bool,
    /// `STA_BUSY`, that it is not available: the manual does not say when.
    pub busy: bool,
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
            signalled: answer.status.signalled(),
            busy: answer.status.busy(),
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

impl SmartDrive {
    pub(crate) async fn ask(
        &mut self,
        address: u8,
        command: Command,
    ) -> Result<Answer, DriveError> {
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
                let alarms = Some(state.alarms).filter(|alarms| !alarms.is_empty());
                let ended = alarms.is_some() || mode != Mode::Changing.number();
                // An answer from before the change would say that it is over.
                if ended && self.witness(address, command).await? {
                    return Ok(alarms);
                }
                sleep(LOOK).await;
            }
        };
        let outcome = timeout(patience, changing).await;
        let at = self.at(address, command.action());
        match outcome {
            Ok(Ok(None)) => Ok(mode),
            Ok(Ok(Some(alarms))) => Err(Fault::Alarm(alarms).at(at)),
            Ok(Err(error)) => Err(error),
            Err(_) => Err(DriveError::Mode { at, expected: Mode::Remote.number(), found: mode }),
        }
    }

    /// RESET: restarts the drive, which is silent for its bootloader's 250 ms and its start; or holds it in the
    /// bootloader.
    ///
    /// # Errors
    /// As [`SmartDrive::send`].
    pub async fn reset(&mut self, address: u8, bootloader: bool) -> Result<(), DriveError> {
        self.ask(address, Command::Reset { bootloader }).await.map(|_| ())
    }

    /// IOUPDATE: switches outputs, clears captures; levels and captures, these as they were before. An output that is to
    /// be set and cleared stays as it is: neither is sent, as drives may take both in more than one way.
    ///
    /// # Errors
    /// As [`SmartDrive::send`].
    pub async fn io(&mut self, address: u8, update: IoUpdate) -> Result<IoState, DriveError> {
        let both = update.set & update.clear;
        let update = IoUpdate { set: update.set & !both, clear: update.clear & !both, ..update };
        let [levels, _, active, reverse] = self.ask(address, Command::IoUpdate(update)).await?.data;
        Ok(IoState { levels, active, reverse })
    }

    /// START: runs at `speed` rpm with sign, at `rate` rpm/s (0: the largest). It runs until another command:
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
    /// As [`SmartDrive::send`]; [`Fault::Rejected`] if the target is outside the drive's limits.
    pub async fn go_to(
        &mut self,
        address: u8,
        target: i32,
        profile: Option<(u16, u16)>,
    ) -> Result<DriveState, DriveError> {
        let answer = self.ask(address, Command::GoTo { target, profile }).await?;
        Ok(DriveState::from_answer(answer))
    }

    /// STEP: by `distance` µsteps, as [`SmartDrive::go_to`]. Never sent twice unless the drive says that it has not heard
    /// it. On a drive that moves, where it counts from is [`crate::StepFrom`].
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
    /// As [`SmartDrive::send`]; [`Fault::Alarm`], [`twin_drives::DriveError::Mode`] or
    /// [`twin_drives::DriveError::NotHomed`] if it fails, [`twin_drives::DriveError::Unfinished`] if it goes on for longer than
    /// [`SmartDriveOptions::homing`](crate::SmartDriveOptions::homing).
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
                if !state.homing && self.witness(address, &Command::Ping).await? {
                    return Ok(state);
                }
                sleep(LOOK).await;
            }
        };
        let outcome = timeout(patience, running).await;
        match outcome {
            Ok(Ok(state)) if !state.alarms.is_empty() => Err(Fault::Alarm(state.alarms).at(at)),
            // One that has started anew meanwhile says that it is done, too.
            Ok(Ok(state)) if state.mode != Mode::Remote.number() => {
                let (expected, found) = (Mode::Remote.number(), state.mode);
                Err(DriveError::Mode { at, expected, found })
            }
            Ok(Ok(state)) if state.flags.contains(TrajectoryFlags::DONE) => Ok(state.position),
            Ok(Err(error)) => Err(error),
            Ok(Ok(_)) => Err(DriveError::NotHomed { at }),
            Err(_) => Err(DriveError::Unfinished { at, patience }),
        }
    }
}
