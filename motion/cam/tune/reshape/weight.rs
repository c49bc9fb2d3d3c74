//! What counts in a shape: sums of y′, y″ and y‴ as parts of limits.

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
    let pull = wish.master_acceleration;
    let square = velocity * velocity;
    // What the master's acceleration adds comes with both signs.
    let [alone, pulled] = match quantity {
        Quantity::Velocity => [[velocity, 0.0, 0.0], [0.0; 3]],
        Quantity::Acceleration => [[0.0, square, 0.0], [pull, 0.0, 0.0]],
        Quantity::Jerk => [[0.0, 0.0, square * velocity], [0.0, 3.0 * velocity * pull, 0.0]],
    };
    for sign in [1.0, -1.0] {
        let mut factors = [0.0; 3];
        for ((factor, alone), pulled) in factors.iter_mut().zip(alone).zip(pulled) {
            *factor = (alone + sign * pulled) / limit;
        }
        rows.push(Weight { factors, counts });
        if pull == 0.0 || quantity == Quantity::Velocity {
            break;
        }
    }
}
