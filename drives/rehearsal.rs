//! Following a plan without a wire: what a device will make of it.

use crate::{IncrementMotion, SetpointStream};

/// A device that follows a plan in simulated time: the driver's own decisions reach the device's own profile
/// generators after the time that the exchanges take on the wire. No bytes, no threads, no clock: the same plan gives
/// the same motion, bit by bit.
///
/// It stands in the loop of a simulated machine, between set-points and motors, and tells before a run how far the
/// drives will be from the plan.
pub trait Rehearsal: Send + std::fmt::Debug {
    /// Number of axes in use; the first this many entries of every array count.
    fn axis_count(&self) -> usize;

    /// Lets time pass up to `time_ns` (never backwards), following `plan`, of which only what is planned up to its
    /// horizon counts; its clock does not. Gives what the device's profile generators ask of the motors at `time_ns`:
    /// between the steps of a step motor, that is how far the next step is.
    ///
    /// The first call says where the axes stand.
    fn advance(&mut self, plan: &dyn SetpointStream, time_ns: i64) -> IncrementMotion;

    /// Exchanges with the device so far: commands and samples.
    fn exchanges(&self) -> u64;

    /// The same once more, to go on from here twice.
    fn copied(&self) -> Box<dyn Rehearsal>;
}

/// A plan as it is seen at an instant of simulated time.
#[derive(Clone, Copy)]
pub(crate) struct SeenAt<'a> {
    /// The plan.
    pub(crate) plan: &'a dyn SetpointStream,
    /// The instant, ns.
    pub(crate) now_ns: i64,
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
