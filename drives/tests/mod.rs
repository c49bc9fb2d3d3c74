//! What all families offer alike, asked of the real drivers and their emulators in real time.

mod assumptions;
mod backup;
pub(crate) mod bench;
mod device;
mod homing;
mod net;
pub(crate) mod peer;
