//! The drives as a plant: one thread per device, which follows the same set-points as the simulated machine.

use crate::clock::Clock;
use crate::machine::{Axis, Machine};
use crate::plant::{AxisFeedback, Plant};
use crate::setpoint::AxisSetpoint;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;
use twin_drives::{
    Drive, DriveError, IncrementMotion, Increments, MAX_DRIVE_AXES, Sample, SetpointStream,
};
use twin_kinematics::AxisVector;

/// How far ahead of the wall clock set-points are planned for drives, ns. A device that retargets thirty times a
/// second needs to see its next turning point; a stop requested by the user takes effect after this time.
pub const HORIZON_NS: i64 = 250_000_000;

/// How far back the stream remembers, ns: longer than any exchange.
const MEMORY_NS: i64 = 1_000_000_000;

/// Samples that may wait for the session before the device's thread waits for it.
const WAITING_SAMPLES: usize = 1024;

/// What a device's thread is asked to do.
const APPROACH: u8 = 0;
const FOLLOW: u8 = 1;
const FINISH: u8 = 2;
const STOP: u8 = 3;

/// Where one machine axis is found on the device.
#[derive(Clone, Copy, Debug)]
struct Mapping {
    increments_per_si: f64,
}

/// The planned motion in increments, shared between session and device.
#[derive(Debug)]
struct Stream {
    plan: Mutex<Plan>,
    cycle_ns: i64,
}

#[derive(Debug)]
struct Plan {
    /// Read once the program runs; before that it is time 0 minus something.
    clock: Option<Clock>,
    /// Cycle number of the first kept set-point.
    first: i64,
    setpoints: VecDeque<IncrementMotion>,
}

impl Stream {
    fn plan(&self) -> MutexGuard<'_, Plan> {
        // A plan is valid between any two statements that change it.
        self.plan.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl SetpointStream for Stream {
    fn now_ns(&self) -> i64 {
        self.plan().clock.map_or(-1, |clock| clock.now_ns())
    }

    #[expect(clippy::cast_precision_loss, reason = "a fraction of a cycle")]
    fn at(&self, time_ns: i64) -> IncrementMotion {
        let plan = self.plan();
        let cycle = time_ns.div_euclid(self.cycle_ns) - plan.first;
        let fraction = time_ns.rem_euclid(self.cycle_ns) as f64 / self.cycle_ns as f64;
        let at_rest = |motion: Option<&IncrementMotion>| IncrementMotion {
            position: motion.map(|motion| motion.position).unwrap_or_default(),
            velocity: [0.0; MAX_DRIVE_AXES],
        };
        let Ok(index) = usize::try_from(cycle) else { return at_rest(plan.setpoints.front()) };
        let (Some(from), Some(to)) = (plan.setpoints.get(index), plan.setpoints.get(index + 1))
        else {
            return at_rest(plan.setpoints.back());
        };
        let between = |from: &[f64; MAX_DRIVE_AXES], to: &[f64; MAX_DRIVE_AXES]| {
            let mut result = [0.0; MAX_DRIVE_AXES];
            for (result, (from, to)) in result.iter_mut().zip(from.iter().zip(to)) {
                *result = from + (to - from) * fraction;
            }
            result
        };
        IncrementMotion {
            position: between(&from.position, &to.position),
            velocity: between(&from.velocity, &to.velocity),
        }
    }

    fn horizon_ns(&self) -> i64 {
        HORIZON_NS
    }
}

/// Drives at work.
#[derive(Debug)]
pub struct Hardware {
    stream: Arc<Stream>,
    order: Arc<AtomicU8>,
    events: Receiver<Result<Event, HardwareError>>,
    thread: Option<JoinHandle<()>>,
    axes: Vec<Mapping>,
    ended: bool,
}

/// What a device's thread tells the session.
#[derive(Debug)]
enum Event {
    /// Enabled, and the axes stand at the start of the program.
    Ready,
    Sample(Sample),
    /// Finished or stopped: the axes are at rest.
    AtRest,
}

/// Why the drives cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum HardwareError {
    /// The device or its wire.
    #[error("{0}")]
    Drive(#[from] DriveError),
    /// An axis position does not fit the counters.
    #[error("axis {axis} at {position} {unit} is beyond what its drive can count")]
    Range {
        /// The axis.
        axis: String,
        /// The position, in `unit`.
        position: f64,
        /// "mm" or "deg".
        unit: &'static str,
    },
    /// The axes stand still where they should not.
    #[error("the drive stopped moving at {position:?} on its way to {target:?} increments")]
    Stuck {
        /// Where the axes are.
        position: Vec<i64>,
        /// Where they should be.
        target: Vec<i64>,
    },
    /// The device's thread ended without saying why.
    #[error("the thread of the drive ended unexpectedly")]
    Gone,
    /// The device's thread could not be started.
    #[error("the thread of the drive cannot be started: {0}")]
    Thread(std::io::Error),
}

impl Hardware {
    /// Enables the device that `drive` speaks to and starts moving its axes to `start` (m or rad), at no more than
    /// `approach` times each axis's largest velocity. Returns at once; [`Self::ready`] tells when it is there.
    ///
    /// # Errors
    /// If the start does not fit the counters, or no thread can be had.
    pub fn start(
        machine: &Machine,
        drive: Box<dyn Drive>,
        start: &AxisVector,
        cycle_ns: i64,
        approach: f64,
    ) -> Result<Self, HardwareError> {
        let axes: Vec<_> = machine
            .axes
            .iter()
            .map(|axis| Mapping { increments_per_si: axis.increments_per_si() })
            .collect();
        let mut target = [0; MAX_DRIVE_AXES];
        let mut speed = [0.0; MAX_DRIVE_AXES];
        for (slot, (axis, position)) in machine.axes.iter().zip(start.iter()).enumerate() {
            let increments = whole(axis, *position)?;
            if let (Some(target), Some(speed)) = (target.get_mut(slot), speed.get_mut(slot)) {
                *target = increments;
                *speed = (axis.max_velocity * axis.increments_per_si()).abs() * approach;
            }
        }
        let plan = Plan { clock: None, first: 0, setpoints: VecDeque::new() };
        let stream = Arc::new(Stream { plan: Mutex::new(plan), cycle_ns });
        let order = Arc::new(AtomicU8::new(APPROACH));
        let (sender, events) = sync_channel(WAITING_SAMPLES);
        let device =
            Device { drive, stream: Arc::clone(&stream), order: Arc::clone(&order), sender };
        let thread = std::thread::Builder::new()
            .name("drive".to_owned())
            .spawn(move || device.run(&target, &speed))
            .map_err(HardwareError::Thread)?;
        Ok(Self { stream, order, events, thread: Some(thread), axes, ended: false })
    }

    /// True once the drives are enabled and stand at the start of the program.
    ///
    /// # Errors
    /// If they cannot get there.
    pub fn ready(&mut self) -> Result<bool, HardwareError> {
        match self.event()? {
            Some(Event::Ready) => Ok(true),
            _ => Ok(false),
        }
    }

    /// Lets the program begin: from now on the drives follow the stream by `clock`.
    pub fn follow(&mut self, clock: Clock) {
        self.stream.plan().clock = Some(clock);
        self.order.store(FOLLOW, Ordering::Relaxed);
    }

    /// Asks the drives to come to rest at the end of the stream; [`Self::feedback`] goes on until they are there.
    pub fn finish(&mut self) {
        // A stop that was asked for stays asked for.
        self.order
            .compare_exchange(FOLLOW, FINISH, Ordering::Relaxed, Ordering::Relaxed)
            .unwrap_or_default();
    }

    /// Asks the drives to brake now, wherever they are.
    pub fn stop(&mut self) {
        self.order.store(STOP, Ordering::Relaxed);
    }

    /// True while the device's thread runs.
    pub fn is_running(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }

    fn event(&mut self) -> Result<Option<Event>, HardwareError> {
        match self.events.try_recv() {
            Ok(Ok(event)) => Ok(Some(event)),
            Ok(Err(error)) => {
                self.ended = true;
                Err(error)
            }
            Err(TryRecvError::Empty) => Ok(None),
            Err(TryRecvError::Disconnected) if self.ended => Ok(None),
            Err(TryRecvError::Disconnected) => Err(HardwareError::Gone),
        }
    }
}

impl Drop for Hardware {
    fn drop(&mut self) {
        self.stop();
        if let Some(thread) = self.thread.take() {
            // Whatever the thread had to say has been said through the channel; let it bring the axes to rest.
            while !thread.is_finished() {
                while self.events.try_recv().is_ok() {}
                std::thread::sleep(Duration::from_millis(1));
            }
            thread.join().unwrap_or_default();
        }
    }
}

impl Plant for Hardware {
    type Error = HardwareError;

    fn command(&mut self, setpoint: &AxisSetpoint) -> Result<(), HardwareError> {
        let mut motion = IncrementMotion::default();
        let slots = motion.position.iter_mut().zip(motion.velocity.iter_mut());
        let axes = setpoint.axes.position.iter().zip(setpoint.axes.velocity.iter());
        for ((position, velocity), ((si_position, si_velocity), axis)) in
            slots.zip(axes.zip(&self.axes))
        {
            *position = si_position * axis.increments_per_si;
            *velocity = si_velocity * axis.increments_per_si;
        }
        let mut plan = self.stream.plan();
        plan.setpoints.push_back(motion);
        let oldest = (setpoint.time_ns - MEMORY_NS - HORIZON_NS).div_euclid(self.stream.cycle_ns);
        while plan.first < oldest {
            plan.setpoints.pop_front();
            plan.first += 1;
        }
        Ok(())
    }

    fn feedback(&mut self) -> Result<Option<AxisFeedback>, HardwareError> {
        loop {
            match self.event()? {
                Some(Event::Sample(sample)) => {
                    let position = self.axes.iter().zip(sample.position);
                    #[expect(clippy::cast_precision_loss, reason = "counters have 32 bits")]
                    let position =
                        position.map(|(axis, counter)| counter as f64 / axis.increments_per_si);
                    return Ok(Some(AxisFeedback {
                        time_ns: sample.time_ns,
                        position: AxisVector::from_values(position),
                    }));
                }
                Some(Event::Ready) => {}
                Some(Event::AtRest) => {
                    self.ended = true;
                    return Ok(None);
                }
                None => return Ok(None),
            }
        }
    }
}

/// A position as whole increments.
fn whole(axis: &Axis, position: f64) -> Result<i64, HardwareError> {
    let increments = (position * axis.increments_per_si()).round();
    if increments.abs() < f64::from(i32::MAX) {
        #[expect(clippy::cast_possible_truncation, reason = "just compared")]
        return Ok(increments as i64);
    }
    Err(HardwareError::Range {
        axis: axis.name.clone(),
        position: axis.from_si(position),
        unit: axis.unit(),
    })
}

/// What runs on the device's thread.
struct Device {
    drive: Box<dyn Drive>,
    stream: Arc<Stream>,
    order: Arc<AtomicU8>,
    sender: SyncSender<Result<Event, HardwareError>>,
}

/// After this many samples in a row at rest away from its target an axis is stuck, not slow to start.
const PATIENCE: u32 = 100;

impl Device {
    fn run(mut self, target: &Increments, speed: &[f64; MAX_DRIVE_AXES]) {
        let last = match self.work(target, speed) {
            Ok(()) => Ok(Event::AtRest),
            Err(error) => {
                // The first error is the one to report; the stop is tried on whatever still answers.
                if self.drive.soft_stop().is_err() {
                    self.drive.hard_stop().unwrap_or_default();
                }
                Err(error)
            }
        };
        // If nobody listens any more there is nobody to tell.
        self.sender.send(last).unwrap_or_default();
    }

    fn order(&self) -> u8 {
        self.order.load(Ordering::Relaxed)
    }

    /// False if the session is gone.
    fn tell(&self, event: Event) -> bool {
        self.sender.send(Ok(event)).is_ok()
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
        if !self.arrive(target)? || !self.tell(Event::Ready) {
            return Ok(());
        }
        loop {
            match self.order() {
                APPROACH => {
                    // Waiting for the session; a loss of the device must not go unnoticed meanwhile.
                    self.drive.sample(&*self.stream)?;
                }
                FOLLOW => {
                    let sample = self.drive.follow(&*self.stream)?;
                    if !self.tell(Event::Sample(sample)) {
                        return self.brake();
                    }
                }
                FINISH => {
                    self.settle()?;
                    return Ok(());
                }
                _ => return self.brake(),
            }
        }
    }

    /// Waits until the axes stand at `target`; false if a stop came first.
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
                    position: list(position),
                    target: list(target),
                });
            }
        }
    }

    /// Follows on until the axes rest at the end of the stream.
    fn settle(&mut self) -> Result<(), HardwareError> {
        let axes = self.drive.axis_count();
        let mut still = 0;
        loop {
            if self.order() == STOP {
                return self.brake();
            }
            let sample = self.drive.follow(&*self.stream)?;
            if !self.tell(Event::Sample(sample)) {
                return self.brake();
            }
            let end = self.stream.at(i64::MAX);
            let there = sample.position.iter().zip(end.position).take(axes);
            #[expect(clippy::cast_precision_loss, reason = "counters have 32 bits")]
            let there =
                there.into_iter().all(|(position, end)| (*position as f64 - end).abs() <= 1.0);
            if !sample.moving && there {
                return Ok(());
            }
            still = if sample.moving { 0 } else { still + 1 };
            if still > PATIENCE {
                let position = sample.position.iter().take(axes).copied().collect();
                #[expect(clippy::cast_possible_truncation, reason = "for a message")]
                let target = end.position.iter().take(axes).map(|end| end.round() as i64).collect();
                return Err(HardwareError::Stuck { position, target });
            }
        }
    }

    /// Brakes every axis on its ramp and waits until they rest.
    fn brake(&mut self) -> Result<(), HardwareError> {
        self.drive.soft_stop()?;
        loop {
            let sample = self.drive.sample(&*self.stream)?;
            self.sender.try_send(Ok(Event::Sample(sample))).unwrap_or_default();
            if !sample.moving {
                return Ok(());
            }
        }
    }
}
