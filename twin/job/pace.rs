//! How fast the time of a job passes: the override, and stops on the way.
//!
//! Cams and gears hold between axes at every time of the job. So the override changes how fast that time passes for all of
//! them together: velocities by the factor, accelerations by its square. It changes as fast as the acceleration of every axis
//! allows.

use super::engine::State;

/// A factor this much above what it shall be counts as that.
const SAME: f64 = 1e-9;

/// Cycles in which the factor goes from 1 to 0 at the latest, also where an axis would rather not.
const LONGEST_STOP: f64 = 5000.0;

/// Time of the job in cycles, as fast as it passes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// Cycles of the job in a cycle.
    rate: f64,
    wanted: f64,
    /// Between two set-points of the job, 0 to 1.
    phase: f64,
}

impl Pace {
    /// From the beginning with this factor; more than 1 is 1.
    pub(super) fn new(factor: f64) -> Self {
        let rate = factor.clamp(0.0, 1.0);
        Self { rate, wanted: rate, phase: 0.0 }
    }

    /// Wants another factor; more than 1 is 1.
    pub(super) fn want(&mut self, factor: f64) {
        self.wanted = factor.clamp(0.0, 1.0);
    }

    /// Whether time passes as it shall.
    pub(super) fn is_as_wanted(&self) -> bool {
        (self.rate - self.wanted).abs() <= SAME
    }

    /// Whether it stands still, and shall.
    pub(super) fn stands(&self) -> bool {
        self.rate <= 0.0 && self.wanted <= 0.0
    }

    /// A cycle on, with axes that move like `states`, each with its largest acceleration. The number of cycles that the job
    /// has to go on.
    pub(super) fn advance(
        &mut self,
        states: impl Iterator<Item = (State, f64)>,
        cycle: f64,
    ) -> u32 {
        let before = self.rate;
        let change = self.wanted - before;
        self.rate = if change.abs() <= SAME {
            self.wanted
        } else {
            (before + self.bearable(change, states, cycle)).clamp(0.0, 1.0)
        };
        self.phase += f64::midpoint(before, self.rate);
        // Rounding does not make a cycle of its own.
        if self.phase >= 1.0 - SAME {
            self.phase = (self.phase - 1.0).max(0.0);
            if self.phase <= SAME {
                self.phase = 0.0;
            }
            1
        } else {
            0
        }
    }

    /// The part of `change` that every axis bears in a cycle (s).
    fn bearable(&self, change: f64, states: impl Iterator<Item = (State, f64)>, cycle: f64) -> f64 {
        let mut least = f64::INFINITY;
        for (State { velocity, acceleration, .. }, most) in states {
            // a·r² + v·dr/dt is to stay within the limit.
            let own = acceleration * self.rate * self.rate;
            let push = velocity * change.signum();
            let room = if push > 0.0 { most - own } else { most + own };
            if push != 0.0 {
                least = least.min((room / push.abs()).max(0.0) * cycle);
            }
        }
        let slowest = if change < 0.0 { LONGEST_STOP.recip() } else { 0.0 };
        change.signum() * least.max(slowest).min(change.abs())
    }

    /// How an axis moves between two set-points of the job, `cycle` (s) apart; `before` is the factor a cycle ago.
    pub(super) fn between(&self, from: State, to: State, before: f64, cycle: f64) -> State {
        let at = if self.phase == 0.0 { from } else { between(from, to, self.phase, cycle) };
        State {
            position: at.position,
            velocity: at.velocity * self.rate,
            acceleration: at.acceleration * self.rate * self.rate
                + at.velocity * (self.rate - before) / cycle,
        }
    }

    /// How fast time passes.
    pub(super) fn rate(&self) -> f64 {
        self.rate
    }
}

/// Between two states `cycle` (s) apart, at the part `phase` of the way: the position on the cubic polynomial through both, velocity
/// and acceleration on straight lines, so that they exceed nothing where the acceleration steps.
fn between(from: State, to: State, phase: f64, cycle: f64) -> State {
    let [v0, v1] = [from, to].map(|it| it.velocity * cycle);
    let way = to.position - from.position;
    let (square, cube) = (3.0 * way - 2.0 * v0 - v1, v0 + v1 - 2.0 * way);
    let line = |from: f64, to: f64| from + phase * (to - from);
    State {
        position: from.position + phase * (v0 + phase * (square + phase * cube)),
        velocity: line(from.velocity, to.velocity),
        acceleration: line(from.acceleration, to.acceleration),
    }
}
