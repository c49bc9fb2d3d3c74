//! Following a plan, by moves that are retargeted or by segments.

use super::{InterpCncDrive, counter};
use crate::{Command, drive::follow::Buffered};
use twin_drives::{Action, Axes, DriveError, MAX_DRIVE_AXES, Sample, SetpointStream};

impl InterpCncDrive {
    /// One cycle of following: commands for the axes that need one, then a look.
    pub(super) fn follow_cycle(
        &mut self,
        stream: &dyn SetpointStream,
    ) -> Result<Sample, DriveError> {
        if let Some(buffered) = &mut self.buffered {
            // Comes back if nothing goes wrong; else it starts from what the next sample shows.
            let present = buffered.clone();
            buffered.restart();
            return self.follow_buffered(present, stream);
        }
        let clock = || stream.now_ns();
        let needing = self.follower.survey(stream);
        for index in &needing {
            let decided_ns = stream.now_ns();
            let Some(order) = self.follower.order(*index, needing.len(), decided_ns) else {
                continue;
            };
            let Some(axis) = self.axes().nth(order.axis) else { continue };
            let sent = self.send(&Command::Move { axis, profile: order.profile }, &clock);
            // Whether a lost command was executed is unknown: start again from what the next sample shows.
            let stamp = sent.inspect_err(|_| self.restart())?;
            self.follower.executed(&order, decided_ns, &stamp);
            if let Some(place) = self.commanded.get_mut(order.axis) {
                *place = Some(order.profile.target);
            }
        }
        let mut seen = self.obeying_state(&clock);
        if seen.as_ref().is_ok_and(|(_, stamp)| self.follower.is_poor(stamp)) {
            seen = self.obeying_state(&clock);
        }
        let (state, stamp) = seen.inspect_err(|_| self.follower.restart())?;
        let moving = state.status.moving();
        let counters = self
            .board
            .options()
            .axes
            .iter()
            .map(|axis| (counter(&state, axis.axis), moving.contains(axis.axis)));
        self.follower.sampled(&stamp, counters);
        let idle = self.follower.idle().and_then(|index| self.axes().nth(index));
        if let Some(axis) = idle {
            self.restart();
            let (at, found) = (self.board.at(Action::ReadState), counter(&state, axis).into());
            return Err(DriveError::NoEffect {
                at,
                axis: Axes::Letters(axis.mask().bits()),
                found,
            });
        }
        let astray = self.follower.astray();
        let astray = astray.and_then(|(index, expected)| Some((self.axes().nth(index)?, expected)));
        if let Some((axis, expected)) = astray {
            self.restart();
            #[expect(clippy::cast_possible_truncation, reason = "a counter")]
            let target = expected.round() as i64;
            let (at, found) = (self.board.at(Action::ReadState), counter(&state, axis).into());
            return Err(DriveError::NotArrived {
                at,
                axis: Axes::Letters(axis.mask().bits()),
                target,
                found,
            });
        }
        self.watch_encoder((&state, &stamp), &clock)?;
        Ok(self.to_sample(&state, stamp))
    }

    /// One cycle of following by segments.
    fn follow_buffered(
        &mut self,
        mut buffered: Buffered,
        stream: &dyn SetpointStream,
    ) -> Result<Sample, DriveError> {
        let clock = || stream.now_ns();
        let decided_ns = stream.now_ns();
        if let Some(order) = buffered.order(stream, decided_ns) {
            // Whether a lost segment is in the board is unknown: the error ends following.
            let before = std::mem::replace(&mut self.commanded, [None; MAX_DRIVE_AXES]);
            let stamp = self.send(&order.command(), &clock)?;
            self.commanded = before;
            for (place, axis) in self.commanded.iter_mut().zip(&self.board.options().axes) {
                let target = order.targets.get(axis.axis.index()).copied().flatten();
                *place = target.or(*place);
            }
            buffered.executed(&order, decided_ns, &stamp);
        }
        let (state, stamp) = self.obeying_state(&clock)?;
        let counters = self.axes().map(|axis| counter(&state, axis)).collect::<Vec<_>>();
        buffered.sampled(&stamp, counters.into_iter(), state.status.segments_finished());
        self.buffered = Some(buffered);
        self.watch_encoder((&state, &stamp), &clock)?;
        Ok(self.to_sample(&state, stamp))
    }
}
