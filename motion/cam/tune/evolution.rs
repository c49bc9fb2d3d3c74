//! Differential evolution: the least value of a function that is neither smooth nor convex.
//!
//! Storn and Price, Journal of Global Optimization 11, 1997, with a difference factor drawn anew for each trial. The differences within
//! the population follow the shape of a valley, so corners between limits are found to the last digits. A crowded population stays
//! in all its valleys: a trial begins at its own place and replaces the nearest one (Thomsen, Congress on Evolutionary
//! Computation, 2004). The random numbers are the same in every run.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};

/// Share of the values that a trial takes from the mutant.
const CROSSED: f64 = 0.9;
/// Range of the difference factor.
const FACTOR: [f64; 2] = [0.4, 1.0];
/// Share of trials that begin at the best place instead of a random one.
const FROM_BEST: f64 = 0.3;

/// A score and its place.
type Scored<const N: usize> = (f64, [f64; N]);
pub(super) type Population<const N: usize> = Vec<Scored<N>>;

/// How a population evolves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evolution<const N: usize> {
    /// Values that change; the others stay as they are.
    pub(super) free: [bool; N],
    pub(super) generations: usize,
    pub(super) crowded: bool,
    /// Of the random numbers.
    pub(super) stream: u64,
}

/// Evolves a population and sorts it. `score` may move a place into its range.
pub(super) fn evolve<const N: usize>(
    mut all: Population<N>,
    by: Evolution<N>,
    score: &mut dyn FnMut(&mut [f64; N]) -> f64,
) -> Population<N> {
    let Evolution { free, generations, crowded, stream } = by;
    let mut random = ChaCha8Rng::seed_from_u64(stream);
    let count = all.len();
    let (Ok(share), Ok(factor), Ok(member), Ok(index)) = (
        Uniform::new(0.0, 1.0),
        Uniform::new(FACTOR[0], FACTOR[1]),
        Uniform::new(0, count),
        Uniform::new(0, N),
    ) else {
        return all;
    };
    let least = |all: &Population<N>, of: &dyn Fn(&Scored<N>) -> f64| {
        (0..count).min_by(|one, other| of(&all[*one]).total_cmp(&of(&all[*other])))
    };
    for _ in 0..generations {
        for target in 0..count {
            let [mut base, one, other] = [(); 3].map(|()| member.sample(&mut random));
            if crowded {
                base = target;
            } else if share.sample(&mut random) < FROM_BEST {
                base = least(&all, &|place| place.0).unwrap_or(base);
            }
            let by: f64 = factor.sample(&mut random);
            let taken = index.sample(&mut random);
            let [base, one, other] = [base, one, other].map(|index| all[index].1);
            let mut trial = all[target].1;
            for index in 0..N {
                let crosses = share.sample(&mut random) < CROSSED || index == taken;
                if free[index] && crosses {
                    trial[index] = base[index] + by * (one[index] - other[index]);
                }
            }
            let found = score(&mut trial);
            let far = |place: &Scored<N>| {
                let pairs = trial.iter().zip(&place.1).zip(free).filter(|(_, free)| *free);
                pairs.map(|((one, other), _)| (one - other).powi(2)).sum::<f64>()
            };
            let replaced = if crowded { least(&all, &far).unwrap_or(target) } else { target };
            if found < all[replaced].0 {
                all[replaced] = (found, trial);
            }
        }
    }
    all.sort_by(|one, other| one.0.total_cmp(&other.0));
    all
}
