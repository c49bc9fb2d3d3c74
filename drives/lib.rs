//! Real drives and their emulators.
//!
//! This crate knows increments, registers and wires; it never learns which machine hangs on the axes.

mod assumptions;
pub mod backup;
pub mod bim2ax;
mod clock;
mod control;
mod decimal_ratio;
mod device;
mod drive;
mod error;
mod fault;
mod follow;
pub mod homing;
pub mod interpcnc;
mod kept;
mod pause;
mod port;
mod pty;
mod ramp;
mod rehearsal;
mod shaft;
mod slave;
pub mod smartdrive;
mod stamp;
#[cfg(test)]
mod tests;
mod transport;

pub use assumptions::{Assumed, AssumedError, AssumedValues, OpenQuestion};
pub use clock::{Accelerated, Clock, Speed};
pub use control::Control;
pub use decimal_ratio::DecimalRatio;
pub use device::{
    AxisSignals, Bits, DeviceLimits, Identity, MAX_DRIVE_AXES, ParameterId, ParameterInfo, Signals,
    UnitIdentity, Values,
};
pub use drive::{
    Commanded, Drive, HomingWays, IncrementMotion, Increments, Sample, SetpointStream,
};
pub use error::{Action, Axes, DeviceFault, DriveError, EmulatorError, Exchange, ProtocolFault};
pub use fault::{Direction, FaultRule, FaultyWire, When, WireFault};
pub use port::Port;
pub use rehearsal::{Rehearsal, WireRates};
pub use stamp::Stamp;
