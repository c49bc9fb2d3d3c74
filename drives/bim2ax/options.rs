//! Settings of the drive.

use std::time::Duration;

use super::{Bim2AxOptions, ModuleAxis};

/// Settings of the drive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bim2AxDriveOptions {
    /// Of the exchanges.
    pub driver: Bim2AxOptions,
    /// Axes in use, in the order of the arrays of [`crate::Drive`].
    pub axes: Vec<ModuleAxis>,
    /// Time between two looks at moving axes. Every look interrupts the module for 300 µs.
    pub look_every: Duration,
}

impl Bim2AxDriveOptions {
    /// Both axes, 200 looks a second.
    pub fn new() -> Self {
        Self {
            driver: Bim2AxOptions::default(),
            axes: ModuleAxis::ALL.to_vec(),
            look_every: Duration::from_millis(5),
        }
    }
}

impl Default for Bim2AxDriveOptions {
    fn default() -> Self {
        Self::new()
    }
}
