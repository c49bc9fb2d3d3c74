//! Following a plan, drive by drive, and their commanded positions.

use super::{SmartDriveBus, positions::Shifted};
use crate::{Command, DriveState, TrajectoryFlags};
use twin_drives::{Axes, Commanded, DriveError, MAX_DRIVE_AXES, Sample, SetpointStream};

/// Time between two questions with known answers while following.
const WITNESS_PERIOD_NS: u64 = 500_000_000;

impl SmartDriveBus {
    /// One round: a command or a look for each drive.
    pub(super) fn follow_round(
        &mut self,
        stream: &dyn SetpointStream,
    ) -> Result<Sample, DriveError> {
        self.sent.clear();
        self.standing.clear();
        let clock = || stream.now_ns();
        let shifted = Shifted { stream, zeros: self.zeros };
        let needing = self.follower.survey(&shifted);
        let addresses: Vec<u8> = self.axes().collect();
        let mut seen = Vec::with_capacity(addresses.len());
        for (index, address) in addresses.iter().copied().enumerate() {
            let decided_ns = stream.now_ns();
            let order = if needing.contains(&index) {
                self.follower.order(index, addresses.len(), decided_ns)
            } else {
                None
            };
            let command = order.map_or(Command::Ping, |order| order.profile.command());
            let sent = self.runtime.block_on(self.bus.send(address, &command, &clock));
            // Whether a lost command was executed is unknown: start again from what the next sample shows.
            let (answer, stamp) = sent.map_err(|error| {
                self.restart();
                self.explain(address, error)
            })?;
            let state = DriveState::from_answer(answer);
            self.check(address, &state, command.action()).inspect_err(|_| self.restart())?;
            let turning = state.flags.contains(TrajectoryFlags::IN_MOTION);
            self.follower.sampled_axis(index, &stamp, state.position, turning);
            if let Some(order) = &order {
                self.follower.executed(order, decided_ns, &stamp);
                if let Some(place) = self.commanded.get_mut(index) {
                    *place = Some(order.profile.target);
                }
            }
            if self.follower.idle() == Some(index) {
                self.restart();
                let (at, found) = (self.bus.at(address, command.action()), state.position.into());
                return Err(DriveError::NoEffect { at, axis: Axes::Only, found });
            }
            if let Some((_, expected)) = self.follower.astray().filter(|(axis, _)| *axis == index) {
                let astray = self.elsewhere(index, address, expected, state.position);
                self.restart();
                return Err(astray);
            }
            seen.push((state, stamp));
        }
        self.check_step(stream)?;
        Ok(self.to_sample(&seen))
    }

    /// From time to time asks a drive, one after the other, what is known: samples that are one behind would show nowhere else.
    fn check_step(&mut self, stream: &dyn SetpointStream) -> Result<(), DriveError> {
        let now_ns = stream.now_ns();
        if now_ns.saturating_sub(self.witnessed.0).unsigned_abs() < WITNESS_PERIOD_NS {
            return Ok(());
        }
        let count = self.axes().count().max(1);
        let address = self.axes().nth(self.witnessed.1 % count).unwrap_or(0);
        self.witnessed = (now_ns, self.witnessed.1.wrapping_add(1));
        if !self.runtime.block_on(self.bus.witness(address, &Command::Ping))? {
            // Positions may have been those of before: start again from what the next sample shows.
            self.follower.restart();
        }
        Ok(())
    }

    /// Where the drives have been sent, in the caller's increments.
    pub(super) fn commanded_positions(&self) -> Commanded {
        let mut positions = [None; MAX_DRIVE_AXES];
        for ((position, zero), counter) in positions.iter_mut().zip(self.zeros).zip(self.commanded)
        {
            *position = counter.map(|counter| zero.saturating_add(counter.into()));
        }
        positions
    }
}
