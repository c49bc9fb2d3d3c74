//! Tests of the behaviour common to all families, with the real drivers and their emulators in real time.

mod assumptions;
mod backup;
pub(crate) mod bench;
mod device;
mod homing;
mod net;
pub(crate) mod peer;

use crate::{DeviceFault, DriveError};

/// The fault of a family that an outcome has ended with.
pub(crate) fn fault_of<F: DeviceFault, T>(outcome: &Result<T, DriveError>) -> Option<&F> {
    outcome.as_ref().err()?.fault()
}
