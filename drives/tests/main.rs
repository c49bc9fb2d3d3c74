//! Tests of the behaviour common to all families, with the real drivers and their emulators in real time.

mod assumptions;
mod backup;
mod bench;
#[allow(dead_code, reason = "each family uses a part")]
mod common;
mod device;
mod error;
mod homing;
mod net;
