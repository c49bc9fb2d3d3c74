//! The linear program that says where a better ramp is.

use super::super::linear_program::Program;
use super::place::{Judge, Place};
use super::problem::Values;

/// What a place costs: its aim as a part of `unit`, and its excess, each part of which costs `dear`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Price<'a> {
    pub(super) judge: &'a Judge,
    pub(super) unit: f64,
    pub(super) dear: f64,
}

/// How a place changes with its values.
#[derive(Debug)]
pub(super) struct Slopes {
    /// Of each part, by each of the values.
    pub(super) parts: Vec<Vec<f64>>,
    /// By how much each value may grow before it is not reached any more, and by how much more with each of the values.
    pub(super) reached: Vec<(f64, Vec<f64>)>,
    /// What the values are at most.
    pub(super) most: Values,
}

/// What a program says.
#[derive(Debug)]
pub(super) struct Step {
    /// By how much each value is to be changed.
    pub(super) by: Vec<f64>,
    /// What is gained.
    pub(super) gain: f64,
}

impl Price<'_> {
    pub(super) fn of(self, place: &Place) -> f64 {
        place.aim / self.unit + self.dear * place.excess
    }

    /// The cheapest place in a region if all parts are linear there.
    pub(super) fn program(self, place: &Place, slopes: &Slopes, region: f64) -> Option<Step> {
        let n = slopes.reached.len();
        let aim = place.aim / self.unit;
        // The unknowns are parts of the region, how much greater the aim is, and how large the excess, as parts of it as well.
        let mut costs = vec![0.0; n];
        costs.extend([1.0, self.dear]);
        let mut program = Program::new(costs);
        for (part, slopes) in place.parts.iter().zip(&slopes.parts) {
            let by = |factor: f64| slopes.iter().map(move |slope| slope * factor).enumerate();
            let far = slopes.iter().map(|slope| slope.abs()).sum::<f64>() * region;
            // What is not reached in the region holds nothing.
            if self.judge.aims(part) {
                let factor = 1.0 / self.unit;
                let below = aim - factor * part.value;
                if below < 2.0 * (far * factor + region) {
                    program.most(by(factor).chain([(n, -1.0)]), below / region);
                }
            }
            if let Some([factor, add]) = self.judge.exceeds(part) {
                let below = -factor * part.value - add;
                if below < 2.0 * far * factor {
                    program.most(by(factor).chain([(n + 1, -1.0)]), below / region);
                }
            }
        }
        program.most([(n + 1, -1.0)], 0.0);
        for (column, (room, by)) in slopes.reached.iter().enumerate() {
            let others = by.iter().map(|slope| -slope).enumerate();
            let row = others.map(|(other, by)| (other, if other == column { 1.0 } else { by }));
            if room.is_finite() {
                program.most(row, room / region);
            }
        }
        for (column, (at, most)) in place.at.iter().zip(slopes.most).take(n).enumerate() {
            program.most([(column, 1.0)], ((most - at) / region).clamp(0.0, 1.0));
            program.most([(column, -1.0)], 1.0);
        }
        let mut x = program.solved().ok()?;
        let (excess, more) = (x.pop()?, x.pop()?);
        let by: Vec<f64> = x.into_iter().map(|part| part.clamp(-1.0, 1.0) * region).collect();
        let cost = aim + region * more + self.dear * region * excess.max(0.0);
        Some(Step { by, gain: self.of(place) - cost })
    }
}
