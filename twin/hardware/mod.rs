//! Drives as a plant: one thread per device. The devices follow the same set-points as the simulated machine.

mod device;
mod error;
mod events;
mod guard;
mod heard;
mod merge;
mod stream;
mod switched;
#[cfg(test)]
mod tests;
mod unit;

use crate::attached::Attached;
use crate::clock::Clock;
use crate::plant::{AxisFeedback, Plant};
use crate::setpoint::AxisSetpoint;
pub use error::HardwareError;
use events::Event;
pub use guard::Guarded;
pub(crate) use guard::lost_answer;
pub use heard::{Heard, LastHeard};
use merge::{Positions, Track};
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
pub use switched::SwitchedOutputs;
use twin_kinematics::AxisVector;
use twin_machine::{DriveFamily, Machine};
use unit::Unit;

/// How long devices may take to stop until those are named that have not confirmed it: longer than ramps take, and then a hard
/// stop with the same patience.
const LONGEST_STOP: Duration = Duration::from_secs(25);

/// Drives at work.
#[derive(Debug)]
pub struct Hardware {
    units: Vec<Unit>,
    /// Samples of each that have not been reported.
    tracks: Vec<Track>,
    /// Which of them switches outputs.
    switching_unit: usize,
    /// Number of axes of the machine.
    axes: usize,
    /// Outputs that the device has not confirmed yet.
    switching: u32,
    /// The program does not go to its end.
    early: Arc<AtomicBool>,
    left_on: Vec<u8>,
    /// Devices that could not be brought to rest, and why.
    not_stopped: Vec<String>,
    /// Devices that were found restarted, or their axes elsewhere than they count, after they had failed, in words.
    restarted: Vec<String>,
    /// Errors that came while another one was reported.
    failures: VecDeque<HardwareError>,
    /// Since the program has begun.
    clock: Option<Clock>,
    /// How often each has been heard of since.
    heard: Vec<Heard>,
    /// How late outputs of each were switched.
    switched: Vec<SwitchedOutputs>,
    /// When each was heard of last, and where its axes were.
    last: Vec<Option<(i64, Positions)>>,
}

/// The drive whose outputs M functions switch: the first InterpCNC board, or the first drive where there is none.
pub fn switching_drive(machine: &Machine, drives: &[Attached]) -> Option<usize> {
    let board = drives.iter().position(|attached| {
        let entry = machine.drives.get(attached.device);
        entry.is_some_and(|entry| matches!(entry.family(), DriveFamily::InterpCnc(_)))
    });
    board.or_else(|| (!drives.is_empty()).then_some(0))
}

/// An output to be switched.
#[derive(Clone, Copy, Debug)]
struct Switch {
    output: u8,
    on: bool,
    /// Set-point at which it is due, ns.
    due_ns: i64,
}

impl Hardware {
    /// Enables the devices and starts moving their axes to `start` (m or rad), at no more than `approach` times each axis's
    /// largest velocity. Returns at once; [`Self::ready`] is true when they are there.
    ///
    /// # Errors
    /// If a `longest_silence_ms` is shorter than a few rounds on the wire, the start does not fit the counters, or no thread
    /// can be had; devices that have begun are stopped then.
    pub fn start(
        machine: &Machine,
        drives: Vec<Attached>,
        start: &AxisVector,
        cycle_ns: i64,
        approach: f64,
    ) -> Result<Self, HardwareError> {
        drives.iter().try_for_each(|attached| guard::check(machine, attached.device))?;
        let early = Arc::new(AtomicBool::new(false));
        let switching_unit = switching_drive(machine, &drives).unwrap_or_default();
        // From the first one on they are stopped together if another one does not start.
        let mut hardware = Self {
            tracks: drives.iter().map(|_| Track::default()).collect(),
            heard: vec![Heard::default(); drives.len()],
            switched: vec![SwitchedOutputs::default(); drives.len()],
            last: vec![None; drives.len()],
            units: Vec::with_capacity(drives.len()),
            switching_unit,
            axes: machine.axes.len(),
            switching: 0,
            early: Arc::clone(&early),
            left_on: Vec::new(),
            not_stopped: Vec::new(),
            restarted: Vec::new(),
            failures: VecDeque::new(),
            clock: None,
        };
        for attached in drives {
            let unit = Unit::start(machine, attached, start, (cycle_ns, approach), &early)?;
            hardware.units.push(unit);
        }
        Ok(hardware)
    }

    /// True once the drives are enabled and at rest at the start of the program.
    ///
    /// # Errors
    /// If they cannot get there.
    pub fn ready(&mut self) -> Result<bool, HardwareError> {
        for unit in &mut self.units {
            // Of those that are ready only failures are heard.
            unit.ready |= matches!(unit.event()?, Some(Event::Ready));
        }
        Ok(self.units.iter().all(|unit| unit.ready))
    }

    /// From now on [`Self::feedback`] also fails where a device keeps silent for longer than `machine` says while its axes
    /// are to move ([`HardwareError::Silent`]), and where an axis is farther from its set-points than it may be
    /// ([`HardwareError::TooFar`]). The devices go on following all the same: it is for the caller to stop them
    /// ([`Self::stop_astray`]).
    #[must_use]
    pub fn guarded(mut self, machine: &Machine, whose: Guarded) -> Self {
        self.units.iter_mut().for_each(|unit| unit.guard(machine, whose));
        self
    }

    /// Lets the program begin: from now on the drives follow the stream by `clock`.
    pub fn follow(&mut self, clock: Clock) {
        self.clock = Some(clock);
        self.units.iter_mut().for_each(|unit| unit.follow(clock));
    }

    /// Asks the drives to come to rest at the end of the stream, which is an `early` one if the program is not through;
    /// [`Self::feedback`] goes on until they are there.
    pub fn finish(&mut self, early: bool) {
        if early {
            self.early.store(true, Ordering::Relaxed);
        }
        self.units.iter().for_each(Unit::finish);
    }

    /// Another plan than was commanded: `setpoints` in the place of those after `time_ns`, to an early end at which the drives
    /// come to rest.
    pub fn replan<'a>(
        &mut self,
        time_ns: i64,
        setpoints: &(impl Iterator<Item = &'a AxisSetpoint> + Clone),
    ) {
        // First this: the end of a plan that gets shorter is not a delay.
        self.finish(true);
        // One that cannot be counted ends it for all axes; the session hears of that and brakes where it still can.
        let units = &self.units;
        let beyond = |setpoint| units.iter().find_map(|unit| unit.motion(setpoint).err());
        let mut countable = 0;
        let failure = setpoints.clone().find_map(|setpoint| {
            let failure = beyond(setpoint);
            countable += usize::from(failure.is_none());
            failure
        });
        for unit in units {
            let motions = setpoints.clone().take(countable);
            unit.replace(time_ns, motions.filter_map(|setpoint| unit.motion(setpoint).ok()));
        }
        self.failures.extend(failure);
    }

    /// Stops all drives if the plan of real ones has ended before `now_ns`. They are at rest at its end, or soon will
    /// be, and a later plan would be a jump. Emulated drives jump by the delay of this computer.
    pub fn starved(&mut self, now_ns: i64) -> Option<HardwareError> {
        let starved = self.units.iter().find_map(|unit| unit.starved(now_ns));
        if starved.is_some() {
            self.stop();
        }
        starved
    }

    /// Asks the devices with an axis that is too far from its set-points to brake now, on ramps of their own: after the set-points,
    /// which brake as well, that axis would go all the way that it is behind.
    pub fn stop_astray(&mut self) {
        self.units.iter().filter(|unit| unit.guard.is_astray()).for_each(Unit::stop);
    }

    /// Asks the drives to brake now, wherever they are, on ramps of their own.
    pub fn stop(&mut self) {
        self.units.iter().for_each(Unit::stop);
    }

    /// Switches outputs of the first InterpCNC board, or of the first device where there is none, between two exchanges that
    /// follow the stream; due with the set-point at `due_ns`. Those that it has switched on it switches off again if the program
    /// ends early, and where the drives are stopped or fail.
    pub fn switch(&mut self, on: &[u8], off: &[u8], due_ns: i64) {
        let all = off.iter().map(|output| (*output, false)).chain(on.iter().map(|o| (*o, true)));
        for (output, on) in all {
            self.switch_of(self.switching_unit, Switch { output, on, due_ns });
        }
    }

    /// Switches an output of the device that is `device` in [`Machine::drives`], as [`Self::switch`] does; nothing if it is not
    /// among these drives.
    pub fn switch_output(&mut self, device: usize, output: u8, on: bool, due_ns: i64) {
        if let Some(unit) = self.units.iter().position(|unit| unit.index == device) {
            self.switch_of(unit, Switch { output, on, due_ns });
        }
    }

    fn switch_of(&mut self, unit: usize, switch: Switch) {
        match self.units.get(unit).map(|unit| unit.switch(switch)) {
            Some(Ok(true)) => self.switching += 1,
            // A device that has ended has nothing to confirm: the session hears of it.
            Some(Ok(false)) | None => {}
            Some(Err(error)) => self.failures.push_back(error),
        }
    }

    /// True if all outputs have been confirmed.
    pub fn has_switched(&self) -> bool {
        self.switching == 0
    }

    /// Outputs that are perhaps still on although the run has ended early: they could not be switched off.
    pub fn left_on(&self) -> &[u8] {
        &self.left_on
    }

    /// Devices that did not confirm that they stop, and why: whether their axes move is not known.
    pub fn not_stopped(&self) -> &[String] {
        &self.not_stopped
    }

    /// Sample statistics of each device, by its name, since the program began.
    pub fn heard(&self) -> Vec<(String, Heard)> {
        let units = self.units.iter().zip(&self.heard);
        units.map(|(unit, heard)| (unit.device.clone(), *heard)).collect()
    }

    /// Switching delays of the devices, by their names, that have switched outputs.
    pub fn switched(&self) -> Vec<(String, SwitchedOutputs)> {
        let units = self.units.iter().zip(&self.switched);
        let some = units.filter(|(_, switched)| switched.count > 0);
        some.map(|(unit, switched)| (unit.device.clone(), *switched)).collect()
    }

    /// Last known axis positions of each device that has sent samples since the program began.
    pub fn last_heard(&self) -> Vec<LastHeard> {
        let units = self.units.iter().zip(&self.tracks).zip(&self.last);
        let heard = units.filter_map(|((unit, track), last)| {
            let (time_ns, positions) = (*last)?;
            let axes = unit.axes.iter().map(|place| place.axis).zip(positions).collect();
            Some(LastHeard { device: unit.device.clone(), time_ns, axes, lost: track.lost })
        });
        heard.collect()
    }

    /// Devices that were found restarted, or their axes elsewhere than they count, after they had failed, in words: the cause of the
    /// failure.
    pub fn restarted(&self) -> &[String] {
        &self.restarted
    }

    /// Stops all devices at once and waits until each has finished, but no longer than 25 s. [`Self::not_stopped`] and
    /// [`Self::left_on`] report the result.
    ///
    /// A driver that waits for an answer then is named as not stopped. It goes on trying: dropping this waits for it.
    pub fn abandon(&mut self) {
        self.stop();
        let since = Clock::start();
        let waited = || Duration::from_nanos(since.now_ns().unsigned_abs());
        while self.is_running() && waited() < LONGEST_STOP {
            self.listen();
            std::thread::sleep(Duration::from_millis(1));
        }
        self.listen();
        let waiting = self.units.iter().filter(|unit| unit.is_running());
        self.not_stopped.extend(waiting.map(|unit| {
            let (device, waited_s) = (&unit.device, LONGEST_STOP.as_secs());
            format!("device `{device}`: it has not answered to a stop for {waited_s} s")
        }));
    }

    /// The drivers of the devices whose threads have ended.
    pub fn take_drives(&mut self) -> Vec<Attached> {
        self.units.iter_mut().filter_map(Unit::take_drive).collect()
    }

    /// True while a device's thread runs.
    pub fn is_running(&self) -> bool {
        self.units.iter().any(Unit::is_running)
    }
}

impl Drop for Hardware {
    /// All of them at once: the first may take its time, and the others move meanwhile.
    fn drop(&mut self) {
        self.stop();
    }
}

impl Plant for Hardware {
    type Error = HardwareError;

    fn command(&mut self, setpoint: &AxisSetpoint) -> Result<(), HardwareError> {
        // All of them or none: no axis goes on without the others.
        let motions = self.units.iter().map(|unit| unit.motion(setpoint));
        let motions: Vec<_> = motions.collect::<Result<_, _>>()?;
        for (unit, motion) in self.units.iter().zip(motions) {
            unit.push(setpoint.time_ns, motion);
        }
        Ok(())
    }

    fn feedback(&mut self) -> Result<Option<AxisFeedback>, HardwareError> {
        self.listen();
        let units = &self.units;
        let planned = |unit: usize, time_ns| {
            units.get(unit).map_or_else(Default::default, |unit| unit.planned(time_ns))
        };
        if let Some((time_ns, found)) = merge::next(&mut self.tracks, planned) {
            let mut position = AxisVector::zeros(self.axes);
            for (unit, found) in units.iter().zip(found) {
                for (place, found) in unit.axes.iter().zip(found) {
                    if let Some(slot) = position.get_mut(place.axis) {
                        *slot = found;
                    }
                }
            }
            return Ok(Some(AxisFeedback { time_ns, position }));
        }
        self.failures.pop_front().map_or(Ok(None), Err)
    }
}
