//! The family as the list of families takes it.

use crate::assumptions::Assumptions;
use crate::drive::OwnDrive;
use crate::emulator::EmulatedOwn;
use crate::prediction::OwnPrediction;
use std::time::Duration;
use twin_drives::family::{
    Abilities, AxisDemand, ConnectError, Connected, Device, DeviceClock, EMULATED_DEADLINE, Family,
    Keys, assumptions, microseconds,
};
use twin_drives::{Drive, DriveError, Prediction};

/// Names of the axes in a machine file.
const AXES: [&str; 3] = ["left", "right", "lift"];

/// The fourth family.
#[derive(Debug)]
pub(crate) struct OwnFamily;

impl Family for OwnFamily {
    fn kind(&self) -> &'static str {
        "own"
    }

    fn title(&self) -> &'static str {
        "Own"
    }

    fn axis(&self, keys: &dyn Keys) -> Option<usize> {
        keys.word("drive_axis", &AXES)
    }

    fn axis_name(&self, index: usize) -> String {
        AXES.get(index).copied().unwrap_or("?").to_owned()
    }

    fn read(&self, keys: &dyn Keys) -> Option<Box<dyn Device>> {
        let response_us = microseconds(keys, "emulated_turnaround_ms", 1.0);
        Some(Box::new(OwnEntry { response_us, assumptions: assumptions(keys) }))
    }
}

/// A device as a machine file describes it.
#[derive(Clone, Debug)]
pub(crate) struct OwnEntry {
    response_us: u32,
    pub(crate) assumptions: Assumptions,
}

impl Device for OwnEntry {
    fn family(&self) -> &'static dyn Family {
        &OwnFamily
    }

    fn copied(&self) -> Box<dyn Device> {
        Box::new(self.clone())
    }

    fn abilities(&self) -> Abilities {
        Abilities { speeds: 1.0..=1e6, counts: 1e9, start_stop: None }
    }

    fn response_us(&self) -> u32 {
        self.response_us
    }

    fn expect_response_us(&mut self, response_us: u32) {
        self.response_us = response_us;
    }

    fn waits(&self, said: Option<Duration>) -> [Duration; 2] {
        [said.unwrap_or(Duration::from_millis(100)), Duration::ZERO]
    }

    fn open(
        &self,
        port: &str,
        axes: &[AxisDemand],
        [deadline, _]: [Duration; 2],
    ) -> Result<Box<dyn Drive>, DriveError> {
        Ok(Box::new(OwnDrive::open(port, axes.len(), deadline)?))
    }

    fn emulate(&self, axes: &[AxisDemand], clock: DeviceClock) -> Result<Connected, ConnectError> {
        let emulator = EmulatedOwn::start(&self.assumptions, clock)?;
        let port = emulator.path().display().to_string();
        let drive = self.open(&port, axes, [EMULATED_DEADLINE, Duration::ZERO])?;
        Ok((Box::new(emulator), drive))
    }

    fn prediction(&self, axes: &[AxisDemand]) -> Box<dyn Prediction> {
        let turnaround = Duration::from_micros(self.response_us.into());
        Box::new(OwnPrediction { axes: axes.len(), turnaround, rounds: 0 })
    }
}
