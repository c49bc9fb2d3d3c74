//! Cams: a slave axis as a function of a master axis (manual 4, 5.4, 5.5, 10.3).
//!
//! [`Source`] is the editable form: points, straight lines and tappets on a scale. It is compiled to a [`Cam`], a
//! polynomial or a table, whose [`Curve`] gives the slave's position and derivatives. [`CamCoupling`] makes a slave
//! follow one cycle by cycle; its tappets switch a [`TappetBit`].
//!
//! Everything is in the axes' technical units u. There is no clock: the caller gives the time of each cycle.
//!
//! ```
//! use std::sync::Arc;
//! use twin_cam::{CamCoupling, CamInput, CamTable, Compile, Source, StartMode};
//! use twin_profile::State;
//!
//! // A lift of 40 mm in half a turn of the master, and back: quintics at rest in all three points.
//! let mut source = Source::new("lift");
//! for (master, slave) in [(0.0, 0.0), (180.0, 40.0), (360.0, 0.0)] {
//!     source.insert_point(master, slave);
//! }
//! let cam = source.compile(Compile::Polynomial)?;
//! // A quintic of rise h over b is fastest in the middle: 15/8 h/b, in mm per degree.
//! let rise = cam.curve().at(90.0);
//! assert!((rise.position - 20.0).abs() < 1e-9);
//! assert!((rise.velocity - 15.0 / 8.0 * 40.0 / 180.0).abs() < 1e-12);
//! // At 360 degrees/s of the master the slave moves at 150 mm/s there.
//! let master = State { position: 90.0, velocity: 360.0, acceleration: 0.0 };
//! let input = CamInput { start_mode: StartMode::Absolute, ..CamInput::default() };
//! let table = CamTable::new(Arc::new(cam));
//! let coupling = CamCoupling::start(table, input, &master, &State::resting(20.0), 0)?;
//! assert!((coupling.output().slave.velocity - 150.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bit;
mod bounds;
mod cells;
mod coupling;
mod coupling_output;
mod curve;
mod curve_distance;
mod error;
pub mod file;
mod jerk_limited_ramp_in;
mod joints;
mod knot;
mod maximum_master_velocity;
mod passage;
mod polynomial;
mod ramp_in;
mod reference;
mod selection;
mod source;
mod table;
mod tappet;
#[cfg(test)]
mod tests;
pub mod tune;
mod unwrap;

pub use bit::TappetBit;
pub use bounds::{Bounds, Factors, MasterMotion, Peak, Quantity, SlaveLimits};
pub use coupling::{
    CamCoupling, Coupled, CouplingError, MAX_TRIGGERS, TappetData, slave_set_position,
};
pub use curve::{Curve, CurveExtremes, Jump, Jumps, Range};
pub use error::CamError;
pub use jerk_limited_ramp_in::{Approach, Gap};
pub use joints::{Joint, Joints};
pub use knot::{Derivatives, Knot, quintic};
pub use maximum_master_velocity::{Largest, LimitError};
pub use passage::Trigger;
pub use reference::{Cam, Shape};
pub use selection::{CamInput, CamTable, StartMode};
pub use source::{Compile, Element, Kind, Scale, Source};
pub use table::{Equidistant, Interpolation, PairTable, TableScale, VariableType};
pub use tappet::{Action, Passage, Tappet};
