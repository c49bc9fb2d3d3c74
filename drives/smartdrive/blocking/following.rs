//! Following a plan, drive by drive, and what they have been told.

use super::{SmartDriveBus, positions::Shifted};
use crate::{
    Commanded, DriveError, MAX_DRIVE_AXES, Sample, SetpointStream,
    smartdrive::{Command, DriveState, TrajectoryFlags},
};

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
            if let Some((_, expected)) = self.follower.astray().filter(|(axis, _)| *axis == index) {
                let astray = self.elsewhere(index, address, expected, state.position);
                self.restart();
                return Err(astray);
            }
            seen.push((state, stamp));
        }
        Ok(self.to_sample(&seen))
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
