//! Tests of the behaviour common to all families, with the real drivers and their emulators in real time.

#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "a test that cannot be set up has failed"
)]

mod assumptions;
mod backup;
mod bench;
#[allow(dead_code, reason = "each family uses a part")]
mod common;
mod device;
mod error;
mod homing;
mod net;
