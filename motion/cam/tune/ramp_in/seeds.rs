//! Starting points of the ramp search: ramps of all kinds that take a given time.
//!
//! A ramp over D in T s has velocities of the order of D/T, accelerations of D/T² and jerks of D/T³. If it makes up for
//! a velocity difference v these are v/1, v/T and v/T². The kind of a ramp gives the rest: acceleration against
//! deceleration, how soon it reaches its accelerations, and what part of its unlimited peak velocity it uses. The size
//! of its accelerations for a duration of T s is found by bisection. The limits of the axis have no influence here,
//! except the limits of the inputs themselves, so limits that do not bind change nothing.

use super::problem::{Problem, Values};
use std::f64::consts::LN_2;

/// Growth of the velocity against its fall, as powers of 2.
const LOPSIDED: [f64; 9] = [-10.0, -5.0, -2.5, -1.0, 0.0, 1.0, 2.5, 5.0, 10.0];
/// Jerk by velocity, as a part of the square of the acceleration: above about 1 a ramp reaches its accelerations.
const SUDDEN: [f64; 4] = [0.7, 1.5, 4.0, 20.0];
/// Parts of the velocity that is reached without a limit.
const SLOWER: [f64; 6] = [1.0, 0.9, 0.75, 0.6, 0.45, 0.25];
/// The logarithm of an acceleration is looked for within this, and with so many halvings.
const BRACKET: f64 = 12.0;
const HALVINGS: u32 = 14;
/// As good as no limit of the velocity, in its own unit.
const FREE: f64 = 1e6;

/// What kind a ramp is.
#[derive(Clone, Copy)]
struct Kind {
    /// The logarithm of half of up against down.
    lopsided: f64,
    /// The logarithm of [`SUDDEN`].
    sudden: f64,
}

/// The units of ramps that take a time.
#[derive(Clone, Copy)]
struct Units {
    time: f64,
    velocity: f64,
}

impl Problem<'_> {
    /// Logarithms of the values of ramps that take `time` s, or a little less where their values may not be so small.
    pub(super) fn seeds(&self, time: f64) -> Vec<Values> {
        let [distance, velocity, acceleration] = self.gap();
        let units = Units { time, velocity: distance / time + velocity + acceleration * time };
        let suddens: &[f64] = if self.limited() { &SUDDEN } else { &[1.0] };
        let mut seeds = Vec::new();
        for lopsided in LOPSIDED {
            for sudden in suddens {
                let kind = Kind { lopsided: lopsided * LN_2 / 2.0, sudden: sudden.ln() };
                let Some(free) = self.timed(&units, kind, units.velocity * FREE) else { continue };
                let Ok(way) = self.way(free.map(f64::exp)) else { continue };
                let [reached, ..] = way.reached();
                let slower =
                    SLOWER.iter().filter_map(|part| self.timed(&units, kind, part * reached));
                seeds.extend(slower);
            }
        }
        seeds
    }

    /// The ramp of a kind that takes a time.
    fn timed(&self, units: &Units, kind: Kind, velocity: f64) -> Option<Values> {
        let (pull, v) = ((units.velocity / units.time).ln(), units.velocity.ln());
        let most = self.most_values();
        let with = |by: f64| {
            let pull = pull + by;
            let all = [
                velocity.ln(),
                pull + kind.lopsided,
                pull - kind.lopsided,
                kind.sudden + 2.0 * pull - v,
            ];
            let mut at = all;
            for (at, most) in at.iter_mut().zip(most) {
                *at = at.min(most);
            }
            at
        };
        let in_time = |by: f64| {
            let way = self.way(with(by).map(f64::exp));
            way.is_ok_and(|way| way.duration() <= units.time)
        };
        let (mut low, mut high) = (-BRACKET, BRACKET);
        if !in_time(high) {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            if in_time(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        Some(with(high))
    }
}
