//! Tripods: three carriages on vertical rails, each with a pair of rods to a platform (SoftMotion manual 8.2.6).
//!
//! [`Tripod`] is the manual's ideal tripod: six equal rods, parallel in pairs, so that the platform stays level; both
//! directions have a closed form. [`CalibratedTripod`] is a measured one: every rod, joint and tower has its own
//! position, the platform tilts slightly, and both directions are solved numerically.

mod calibrated;
mod ideal;
mod meet;
mod rods;

pub use calibrated::{CalibratedTripod, HeldByRods};
pub use ideal::{Tripod, TripodRods};
pub use rods::{Rod, TripodDeviations, TripodDimensions};
