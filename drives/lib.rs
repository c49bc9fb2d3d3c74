//! Common parts of all drive families.
//!
//! The trait [`Drive`] is a device with one to five axes; positions are increments. For the families there are the
//! follower of a plan, the profile generator, homing by a switch, backups of parameters, faults of a wire and the host that
//! serves an emulated device. This crate knows no family, and no machine that the axes belong to.

pub mod assumptions;
pub mod backup;
mod clock;
mod decimal_ratio;
mod device;
pub mod drive;
pub mod emulator_host;
pub mod encoder_check;
mod error;
pub mod family;
mod fault;
pub mod follow;
pub mod homing;
pub mod pause;
pub mod port;
pub mod prediction;
pub mod ramp;
mod stamp;
pub mod transport;

pub use assumptions::{Assumed, AssumedError, AssumedValues, OpenQuestion};
pub use clock::{Accelerated, Clock, Speed};
pub use decimal_ratio::DecimalRatio;
pub use device::{
    AxisSignals, Bits, DeviceLimits, Identity, MAX_DRIVE_AXES, ParameterId, ParameterInfo, Signals,
    UnitIdentity, Values,
};
pub use drive::{
    Commanded, Drive, HomingWays, IncrementMotion, Increments, Sample, SetpointStream,
};
pub use emulator_host::Control;
pub use error::{
    Action, Axes, DeviceFault, DriveError, EmulatorError, Exchange, ProtocolFault, find_parameter,
};
pub use fault::{Direction, FaultRule, FaultyWire, When, WireFault};
pub use port::Port;
pub use prediction::{Prediction, WireRates};
pub use stamp::Stamp;
