//! Emulators of the drives a machine file names, in this process, with their clients connected, and the same in
//! simulated time.

use crate::attached::Attached;
use crate::clock::Clock;
use std::time::Duration;
use twin_drives::Prediction;
use twin_drives::family::{self, AxisDemand, Emulator};
use twin_machine::{Axis, DeviceEntry, Machine};

/// A drive that lags may go this much faster than its axis's largest velocity.
pub(crate) const CATCH_UP: f64 = 1.2;

/// Error of emulated drives that cannot be connected.
#[derive(Debug, thiserror::Error)]
pub enum ConnectError {
    /// One of them.
    #[error(transparent)]
    Device(#[from] family::ConnectError),
    /// The machine file has no such device.
    #[error("the machine file names no drive for its axes")]
    NoDevice,
}

/// An emulated device, and its drive.
pub type Emulated = (Box<dyn Emulator>, Attached);

/// Powers up an emulator for each device with axes, and opens it with its client.
///
/// # Errors
/// [`ConnectError`].
pub fn connect(machine: &Machine) -> Result<Vec<Emulated>, ConnectError> {
    let driven = machine.drives.iter().enumerate();
    let driven = driven.filter(|(index, _)| machine.axes_of(*index).next().is_some());
    let connected = driven
        .map(|(device, entry)| {
            let clock = Clock::start();
            let demands = demands(machine, device);
            let connected = entry.device.emulate(&demands, Box::new(move || clock.now_ns()));
            let (emulator, drive) = connected?;
            Ok((emulator, Attached { device, drive }))
        })
        .collect::<Result<Vec<_>, ConnectError>>()?;
    if connected.is_empty() { Err(ConnectError::NoDevice) } else { Ok(connected) }
}

/// Time of a round on the wire of a device (with its place in the file), in which each of its axes gets a command and
/// is seen.
pub(crate) fn round(machine: &Machine, (index, device): (usize, &DeviceEntry)) -> Duration {
    let rates = prediction(machine, (index, device)).rates();
    let axes = u32::try_from(machine.axes_of(index).count()).unwrap_or(u32::MAX);
    let seconds = (f64::from(axes) / rates.commands_per_s).max(1.0 / rates.samples_per_s);
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}

/// Client and device on the wire that `device` (with its place in the file) describes, in simulated time.
pub(crate) fn prediction(
    machine: &Machine,
    (index, device): (usize, &DeviceEntry),
) -> Box<dyn Prediction> {
    device.device.prediction(&demands(machine, index))
}

/// Demands of the axes of a machine on one of its devices, in the order of the file.
pub(crate) fn demands(machine: &Machine, device: usize) -> Vec<AxisDemand> {
    machine.axes_of(device).map(|(_, axis)| demand(axis)).collect()
}

/// Demand of an axis on its drive.
pub(crate) fn demand(axis: &Axis) -> AxisDemand {
    AxisDemand {
        index: axis.drive.as_ref().map_or(0, |drive| drive.index),
        speed: (axis.max_velocity * axis.increments_per_si()).abs() * CATCH_UP,
        limits: software_limits(axis),
    }
}

/// The largest velocity of an axis, m/s or rad/s, that a drive with this number of increments/s can follow.
pub(crate) fn velocity_within(axis: &Axis, increments_per_s: f64) -> f64 {
    increments_per_s / axis.increments_per_si().abs() / CATCH_UP
}

/// Software limits for a device, increments: an increment beyond those of the axis, which it may reach.
pub(crate) fn software_limits(axis: &Axis) -> Option<[i32; 2]> {
    let counting = axis.counting().filter(|_| axis.limited)?;
    let [one, other] = axis.position_limits.map(|limit| counting.increments(limit));
    #[expect(clippy::cast_possible_truncation, reason = "saturates, as counters end there")]
    let limits = [one.min(other).floor() as i32, one.max(other).ceil() as i32];
    let [lowest, highest] = limits;
    Some([lowest.saturating_sub(1), highest.saturating_add(1)])
}
