//! Checks of a module: it obeys, its axes rest at their targets, and moves end in time.

use super::{
    Action, Bim2AxDrive, BusStamp, Clock, DriveError, Duration, FAULTS, Following, NOT_READY,
    Positions, STRAY_LOOKS, message, no_clock,
};
use crate::Fault;

/// A leg that lasts so much longer than it should, ns, does not end.
const OVERDUE_NS: i64 = 1_000_000_000;
/// What shows that an axis has stopped obeying. An axis at a soft limit obeys in the other direction.
const STOPPED: u16 = FAULTS
    | message::PHASES_OFF
    | message::HARD_STOPPED
    | message::PLUS_SWITCH
    | message::MINUS_SWITCH;

impl Bim2AxDrive {
    /// Looks at a module that is expected to obey, and whose axes, if they stand, are to stand where they were sent:
    /// the bus has no check sums, so this is how a target that was spoilt on the way is found out.
    pub(super) fn obeying(
        &mut self,
        clock: &dyn Clock,
    ) -> Result<(Positions, BusStamp), DriveError> {
        let mut looks = 0;
        loop {
            let seen = self.look(clock)?;
            looks += 1;
            // Homing turns round on end switches.
            let turns = if self.homing { message::PLUS_SWITCH | message::MINUS_SWITCH } else { 0 };
            self.watch_homing(&seen);
            let obeys = self.check(&seen.0, Action::ReadState, |messages| {
                let moving = messages & message::MOVING != 0;
                messages & STOPPED & !if moving { turns } else { 0 } != 0
            });
            let stray = self.stray(&seen.0);
            if self.in_order(&seen.0) != self.vain.from {
                self.vain.idle = 0;
            }
            // What has stopped an axis says more than where that is.
            let watched = if obeys.is_ok() { self.watch_encoders(&seen, clock) } else { Ok(()) };
            if looks >= STRAY_LOOKS {
                obeys?;
                watched.inspect_err(|error| self.doubt_encoder(error))?;
                return stray.map_or(Ok(()), |stray| self.idle(&seen.0, stray)).map(|()| seen);
            }
            if let Err(error) = &watched
                && !error.is_of_encoder()
            {
                watched?;
            } else if obeys.is_ok() && watched.is_ok() && stray.is_none() {
                return self.not_overdue(&seen).map(|()| seen);
            }
        }
    }

    /// Axes rest elsewhere than they were sent. Where a leg has begun nowhere, its order had no effect: the next leg repeats it, once.
    fn idle(&mut self, seen: &Positions, stray: DriveError) -> Result<(), DriveError> {
        self.sent = None;
        let leg = matches!(self.following, Following::Leg(_));
        if !leg || self.in_order(seen) != self.vain.from {
            return Err(stray);
        }
        self.vain.idle += 1;
        match stray {
            DriveError::NotArrived { at, axis, found, .. } if self.vain.idle > 1 => {
                Err(DriveError::NoEffect { at, axis, found })
            }
            _ => Ok(()),
        }
    }

    /// Looks at a module whose axes are to be ready for an order; one look may be spoilt.
    pub(super) fn ready(&mut self) -> Result<Positions, DriveError> {
        let mut looks = 0;
        loop {
            looks += 1;
            let seen = self.look(&no_clock)?;
            let ready = self.check(&seen.0, Action::ReadState, |word| word & NOT_READY != 0);
            let watched = ready.and_then(|()| self.watch_encoders(&seen, &no_clock));
            match watched.and_then(|()| self.check_homes(&seen.0)) {
                Err(error) if looks >= STRAY_LOOKS => {
                    self.doubt_encoder(&error);
                    return Err(error);
                }
                Err(_) => {}
                Ok(()) => return Ok(seen.0),
            }
        }
    }

    /// Looks at the encoders of axes that have been stopped, where it is known what they are to show.
    pub(super) fn check_rest(&mut self, rested: (Positions, BusStamp)) -> Result<(), DriveError> {
        let mut seen = rested;
        let mut looks = 1;
        while let Err(error) = self.watch_known(&seen) {
            if looks >= STRAY_LOOKS {
                self.doubt_encoder(&error);
                return Err(error);
            }
            looks += 1;
            seen = self.look(&no_clock)?;
        }
        Ok(())
    }

    /// Forgets the references of the encoders after an error of one: they are taken anew where the axes rest next.
    fn doubt_encoder(&mut self, error: &DriveError) {
        if error.is_of_encoder() {
            self.encoders.forget();
        }
    }

    /// Fails if a leg lasts much longer than it should.
    fn not_overdue(&mut self, (seen, stamp): &(Positions, BusStamp)) -> Result<(), DriveError> {
        match self.following {
            Following::Leg(end_ns)
                if self.moving(seen) != 0 && stamp.sent_ns > end_ns.saturating_add(OVERDUE_NS) =>
            {
                self.forget();
                let at = self.module.at(Action::ReadState);
                let patience = Duration::from_nanos(OVERDUE_NS.unsigned_abs());
                Err(DriveError::Unfinished { at, patience })
            }
            _ => Ok(()),
        }
    }

    /// The first axis that is elsewhere than it was sent.
    fn stray(&self, seen: &Positions) -> Option<DriveError> {
        let sent = self.sent.filter(|_| self.moving(seen) == 0)?;
        let places = (0_u8..).zip(sent).zip(self.in_order(seen)).take(self.options.axes.len());
        let ((place, target), found) =
            places.into_iter().find(|((_, target), found)| target != found)?;
        let axis = self.names(1 << place);
        let (target, found) = (target.into(), found.into());
        let at = self.module.at(Action::ReadState);
        Some(DriveError::NotArrived { at, axis, target, found })
    }

    /// Fails for the first axis in use whose messages are wrong.
    pub(super) fn check(
        &self,
        seen: &Positions,
        action: Action,
        wrong: impl Fn(u16) -> bool,
    ) -> Result<(), DriveError> {
        for axis in &self.options.axes {
            let messages = seen.messages.get(axis.index()).copied().unwrap_or(0);
            if wrong(messages) {
                let axis = u8::try_from(axis.number()).unwrap_or(0);
                return Err(Fault::AxisMessages { axis, messages }.at(self.module.at(action)));
            }
        }
        Ok(())
    }
}
