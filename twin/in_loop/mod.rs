//! Drives in the loop: driver and device models between the set-points and the motors of the simulated machine.
//!
//! A drive generates profiles of its own from the commands that its wire carries. In the loop, driver and device process the
//! same set-points in simulated time ([`Prediction`]); the motors get the output of the devices' profile generators.

#![expect(clippy::indexing_slicing, reason = "axes of the machine, in arrays of all its axes")]

#[cfg(test)]
mod tests;

use crate::emulated;
use crate::setpoint::{AxisSetpoint, HORIZON_NS};
use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};
use twin_drives::{IncrementMotion, MAX_DRIVE_AXES, Prediction, SetpointStream};
use twin_kinematics::{AxisMotion, AxisVector};
use twin_machine::axis_kind::AxisKind;
use twin_machine::{Counting, DeviceEntry, Machine};
use twin_number::seconds;

/// The drives of a machine, in simulated time.
#[derive(Clone, Debug)]
pub(crate) struct DrivesInLoop {
    devices: Vec<Device>,
    /// The set-point of the cycle before, and the motion of the motors.
    before: Option<(AxisSetpoint, AxisMotion)>,
    cycle_ns: i64,
}

#[derive(Debug)]
struct Device {
    /// Index into [`Machine::drives`].
    index: usize,
    prediction: Box<dyn Prediction>,
    axes: Vec<DeviceAxis>,
    /// The set-points from that of the cycle before on, as far as the device has looked at them.
    counted: Mutex<VecDeque<Counted>>,
}

impl Clone for Device {
    fn clone(&self) -> Self {
        let (prediction, axes) = (self.prediction.copied(), self.axes.clone());
        Self { index: self.index, prediction, axes, counted: Mutex::default() }
    }
}

/// A motion in increments, which a device that looks ahead asks for again and again.
#[derive(Clone, Copy, Debug, Default)]
struct Counted {
    /// Positions and velocities of the axes, m or rad.
    si: [[f64; MAX_DRIVE_AXES]; 2],
    increments: IncrementMotion,
}

impl Counted {
    fn of(axes: &[DeviceAxis], si: [[f64; MAX_DRIVE_AXES]; 2]) -> Self {
        let [positions, velocities] = si;
        let pairs = axes.iter().zip(positions.into_iter().zip(velocities));
        let increments = IncrementMotion::of(pairs.map(|(place, (position, velocity))| {
            (place.counting.increments(position), place.counting.increments(velocity))
        }));
        Self { si, increments }
    }
}

/// An axis of the machine on a device.
#[derive(Clone, Copy, Debug)]
struct DeviceAxis {
    /// In machine-file order.
    axis: usize,
    counting: Counting,
}

impl DrivesInLoop {
    /// The devices that the machine file puts there; `None` without any.
    pub(crate) fn of(machine: &Machine) -> Option<Self> {
        Self::among(machine, |device| device.in_loop)
    }

    /// All devices of the machine file, wherever it puts them; `None` without any.
    pub(crate) fn all(machine: &Machine) -> Option<Self> {
        Self::among(machine, |_| true)
    }

    fn among(machine: &Machine, chosen: impl Fn(&DeviceEntry) -> bool) -> Option<Self> {
        Self::predicting(machine, |index, entry| {
            chosen(entry).then(|| emulated::prediction(machine, (index, entry)))
        })
    }

    /// The devices for which `prediction` returns a simulation, given their index and entry; `None` without any.
    pub(crate) fn predicting(
        machine: &Machine,
        prediction: impl Fn(usize, &DeviceEntry) -> Option<Box<dyn Prediction>>,
    ) -> Option<Self> {
        let devices = machine.drives.iter().enumerate();
        let devices: Vec<_> = devices
            .filter_map(|(index, entry)| {
                let axes = machine.axes_of(index).filter_map(|(axis, described)| {
                    Some(DeviceAxis { axis, counting: described.counting()? })
                });
                let axes: Vec<_> = axes.collect();
                let prediction = if axes.is_empty() { None } else { prediction(index, entry) };
                Some(Device { index, prediction: prediction?, axes, counted: Mutex::default() })
            })
            .collect();
        let cycle_ns = machine.cycle_ns;
        (!devices.is_empty()).then_some(Self { devices, before: None, cycle_ns })
    }

    /// Resolution of drives in the loop of `machine`, m: their largest increment, as far as turns move the tool. 0
    /// without any.
    pub(crate) fn resolution(machine: &Machine) -> f64 {
        let driven = machine.axes.iter().filter(|axis| {
            let device = axis.drive.as_ref().and_then(|drive| machine.drives.get(drive.device));
            device.is_some_and(|device| device.in_loop)
        });
        let increments = driven.map(|axis| {
            let increment = 1.0 / axis.increments_per_si().abs();
            match axis.kind {
                AxisKind::Linear => increment,
                AxisKind::Rotary => increment * machine.length_scale,
            }
        });
        increments.fold(0.0, f64::max)
    }

    /// The devices, by their places in [`Machine::drives`].
    pub(crate) fn predictions(&self) -> impl Iterator<Item = (usize, &dyn Prediction)> {
        self.devices.iter().map(|device| (device.index, &*device.prediction))
    }

    /// True if the set-points of the motors are at rest at the end of the plan, to an increment.
    pub(crate) fn have_arrived(&self) -> bool {
        let Some((setpoint, motion)) = &self.before else { return true };
        self.devices.iter().flat_map(|device| &device.axes).all(|place| {
            let axis = place.axis;
            let apart = motion.position[axis] - setpoint.axes.position[axis];
            motion.velocity[axis] == 0.0 && place.counting.increments(apart).abs() <= 1.0
        })
    }

    /// Motion of the motors in the cycle that ends with `setpoint`, before those of `ahead`.
    pub(crate) fn motion(
        &mut self,
        setpoint: &AxisSetpoint,
        ahead: &VecDeque<AxisSetpoint>,
    ) -> AxisMotion {
        let mut motion = setpoint.axes;
        let (before, earlier) =
            self.before.unwrap_or((*setpoint, AxisMotion::at_rest(motion.position)));
        let cycle = seconds(self.cycle_ns);
        for device in &mut self.devices {
            let plan = Plan {
                axes: &device.axes,
                counted: &device.counted,
                before: &before,
                setpoint,
                ahead,
                cycle_ns: self.cycle_ns,
            };
            let asked = device.prediction.advance(&plan, setpoint.time_ns);
            // In the next cycle this one is the one before.
            held(&device.counted).pop_front();
            let asked = asked.position.iter().zip(asked.velocity);
            for (place, (position, velocity)) in device.axes.iter().zip(asked) {
                let DeviceAxis { axis, counting } = *place;
                motion.position[axis] = counting.si(*position);
                motion.velocity[axis] = counting.si(velocity);
                motion.acceleration[axis] =
                    (counting.si(velocity) - earlier.velocity[axis]) / cycle;
            }
        }
        self.before = Some((*setpoint, motion));
        motion
    }
}

/// A poisoned lock does no harm: entries are compared before they are used.
fn held(counted: &Mutex<VecDeque<Counted>>) -> MutexGuard<'_, VecDeque<Counted>> {
    counted.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The planned motion of a device's axes, around the cycle that is simulated.
struct Plan<'a> {
    axes: &'a [DeviceAxis],
    counted: &'a Mutex<VecDeque<Counted>>,
    before: &'a AxisSetpoint,
    setpoint: &'a AxisSetpoint,
    ahead: &'a VecDeque<AxisSetpoint>,
    cycle_ns: i64,
}

impl Plan<'_> {
    /// The set-point of a cycle, counted from the one before.
    fn get(&self, cycle: usize) -> Option<&AxisSetpoint> {
        match cycle {
            0 => Some(self.before),
            1 => Some(self.setpoint),
            _ => self.ahead.get(cycle - 2),
        }
    }

    /// Positions and velocities of the device's axes, m or rad.
    fn si(&self, motion: &AxisMotion) -> [[f64; MAX_DRIVE_AXES]; 2] {
        [&motion.position, &motion.velocity].map(|values: &AxisVector| {
            let mut of_device = [0.0; MAX_DRIVE_AXES];
            for (slot, place) in of_device.iter_mut().zip(self.axes) {
                *slot = values[place.axis];
            }
            of_device
        })
    }

    /// The set-point of a cycle, counted from the one before, in increments. It may have changed since it was asked for: an
    /// override changes the plan.
    fn increments(&self, counted: &mut VecDeque<Counted>, cycle: usize) -> Option<IncrementMotion> {
        let si = self.si(&self.get(cycle)?.axes);
        while counted.len() <= cycle {
            let next = self.si(&self.get(counted.len())?.axes);
            counted.push_back(Counted::of(self.axes, next));
        }
        let slot = counted.get_mut(cycle)?;
        if slot.si != si {
            *slot = Counted::of(self.axes, si);
        }
        Some(slot.increments)
    }
}

impl SetpointStream for Plan<'_> {
    fn now_ns(&self) -> i64 {
        self.setpoint.time_ns
    }

    fn at(&self, time_ns: i64) -> IncrementMotion {
        let since_ns = time_ns - (self.setpoint.time_ns - self.cycle_ns);
        let last = self.ahead.back().unwrap_or(self.setpoint);
        let resting = |at: &AxisSetpoint| {
            Counted::of(self.axes, self.si(&AxisMotion::at_rest(at.axes.position))).increments
        };
        let Ok(index) = usize::try_from(since_ns.div_euclid(self.cycle_ns)) else {
            return resting(self.before);
        };
        let next = index.saturating_add(1);
        let part = seconds(since_ns.rem_euclid(self.cycle_ns)) / seconds(self.cycle_ns);
        let ends = self.get(next).and_then(|_| {
            let mut counted = held(self.counted);
            let from = self.increments(&mut counted, index)?;
            // Devices look ahead at whole cycles.
            let to = if part > 0.0 { self.increments(&mut counted, next)? } else { from };
            Some((from, to))
        });
        let Some((from, to)) = ends else { return resting(last) };
        from.towards(&to, part)
    }

    fn horizon_ns(&self) -> i64 {
        HORIZON_NS
    }
}
