//! Search for the best ramp: differential evolution of ramps of all kinds and times.
//!
//! Where the cam moves meanwhile there are several valleys, and the best ramp mostly lies in a corner where two or three limits hold
//! at once. The ramps of each time evolve first, crowded; then places around the best ones that are apart, and around the best of
//! all. Nothing is taken but what keeps the limits by its exact peaks.
//!
//! A ramp over D in T s has velocities of the order of D/T, accelerations of D/T² and jerks of D/T³. Its kind says the rest: how
//! lopsided it is, how soon it reaches its accelerations, and which part of its velocity it may have. The accelerations with which
//! it takes T s are found by bisection.

use super::super::evolution::{Evolution, Population, evolve};
use super::NOTHING;
use super::problem::{Problem, ROUNDING, Values, values};
use super::wish::{RampError, RampIn};
use crate::{Quantity, SlaveLimits};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::LN_2;

/// Growth of the velocity against its fall, as powers of 2; jerk by velocity, as a part of the square of the acceleration; parts of
/// the velocity that is reached without a limit.
const LOPSIDED: [f64; 9] = [-10.0, -5.0, -2.5, -1.0, 0.0, 1.0, 2.5, 5.0, 10.0];
const SUDDEN: [f64; 4] = [0.7, 1.5, 4.0, 20.0];
const SLOWER: [f64; 6] = [1.0, 0.9, 0.75, 0.6, 0.45, 0.25];
/// The logarithm of an acceleration lies within this.
const BRACKET: f64 = 12.0;
const HALVINGS: u32 = 14;
/// As good as no limit of the velocity, in its own unit.
const UNLIMITED: f64 = 1e6;
/// The cost of an excess in a walk: more than any limit is worth.
const DEAR: f64 = 20.0;
/// How many ramps of a time are evolved: the best ones with each of these costs of an excess. The cheap ones come near to corners, the
/// dear ones keep limits.
const ISLAND: usize = 36;
const COSTS: [f64; 3] = [0.5, 3.0, 30.0];
/// Values may leave the box of those that are evolved by this much, as a logarithm.
const ROOM: f64 = 1.0;
/// Generations of the ramps of a time, how many of them go on, and of all of them. Alike are ramps whose duration and peaks differ by
/// less, as logarithms.
const GENERATIONS: usize = 20;
const OF_EACH: usize = 4;
const LEFT: usize = 24;
const ALIKE: f64 = 0.05;
/// Stride of places around those that go on, and those around the best ramp one after the other, as logarithms; how many places, and
/// for how many generations.
const NEIGHBOURS: f64 = 0.2;
const AGAIN: [f64; 8] = [1.0, 0.05, 5e-3, 5e-4, 0.5, 0.2, 0.02, 2e-4];
const AROUND: usize = 20;
const AGAIN_GENERATIONS: usize = 70;
/// Of the values this part is what the search left over.
const NEAT: f64 = 1e-7;
/// Jerks of the axis that are tried, each 5 % less than the one before.
const ROW: i32 = 400;
/// More velocity by this part than without a limit is reached costs next to nothing.
const HAIR: f64 = 1e-4;

/// What a ramp is compared by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    /// The peak that is to be small; the duration if none.
    pub(super) least: Option<Quantity>,
    /// It takes so long at most, s.
    pub(super) within_s: f64,
}

impl Aim {
    pub(super) fn of(&self, ramp: &RampIn) -> f64 {
        self.least.map_or(ramp.duration_s, |least| ramp.peak(least))
    }
}

/// Logarithms of a ramp's values, its objective, and by how much it exceeds limits.
#[derive(Clone, Copy, Debug)]
struct Place {
    at: Values,
    aim: f64,
    excess: f64,
    /// Logarithms of its duration and its peaks.
    done: [f64; 4],
}

impl Place {
    fn price(&self, dear: f64) -> f64 {
        self.aim.ln() + dear * self.excess.ln_1p()
    }
}

/// A search, and the best ramp so far.
#[derive(Debug)]
pub(super) struct Search<'a> {
    problem: &'a Problem<'a>,
    aim: Aim,
    begun: Vec<Vec<Place>>,
    best: Option<(f64, RampIn)>,
    /// Of the random numbers.
    stream: u64,
}

impl<'a> Search<'a> {
    pub(super) fn new(problem: &'a Problem<'a>, aim: Aim) -> Self {
        Self { problem, aim, begun: Vec::new(), best: None, stream: 0 }
    }

    pub(super) fn best(&self) -> Option<RampIn> {
        self.best.map(|(_, ramp)| ramp)
    }

    /// Begins with a ramp that is known.
    pub(super) fn begin_with(&mut self, ramp: &RampIn) {
        let place = self.place(values(ramp).map(f64::ln));
        self.begun.push(place.into_iter().collect());
    }

    /// Begins with ramps of a time.
    pub(super) fn sow(&mut self, time: f64) {
        let seeds = self.problem.seeds(time);
        let mut places: Vec<_> = seeds.into_iter().filter_map(|at| self.place(at)).collect();
        let mut island = Vec::new();
        for cost in COSTS {
            places.sort_by(|one, other| one.price(cost).total_cmp(&other.price(cost)));
            island.extend(places.drain(..places.len().min(ISLAND / COSTS.len())));
        }
        self.begun.push(island);
    }

    /// Evolves the ramps of each time, places around the best of them that are apart, and around the best of all.
    pub(super) fn run(&mut self) {
        let mut evolved: Vec<(f64, usize, Values)> = Vec::new();
        for (time, island) in std::mem::take(&mut self.begun).into_iter().enumerate() {
            let island = island.iter().map(|place| (place.price(DEAR), place.at)).collect();
            let island = self.evolved(island, GENERATIONS, true);
            evolved.extend(island.into_iter().map(|(price, at)| (price, time, at)));
        }
        evolved.sort_by(|one, other| one.0.total_cmp(&other.0));
        // Values that hold nothing do not make a ramp another one.
        let mut left: Vec<(usize, Values, [f64; 4])> = Vec::new();
        for (_, time, at) in evolved {
            let Some(place) = self.place(at).filter(|_| left.len() < LEFT) else { continue };
            let near = |other: &(usize, Values, [f64; 4])| {
                place.done.iter().zip(other.2).all(|(one, other)| (one - other).abs() < ALIKE)
            };
            let of_time = left.iter().filter(|other| other.0 == time).count();
            if of_time < OF_EACH && !left.iter().any(near) {
                left.push((time, at, place.done));
            }
        }
        for (_, at, _) in left {
            self.around(at, NEIGHBOURS);
        }
        for stride in AGAIN {
            if let Some((_, ramp)) = self.best {
                self.around(values(&ramp).map(f64::ln), stride);
            }
        }
    }

    /// Evolves places around one.
    fn around(&mut self, at: Values, stride: f64) {
        self.stream += 1;
        let mut random = ChaCha8Rng::seed_from_u64(self.stream);
        let mut all = Population::new();
        for index in 0..AROUND {
            let stride = if index == 0 { 0.0 } else { stride };
            let by = [(); 4].map(|()| -> f64 { StandardNormal.sample(&mut random) });
            let at = std::array::from_fn(|index| at[index] + stride * by[index]);
            all.extend(self.place(at).map(|place| (place.price(DEAR), place.at)));
        }
        self.evolved(all, AGAIN_GENERATIONS, false);
    }

    /// Evolves places within the box around them; values that hold nothing would drift away.
    fn evolved(&mut self, all: Population<4>, generations: usize, crowded: bool) -> Population<4> {
        let free = [true, true, true, self.problem.limited()];
        let end = |index: usize, sign: f64| {
            let all = all.iter().map(|(_, at)| sign * at[index]);
            sign * (all.fold(f64::NEG_INFINITY, f64::max) + ROOM)
        };
        let ends: [[f64; 2]; 4] = std::array::from_fn(|index| [end(index, -1.0), end(index, 1.0)]);
        let by = Evolution { free, generations, crowded, stream: self.stream };
        evolve(all, by, &mut |at| {
            let within =
                std::array::from_fn(|index| at[index].clamp(ends[index][0], ends[index][1]));
            let Some(place) = self.place(within) else { return f64::INFINITY };
            *at = place.at;
            place.price(DEAR)
        })
    }

    /// A ramp of these logarithms, or next to them within what values may be; none if they make none.
    fn place(&mut self, at: Values) -> Option<Place> {
        let most = self.problem.most_values();
        let at: Values = std::array::from_fn(|index| at[index].min(most[index]));
        let mut values = at.map(f64::exp);
        let jerk = self.problem.wish.limits.jerk;
        values[0] = values[0].min(self.problem.most);
        values[3] = if self.problem.limited() { values[3].min(jerk) } else { jerk };
        let ramp = self.problem.ramp(values).ok()?;
        if ramp.duration_s <= NOTHING * self.problem.wish.cycle_s {
            return None;
        }
        let aim = self.aim.of(&ramp);
        let late = ramp.duration_s / self.aim.within_s - 1.0;
        let excess = self.problem.excess(&ramp).max(late);
        if excess <= ROUNDING && late <= 0.0 && self.best.is_none_or(|(best, _)| aim < best) {
            self.best = Some((aim, ramp));
        }
        let at = if self.problem.limited() { at } else { [at[0], at[1], at[2], f64::INFINITY] };
        let done = [ramp.duration_s, ramp.peak_velocity, ramp.peak_acceleration, ramp.peak_jerk];
        let done = done.map(f64::ln);
        aim.is_finite().then_some(Place { at, aim, excess: excess.max(0.0), done })
    }
}

impl Problem<'_> {
    /// Logarithms of the values of ramps that take a time, or a little less where their values may not be so small.
    fn seeds(&self, time: f64) -> Vec<Values> {
        let [distance, velocity, acceleration] = self.gap();
        let unit = distance / time + velocity + acceleration * time;
        let suddens: &[f64] = if self.limited() { &SUDDEN } else { &SUDDEN[..1] };
        let mut seeds = Vec::new();
        for lopsided in LOPSIDED.map(|power| power * LN_2 / 2.0) {
            for sudden in suddens.iter().map(|sudden| sudden.ln()) {
                let kind = [lopsided, sudden];
                let Some(free) = self.timed([time, unit], kind, unit * UNLIMITED) else { continue };
                let Ok(way) = self.way(free.map(f64::exp)) else { continue };
                let fastest = way.fastest();
                let slower = |part| self.timed([time, unit], kind, part * fastest);
                seeds.extend(SLOWER.iter().filter_map(slower));
            }
        }
        seeds
    }

    /// The ramp of a kind that takes a time.
    fn timed(
        &self,
        [time, unit]: [f64; 2],
        [lopsided, sudden]: [f64; 2],
        velocity: f64,
    ) -> Option<Values> {
        let pull = (unit / time).ln();
        let most = self.most_values();
        let with = |by: f64| {
            let pull = pull + by;
            let jerk = sudden + 2.0 * pull - unit.ln();
            let all = [velocity.ln(), pull + lopsided, pull - lopsided, jerk];
            std::array::from_fn(|index| all[index].min(most[index]))
        };
        let in_time = |by: f64| {
            let way = self.way(with(by).map(f64::exp));
            way.is_ok_and(|way| way.duration() <= time)
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

    /// The same ramp with values that ask for no more than it needs, and with few digits.
    pub(super) fn settled(&self, mut ramp: RampIn, aim: &Aim) -> Result<RampIn, RampError> {
        let within = |tried: &RampIn| self.keeps(tried) && tried.duration_s <= aim.within_s;
        let same = |one: f64, other: f64| one <= other * (1.0 + NEAT);
        let as_good = |tried: &RampIn, known: &RampIn| {
            within(tried)
                && same(tried.duration_s, known.duration_s)
                && Quantity::ALL.into_iter().all(|of| same(tried.peak(of), known.peak(of)))
        };
        let SlaveLimits { acceleration, jerk, .. } = self.wish.limits;
        let [velocity, up, down, own] = values(&ramp);
        let softer = self.ramp([velocity, up.min(acceleration), down.min(acceleration), own])?;
        if as_good(&softer, &ramp) {
            ramp = softer;
        }
        let [velocity, up, down, own] = values(&ramp);
        if self.limited() && aim.least == Some(Quantity::Jerk) {
            // The least jerk of the axis that is enough: of a geometric row first, as more need not be enough.
            let peak = ramp.peak_jerk;
            let mut enough = |part: f64| {
                let tried = self.ramp([velocity, up, down, own * part]);
                let tried = tried.ok().filter(|tried| within(tried) && same(tried.peak_jerk, peak));
                ramp = tried.unwrap_or(ramp);
                tried.is_some()
            };
            let row = (0..ROW).rev().map(|power| 0.95_f64.powi(power));
            if let Some(mut high) = row.into_iter().find(|part| enough(*part)) {
                let mut low = 0.95 * high;
                for _ in 0..30 {
                    let middle = f64::midpoint(low, high);
                    if enough(middle) { high = middle } else { low = middle }
                }
            }
        } else if self.limited() {
            let tried = self.ramp([velocity, up, down, jerk])?;
            if within(&tried) && same(aim.of(&tried), aim.of(&ramp)) {
                ramp = tried;
            }
        }
        // Without a velocity limit a hair below the reached velocity, and with the reached one.
        let [velocity, up, down, own] = values(&ramp);
        let free = self.ramp([(velocity * (1.0 + HAIR)).min(self.most), up, down, own])?;
        let fastest = self.way(values(&free))?.fastest();
        if within(&free) && fastest < free.velocity_difference && same(aim.of(&free), aim.of(&ramp))
        {
            ramp = free;
        }
        let known = ramp;
        let fastest = self.way(values(&known))?.fastest();
        let mut tries = vec![(0, fastest.min(known.velocity_difference))];
        tries.extend((0..3).flat_map(|index| {
            let value = values(&known)[index];
            (1..9).rev().map(move |digits| (index, rounded(value, digits, index == 0)))
        }));
        for (index, value) in tries.into_iter().filter(|(_, value)| *value > 0.0) {
            let mut tried = values(&ramp);
            tried[index] = value;
            let tried = self.ramp(tried)?;
            if as_good(&tried, &known) {
                ramp = tried;
            }
        }
        Ok(ramp)
    }
}

/// The nearest number with these digits behind the first one, or the next one that is not less.
fn rounded(value: f64, digits: usize, up: bool) -> f64 {
    let short = |value: f64| -> f64 { format!("{value:.digits$e}").parse().unwrap_or(value) };
    let nearest = short(value);
    #[expect(clippy::cast_precision_loss, reason = "a few digits")]
    let last = 10.0_f64.powf(value.log10().floor() - digits as f64);
    if up && nearest < value { short(nearest + last) } else { nearest }
}
