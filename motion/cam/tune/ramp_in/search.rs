//! The best of all ramps: from many places of all kinds (`motion/cam/tune/ramp_in/seeds.rs`), by chance first, and by linear
//! programs to the end.
//!
//! Where the cam moves meanwhile there are several valleys, and the best ramp mostly lies in a corner where two or three limits
//! hold at once: no single value can be changed there for the better. Linear programs find the corner of a valley to the last
//! digits (`motion/cam/tune/ramp_in/descent.rs`), but see nothing beyond an edge: the jerk of ramp and cam jumps where the end of a
//! stretch of the ramp passes a joint of the cam, and what is reached bends where a stretch comes or goes. Walks by chance pass
//! such edges. So all places are followed by a short walk each, the best of each time and of all then by a longer one, and the
//! best of these by linear programs. From the best of all it is begun again as long as that leads to a better one.
//!
//! A walk depends on nothing but where it begins, and the times of the ramps that it is begun with are the same for all wishes:
//! with more time, or with a limit that holds nothing, the same walks are made again.
//!
//! Nothing is taken but what keeps the limits by its exact peaks.

use super::super::random_numbers::Draws;
use super::place::{Aim, Judge, Place};
use super::problem::{Problem, Values, values};
use super::wish::{RampError, RampIn};

/// What an excess costs when places are chosen, as a power of how many times a limit is reached: the cheap ones come near to the
/// corners, the dear ones keep the limits.
const COSTS: [f64; 3] = [0.5, 3.0, 30.0];
/// So many places for each of them, of ramps that take one time.
const PLACES: usize = 3;
/// These are apart if a value differs by this much, as a logarithm.
const APART: f64 = 0.6;
/// What each part of an excess costs on the way, in parts of the aim: more than any limit is worth.
pub(super) const DEAR: f64 = 20.0;
/// Steps of each walk, and how many walks are left then of each time, and beside these of all: first of all walks, then of
/// those that are left.
const WALKS: [[usize; 3]; 2] = [[60, 2, 8], [150, 1, 6]];
/// Of walks that are nearer, as a logarithm, only the better one is left.
const NEIGHBOURS: f64 = 0.1;
/// The first stride of a walk, and the largest one, as a logarithm.
const STRIDE: f64 = 0.25;
/// What a stride is multiplied by after a success and without one: it stays as it is if one of six steps is one.
const STRIDES: [f64; 2] = [1.6, 0.9];
/// Strides with which the best ramp is walked from again, how long, and how often at most.
const AGAIN: [f64; 3] = [0.5, 0.1, 0.02];
const AGAIN_STEPS: usize = 150;
const ROUNDS: u64 = 4;
/// The region of linear programs at the begin, as a logarithm.
const REGION: f64 = 0.5;
/// Parts of the velocity that the best ramp reaches, with which it is begun again, too.
const SLOWER: [f64; 3] = [0.98, 0.9, 0.75];
/// A value is another one by far if it differs by this much, as a logarithm.
const OTHER: f64 = 2.3;
/// What is better by less is not better.
const GAIN: f64 = 1e-6;

/// A search, and what it has found.
#[derive(Debug)]
pub(super) struct Search<'a> {
    pub(super) problem: &'a Problem<'a>,
    aim: Aim,
    pub(super) judge: Judge,
    /// Values that are looked for: with or without the jerk.
    pub(super) unknowns: usize,
    /// Where it begins: places of ramps that take about one time each.
    places: Vec<Vec<Place>>,
    /// The best ramp that keeps all limits, and its aim.
    pub(super) best: Option<(f64, RampIn)>,
}

/// A walk by chance.
#[derive(Debug)]
struct Walk {
    /// Which of the times it was begun with.
    time: usize,
    place: Place,
    price: f64,
    stride: f64,
    draws: Draws,
}

impl Walk {
    fn new(time: usize, place: Place, stride: f64, stream: u64) -> Self {
        let price = log_price(&place, DEAR);
        Self { time, place, price, stride, draws: Draws::new(stream) }
    }
}

impl<'a> Search<'a> {
    pub(super) fn new(problem: &'a Problem<'a>, aim: Aim) -> Self {
        let unknowns = if problem.limited() { 4 } else { 3 };
        let judge = Judge::new(problem, aim);
        Self { problem, aim, judge, unknowns, places: Vec::new(), best: None }
    }

    /// The best ramp so far.
    pub(super) fn best(&self) -> Option<RampIn> {
        self.best.map(|(_, ramp)| ramp)
    }

    /// Looks at ramps that take a time.
    pub(super) fn sow(&mut self, time: f64) {
        let mut places = Vec::new();
        for at in self.problem.seeds(time) {
            places.extend(self.place(at));
        }
        let chosen = self.apart(places);
        self.places.push(chosen);
    }

    /// Begins with a ramp, too.
    pub(super) fn begin_with(&mut self, ramp: &RampIn) {
        let place = self.place(values(ramp).map(f64::ln));
        self.places.push(place.into_iter().collect());
    }

    /// Goes on from the places seen.
    pub(super) fn run(&mut self) -> Result<(), RampError> {
        let places = std::mem::take(&mut self.places);
        let begun = places.into_iter().enumerate().flat_map(|(time, places)| {
            places.into_iter().map(move |place| Walk::new(time, place, STRIDE, 0))
        });
        let mut walks: Vec<_> = begun.collect();
        for [steps, of_time, of_all] in WALKS {
            for walk in &mut walks {
                self.walk(walk, steps);
            }
            walks = self.left(walks, of_time, of_all);
        }
        for walk in walks {
            if let Some(place) = self.place(self.just_reached(walk.place.at)) {
                self.descend(place, REGION);
            }
        }
        for round in 1..=ROUNDS {
            let Some((before, ramp)) = self.best else { break };
            self.again(&ramp, round)?;
            if self.best.is_none_or(|(aim, _)| aim >= before * (1.0 - GAIN)) {
                break;
            }
        }
        Ok(())
    }

    /// Begins again from a ramp.
    fn again(&mut self, ramp: &RampIn, round: u64) -> Result<(), RampError> {
        let reached = self.just_reached(values(ramp).map(f64::ln));
        for begin in [reached, self.loose(reached)] {
            for stride in AGAIN {
                if let Some(place) = self.place(begin) {
                    let mut walk = Walk::new(0, place, stride, round);
                    self.walk(&mut walk, AGAIN_STEPS);
                    if let Some(place) = self.place(self.just_reached(walk.place.at)) {
                        self.descend(place, stride);
                    }
                }
            }
        }
        for at in self.beside(ramp)? {
            if let Some(place) = self.place(self.just_reached(at)) {
                self.descend(place, REGION);
            }
        }
        Ok(())
    }

    /// The best of some walks that are no neighbours: of each time, and of all.
    fn left(&self, mut walks: Vec<Walk>, of_time: usize, of_all: usize) -> Vec<Walk> {
        walks.sort_by(|one, other| one.price.total_cmp(&other.price));
        let mut left: Vec<Walk> = Vec::new();
        let mut more = 0;
        for walk in walks {
            let near = |other: &Walk| self.distance(&walk.place, &other.place) < NEIGHBOURS;
            if left.iter().any(near) {
                continue;
            }
            if left.iter().filter(|other| other.time == walk.time).count() < of_time {
                left.push(walk);
            } else if more < of_all {
                more += 1;
                left.push(walk);
            }
        }
        left
    }

    /// Goes some steps of a walk by chance: wherever it is better, in strides that grow with success and shrink without.
    fn walk(&mut self, walk: &mut Walk, steps: usize) {
        let [longer, shorter] = STRIDES;
        for _ in 0..steps {
            let [[one, two], [three, four]] = [walk.draws.normals(), walk.draws.normals()];
            let mut at = walk.place.at;
            for (at, by) in at.iter_mut().zip([one, two, three, four]).take(self.unknowns) {
                *at += by * walk.stride;
            }
            let next = self.place(at);
            let next = next.map(|next| (log_price(&next, DEAR), next));
            if let Some((price, next)) = next.filter(|(price, _)| *price < walk.price) {
                (walk.place, walk.price) = (next, price);
                walk.stride = (walk.stride * longer).min(STRIDE);
            } else {
                walk.stride *= shorter;
            }
        }
    }

    /// How far two places are from each other, as a logarithm.
    fn distance(&self, one: &Place, other: &Place) -> f64 {
        let pairs = one.at.iter().zip(&other.at).take(self.unknowns);
        pairs.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
    }

    /// The best of some places that are apart.
    fn apart(&self, mut places: Vec<Place>) -> Vec<Place> {
        let mut chosen: Vec<Place> = Vec::new();
        for cost in COSTS {
            places.sort_by(|one, other| log_price(one, cost).total_cmp(&log_price(other, cost)));
            let mut more = 0;
            for place in &places {
                let near = |other: &Place| self.distance(place, other) < APART;
                if !chosen.iter().any(near) {
                    chosen.push(place.clone());
                    more += 1;
                }
                if more == PLACES {
                    break;
                }
            }
        }
        chosen
    }

    /// Places beside a ramp that no walk reaches: slower ones, and those of which one value is another one by far.
    fn beside(&self, ramp: &RampIn) -> Result<Vec<Values>, RampError> {
        let [reached, ..] = self.problem.way(values(ramp))?.reached();
        let reached = reached.min(ramp.velocity_difference);
        let at = values(ramp).map(f64::ln);
        let [_, up, down, jerk] = at;
        let mut beside: Vec<_> =
            SLOWER.iter().map(|part| [(reached * part).ln(), up, down, jerk]).collect();
        for index in 0..self.unknowns {
            for by in [-OTHER, OTHER] {
                let mut at = at;
                if let Some(at) = at.get_mut(index) {
                    *at += by;
                }
                beside.push(at);
            }
        }
        Ok(beside)
    }

    /// A ramp; none if its values make none.
    pub(super) fn place(&mut self, mut at: Values) -> Option<Place> {
        for (at, most) in at.iter_mut().zip(self.problem.most_values()) {
            *at = at.min(most);
        }
        let mut values = at.map(f64::exp);
        let jerk = self.problem.wish.limits.jerk;
        values[0] = values[0].min(self.problem.most);
        values[3] = if self.problem.limited() { values[3].min(jerk) } else { jerk };
        let course = self.problem.course(values).ok()?;
        let ramp = course.ramp;
        let aim = self.aim.of(&ramp);
        let better = self.best.is_none_or(|(best, _)| aim < best);
        if better && ramp.duration_s <= self.aim.within_s && self.problem.keeps(&ramp) {
            self.best = Some((aim, ramp));
        }
        let place = self.judge.place(at, &course);
        place.aim.is_finite().then_some(place)
    }
}

/// What a place costs among others of any size.
fn log_price(place: &Place, dear: f64) -> f64 {
    place.aim.ln() + dear * place.excess.ln_1p()
}
