//! What devices of every family tell about themselves: who they are, inputs, parameters and limits.

mod identity;
mod limits;
mod parameter;
mod signals;

pub use identity::{Identity, UnitIdentity};
pub use limits::DeviceLimits;
pub(crate) use parameter::find;
pub use parameter::{ParameterId, ParameterInfo, Values};
pub use signals::{AxisSignals, Bits, Signals};
