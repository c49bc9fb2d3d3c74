//! Feedback and failures of the drives of a run.

use super::run::{Plan, Run};
use super::{DriveSample, Observer, Stopped};
use crate::clock::Clock;
use crate::compare::Measured;
use crate::hardware::{Hardware, HardwareError};
use crate::plant::{AxisFeedback, Plant};
use std::time::Duration;
use twin_physics::PhysicsError;

/// How long drives may take to come to rest at the end before the session ends without them.
const LONGEST_SETTLING: Duration = Duration::from_secs(10);

impl<P: Plant<Error = PhysicsError>> Run<'_, '_, P> {
    /// Handles a failure of the drives. They are off the path or their positions are not known, so the simulated
    /// machine need not stay on it. A failure of the drives replaces an earlier stop by the user as the reason.
    pub(super) fn lose_drives(&mut self, source: HardwareError) {
        let place = match &source {
            HardwareError::TooFar { time_ns, .. } => self.history.place(*time_ns),
            _ => None,
        };
        let place = place.unwrap_or_else(|| self.place());
        match &mut self.stopped {
            None | Some(Stopped::Interrupted(_) | Stopped::Unsettled) => {
                self.stopped = Some(Stopped::Drives { place, source });
            }
            // What its driver has said once it had given the device up.
            Some(Stopped::Drives { source: HardwareError::Silent { then, .. }, .. })
                if then.is_none() =>
            {
                *then = Some(Box::new(source));
            }
            Some(_) => {}
        }
        if let Some(hardware) = &mut self.hardware {
            hardware.stop_astray();
        }
        self.brake();
    }

    /// Handles a plan that ended before the drives did. No drive follows overdue set-points, because that would be a
    /// jump.
    pub(super) fn lose_overdue(&mut self, now_ns: i64) {
        if self.plan != Plan::GoesOn {
            return;
        }
        if let Some(source) = self.hardware.as_mut().and_then(|drives| drives.starved(now_ns)) {
            self.lose_drives(source);
        }
    }

    /// A device keeps silent and is perhaps heard of again: all axes come to rest on the path, as when the user wants it.
    fn hold_drives(&mut self, source: HardwareError) {
        if matches!(self.stopped, None | Some(Stopped::Interrupted(_))) {
            let goes_on = self.plan == Plan::GoesOn && self.stopped.is_none();
            self.stopped = Some(Stopped::Drives { place: self.place(), source });
            if goes_on {
                self.items.request_stop();
            }
        }
    }

    /// Takes the samples of the drives, and compares them with set-points and simulated machine.
    pub(super) fn listen(&mut self, observer: &mut dyn Observer) {
        let failure = loop {
            match self.hardware.as_mut().map(Plant::feedback) {
                Some(Ok(Some(feedback))) => self.samples.push_back(feedback),
                Some(Ok(None)) | None => break None,
                Some(Err(source)) => break Some(source),
            }
        };
        // After the end everything rests; before it, what a sample is compared with must have been simulated.
        let known_ns = if self.goes_on() { self.executed_ns() } else { i64::MAX };
        while let Some(sample) = self.samples.pop_front_if(|sample| sample.time_ns <= known_ns) {
            self.compare(&sample, observer);
        }
        match failure {
            Some(source @ HardwareError::Silent { .. }) => self.hold_drives(source),
            Some(source) => self.lose_drives(source),
            None => {}
        }
    }

    fn compare(&mut self, sample: &AxisFeedback, observer: &mut dyn Observer) {
        let Some(drives) = Measured::new(self.machine, sample.position) else { return };
        self.resting.drives = Some((sample.time_ns, drives));
        if self.twin_failed {
            return;
        }
        let Some((place, wanted, twin)) = self.history.at(self.machine, sample.time_ns) else {
            return;
        };
        self.comparison.drives(&wanted, &twin, &drives, place);
        observer.drives(&DriveSample {
            time_ns: sample.time_ns,
            place,
            wanted: &wanted,
            twin: &twin,
            drives: &drives,
        });
    }

    /// Waits until the drives rest, too.
    pub(super) fn settle(
        &mut self,
        clock: Clock,
        observer: &mut dyn Observer,
        interrupts: &dyn Fn() -> u32,
    ) {
        let patience_ns = i64::try_from(LONGEST_SETTLING.as_nanos()).unwrap_or(i64::MAX);
        let deadline_ns = clock.now_ns().saturating_add(patience_ns);
        loop {
            // First whether it runs, then what it has said: what it says last is said before it ends.
            let running = self.hardware.as_ref().is_some_and(Hardware::is_running);
            self.listen(observer);
            if !running {
                return;
            }
            if clock.now_ns() >= deadline_ns {
                self.stopped.get_or_insert(Stopped::Unsettled);
                return;
            }
            self.handle_interrupt(interrupts());
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}
