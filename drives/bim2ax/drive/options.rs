//! Settings of the drive.

use std::time::Duration;

use crate::{Bim2AxOptions, ModuleAxis};

/// Settings of the drive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bim2AxDriveOptions {
    /// Of the exchanges.
    pub driver: Bim2AxOptions,
    /// Axes in use, in the order of the arrays of [`twin_drives::Drive`].
    pub axes: Vec<ModuleAxis>,
    /// Time between two looks at moving axes. Every look interrupts the module for 300 µs.
    pub look_every: Duration,
    /// Axes that have an encoder: they are refused if their parameters declare none. One that is declared and recognised is
    /// watched in any case.
    pub encoder_axes: Vec<ModuleAxis>,
    /// So far a counter and its encoder may be apart, µsteps; by default three full steps: a rotor slips beyond two, and stands
    /// four away then. What the numbers of the encoder are rounded by comes on top.
    pub encoder_tolerance: Option<u32>,
}

impl Bim2AxDriveOptions {
    /// Both axes, 200 looks a second, encoders as the module declares them.
    pub fn new() -> Self {
        Self {
            driver: Bim2AxOptions::default(),
            axes: ModuleAxis::ALL.to_vec(),
            look_every: Duration::from_millis(5),
            encoder_axes: Vec::new(),
            encoder_tolerance: None,
        }
    }
}

impl Default for Bim2AxDriveOptions {
    fn default() -> Self {
        Self::new()
    }
}
