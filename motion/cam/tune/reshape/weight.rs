//! Objective and constraints of a shape: weighted sums of y′, y″ and y‴, as fractions of their limits.

use super::super::super::bounds::Quantity;
use super::Wish;

/// A sum of y′, y″ and y‴ that is a part of a limit; it counts with both signs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weight {
    pub(super) factors: [f64; 3],
    /// Whether it is to be as small as possible; else it is to be 1 at most.
    pub(super) counts: bool,
}

/// All of them at a velocity of the master.
#[derive(Clone, Debug)]
pub(super) struct Weights {
    pub(super) rows: Vec<Weight>,
}

impl Weights {
    /// All limits count alike: the smaller the largest part of one, the faster the master may go.
    pub(super) fn fastest(wish: &Wish, velocity: f64) -> Self {
        let mut rows = Vec::new();
        for quantity in Quantity::ALL {
            add(&mut rows, wish, velocity, quantity, wish.limits.of(quantity), true);
        }
        Self { rows }
    }

    /// One quantity counts, as a part of its `size`.
    pub(super) fn gentlest(wish: &Wish, velocity: f64, quantity: Quantity, size: f64) -> Self {
        let mut rows = Vec::new();
        for other in Quantity::ALL {
            if other == quantity {
                add(&mut rows, wish, velocity, other, size, true);
            } else {
                add(&mut rows, wish, velocity, other, wish.limits.of(other), false);
            }
        }
        Self { rows }
    }
}

fn add(
    rows: &mut Vec<Weight>,
    wish: &Wish,
    velocity: f64,
    quantity: Quantity,
    limit: f64,
    counts: bool,
) {
    if !limit.is_finite() {
        return;
    }
    let (pull, jolt) = (wish.master_acceleration, wish.master_jerk);
    let square = velocity * velocity;
    // What the master's acceleration and jerk add comes with both signs, each for itself.
    let [alone, pulled, jolted] = match quantity {
        Quantity::Velocity => [[velocity, 0.0, 0.0], [0.0; 3], [0.0; 3]],
        Quantity::Acceleration => [[0.0, square, 0.0], [pull, 0.0, 0.0], [0.0; 3]],
        Quantity::Jerk => {
            [[0.0, 0.0, square * velocity], [0.0, 3.0 * velocity * pull, 0.0], [jolt, 0.0, 0.0]]
        }
    };
    let pulls = pull != 0.0 && quantity != Quantity::Velocity;
    let jolts = jolt != 0.0 && quantity == Quantity::Jerk;
    for of_pull in signs(pulls) {
        for of_jolt in signs(jolts) {
            let mut factors = [0.0; 3];
            for (((factor, alone), pulled), jolted) in
                factors.iter_mut().zip(alone).zip(pulled).zip(jolted)
            {
                *factor = (alone + of_pull * pulled + of_jolt * jolted) / limit;
            }
            rows.push(Weight { factors, counts });
        }
    }
}

/// Both signs, or one where there is nothing to have them.
fn signs(both: bool) -> impl Iterator<Item = f64> {
    [1.0, -1.0].into_iter().take(if both { 2 } else { 1 })
}
