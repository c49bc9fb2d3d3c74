//! What the parameters of real devices must be for a machine file.

use crate::emulated::{bim2ax_axis, smartdrive_axis};
use crate::machine::{DriveFamily, Machine};
use twin_drives::ParameterId;
use twin_drives::bim2ax::ModuleAxis;
use twin_drives::bim2ax::parameter::{AxisParameter, Parameter};
use twin_drives::interpcnc::parameters::COUPLING;
use twin_drives::smartdrive::parameters::{
    ACCELERATION_MAX, DECELERATION_MAX, FULL_STEPS, STEP_DIVISOR, VELOCITY_MAX,
};

/// What a parameter must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Must {
    Be(i64),
    BeAtLeast(i64),
    /// 0 says that another parameter counts.
    BeAtLeastOrZero(i64),
}

impl Must {
    pub(super) fn allows(self, found: i64) -> bool {
        match self {
            Self::Be(value) => found == value,
            Self::BeAtLeast(value) => found >= value,
            Self::BeAtLeastOrZero(value) => found == 0 || found >= value,
        }
    }
}

/// A parameter that counts.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    pub(super) id: ParameterId,
    pub(super) must: Must,
    /// Name of the axis whose parameter it is.
    pub(super) axis: Option<String>,
}

/// The parameters that count of a device.
pub(super) fn wanted(machine: &Machine, index: usize) -> Vec<Wanted> {
    let Some(entry) = machine.drives.get(index) else { return Vec::new() };
    let mut wanted = Vec::new();
    match &entry.family {
        // Moves carry their speeds and ramps; that an axis goes along with another is kept by the board.
        DriveFamily::InterpCnc(_) => {
            let id = ParameterId { station: 0, number: COUPLING };
            wanted.push(Wanted { id, must: Must::Be(0), axis: None });
        }
        DriveFamily::SmartDrive(bus) => {
            for (_, axis) in machine.axes_of(index) {
                let driven = smartdrive_axis(axis, bus);
                let deceleration = match driven.deceleration_rpm_per_s {
                    0 => driven.acceleration_rpm_per_s,
                    rate => rate,
                };
                for (number, must) in [
                    (FULL_STEPS, Must::Be(bus.full_steps.into())),
                    (STEP_DIVISOR, Must::Be(bus.microsteps.into())),
                    (VELOCITY_MAX, Must::BeAtLeast(driven.velocity_rpm.into())),
                    (ACCELERATION_MAX, Must::BeAtLeast(driven.acceleration_rpm_per_s.into())),
                    (DECELERATION_MAX, Must::BeAtLeastOrZero(deceleration.into())),
                ] {
                    let id = ParameterId { station: driven.address, number };
                    wanted.push(Wanted { id, must, axis: Some(axis.name.clone()) });
                }
            }
        }
        DriveFamily::Bim2Ax(module) => {
            for (_, axis) in machine.axes_of(index) {
                let place = axis.drive.as_ref().map_or(0, |drive| drive.index);
                let Some(on_module) = ModuleAxis::ALL.get(place).copied() else { continue };
                let driven = bim2ax_axis(axis, module);
                for (parameter, must) in [
                    (AxisParameter::Mode, Must::Be(driven.mode.code().into())),
                    (AxisParameter::FastSpeed, Must::BeAtLeast(driven.fast_speed.into())),
                    (AxisParameter::StartStopSpeed, Must::Be(driven.start_stop_speed.into())),
                    (AxisParameter::Acceleration, Must::BeAtLeast(driven.acceleration.into())),
                ] {
                    let number = Parameter::Axis(parameter, on_module).number();
                    let Some(number) = number else { continue };
                    let id = ParameterId { station: 0, number };
                    wanted.push(Wanted { id, must, axis: Some(axis.name.clone()) });
                }
            }
        }
    }
    wanted
}
