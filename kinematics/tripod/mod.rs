//! Tripods: three carriages on vertical rails, each with a pair of rods to a platform (SoftMotion manual 8.2.6).
//!
//! [`Tripod`] is the manual's: six equal rods, parallel in pairs, so that the platform stays level, and a closed form both ways.
//! [`CalibratedTripod`] is a real one: every rod, joint and tower is where it was measured, the platform tilts a little on its
//! way, and both ways are solved numerically.

mod calibrated;
mod ideal;
mod meet;
mod rods;
mod view;

pub use calibrated::{CalibratedTripod, HeldByRods};
pub use ideal::{Tripod, TripodRods};
pub use rods::{Rod, TripodDeviations, TripodDimensions};
pub use view::TripodView;
