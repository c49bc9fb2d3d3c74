//! Description of a device, whatever its family: identity, inputs, parameters and limits.

mod identity;
mod limits;
mod parameter;
mod signals;

pub use identity::{Identity, UnitIdentity};
pub use limits::DeviceLimits;
pub use parameter::{ParameterId, ParameterInfo, Values};
pub use signals::{AxisSignals, Bits, Signals};

/// The largest number of axes one device has (InterpCNC: X Y Z A B).
pub const MAX_DRIVE_AXES: usize = 5;
