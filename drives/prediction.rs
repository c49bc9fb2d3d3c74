//! Following a plan without a wire: what a device will make of it.

use crate::{IncrementMotion, SetpointStream};

/// A device that follows a plan in simulated time: the driver's own decisions reach the device's own profile
/// generators after the time that the exchanges take on the wire. No bytes, no threads, no clock: the same plan gives
/// the same motion, bit by bit.
///
/// It stands in the loop of a simulated machine, between set-points and motors, and shows before a run how far the
/// drives will be from the plan.
pub trait Prediction: Send + std::fmt::Debug {
    /// Number of axes in use; the first this many entries of every array count.
    fn axis_count(&self) -> usize;

    /// Lets time pass up to `time_ns` (never backwards), following `plan`, of which only what is planned up to its
    /// horizon counts; its clock does not. Gives what the device's profile generators ask of the motors at `time_ns`:
    /// between the steps of a step motor, that is how far the next step is.
    ///
    /// The first call says where the axes are.
    fn advance(&mut self, plan: &dyn SetpointStream, time_ns: i64) -> IncrementMotion;

    /// Exchanges with the device so far: commands and samples.
    fn exchanges(&self) -> u64;

    /// Capacity of the wire while every axis needs a command.
    fn rates(&self) -> WireRates;

    /// The same once more, to go on from here twice.
    fn copied(&self) -> Box<dyn Prediction>;
}

/// Exchanges that the timing of a wire allows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WireRates {
    /// Commands for axes, all axes of the device together, 1/s.
    pub commands_per_s: f64,
    /// Samples of every axis, 1/s.
    pub samples_per_s: f64,
}

impl WireRates {
    /// Of rounds of `duration` s in which every axis gets `commands` commands and is seen once.
    pub fn of_rounds(commands: usize, duration: f64) -> Self {
        let samples_per_s = 1.0 / duration.max(1e-9);
        let commands = f64::from(u32::try_from(commands).unwrap_or(u32::MAX));
        Self { commands_per_s: commands * samples_per_s, samples_per_s }
    }
}

/// A plan as it is seen at an instant of simulated time.
#[derive(Clone, Copy)]
#[expect(missing_debug_implementations, reason = "a plan has nothing to show")]
pub struct SeenAt<'a> {
    /// The plan.
    pub plan: &'a dyn SetpointStream,
    /// The instant, ns.
    pub now_ns: i64,
}

impl SetpointStream for SeenAt<'_> {
    fn now_ns(&self) -> i64 {
        self.now_ns
    }

    fn at(&self, time_ns: i64) -> IncrementMotion {
        self.plan.at(time_ns.min(self.now_ns.saturating_add(self.horizon_ns())))
    }

    fn horizon_ns(&self) -> i64 {
        self.plan.horizon_ns()
    }
}
