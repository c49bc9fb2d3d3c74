//! The device in simulated time: it is where the plan was a round of the wire before.

use crate::protocol::wire_time;
use std::time::Duration;
use twin_drives::{IncrementMotion, Prediction, SetpointStream, WireRates};

/// Bytes of a move and of its answer, as long as they get.
const ROUND_BYTES: usize = 120;

/// Axes that lag behind their plan by one round.
#[derive(Clone, Debug)]
pub(crate) struct OwnPrediction {
    pub(crate) axes: usize,
    pub(crate) turnaround: Duration,
    pub(crate) rounds: u64,
}

impl OwnPrediction {
    fn round(&self) -> Duration {
        wire_time(ROUND_BYTES) + self.turnaround
    }
}

impl Prediction for OwnPrediction {
    fn axis_count(&self) -> usize {
        self.axes
    }

    fn advance(&mut self, plan: &dyn SetpointStream, time_ns: i64) -> IncrementMotion {
        self.rounds += 1;
        plan.at(time_ns - twin_drives::ramp::whole_ns(self.round()))
    }

    fn exchanges(&self) -> u64 {
        self.rounds
    }

    fn rates(&self) -> WireRates {
        WireRates::of_rounds(self.axes, self.round().as_secs_f64())
    }

    fn copied(&self) -> Box<dyn Prediction> {
        Box::new(self.clone())
    }
}
