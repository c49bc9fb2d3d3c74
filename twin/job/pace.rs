//! Time scaling of a job: override and feed hold.
//!
//! Cams and gears must hold between axes at every time of the job. The override therefore scales the time of all axes
//! together: velocities by the factor, accelerations by its square. It changes as fast as the acceleration and jerk of
//! every axis allow.

use super::engine::State;

/// Tolerance of the factor.
const SAME: f64 = 1e-9;

/// Time for which axes at their own deceleration limit may forbid a slower pace, s.
const PATIENCE: f64 = 0.5;

/// Time of the factor from 1 to 0 then, s.
const LONGEST_STOP: f64 = 5.0;

/// Limits of an axis for the change of pace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bears {
    /// u/s².
    pub(super) acceleration: f64,
    /// u/s³; infinite without a limit.
    pub(super) jerk: f64,
}

/// Time of the job in cycles, as fast as it passes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// Cycles of the job in a cycle.
    rate: f64,
    /// Its change per s.
    slope: f64,
    wanted: f64,
    /// Time for which a slower pace has been forbidden, s.
    forbidden: f64,
    /// Between two set-points of the job, 0 to 1.
    phase: f64,
}

impl Pace {
    /// From the beginning with this factor; more than 1 is 1.
    pub(super) fn new(factor: f64) -> Self {
        let rate = factor.clamp(0.0, 1.0);
        Self { rate, slope: 0.0, wanted: rate, forbidden: 0.0, phase: 0.0 }
    }

    /// Wants another factor; more than 1 is 1.
    pub(super) fn want(&mut self, factor: f64) {
        self.wanted = factor.clamp(0.0, 1.0);
    }

    /// True if time passes at the requested rate.
    pub(super) fn is_as_wanted(&self) -> bool {
        (self.rate - self.wanted).abs() <= SAME
    }

    /// True if time is stopped, as requested.
    pub(super) fn stands(&self) -> bool {
        self.rate <= 0.0 && self.wanted <= 0.0
    }

    /// Goes on by a `cycle` (s); `states` are the axes at the set-points around now. Returns the number of cycles of the job.
    pub(super) fn advance(
        &mut self,
        states: impl Iterator<Item = (State, Bears)>,
        cycle: f64,
    ) -> u32 {
        let before = self.rate;
        let change = self.wanted - before;
        if change.abs() <= SAME {
            (self.rate, self.slope) = (self.wanted, 0.0);
        } else {
            self.slope = self.bearable(change, states, cycle);
            self.rate = before + self.slope * cycle;
            self.forbidden = if self.slope == 0.0 { self.forbidden + cycle } else { 0.0 };
            let reached = (self.wanted - self.rate) * change <= 0.0;
            if reached {
                (self.rate, self.slope) = (self.wanted, 0.0);
            }
        }
        self.phase += f64::midpoint(before, self.rate);
        // Rounding does not add a cycle.
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

    /// The change of the rate per s that every axis bears.
    fn bearable(
        &self,
        change: f64,
        states: impl Iterator<Item = (State, Bears)>,
        cycle: f64,
    ) -> f64 {
        let (mut most, mut bend) = (f64::INFINITY, f64::INFINITY);
        for (state, bears) in states.filter(|(state, _)| state.velocity != 0.0) {
            most = most.min(self.room(state, bears, change, cycle));
            // v·d²r/dt² is to stay within the jerk.
            bend = bend.min(bears.jerk / state.velocity.abs());
        }
        let insists = change < 0.0 && self.forbidden > PATIENCE;
        let slowest = if insists { LONGEST_STOP.recip() } else { 0.0 };
        // Slow enough to end level at the requested rate.
        let level = if bend.is_finite() {
            bend * ((0.25 * cycle * cycle + 2.0 * change.abs() / bend).sqrt() - 0.5 * cycle)
        } else {
            f64::INFINITY
        };
        let along = self.slope * change.signum();
        let speed = (along + bend * cycle).max(0.0).min(level).min(most).max(slowest);
        change.signum() * speed.min(change.abs() / cycle)
    }

    /// Largest change of the rate in the direction of `change`, per s, with a·r² + v·dr/dt of an axis within its limit.
    fn room(&self, state: State, bears: Bears, change: f64, cycle: f64) -> f64 {
        let push = state.velocity * change.signum();
        let at = |rate: f64| {
            let own = state.acceleration * rate * rate * push.signum();
            ((bears.acceleration - own) / push.abs()).max(0.0)
        };
        // A bound of the rate at the end of the cycle.
        let end = (self.rate + change.signum() * at(self.rate) * cycle).clamp(0.0, 1.0);
        at(self.rate).min(at(end))
    }

    /// State of an axis between two set-points of the job, `cycle` (s) apart; `before` is the factor a cycle ago.
    pub(super) fn between(&self, from: State, to: State, before: f64, cycle: f64) -> State {
        let at = if self.phase == 0.0 { from } else { between(from, to, self.phase, cycle) };
        State {
            position: at.position,
            velocity: at.velocity * self.rate,
            acceleration: at.acceleration * self.rate * self.rate
                + at.velocity * (self.rate - before) / cycle,
        }
    }

    /// Phase between two set-points of the job, 0 to 1.
    pub(super) fn phase(&self) -> f64 {
        self.phase
    }

    /// Rate at which time passes.
    pub(super) fn rate(&self) -> f64 {
        self.rate
    }
}

/// State between two states `cycle` (s) apart: the position on the cubic through both, velocity and acceleration on straight
/// lines, so that they exceed neither where the acceleration steps.
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
