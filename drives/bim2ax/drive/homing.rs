//! The module's own homing and its lock as a [`twin_drives::Drive`] offers them.

use std::time::Duration;

use super::{AXES, Bim2AxDrive, BusStamp, Positions, STRAY_LOOKS, no_clock};
use crate::{Fault, protocol::bits::message};
use twin_drives::{Action, DriveError, HomingWays, MAX_DRIVE_AXES};

/// A counter that counts on through homing goes no further between two looks than the axis does at its start-stop speed, but
/// for when exactly each look was: so much more, µsteps.
const SLACK: f64 = 16.0;

/// What is known of axes that are homed, in the order of those in use.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Homes {
    /// Axes whose counters are to be looked at when they are home, bit by bit.
    asked: u8,
    /// When they were seen last on their way, and where, increments.
    on_the_way: Option<(i64, [i32; AXES])>,
    /// Counters that have jumped meanwhile, bit by bit.
    jumped: u8,
}

impl Bim2AxDrive {
    /// Follows homing look by look, to see whether the counters go on.
    pub(super) fn watch_homing(&mut self, (seen, stamp): &(Positions, BusStamp)) {
        if !self.homing {
            return;
        }
        let now = (stamp.middle_ns(), self.in_order(seen));
        if let Some((then_ns, before)) = self.homes.on_the_way {
            let speeds = self.settings.iter().map(crate::AxisSettings::start_stop);
            for ((place, speed), (before, after)) in
                (0_u8..).zip(speeds).zip(before.into_iter().zip(now.1))
            {
                #[expect(clippy::cast_precision_loss, reason = "seconds")]
                let way = speed * (now.0 - then_ns) as f64 * 1e-9;
                if f64::from(before.abs_diff(after)) > 2.0 * way + SLACK {
                    self.homes.jumped |= 1 << place;
                }
            }
        }
        self.homing = self.moving(seen) != 0;
        if self.homing {
            self.homes.on_the_way = Some(now);
        }
    }

    /// Holds the counters of axes that have come home against what is assumed of them.
    fn check_counts(&mut self, first: &Positions) -> Result<(), DriveError> {
        let counted_on = self.options.driver.assumptions.homing_keeps_position;
        let before = self.homes.on_the_way.map_or([0; AXES], |(_, positions)| positions);
        let wrong = |drive: &Self, seen: &Positions| {
            let homes = drive.homes;
            let axes = (0_u8..).zip(&drive.options.axes).zip(drive.in_order(seen)).zip(before);
            axes.map(|(((place, axis), found), before)| (place, *axis, found, before)).find(
                |(place, axis, found, _)| {
                    let home = seen
                        .messages
                        .get(axis.index())
                        .is_some_and(|word| word & message::HOMED != 0);
                    let as_assumed = if counted_on {
                        // Where it has jumped to 0 it is made 0; elsewhere a look was spoilt.
                        *found != 0 || homes.jumped >> place & 1 == 0
                    } else {
                        *found == 0
                    };
                    homes.asked >> place & 1 == 1 && home && !as_assumed
                },
            )
        };
        let mut found = wrong(self, first);
        // The bus has no check sums: one look may have been spoilt.
        for _ in 1..STRAY_LOOKS {
            if found.is_none() {
                break;
            }
            let (again, _) = self.look(&no_clock)?;
            found = wrong(self, &again);
        }
        self.homes = Homes::default();
        let Some((place, _, found, before)) = found else { return Ok(()) };
        let (at, axis) = (self.module.at(Action::ReadState), self.names(1 << place));
        let (before, found) = (before.into(), found.into());
        Err(Fault::HomeCount { axis, counted_on, before, found }.at(at))
    }

    /// Homes the axes in use, both at a time, and waits for the end.
    ///
    /// # Errors
    /// If an axis does not start, has not ended after `patience`, or has not found its cam; [`Fault::HomeCount`].
    pub fn home(&mut self, patience: Duration) -> Result<(), DriveError> {
        self.forget();
        self.encoders.forget();
        let axes = self.options.axes.clone();
        let seen = self.runtime.block_on(async {
            self.module.home(&axes, &no_clock).await?;
            self.module.rested(patience, &no_clock).await
        })?;
        self.check(&seen.0, Action::ReadState, |messages| messages & message::HOMED == 0)?;
        self.homes.asked = u8::MAX;
        self.check_counts(&seen.0)
    }

    /// Switches phases off, at rest.
    pub(super) fn lock(&mut self) -> Result<(), DriveError> {
        self.forget();
        let (seen, _) = self.look(&no_clock)?;
        let moving = self.moving(&seen);
        if moving != 0 {
            return Err(DriveError::Moving {
                at: self.module.at(Action::ReadState),
                axes: self.names(moving),
            });
        }
        let axes = self.options.axes.clone();
        self.runtime.block_on(self.module.set_phases(&axes, false, &no_clock))
    }

    /// The module's homing of the axes that have a way, which it cannot be given.
    pub(super) fn start_homing(&mut self, ways: &HomingWays) -> Result<(), DriveError> {
        self.forget();
        let chosen = self.options.axes.iter().zip(ways).filter(|(_, way)| way.is_some());
        let axes: Vec<_> = chosen.map(|(axis, _)| *axis).collect();
        if axes.is_empty() {
            return Ok(());
        }
        self.prepared()?;
        self.refer_encoders()?;
        self.homing = true;
        let in_use = (0_u8..).zip(&self.options.axes);
        let asked = in_use.filter(|(_, axis)| axes.contains(axis));
        self.homes.asked = asked.fold(0, |mask, (place, _)| mask | 1 << place);
        self.runtime.block_on(self.module.home(&axes, &no_clock))
    }

    /// Which axes are homed: the module keeps it.
    pub(super) fn homed_axes(&mut self) -> Result<[Option<bool>; MAX_DRIVE_AXES], DriveError> {
        let (mut seen, _) = self.look(&no_clock)?;
        let asked = if self.moving(&seen) == 0 { self.homes.asked } else { 0 };
        if asked != 0 {
            self.check_counts(&seen)?;
        }
        let mut displaced = self.displaced(&seen)?;
        if displaced.iter().any(Option::is_some) {
            // Either look may have been spoilt.
            (seen, _) = self.look(&no_clock)?;
            displaced = self.displaced(&seen)?;
        }
        // Of one that has just been homed more is to be said than that it is not home.
        let mut just_homed = (0_u8..).zip(displaced).filter(|(place, _)| asked >> place & 1 == 1);
        if let Some((place, apart)) = just_homed.find_map(|(place, apart)| Some((place, apart?))) {
            return Err(self.differs(place, apart));
        }
        let mut homed = [None; MAX_DRIVE_AXES];
        for ((slot, axis), apart) in homed.iter_mut().zip(&self.options.axes).zip(displaced) {
            let stays = apart.is_none();
            *slot = seen.messages.get(axis.index()).map(|word| word & message::HOMED != 0 && stays);
        }
        Ok(homed)
    }
}
