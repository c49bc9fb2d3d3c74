//! Estimates against known truths, and ramps against the best that is known.

#![expect(clippy::float_cmp, reason = "given, or to be the same bit for bit")]

mod choice;
mod constrained;
mod distributions;
mod fit;
mod intervals;
mod least_peak;
mod quantum;
mod ramp_in;
mod region;

use crate::{Curve, Knot};
use std::ops::RangeInclusive;

/// Trials of an interval: a quarter of the full count, or all of them where the environment has `TWIN_LONG` (before a release).
pub(super) fn trials(all: u64) -> u64 {
    if long() { all } else { all / 4 }
}

/// Whether the environment has `TWIN_LONG`: all trials and all starts of ramps, before a release.
pub(super) fn long() -> bool {
    std::env::var_os("TWIN_LONG").is_some()
}

/// The first `usual` of some cases, all of them with `TWIN_LONG`.
pub(super) fn cases<T>(all: impl IntoIterator<Item = T>, usual: usize) -> impl Iterator<Item = T> {
    all.into_iter().take(if long() { usize::MAX } else { usual })
}

/// 95 % of the trials: of 1,000 within 2.4 standard deviations, 933 to 967; of fewer, of which there are as many cases, within 3
/// (seeds are fixed).
pub(super) fn right(trials: u64) -> RangeInclusive<usize> {
    let count = f64::from(u32::try_from(trials).expect("a count"));
    let room = if trials < 1000 { 3.0 } else { 2.4 } * (0.95 * 0.05 * count).sqrt();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
    let ends = [(0.95 * count - room).ceil() as usize, (0.95 * count + room).floor() as usize];
    ends[0]..=ends[1]
}

/// A cam that rests at these masters, each with its slave.
fn at_rest(points: &[(f64, f64)]) -> Curve {
    let knot = |(master, slave): &(f64, f64)| Knot::at_rest(*master, *slave);
    Curve::polynomial(&points.iter().map(knot).collect::<Vec<_>>()).expect("a curve")
}

/// 100 up in half a turn and down in the other one, and its largest y″: 10/√3 · 100/180².
fn lift() -> Curve {
    at_rest(&[(0.0, 0.0), (180.0, 100.0), (360.0, 0.0)])
}

const PEAK: f64 = 10.0 / 1.732_050_807_568_877_2 * 100.0 / (180.0 * 180.0);
/// Velocity of the master, u/s.
const VELOCITY: f64 = 300.0;

/// Numbers that come again with their seed (splitmix64).
pub(super) struct Random(pub(super) u64);

impl Random {
    /// 0 to 1, neither included.
    pub(super) fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        let high = u32::try_from((bits ^ (bits >> 31)) >> 32).expect("32 bits");
        (f64::from(high) + 0.5) / 4_294_967_296.0
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    /// Normal, of mean 0 and variance 1 (Box and Muller).
    pub(super) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.share().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.share()).cos()
    }
}
