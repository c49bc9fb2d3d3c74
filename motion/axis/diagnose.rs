//! Diagnosis of an axis: limits, largest set values and tracking error (manual 2.2.5, 2.2.8).

use super::Axis;
use super::moves::exceeds;
use std::collections::VecDeque;

impl Axis {
    /// True if the set values exceed `fSWMaxVelocity` (`bCheckVel`) or `fSWMaxAcceleration` and `fSWMaxDeceleration`
    /// (`bCheckAccDec`) (`SMC_CheckLimits`, manual 2.2.5).
    #[doc(alias = "SMC_CheckLimits")]
    #[must_use]
    pub fn exceeds_limits(&self, velocity: bool, rates: bool) -> bool {
        exceeds(self.total(), self.saved, self, velocity, rates)
    }
}

/// A largest value and its time stamp.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Largest {
    /// Without sign.
    pub value: f64,
    /// `dwTimeAtMax`: the stamp of that call.
    pub time: u32,
}

impl Largest {
    /// Takes a value with its stamp into account.
    pub fn update(&mut self, value: f64, time: u32) {
        if value.abs() > self.value {
            *self = Self { value: value.abs(), time };
        }
    }

    /// Largest set velocity, u/s (`SMC_GetMaxSetVelocity`, manual 2.2.8): call it every cycle to be watched; with
    /// `reset` it is 0. `time` is any stamp.
    #[doc(alias = "SMC_GetMaxSetVelocity")]
    pub fn set_velocity(&mut self, axis: &Axis, reset: bool, time: u32) {
        if reset { *self = Self::default() } else { self.update(axis.set_velocity(), time) }
    }

    /// Largest set acceleration or deceleration, u/s² (`SMC_GetMaxSetAccDec`, manual 2.2.8).
    #[doc(alias = "SMC_GetMaxSetAccDec")]
    pub fn set_acceleration(&mut self, axis: &Axis, reset: bool, time: u32) {
        if reset { *self = Self::default() } else { self.update(axis.set_acceleration(), time) }
    }
}

/// Tracking error of an axis: the lag behind its set position, without the dead time of the bus
/// (`SMC_GetTrackingError`, manual 2.2.8).
#[doc(alias = "SMC_GetTrackingError")]
#[derive(Clone, Debug, Default)]
pub struct TrackingError {
    /// `byDeadTimeCycles`: how many cycles the bus takes.
    pub dead_time_cycles: u8,
    /// Set positions, the latest first.
    sent: VecDeque<f64>,
    /// Present error, u: set position then less actual position now.
    pub error: f64,
    /// The largest so far.
    pub largest: Largest,
}

impl TrackingError {
    /// Nothing watched yet.
    #[must_use]
    pub fn new(dead_time_cycles: u8) -> Self {
        Self { dead_time_cycles, ..Self::default() }
    }

    /// Watches a cycle; with `reset` the largest is 0. `time` is any stamp.
    pub fn call(&mut self, axis: &Axis, reset: bool, time: u32) {
        self.sent.push_front(axis.set_position());
        self.sent.truncate(usize::from(self.dead_time_cycles) + 1);
        // At first the oldest set position counts.
        let Some(set) = self.sent.back() else { return };
        self.error = tracking_error(*set, axis.act_position(), axis.period());
        if reset {
            self.largest = Largest::default();
        } else {
            self.largest.update(self.error, time);
        }
    }
}

/// Set position less actual position; the shorter way round on an axis with a period.
#[must_use]
pub fn tracking_error(set: f64, actual: f64, period: Option<f64>) -> f64 {
    let error = set - actual;
    period.map_or(error, |it| error - it * (error / it).round())
}
