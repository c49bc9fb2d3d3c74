//! `MC_Power`: power and brake of the drive.

use crate::{Axis, SmcError};

/// Power and brake of the drive (`MC_Power`, manual 5.3).
#[doc(alias = "MC_Power")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Power {
    /// `bRegulatorOn`: power on.
    pub regulator_on: bool,
    /// `bDriveStart`: brake released.
    pub drive_start: bool,
}

/// Outputs of [`Power`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PowerStatus {
    /// `Status`: the drive is under control.
    pub status: bool,
    /// 110 for an axis without a cycle time.
    pub error: Option<SmcError>,
}

impl Power {
    /// Calls it for a cycle; without `enable` the drive is switched off and braked.
    pub fn call(self, enable: bool, axis: &mut Axis) -> PowerStatus {
        let valid = axis.cycle() > 0.0 && axis.cycle().is_finite();
        let on = enable && valid;
        let error = (enable && !valid).then_some(SmcError::PFtaskcycleEmpty);
        axis.values.regulator_on = on && self.regulator_on;
        axis.values.drive_start = on && self.drive_start;
        PowerStatus { status: on && axis.is_powered(), error }
    }
}
