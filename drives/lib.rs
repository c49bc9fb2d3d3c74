//! Common parts of all drive families.
//!
//! The trait [`Drive`] is a device with one to five axes; positions are increments. For the families there are the
//! follower of a plan, the profile generator, homing by a switch, backups of parameters, faults of a wire and the host that
//! serves an emulated device. This crate knows no family, and no machine that the axes belong to.
//!
//! ```
//! use twin_drives::DecimalRatio;
//! use twin_drives::ramp::{Motion, Ramp, State};
//!
//! // A spindle of 3 mm per turn with 10000 increments per turn: 4.5 mm are 15000 increments.
//! let ratio = DecimalRatio::new(10_000, 3.0, 0).ok_or("no ratio")?;
//! assert_eq!(ratio.increments(4.5), Some(15_000));
//! // The move at 5000 increments/s and 10000 increments/s² takes s/v + v/a = 3 s + 0.5 s.
//! let ramp = Ramp {
//!     start_stop: 0.0,
//!     acceleration: 10_000.0,
//!     speed: 5000.0,
//!     deceleration: 10_000.0,
//!     target: 15_000.0,
//! };
//! let motion = Motion::plan(0, State::default(), &ramp);
//! assert_eq!(motion.end_ns(), 3_500_000_000);
//! assert!((motion.at(1_750_000_000).position - 7500.0).abs() < 1e-6, "half of the way");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod assumptions;
pub mod backup;
mod clock;
mod decimal_ratio;
mod device;
pub mod drive;
pub mod emulator_host;
pub mod encoder_check;
mod error;
pub mod exchanges;
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
pub use clock::{Accelerated, Clock, Speed, no_clock};
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
pub use exchanges::{Exchanges, Losses};
pub use fault::{Direction, FaultRule, FaultyWire, When, WireFault};
pub use port::Port;
pub use prediction::{Prediction, WireRates};
pub use stamp::Stamp;
