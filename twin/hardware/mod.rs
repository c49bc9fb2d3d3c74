//! The drives as a plant: one thread per device, which follows the same set-points as the simulated machine.

mod device;
mod stream;
#[cfg(test)]
mod tests;

use crate::clock::Clock;
use crate::machine::{Axis, Machine};
use crate::plant::{AxisFeedback, Plant};
use crate::setpoint::AxisSetpoint;
use device::{APPROACH, Device, FINISH, FOLLOW, STOP};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;
use stream::Stream;
use twin_drives::{Drive, DriveError, IncrementMotion, MAX_DRIVE_AXES, Sample};
use twin_kinematics::AxisVector;

/// How far ahead of the wall clock set-points are planned for drives, ns. A device that retargets thirty times a
/// second needs to see its next turning point; a stop requested by the user takes effect after this time.
pub const HORIZON_NS: i64 = 250_000_000;

/// Samples that may wait for the session before the device's thread waits for it.
const WAITING_SAMPLES: usize = 1024;

/// Outputs that may wait to be switched: twice those of a board.
const WAITING_SWITCHES: usize = 64;

/// Where one machine axis is found on the device.
#[derive(Clone, Copy, Debug)]
struct Mapping {
    increments_per_si: f64,
}

/// Drives at work.
#[derive(Debug)]
pub struct Hardware {
    stream: Arc<Stream>,
    order: Arc<AtomicU8>,
    events: Receiver<Result<Event, HardwareError>>,
    thread: Option<JoinHandle<()>>,
    axes: Vec<Mapping>,
    switches: SyncSender<Switch>,
    /// Outputs that the device has not confirmed yet.
    switching: u32,
    /// The program does not go to its end.
    early: Arc<AtomicBool>,
    left_on: Vec<u8>,
    ended: bool,
}

/// An output to be switched.
#[derive(Clone, Copy, Debug)]
struct Switch {
    output: u8,
    on: bool,
}

/// What a device's thread tells the session.
#[derive(Debug)]
enum Event {
    /// Enabled, and the axes stand at the start of the program.
    Ready,
    Sample(Sample),
    /// The device has confirmed an output.
    Switched,
    /// Outputs that could not be switched off at an early end.
    LeftOn(Vec<u8>),
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
    /// The plan ended before the program did: whoever plans was kept waiting.
    #[error("the set-points came {late_ms} ms late; the axes were braked where they were")]
    Starved {
        /// Behind the last planned instant, ms.
        late_ms: i64,
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
        let mut rest = [0.0; MAX_DRIVE_AXES];
        let slots = target.iter_mut().zip(speed.iter_mut()).zip(rest.iter_mut());
        for (((target, speed), rest), (axis, position)) in
            slots.zip(machine.axes.iter().zip(start.iter()))
        {
            *target = whole(axis, *position)?;
            *speed = (axis.max_velocity * axis.increments_per_si()).abs() * approach;
            *rest = position * axis.increments_per_si();
        }
        let stream = Arc::new(Stream::new(rest, cycle_ns));
        let order = Arc::new(AtomicU8::new(APPROACH));
        let (sender, events) = sync_channel(WAITING_SAMPLES);
        let early = Arc::new(AtomicBool::new(false));
        let (switches, to_switch) = sync_channel(WAITING_SWITCHES);
        let device = Device {
            drive,
            stream: Arc::clone(&stream),
            order: Arc::clone(&order),
            sender,
            switches: to_switch,
            on: BTreeSet::new(),
            early: Arc::clone(&early),
        };
        let thread = std::thread::Builder::new()
            .name("drive".to_owned())
            .spawn(move || device.run(&target, &speed))
            .map_err(HardwareError::Thread)?;
        let thread = Some(thread);
        let (switching, left_on, ended) = (0, Vec::new(), false);
        Ok(Self { stream, order, events, thread, axes, switches, switching, early, left_on, ended })
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
        self.stream.start(clock);
        self.change_order(APPROACH, FOLLOW);
    }

    /// Asks the drives to come to rest at the end of the stream, which is an `early` one if the program is not through;
    /// [`Self::feedback`] goes on until they are there.
    pub fn finish(&mut self, early: bool) {
        if early {
            self.early.store(true, Ordering::Relaxed);
        }
        self.change_order(FOLLOW, FINISH);
    }

    /// A stop that was asked for stays asked for.
    fn change_order(&self, from: u8, to: u8) {
        let changed = self.order.compare_exchange(from, to, Ordering::Relaxed, Ordering::Relaxed);
        changed.unwrap_or_default();
    }

    /// Another plan than was commanded: `setpoints` in the place of those after `time_ns`, to an early end at which the drives
    /// come to rest.
    pub fn replan<'a>(&mut self, time_ns: i64, setpoints: impl Iterator<Item = &'a AxisSetpoint>) {
        // First this: the end of a plan that gets shorter is no delay.
        self.finish(true);
        self.stream.replace(time_ns, setpoints.map(|setpoint| self.motion(setpoint)));
    }

    /// A set-point in increments.
    fn motion(&self, setpoint: &AxisSetpoint) -> IncrementMotion {
        let mut motion = IncrementMotion::default();
        let slots = motion.position.iter_mut().zip(motion.velocity.iter_mut());
        let axes = setpoint.axes.position.iter().zip(setpoint.axes.velocity.iter());
        for ((position, velocity), ((si_position, si_velocity), axis)) in
            slots.zip(axes.zip(&self.axes))
        {
            *position = si_position * axis.increments_per_si;
            *velocity = si_velocity * axis.increments_per_si;
        }
        motion
    }

    /// Asks the drives to brake now, wherever they are, on ramps of their own.
    pub fn stop(&mut self) {
        self.order.store(STOP, Ordering::Relaxed);
    }

    /// Switches outputs, between two exchanges that follow the stream. Those that it has switched on it switches off
    /// again if the program ends early, and where the drives are stopped or fail.
    pub fn switch(&mut self, on: &[u8], off: &[u8]) {
        let all = off.iter().map(|output| (*output, false)).chain(on.iter().map(|o| (*o, true)));
        for (output, on) in all {
            // A device that has ended has nothing to confirm: the session hears of it.
            if self.switches.try_send(Switch { output, on }).is_ok() {
                self.switching += 1;
            }
        }
    }

    /// Whether all outputs have been confirmed.
    pub fn has_switched(&self) -> bool {
        self.switching == 0
    }

    /// Outputs that are perhaps still on although the run has ended early: they could not be switched off.
    pub fn left_on(&self) -> &[u8] {
        &self.left_on
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
        self.stream.push(setpoint.time_ns, self.motion(setpoint));
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
                Some(Event::LeftOn(outputs)) => self.left_on = outputs,
                Some(Event::Switched) => self.switching = self.switching.saturating_sub(1),
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
