//! Real drives and their emulators.
//!
//! This crate knows increments, registers and wires; it never learns which machine hangs on the axes.

mod drive;

pub use drive::{Drive, Increments, IncrementMotion, MAX_DRIVE_AXES, Sample, SetpointStream};
