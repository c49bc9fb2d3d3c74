//! From a place to the corner of its valley, by linear programs.
//!
//! What each stretch of a ramp reaches beside each piece of the cam is a smooth function of the logarithms of the values. So all
//! of them are taken for linear within a region, a linear program finds the best place in it
//! (`motion/cam/tune/ramp_in/program.rs`), and the region grows or shrinks with how true that was. In a corner this gains twice the
//! digits with each step. What breaks limits is made up for by its excess, so that a valley may be entered from outside.

use super::place::Place;
use super::problem::Values;
use super::program::{Price, Slopes, Step};
use super::search::{DEAR, Search};

/// The largest region, as a logarithm, and the smallest one.
const REGIONS: [f64; 2] = [1.0, 1e-7];
/// Steps from one place on.
const STEPS: usize = 40;
/// Of what is promised: a region in which more is gained may grow, one in which less is gained shrinks.
const GAINED: [f64; 2] = [0.7, 0.2];
/// What promises less, as a part of the aim, is the end.
const PROMISED: f64 = 1e-9;
/// In a region smaller than the first what is worse than the best by the second is given up.
const HOPELESS: [f64; 2] = [2e-2, 0.03];
/// For derivatives.
const NEAR: f64 = 1e-6;
/// How much more of a value is none that is just reached.
const LOOSE: f64 = 0.5;
/// As good as no limit, as a logarithm.
const FREE: f64 = 12.0;

impl Search<'_> {
    /// From a place on as long as that is better.
    pub(super) fn descend(&mut self, mut place: Place, mut region: f64) {
        let judge = self.judge;
        let price = Price { judge: &judge, unit: place.aim, dear: DEAR };
        let [largest, smallest] = REGIONS;
        let [grows, shrinks] = GAINED;
        for _ in 0..STEPS {
            let slopes = self.slopes(&place);
            let Some(Step { by, gain: promised }) = price.program(&place, &slopes, region) else {
                return;
            };
            let mut next = place.at;
            for (next, by) in next.iter_mut().zip(by) {
                *next += by;
            }
            let next = self.place(self.just_reached(next));
            let gained =
                next.as_ref().map_or(f64::NEG_INFINITY, |next| price.of(&place) - price.of(next));
            if gained > grows * promised {
                region = (2.0 * region).min(largest);
            } else if gained < shrinks * promised {
                region /= 4.0;
            }
            if let Some(next) = next.filter(|_| gained > 0.0) {
                place = next;
            }
            let [small, worse] = HOPELESS;
            let best = self.best.map_or(f64::INFINITY, |(best, _)| best / price.unit);
            let hopeless = region < small && price.of(&place) > best * (1.0 + worse);
            if region < smallest || promised < PROMISED || hopeless {
                return;
            }
        }
    }

    /// What a value is reached by if it does not hold the ramp itself, as a logarithm.
    fn reached(&self, at: &Values, index: usize) -> f64 {
        let mut free = *at;
        if let Some(at) = free.get_mut(index) {
            *at += FREE;
        }
        let way = self.problem.way(free.map(f64::exp));
        let reached = way.ok().and_then(|way| way.reached().get(index).copied());
        let reached = reached.filter(|reached| *reached > 0.0).map_or(f64::INFINITY, f64::ln);
        if reached < at.get(index).copied().unwrap_or_default() + FREE / 2.0 {
            reached
        } else {
            f64::INFINITY
        }
    }

    /// The same ramp with more of the values that are just reached, so that others may change without that these hold it.
    pub(super) fn loose(&self, mut at: Values) -> Values {
        for index in 0..self.unknowns {
            let reached = self.reached(&at, index);
            if let Some(at) = at.get_mut(index).filter(|at| reached <= **at + NEAR) {
                *at += LOOSE;
            }
        }
        at
    }

    /// The same ramp with values that are reached.
    pub(super) fn just_reached(&self, mut at: Values) -> Values {
        let reached = self.problem.way(at.map(f64::exp)).map(|way| way.reached());
        if let Ok(reached) = reached {
            for (at, reached) in at.iter_mut().zip(reached).take(self.unknowns) {
                if reached > 0.0 {
                    *at = at.min(reached.ln());
                }
            }
        }
        at
    }

    /// How all parts change with each of the values.
    fn slopes(&mut self, place: &Place) -> Slopes {
        let reached = self.rooms(place);
        // Where a value is just reached, the other side of it says nothing: derivatives are those on this side.
        let mut inside = place.at;
        for (at, (room, _)) in inside.iter_mut().zip(&reached) {
            *at -= if *room < 4.0 * NEAR { 4.0 * NEAR } else { 0.0 };
        }
        let mut parts = vec![vec![0.0; self.unknowns]; place.parts.len()];
        if let Some(base) = self.place(inside) {
            let matched = place.matched(&base);
            let here: Vec<_> = place.parts.iter().map(|part| base.value(part, &matched)).collect();
            for index in 0..self.unknowns {
                let mut at = inside;
                if let Some(at) = at.get_mut(index) {
                    *at -= NEAR;
                }
                let Some(other) = self.place(at) else { continue };
                let matched = place.matched(&other);
                for ((slopes, part), here) in parts.iter_mut().zip(&place.parts).zip(&here) {
                    if let (Some(slope), Some(here), Some(there)) =
                        (slopes.get_mut(index), here, other.value(part, &matched))
                    {
                        *slope = (here - there) / NEAR;
                    }
                }
            }
        }
        Slopes { parts, reached, most: self.problem.most_values() }
    }

    /// By how much each value may grow before it is not reached any more, and by how much more with each of the others.
    fn rooms(&self, place: &Place) -> Vec<(f64, Vec<f64>)> {
        let room = |(index, at): (usize, &f64)| {
            let reached = self.reached(&place.at, index);
            let by = (0..self.unknowns).map(|other| {
                if !reached.is_finite() || other == index {
                    return 0.0;
                }
                let mut near = place.at;
                if let Some(near) = near.get_mut(other) {
                    *near -= NEAR;
                }
                let slope = (reached - self.reached(&near, index)) / NEAR;
                if slope.is_finite() { slope } else { 0.0 }
            });
            ((reached - at).max(0.0), by.collect())
        };
        place.at.iter().take(self.unknowns).enumerate().map(room).collect()
    }
}
