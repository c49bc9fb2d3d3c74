//! Positions of the caller and counters of the drives.

use super::{Seen, SmartDriveBus, no_clock};
use crate::{Command, DriveState, Init, TrajectoryFlags, drive::follow::GoTo};
use twin_drives::{Action, Axes, DriveError, IncrementMotion, Increments, Sample, SetpointStream};

/// A drive that is on its way shows another counter sooner than this, ns: at the least speed and rate of its registers,
/// 1 rpm and 1 rpm/s, and 200 full steps per turn that is 3.3 µsteps/s and 3.3 µsteps/s², it is one µstep away from where it
/// began after 0.8 s, and where it turns it is on the same for 1.1 s.
const FROZEN_NS: i64 = 2_000_000_000;
/// Number of samples in a row that have to show that: what is between two that an outage has set apart is unknown.
const FROZEN_SAMPLES: u32 = 12;

/// Since when a drive on its way has shown the same counter.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Frozen {
    position: i32,
    since_ns: i64,
    /// Samples that have shown it.
    samples: u32,
}

impl Frozen {
    /// Another sample of a drive that says it is on its way; whether it has stood for too long for that.
    fn sampled(&mut self, position: i32, time_ns: i64) -> bool {
        if self.samples == 0 || position != self.position {
            *self = Self { position, since_ns: time_ns, samples: 0 };
        }
        self.samples = self.samples.saturating_add(1);
        self.samples > FROZEN_SAMPLES && time_ns.saturating_sub(self.since_ns) > FROZEN_NS
    }
}

impl SmartDriveBus {
    /// The first drive that says it is on its way and has shown the same counter for longer than any can: its status is
    /// stuck.
    pub(super) fn frozen(&mut self, seen: &[Seen]) -> Option<DriveError> {
        let mut found = None;
        let drives = self.sent.iter().zip(seen).zip(&mut self.frozen).enumerate();
        for (index, ((target, (state, stamp)), frozen)) in drives {
            match target.filter(|target| state.moving() && state.position != *target) {
                Some(target) if frozen.sampled(state.position, stamp.executed_ns) => {
                    found = found.or(Some((index, target, state.position)));
                }
                Some(_) => {}
                None => *frozen = Frozen::default(),
            }
        }
        let (index, target, position) = found?;
        let address = self.axes().nth(index)?;
        Some(self.elsewhere(index, address, f64::from(target), position))
    }

    /// Makes the counter of the drive of an axis (index of the arrays) 0 where it is (TRJINIT 1), and with it moves its
    /// position limits; the caller's positions stay as they are. Unlike [`twin_drives::Drive::set_position`] it outlasts this
    /// driver, until the drive's mode changes.
    ///
    /// # Errors
    /// If the axis does not exist, the drive moves, is not in REMOTE or refuses, or its counter is not 0 afterwards.
    pub fn zero_here(&mut self, axis: usize) -> Result<(), DriveError> {
        let Some(address) = self.axes().nth(axis) else {
            let at = self.bus.at(0, Action::ReadState);
            return Err(DriveError::Unsupported { at, what: "axis of that number" });
        };
        let seen = self.states(&no_clock)?;
        self.check_rest(&seen)?;
        let before = seen.get(axis).map_or(0, |(state, _)| state.position);
        self.restart();
        let command = Command::TrajectoryInit(Init::Position);
        self.runtime.block_on(self.bus.init(address, Init::Position))?;
        let (after, _) = self.state(address, &no_clock)?;
        if after.position != 0 {
            let (at, axis) = (self.bus.at(address, command.action()), Axes::Only);
            let found = after.position.into();
            return Err(DriveError::NotWritten { at, axis, written: 0, found });
        }
        if let Some(zero) = self.zeros.get_mut(axis) {
            *zero = zero.saturating_add(before.into());
        }
        Ok(())
    }

    /// The first drive that says it is done and is elsewhere than it was sent: a target that was spoilt on its way (two
    /// bytes that have changed places leave the check sum as it is), or a status that is stuck.
    pub(super) fn stray(&self, seen: &[Seen]) -> Option<DriveError> {
        let done = |state: &DriveState| state.flags.contains(TrajectoryFlags::DONE);
        let drives = self.axes().zip(&self.sent).zip(seen);
        let strays = drives.enumerate().filter_map(|(index, ((address, target), (state, _)))| {
            let target = target
                .filter(|target| done(state) && !state.moving() && state.position != *target)?;
            Some(self.elsewhere(index, address, f64::from(target), state.position))
        });
        strays.into_iter().next()
    }

    /// A drive is not where it should be; counters of the drive.
    pub(super) fn elsewhere(
        &self,
        index: usize,
        address: u8,
        expected: f64,
        found: i32,
    ) -> DriveError {
        let zero = self.zeros.get(index).copied().unwrap_or(0);
        #[expect(clippy::cast_possible_truncation, reason = "a counter")]
        let target = (expected.round() as i64).saturating_add(zero);
        let found = zero.saturating_add(found.into());
        let (at, axis) = (self.bus.at(address, Action::ReadState), Axes::Only);
        DriveError::NotArrived { at, axis, target, found }
    }

    /// All positions at the middle of the time in which they were seen.
    pub(super) fn to_sample(&self, seen: &[Seen]) -> Sample {
        let times = || seen.iter().map(|(_, stamp)| stamp.executed_ns);
        let first = times().min().unwrap_or(0);
        let time_ns = i64::midpoint(first, times().max().unwrap_or(first));
        let mut position = self.zeros;
        for (index, (position, (state, stamp))) in position.iter_mut().zip(seen).enumerate() {
            let moved = self.follower.moved(index, stamp.executed_ns, time_ns);
            #[expect(clippy::cast_possible_truncation, reason = "a few increments")]
            let moved = moved.round() as i64;
            *position = position.saturating_add(i64::from(state.position)).saturating_add(moved);
        }
        position.iter_mut().skip(seen.len()).for_each(|unused| *unused = 0);
        Sample { time_ns, position, moving: seen.iter().any(|(state, _)| state.moving()) }
    }

    /// A position of the caller as the drive counts.
    pub(super) fn counter(
        &self,
        index: usize,
        address: u8,
        position: i64,
    ) -> Result<i32, DriveError> {
        let zero = self.zeros.get(index).copied().unwrap_or(0);
        let counter = position.checked_sub(zero).and_then(|counter| i32::try_from(counter).ok());
        counter.ok_or_else(|| {
            let command = GoTo { target: 0, speed: 1, rate: 1 }.command();
            #[expect(clippy::cast_precision_loss, reason = "for a message")]
            let value = position as f64 - zero as f64;
            DriveError::Value {
                at: self.bus.at(address, command.action()),
                what: "target",
                value,
                unit: "µsteps",
                low: i32::MIN.into(),
                high: i32::MAX.into(),
            }
        })
    }
}

/// A plan in the counts of the drives.
pub(super) struct Shifted<'a> {
    pub(super) stream: &'a dyn SetpointStream,
    pub(super) zeros: Increments,
}

impl SetpointStream for Shifted<'_> {
    fn now_ns(&self) -> i64 {
        self.stream.now_ns()
    }

    fn at(&self, time_ns: i64) -> IncrementMotion {
        let mut motion = self.stream.at(time_ns);
        for (position, zero) in motion.position.iter_mut().zip(self.zeros) {
            #[expect(
                clippy::cast_precision_loss,
                reason = "positions are of few more than 32 bits"
            )]
            let zero = zero as f64;
            *position -= zero;
        }
        motion
    }

    fn horizon_ns(&self) -> i64 {
        self.stream.horizon_ns()
    }
}

#[test]
fn a_drive_is_stuck_when_it_shows_the_same_counter_for_longer_than_any_that_moves() {
    // Every 100 ms.
    let sampled = |position: &dyn Fn(i64) -> i32| {
        let mut frozen = Frozen::default();
        (0..100).find(|round| frozen.sampled(position(*round), round * 100_000_000))
    };
    assert_eq!(sampled(&|_| 7), Some(21));
    // The slowest there is, 1 rpm of 200 µsteps: one every 0.3 s.
    assert_eq!(sampled(&|round| i32::try_from(round / 3).unwrap()), None);
    // It stands in the end.
    assert_eq!(sampled(&|round| i32::try_from(round.min(50)).unwrap()), Some(71));
    // An outage is no proof, however long.
    let mut frozen = Frozen::default();
    let seen = [0, 10_000, 10_100].map(|ms| frozen.sampled(7, ms * 1_000_000));
    assert_eq!(seen, [false; 3]);
}
