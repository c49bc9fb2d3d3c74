//! One device: its thread, its stream, and the machine axes that it drives.

use super::device::{APPROACH, Device, FINISH, FOLLOW, STOP};
use super::error::Names;
use super::guard::{Guard, Guarded};
use super::stream::Stream;
use super::{Event, HardwareError, Switch};
use crate::attached::Attached;
use crate::clock::Clock;
use crate::setpoint::AxisSetpoint;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;
use twin_drives::{Drive, IncrementMotion, MAX_DRIVE_AXES, Sample, SetpointStream};
use twin_kinematics::AxisVector;
use twin_machine::{Counting, Machine};

/// Samples that may wait for the session before the device's thread waits for it.
const WAITING_SAMPLES: usize = 1024;

/// Outputs that may wait to be switched: twice those of a board.
const WAITING_SWITCHES: usize = 64;

/// Assignment of one machine axis to an axis of the device.
#[derive(Clone, Debug)]
pub(super) struct Mapping {
    /// In machine-file order.
    pub(super) axis: usize,
    name: String,
    counting: Counting,
}

impl Mapping {
    /// A position that the device cannot count.
    fn beyond(&self, device: &str, position: f64) -> HardwareError {
        let (kind, most) = (self.counting.kind(), self.counting.most());
        #[expect(clippy::cast_precision_loss, reason = "counters have 32 bits")]
        let farthest = self.counting.si(most as f64).abs();
        HardwareError::Range {
            device: device.to_owned(),
            axis: self.name.clone(),
            position: position / kind.scale(),
            most,
            farthest: farthest / kind.scale(),
            unit: kind.unit(),
        }
    }
}

/// A device at work.
#[derive(Debug)]
pub(super) struct Unit {
    /// Its name in the machine file, and its place there.
    pub(super) device: String,
    pub(super) index: usize,
    stream: Arc<Stream>,
    order: Arc<AtomicU8>,
    lost_answers: Arc<AtomicU32>,
    events: Receiver<Result<Event, HardwareError>>,
    thread: Option<JoinHandle<Box<dyn Drive>>>,
    pub(super) axes: Vec<Mapping>,
    switches: SyncSender<Switch>,
    /// Enabled, its axes at the start of the program.
    pub(super) ready: bool,
    /// It has nothing more to say.
    pub(super) ended: bool,
    /// Watchdog, inactive until the method `guard` is called.
    pub(super) guard: Guard,
}

impl Unit {
    /// Enables the device and starts moving its axes to `start`.
    pub(super) fn start(
        machine: &Machine,
        attached: Attached,
        start: &AxisVector,
        (cycle_ns, approach): (i64, f64),
        early: &Arc<AtomicBool>,
    ) -> Result<Self, HardwareError> {
        let name = machine.drives.get(attached.device).map(|entry| entry.name.clone());
        let name = name.unwrap_or_default();
        let mut target = [0; MAX_DRIVE_AXES];
        let mut speed = [0.0; MAX_DRIVE_AXES];
        let mut rest = [0.0; MAX_DRIVE_AXES];
        let mut axes = Vec::new();
        let slots = target.iter_mut().zip(speed.iter_mut()).zip(rest.iter_mut());
        for (((target, speed), rest), (index, axis)) in slots.zip(machine.axes_of(attached.device))
        {
            let position = start.get(index).copied().unwrap_or_default();
            // Axes of a device have a drive.
            let Some(counting) = axis.counting() else { continue };
            let mapping = Mapping { axis: index, name: axis.name.clone(), counting };
            let beyond = || mapping.beyond(&name, position);
            *target = counting.whole(position).ok_or_else(beyond)?;
            *speed = counting.increments(axis.max_velocity).abs() * approach;
            *rest = counting.within(position).ok_or_else(beyond)?;
            axes.push(mapping);
        }
        let stream = Arc::new(Stream::new(rest, cycle_ns));
        let order = Arc::new(AtomicU8::new(APPROACH));
        let lost_answers = Arc::new(AtomicU32::new(0));
        let (sender, events) = sync_channel(WAITING_SAMPLES);
        let (switches, to_switch) = sync_channel(WAITING_SWITCHES);
        let device = Device {
            names: Names::of(machine, attached.device),
            drive: attached.drive,
            stream: Arc::clone(&stream),
            order: Arc::clone(&order),
            lost_answers: Arc::clone(&lost_answers),
            sender,
            switches: to_switch,
            on: BTreeSet::new(),
            early: Arc::clone(early),
        };
        let thread = std::thread::Builder::new()
            .name(format!("drive {name}"))
            .spawn(move || device.run(&target, &speed))
            .map_err(|source| HardwareError::Thread { device: name.clone(), source })?;
        let (device, index, thread) = (name, attached.device, Some(thread));
        let (ready, ended, guard) = (false, false, Guard::default());
        Ok(Self {
            device,
            index,
            stream,
            order,
            lost_answers,
            events,
            thread,
            axes,
            switches,
            ready,
            ended,
            guard,
        })
    }

    /// Answers that its driver has lost so far.
    pub(super) fn lost_answers(&self) -> u32 {
        self.lost_answers.load(Ordering::Relaxed)
    }

    /// Reports silence and excessive following errors from now on.
    pub(super) fn guard(&mut self, machine: &Machine, whose: Guarded) {
        self.guard = Guard::new(machine, self.index, whose);
    }

    /// Error if the device has been silent for too long by now.
    pub(super) fn silence(&mut self, now_ns: i64) -> Option<HardwareError> {
        if self.ended {
            return None;
        }
        self.guard.silence(&self.device, now_ns, (&self.stream, self.axes.len()))
    }

    /// Error if its plan has ended before `now_ns`.
    pub(super) fn starved(&self, now_ns: i64) -> Option<HardwareError> {
        let late_ns = now_ns.saturating_sub(self.stream.end_ns());
        let starved = self.guard.is_of_real() && !self.ended && late_ns > 0;
        starved.then(|| HardwareError::Starved {
            device: self.device.clone(),
            late_ms: late_ns / 1_000_000,
        })
    }

    /// From now on it follows its stream by `clock`.
    pub(super) fn follow(&mut self, clock: Clock) {
        self.guard.begin(clock.now_ns());
        self.stream.start(clock);
        self.change_order(APPROACH, FOLLOW);
    }

    /// Asks the device to come to rest at the end of its stream.
    pub(super) fn finish(&self) {
        self.change_order(FOLLOW, FINISH);
    }

    /// A stop that was asked for stays asked for.
    fn change_order(&self, from: u8, to: u8) {
        let changed = self.order.compare_exchange(from, to, Ordering::Relaxed, Ordering::Relaxed);
        changed.unwrap_or_default();
    }

    /// It is to brake now.
    pub(super) fn stop(&self) {
        self.order.store(STOP, Ordering::Relaxed);
    }

    /// Plans a set-point more.
    pub(super) fn push(&self, time_ns: i64, motion: IncrementMotion) {
        self.stream.push(time_ns, motion);
    }

    /// Plans others in the place of those after `time_ns`.
    pub(super) fn replace(&self, time_ns: i64, motions: impl Iterator<Item = IncrementMotion>) {
        self.stream.replace(time_ns, motions);
    }

    /// A set-point in increments; fails where one of its axes is beyond what its drive counts.
    pub(super) fn motion(&self, setpoint: &AxisSetpoint) -> Result<IncrementMotion, HardwareError> {
        let mut motion = IncrementMotion::default();
        let slots = motion.position.iter_mut().zip(motion.velocity.iter_mut());
        for ((position, velocity), place) in slots.zip(&self.axes) {
            let of = |values: &AxisVector| values.get(place.axis).copied().unwrap_or_default();
            let wanted = of(&setpoint.axes.position);
            let counted = place.counting.within(wanted);
            *position = counted.ok_or_else(|| place.beyond(&self.device, wanted))?;
            *velocity = place.counting.increments(of(&setpoint.axes.velocity));
        }
        Ok(motion)
    }

    /// Planned positions of its axes at an instant, m or rad.
    pub(super) fn planned(&self, time_ns: i64) -> [f64; MAX_DRIVE_AXES] {
        self.si(self.stream_position(time_ns))
    }

    fn stream_position(&self, time_ns: i64) -> [f64; MAX_DRIVE_AXES] {
        self.stream.at(time_ns).position
    }

    /// Measured positions of its axes, m or rad.
    pub(super) fn measured(&self, sample: &Sample) -> [f64; MAX_DRIVE_AXES] {
        #[expect(clippy::cast_precision_loss, reason = "counters have 32 bits")]
        let counters = sample.position.map(|counter| counter as f64);
        self.si(counters)
    }

    fn si(&self, mut increments: [f64; MAX_DRIVE_AXES]) -> [f64; MAX_DRIVE_AXES] {
        for (value, place) in increments.iter_mut().zip(&self.axes) {
            *value = place.counting.si(*value);
        }
        increments
    }

    /// Asks for an output; false if the device has ended, of which the session hears otherwise.
    ///
    /// # Errors
    /// If too many wait already.
    pub(super) fn switch(&self, switch: Switch) -> Result<bool, HardwareError> {
        match self.switches.try_send(switch) {
            Ok(()) => Ok(true),
            Err(TrySendError::Disconnected(_)) => Ok(false),
            Err(TrySendError::Full(_)) => {
                let (device, waiting) = (self.device.clone(), WAITING_SWITCHES);
                let output = switch.output;
                Err(HardwareError::Outputs { device, output, waiting })
            }
        }
    }

    /// The driver, once the device's thread has ended; it may be had once.
    pub(super) fn take_drive(&mut self) -> Option<Attached> {
        let thread = self.thread.take_if(|thread| thread.is_finished())?;
        let drive = thread.join().ok()?;
        Some(Attached { device: self.index, drive })
    }

    /// True while the device's thread runs.
    pub(super) fn is_running(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }

    /// The next event of its thread, if any.
    pub(super) fn event(&mut self) -> Result<Option<Event>, HardwareError> {
        match self.events.try_recv() {
            Ok(Ok(event)) => Ok(Some(event)),
            Ok(Err(error)) => {
                self.ended = true;
                Err(error)
            }
            Err(TryRecvError::Empty) => Ok(None),
            Err(TryRecvError::Disconnected) if self.ended => Ok(None),
            Err(TryRecvError::Disconnected) => {
                self.ended = true;
                Err(HardwareError::Gone { device: self.device.clone() })
            }
        }
    }
}

impl Drop for Unit {
    fn drop(&mut self) {
        self.stop();
        if let Some(thread) = self.thread.take() {
            // Whatever the thread had to say has been said through the channel; let it bring the axes to rest. That ends:
            // every question of a driver has its deadline, and the device's thread waits for braking axes so long only.
            while !thread.is_finished() {
                while self.events.try_recv().is_ok() {}
                std::thread::sleep(Duration::from_millis(1));
            }
            drop(thread.join());
        }
    }
}
