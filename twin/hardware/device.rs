//! Device thread: approach, following, finish and stop of one device.

use super::error::Names;
use super::stream::Stream;
use super::{Event, HardwareError, Switch};
use crate::clock::Clock;
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError};
use std::time::Duration;
use twin_drives::{Drive, Increments, MAX_DRIVE_AXES, Sample, SetpointStream};

/// Orders to a device's thread.
pub(super) const APPROACH: u8 = 0;
pub(super) const FOLLOW: u8 = 1;
pub(super) const FINISH: u8 = 2;
pub(super) const STOP: u8 = 3;

/// A device and its side of the channel.
pub(super) struct Device {
    /// Names of the device and its axes in the machine file.
    pub(super) names: Names,
    pub(super) drive: Box<dyn Drive>,
    pub(super) stream: Arc<Stream>,
    pub(super) order: Arc<AtomicU8>,
    /// Answers that the driver has lost, for the session.
    pub(super) lost_answers: Arc<AtomicU32>,
    pub(super) sender: SyncSender<Result<Event, HardwareError>>,
    pub(super) switches: Receiver<Switch>,
    /// Outputs that the session has had switched on.
    pub(super) on: BTreeSet<u8>,
    /// The program does not go to its end.
    pub(super) early: Arc<AtomicBool>,
}

/// After this many samples in a row at rest away from its target an axis is stuck, not slow to start.
const PATIENCE: u32 = 100;

/// How long axes may go on moving after a soft stop that the device has confirmed: longer than any ramp takes.
const LONGEST_BRAKING: Duration = Duration::from_secs(10);

/// How long a device that has failed is asked whether it was restarted: a supply that comes back and firmware that starts.
const LONGEST_LOOK: Duration = Duration::from_secs(2);
const BETWEEN_LOOKS: Duration = Duration::from_millis(20);

/// How a device was stopped after an error.
enum Halted {
    /// On its ramps: nothing else has changed.
    Softly,
    /// At once, which may have locked it and cost it its positions.
    Hard,
}

impl Device {
    /// Works until the axes rest, and gives the driver back.
    pub(super) fn run(
        mut self,
        target: &Increments,
        speed: &[f64; MAX_DRIVE_AXES],
    ) -> Box<dyn Drive> {
        let unsaid = match self.guarded(|device| device.work(target, speed)) {
            Ok(()) => Some(Ok(Event::AtRest)),
            Err(error) => {
                // The first error is the one to report, and at once: the session has a machine of its own to stop. The
                // device is stopped if it still answers, which takes its time.
                let brakes = !matches!(error, HardwareError::Moves { .. });
                let error = self.named(error);
                let asks = matches!(error, HardwareError::Drive { .. });
                let unsaid = self.sender.try_send(Err(error)).err().map(unsent);
                let halted = self.guarded(|device| device.halt(brakes));
                let softly = matches!(halted, Ok(Halted::Softly));
                if let Err(error) = halted {
                    // Whatever else waits to be heard, this is not left out.
                    self.send(Event::NotStopped(self.named(error)));
                }
                if asks {
                    self.attempt(|device| device.look_again(softly));
                }
                self.attempt(Self::switch_off);
                unsaid
            }
        };
        if let Some(last) = unsaid {
            // A session that has ended hears no error.
            self.sender.send(last).unwrap_or_default();
        }
        self.drive
    }

    /// A driver that panics leaves axes that go on to where they were sent: they are to be stopped as after any error.
    fn guarded<T>(
        &mut self,
        act: impl FnOnce(&mut Self) -> Result<T, HardwareError>,
    ) -> Result<T, HardwareError> {
        let done = catch_unwind(AssertUnwindSafe(|| act(self)));
        done.unwrap_or_else(|_panic| {
            Err(HardwareError::Panicked { device: self.names.device.clone() })
        })
    }

    /// Tries something after an error that has been reported; a failure of its own is dropped.
    fn attempt(&mut self, act: impl FnOnce(&mut Self)) {
        let tried = self.guarded(|device| {
            act(device);
            Ok(())
        });
        tried.unwrap_or_default();
    }

    /// As the machine file calls it.
    fn named(&self, error: HardwareError) -> HardwareError {
        match error {
            HardwareError::WithoutUnit(source) => {
                let in_row = if source.is_lost() { self.drive.losses().in_row } else { 0 };
                self.names.attribute(source, in_row)
            }
            error => error,
        }
    }

    fn order(&self) -> u8 {
        self.order.load(Ordering::Relaxed)
    }

    /// False if the session is gone.
    fn send(&self, event: Event) -> bool {
        self.sender.send(Ok(event)).is_ok()
    }

    /// Says what is good to know and waits for nobody: axes are being stopped, and a session that does not listen has seen enough.
    fn mention(&self, event: Event) {
        self.sender.try_send(Ok(event)).unwrap_or_default();
    }

    fn work(
        &mut self,
        target: &Increments,
        speed: &[f64; MAX_DRIVE_AXES],
    ) -> Result<(), HardwareError> {
        self.drive.probe(&*self.stream)?;
        if self.order() == STOP {
            return Ok(());
        }
        self.drive.enable()?;
        self.drive.move_to(target, speed)?;
        if !self.arrive(target)? || !self.send(Event::Ready) {
            return Ok(());
        }
        loop {
            match self.order() {
                APPROACH => {
                    // Waiting for the session; a loss of the device must not go unnoticed meanwhile.
                    self.drive.sample(&*self.stream)?;
                }
                FOLLOW => {
                    // Standing where the plan has ended and then catching up would be a leap. The session looks as well, before
                    // it plans on: this thread may be the later of the two.
                    let late_ns = self.stream.now_ns() - self.stream.end_ns();
                    if late_ns > 0 && self.order() == FOLLOW {
                        let (device, late_ms) = (self.names.device.clone(), late_ns / 1_000_000);
                        return Err(HardwareError::Starved { device, late_ms });
                    }
                    let (_, heard) = self.follow()?;
                    if !heard {
                        return self.brake();
                    }
                }
                FINISH => {
                    self.settle()?;
                    if self.early.load(Ordering::Relaxed) {
                        self.switch_off();
                    }
                    return Ok(());
                }
                _ => return self.brake(),
            }
        }
    }

    /// Waits until the axes rest at `target`; false if a stop came first.
    fn arrive(&mut self, target: &Increments) -> Result<bool, HardwareError> {
        let axes = self.drive.axis_count();
        let mut still = 0;
        loop {
            if self.order() == STOP {
                self.brake()?;
                return Ok(false);
            }
            let sample = self.drive.sample(&*self.stream)?;
            let (position, target) = (sample.position.get(..axes), target.get(..axes));
            if !sample.moving && position == target {
                return Ok(true);
            }
            still = if sample.moving { 0 } else { still + 1 };
            if still > PATIENCE {
                let list = |values: Option<&[i64]>| values.unwrap_or_default().to_vec();
                return Err(HardwareError::Stuck {
                    device: self.names.device.clone(),
                    position: list(position),
                    target: list(target),
                });
            }
        }
    }

    /// One cycle of following; false if the session is gone.
    fn follow(&mut self) -> Result<(Sample, bool), HardwareError> {
        let sample = self.drive.follow(&*self.stream)?;
        self.lost_answers.store(self.drive.losses().total, Ordering::Relaxed);
        Ok((sample, self.send(Event::Sample(sample)) && self.switch()?))
    }

    /// Follows on to the end of the stream, until the axes rest there.
    fn settle(&mut self) -> Result<(), HardwareError> {
        let axes = self.drive.axis_count();
        let mut still = 0;
        loop {
            if self.order() == STOP {
                return self.brake();
            }
            let (sample, heard) = self.follow()?;
            if !heard {
                return self.brake();
            }
            // The session has planned to the end, but the axes follow behind; that they rest now, perhaps just where the
            // path will end, says nothing.
            if sample.time_ns < self.stream.end_ns() {
                continue;
            }
            let end = self.stream.at(i64::MAX);
            let there = sample.position.iter().zip(end.position).take(axes);
            #[expect(clippy::cast_precision_loss, reason = "counters have 32 bits")]
            let there =
                there.into_iter().all(|(position, end)| (*position as f64 - end).abs() <= 1.0);
            if !sample.moving && there {
                // What the plan has switched last is switched, too.
                while self.switch_next()?.is_some() {}
                return Ok(());
            }
            still = if sample.moving { 0 } else { still + 1 };
            if still > PATIENCE {
                let position = sample.position.iter().take(axes).copied().collect();
                #[expect(clippy::cast_possible_truncation, reason = "for a message")]
                let target = end.position.iter().take(axes).map(|end| end.round() as i64).collect();
                let device = self.names.device.clone();
                return Err(HardwareError::Stuck { device, position, target });
            }
        }
    }

    /// Switches the next output that is to be switched; false if the session is gone.
    fn switch(&mut self) -> Result<bool, HardwareError> {
        Ok(self.switch_next()? != Some(false))
    }

    /// None if there is nothing to be switched; false if the session is gone.
    fn switch_next(&mut self) -> Result<Option<bool>, HardwareError> {
        let Ok(Switch { output, on, due_ns }) = self.switches.try_recv() else { return Ok(None) };
        // Even if it is not confirmed it may be on.
        if on {
            self.on.insert(output);
        }
        self.drive.set_output(output, on)?;
        if !on {
            self.on.remove(&output);
        }
        Ok(Some(self.send(Event::Switched { late_ns: self.stream.now_ns() - due_ns })))
    }

    /// A program that ends early leaves no spindle running; what cannot be switched off is reported.
    fn switch_off(&mut self) {
        let on = std::mem::take(&mut self.on).into_iter();
        let left: Vec<_> =
            on.filter(|output| self.drive.set_output(*output, false).is_err()).collect();
        if !left.is_empty() {
            self.mention(Event::LeftOn(left));
        }
    }

    /// Brakes every axis on its ramp and waits until they rest, for so long as ramps may take.
    fn brake(&mut self) -> Result<(), HardwareError> {
        self.drive.soft_stop()?;
        self.switch_off();
        self.rest()
    }

    fn rest(&mut self) -> Result<(), HardwareError> {
        let since = Clock::start();
        loop {
            let sample = self.drive.sample(&*self.stream)?;
            self.mention(Event::Sample(sample));
            if !sample.moving {
                return Ok(());
            }
            let waited = Duration::from_nanos(since.now_ns().unsigned_abs());
            if waited > LONGEST_BRAKING {
                let (device, waited_s) = (self.names.device.clone(), waited.as_secs());
                return Err(HardwareError::Moves { device, waited_s });
            }
        }
    }

    /// Stops the axes after an error: on their ramps if that still makes sense (`brakes`), and at once if it does not or is
    /// not confirmed. Where a soft stop that was confirmed has changed nothing, a hard one only counts when the axes
    /// are at rest.
    fn halt(&mut self, brakes: bool) -> Result<Halted, HardwareError> {
        if brakes {
            match self.drive.soft_stop() {
                Ok(()) => return Ok(Halted::Softly),
                // The axes are at rest; a counter that is wrong is reported next to the first error.
                Err(error) if error.is_of_encoder() => {
                    let error = self.named(error.into());
                    self.send(Event::Displaced(error));
                    return Ok(Halted::Softly);
                }
                Err(_) => {}
            }
        }
        self.drive.hard_stop()?;
        if brakes {
            return Ok(Halted::Hard);
        }
        // A device that is locked by it may refuse to be asked how it is: it has confirmed that it stopped.
        match self.drive.sample(&*self.stream) {
            Ok(sample) if sample.moving => self.rest().map(|()| Halted::Hard),
            Ok(_) | Err(_) => Ok(Halted::Hard),
        }
    }

    /// Looks what has become of a device that has failed, after everything has been stopped: it may have
    /// been without supply for a moment. One that does not answer is asked again for a while.
    fn look_again(&mut self, softly: bool) {
        let certain = softly || self.drive.hard_stop_keeps_position();
        let since = Clock::start();
        loop {
            match self.drive.shows_restart() {
                Ok(true) => {
                    self.mention(Event::Restarted(certain));
                    return;
                }
                Ok(false) => return,
                Err(_) => {}
            }
            if Duration::from_nanos(since.now_ns().unsigned_abs()) > LONGEST_LOOK {
                return;
            }
            std::thread::sleep(BETWEEN_LOOKS);
        }
    }
}

/// What could not be sent.
fn unsent<T>(error: TrySendError<T>) -> T {
    match error {
        TrySendError::Full(value) | TrySendError::Disconnected(value) => value,
    }
}
