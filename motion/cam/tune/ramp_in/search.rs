//! Search for the best ramp: one seeded differential evolution over the logarithms of a ramp's values.
//!
//! Where the cam moves meanwhile there are several valleys, and the best ramp mostly lies in a corner where two or three limits hold
//! at once. Ramps of all times and kinds are scattered first and evolve crowded; then places around the best ones that are apart, and
//! around the best of all. Nothing is taken but what keeps the limits by its exact peaks.
//!
//! A ramp over D in T s has velocities of the order of D/T, accelerations of D/T² and jerks of D/T³: ramps of a time are scattered
//! around these.

use super::super::evolution::{Evolution, Population, evolve};
use super::problem::{Problem, ROUNDING, Values, values};
use super::wish::{RampError, RampIn};
use super::{LONGEST_S, NOTHING};
use crate::Quantity;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, Uniform};

/// Ramps that are scattered, how many of them are evolved for each of these costs of an excess, and for how many generations. The
/// cheap ones come near to corners, the dear ones keep limits.
const SCATTERED: usize = 1000;
const COSTS: [f64; 3] = [0.5, 3.0, 30.0];
const OF_EACH: usize = 30;
const GENERATIONS: usize = 30;
/// Around their order of magnitude values are scattered by this standard deviation, as a logarithm.
const SCATTER: f64 = 1.5;
/// The cost of an excess in a walk: more than any limit is worth.
const DEAR: f64 = 20.0;
/// Values may leave the box of those that are evolved by this much, as a logarithm.
const ROOM: f64 = 1.0;
/// How many ramps go on. Alike are ramps whose duration and peaks differ by less, as logarithms.
const LEFT: usize = 12;
const ALIKE: f64 = 0.05;
/// Stride of places around those that go on, and those around the best ramp one after the other, as logarithms; how many places, and
/// for how many generations.
const NEIGHBOURS: f64 = 0.2;
const AGAIN: [f64; 6] = [1.0, 0.05, 5e-3, 0.2, 0.02, 2e-4];
const AROUND: usize = 20;
const AGAIN_GENERATIONS: usize = 70;
/// Of the values this part is what the search left over.
const NEAT: f64 = 1e-7;

/// What a ramp is compared by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    /// The peak that is to be small; the duration if none.
    pub(super) least: Option<Quantity>,
    /// It takes so long at most, s.
    pub(super) within_s: f64,
}

impl Aim {
    pub(super) const SOONEST: Self = Self { least: None, within_s: f64::INFINITY };

    fn of(&self, ramp: &RampIn) -> f64 {
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
struct Search<'a> {
    problem: &'a Problem<'a>,
    aim: Aim,
    best: Option<(f64, RampIn)>,
    random: ChaCha8Rng,
    /// Of the random numbers of an evolution.
    stream: u64,
}

impl Search<'_> {
    /// The best of the scattered ramps, for each cost of an excess.
    fn scattered(&mut self) -> Vec<Place> {
        let ([distance, velocity, acceleration], limited) =
            (self.problem.gap(), self.problem.limited());
        let within_s = if self.aim.within_s.is_finite() { self.aim.within_s } else { LONGEST_S };
        let low = self.problem.least_time().max(self.problem.wish.cycle_s);
        let range = (within_s.max(low) / low).ln();
        let Ok(share) = Uniform::new(0.0, 1.0) else { return Vec::new() };
        let mut places = Vec::new();
        for _ in 0..SCATTERED {
            let u: f64 = share.sample(&mut self.random);
            // The soonest ramp is rather short, the gentlest one rather long.
            let late = if self.aim.least.is_none() { u * u } else { 1.0 - u * u };
            let time = low * (range * late).exp();
            let unit = distance / time + velocity + acceleration * time;
            let mut near = |value: f64| -> f64 {
                let by: f64 = StandardNormal.sample(&mut self.random);
                value.ln() + 0.7 + SCATTER * by
            };
            let (v, up, down) = (near(unit), near(unit / time), near(unit / time));
            let jerk = if limited { near(unit / (time * time)) + 1.0 } else { f64::INFINITY };
            places.extend(self.place([v, up, down, jerk]));
        }
        let mut crowd = Vec::new();
        for cost in COSTS {
            places.sort_by(|one, other| one.price(cost).total_cmp(&other.price(cost)));
            crowd.extend(places.drain(..places.len().min(OF_EACH)));
        }
        crowd
    }

    fn run(&mut self) {
        let crowd = self.scattered();
        let crowd = crowd.iter().map(|place| (place.price(DEAR), place.at)).collect();
        // Values that hold nothing do not make a ramp another one.
        let mut left: Vec<Place> = Vec::new();
        for (_, at) in self.evolved(crowd, GENERATIONS, true) {
            let Some(place) = self.place(at).filter(|_| left.len() < LEFT) else { continue };
            let near = |other: &Place| {
                let pairs = place.done.iter().zip(other.done);
                pairs.into_iter().all(|(one, other)| (one - other).abs() < ALIKE)
            };
            if !left.iter().any(near) {
                left.push(place);
            }
        }
        for place in left {
            self.around(place.at, NEIGHBOURS);
        }
        for stride in AGAIN {
            if let Some((_, ramp)) = self.best {
                self.around(values(&ramp).map(f64::ln), stride);
            }
        }
    }

    /// Evolves places around one.
    fn around(&mut self, at: Values, stride: f64) {
        let mut all = Population::new();
        for index in 0..AROUND {
            let stride = if index == 0 { 0.0 } else { stride };
            let by = [(); 4].map(|()| -> f64 { StandardNormal.sample(&mut self.random) });
            let at = std::array::from_fn(|index| at[index] + stride * by[index]);
            all.extend(self.place(at).map(|place| (place.price(DEAR), place.at)));
        }
        self.evolved(all, AGAIN_GENERATIONS, false);
    }

    /// Evolves places within the box around them; values that hold nothing would drift away.
    fn evolved(&mut self, all: Population<4>, generations: usize, crowded: bool) -> Population<4> {
        self.stream += 1;
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
    /// The best ramp that keeps the limits; none if no ramp that was tried does.
    pub(super) fn best(&self, aim: Aim) -> Option<RampIn> {
        let random = ChaCha8Rng::seed_from_u64(0);
        let mut search = Search { problem: self, aim, best: None, random, stream: 0 };
        search.run();
        search.best.map(|(_, ramp)| ramp)
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
        let limits = self.wish.limits;
        if self.limited() && aim.least == Some(Quantity::Jerk) {
            // The least jerk of the axis that is enough.
            let [velocity, up, down, own] = values(&ramp);
            let (mut low, mut high, peak) = (0.0, 1.0, ramp.peak_jerk);
            for _ in 0..40 {
                let middle = f64::midpoint(low, high);
                let tried = self.ramp([velocity, up, down, own * middle]).ok();
                match tried.filter(|tried| within(tried) && same(tried.peak_jerk, peak)) {
                    Some(tried) => (ramp, high) = (tried, middle),
                    None => low = middle,
                }
            }
        } else if self.limited() {
            let [velocity, up, down, _] = values(&ramp);
            let tried = self.ramp([velocity, up, down, limits.jerk])?;
            if within(&tried) && same(aim.of(&tried), aim.of(&ramp)) {
                ramp = tried;
            }
        }
        let (known, [velocity, up, down, _]) = (ramp, values(&ramp));
        let fastest = self.way(values(&known))?.fastest().min(velocity);
        let [up, down] = [up, down].map(|value| value.min(limits.acceleration));
        let mut tries = vec![(0, fastest), (1, up), (2, down)];
        tries.extend([velocity, up, down].into_iter().enumerate().flat_map(|(index, value)| {
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
