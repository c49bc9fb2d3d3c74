//! What `MC_CamIn` should be given for a start with a ramp (`VelocityDiff`, `Acceleration`, `Deceleration`, manual 4.6.1
//! and 5.4): so that the slave is on its cam soonest, or comes onto it in a given time as gently as can be.
//!
//! The ramp is added to the cam, which goes on meanwhile, so both together have to keep the limits of the axis. While the
//! master moves evenly the cam's velocity and acceleration are polynomials of time and those of the ramp straight lines
//! piece by piece: what both together reach is found exactly.
//!
//! First the ramp gets what the cam leaves over on the way the master makes meanwhile. The quicker the ramp, the shorter
//! that way and the more is left over, so this is repeated. From the best of these each of the three values is changed as
//! long as that is better; whether it is, and keeps the limits, is always found exactly.

use super::super::bridge::Bridge;
use super::super::coupling::{AxisState, CamCoupling, CouplingError};
use super::super::curve::{Curve, CurveExtremes, Range};
use super::super::polynomial::{Coefficients, Extremes, extremes};
use super::super::selection::{CamInput, CamTable, StartMode};
use super::along::{along, extremes_along};
use crate::cam::SlaveLimits;
use crate::short::Short;

/// What a ramp is to be best in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RampGoal {
    /// The slave is on its cam as soon as its limits allow.
    Soonest,
    /// The largest acceleration of the slave until it is on its cam is as small as can be, and it is there in this time, s.
    Gentlest {
        /// s.
        within_s: f64,
    },
}

/// A start with a ramp.
#[derive(Clone, Debug)]
pub struct RampWish {
    /// The cam as `MC_CamTableSelect` gives it.
    pub table: CamTable,
    /// Inputs of `MC_CamIn`; what it says of a ramp does not count but for the direction of the start mode.
    pub input: CamInput,
    /// Where the master is at the start and how fast it goes on; its acceleration does not count.
    pub master: AxisState,
    /// Where the slave is at the start, and its velocity.
    pub slave: AxisState,
    /// What the slave may do; velocity and acceleration finite. Ramps have steps of acceleration: jerk does not count.
    pub limits: SlaveLimits,
    /// What the ramp is to be best in.
    pub goal: RampGoal,
}

/// A ramp, and what comes of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RampIn {
    /// `VelocityDiff`, u/s.
    pub velocity_difference: f64,
    /// `Acceleration`, u/s².
    pub acceleration: f64,
    /// `Deceleration`, u/s².
    pub deceleration: f64,
    /// When the slave is on its cam, s after the start.
    pub duration_s: f64,
    /// The largest velocity of the slave until then, exact, u/s.
    pub peak_velocity: f64,
    /// The largest acceleration of the slave until then, exact, u/s².
    pub peak_acceleration: f64,
}

/// Why there is no ramp.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RampError {
    /// The coupling does not start.
    #[error(transparent)]
    Coupling(#[from] CouplingError),
    /// A ramp needs a limit of this.
    #[error("the limit of the slave's {what} is {value}: a ramp needs one greater than 0")]
    NoLimit {
        /// Velocity or acceleration.
        what: &'static str,
        /// What it is.
        value: f64,
    },
    /// The cam leaves nothing over for a ramp.
    #[error("the cam alone takes the slave's {what} to {}, its limit is {}: nothing is left for a ramp",
        Short(*.peak), Short(*.limit))]
    NoRoom {
        /// Velocity or acceleration.
        what: &'static str,
        /// What the cam reaches, u/s or u/s².
        peak: f64,
        /// What is allowed.
        limit: f64,
    },
    /// The limits do not allow a ramp as short as it should be.
    #[error("the slave is on its cam after {} s at the earliest, not within {} s", Short(*.soonest_s), Short(*.within_s))]
    TooLate {
        /// The shortest ramp that was found, s.
        soonest_s: f64,
        /// The time it was to take at most, s.
        within_s: f64,
    },
}

/// Rounds in which the way of the master gets shorter.
const ROUNDS: usize = 50;
/// The first change of a value that is tried, as a factor.
const FIRST_CHANGE: f64 = 1.5;
/// The last one: what is gained by less is not looked for.
const LAST_CHANGE: f64 = 1.0 + 1e-7;
/// Of a limit this part is rounding.
const ROUNDING: f64 = 1e-12;

/// Finds the ramp.
///
/// # Errors
/// [`RampError`] if the coupling does not start, the cam leaves nothing over, or the limits do not allow the time.
pub fn ramp_in(wish: &RampWish) -> Result<RampIn, RampError> {
    for (what, value) in
        [("velocity", wish.limits.velocity), ("acceleration", wish.limits.acceleration)]
    {
        if !(value.is_finite() && value > 0.0) {
            return Err(RampError::NoLimit { what, value });
        }
    }
    let problem = Problem { wish };
    let mut best = problem.soonest()?;
    best = problem.improved(best, &|ramp| ramp.duration_s)?;
    let RampGoal::Gentlest { within_s } = wish.goal else { return Ok(best) };
    if best.duration_s > within_s {
        return Err(RampError::TooLate { soonest_s: best.duration_s, within_s });
    }
    // As slow as may be, both accelerations alike, is where the gentlest one is looked for from.
    let (mut low, mut high) = (0.0, 1.0);
    let mut gentle = best;
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        let [velocity, up, down] = values(&best);
        let tried = problem.ramp([velocity, up * middle, down * middle])?;
        if tried.duration_s <= within_s {
            high = middle;
            if tried.peak_acceleration < gentle.peak_acceleration {
                gentle = tried;
            }
        } else {
            low = middle;
        }
    }
    problem.improved(gentle, &|ramp| {
        if ramp.duration_s <= within_s { ramp.peak_acceleration } else { f64::INFINITY }
    })
}

fn values(ramp: &RampIn) -> [f64; 3] {
    [ramp.velocity_difference, ramp.acceleration, ramp.deceleration]
}

struct Problem<'a> {
    wish: &'a RampWish,
}

impl Problem<'_> {
    fn curve(&self) -> &Curve {
        self.wish.table.cam.curve()
    }

    /// How fast the master moves on the scale of the cam.
    fn speed(&self) -> f64 {
        self.wish.master.velocity * self.wish.input.master_scaling
    }

    /// The best of what the cam leaves over, way by way, and of parts of the limits.
    fn soonest(&self) -> Result<RampIn, RampError> {
        let SlaveLimits { velocity, acceleration, .. } = self.wish.limits;
        let mut best: Option<RampIn> = None;
        let take = |best: &mut Option<RampIn>, found: RampIn| {
            let sooner = best.is_none_or(|best| found.duration_s < best.duration_s);
            if sooner && self.keeps(&found) {
                *best = Some(found);
            }
        };
        // Of a cam that is not put end to end the rest lies ahead, or it stands: all of it is enough.
        let mut peaks = self.cam_peaks(None)?;
        for _ in 0..ROUNDS {
            let [most, pull] = [velocity - peaks[0], acceleration - peaks[1]];
            if most <= 0.0 || pull <= 0.0 {
                break;
            }
            let found = self.ramp([most, pull, pull])?;
            let before = best.map_or(f64::INFINITY, |best| best.duration_s);
            take(&mut best, found);
            if before - found.duration_s <= 1e-9 * found.duration_s {
                break;
            }
            peaks = self.cam_peaks(Some(found.duration_s))?;
        }
        for halvings in 0..24 {
            let part = 0.5_f64.powi(halvings);
            take(
                &mut best,
                self.ramp([velocity * part, acceleration * part, acceleration * part])?,
            );
        }
        best.ok_or_else(|| {
            let [v, a] = peaks;
            if v >= velocity {
                RampError::NoRoom { what: "velocity", peak: v, limit: velocity }
            } else {
                RampError::NoRoom { what: "acceleration", peak: a, limit: acceleration }
            }
        })
    }

    /// Largest velocity and acceleration of the cam alone within so many seconds from the start; of all of it without.
    fn cam_peaks(&self, seconds: Option<f64>) -> Result<[f64; 2], RampError> {
        let from = self.place()?;
        let factor = self.wish.input.slave_scaling;
        let speed = self.speed();
        let CurveExtremes { velocity, acceleration, .. } = match seconds {
            Some(seconds) => {
                extremes_along(self.curve(), from, seconds * speed, self.wish.table.periodic)
            }
            None => self.curve().extremes(),
        };
        Ok([
            (velocity.magnitude() * speed * factor).abs(),
            (acceleration.magnitude() * speed * speed * factor).abs(),
        ])
    }

    /// Where the master is on the scale of the cam.
    fn place(&self) -> Result<f64, RampError> {
        let input = CamInput { start_mode: StartMode::Absolute, ..self.wish.input };
        let RampWish { table, master, slave, .. } = self.wish;
        Ok(CamCoupling::start(table.clone(), input, master, slave, 0)?.place())
    }

    /// A ramp of these values, and exactly what comes of it.
    fn ramp(&self, [velocity, up, down]: [f64; 3]) -> Result<RampIn, RampError> {
        let RampWish { table, input, master, slave, .. } = self.wish;
        let start_mode = match input.start_mode {
            StartMode::Absolute | StartMode::Relative => StartMode::RampIn,
            directed => directed,
        };
        let input = CamInput {
            start_mode,
            velocity_difference: velocity,
            acceleration: up,
            deceleration: down,
            ..*input
        };
        let coupling = CamCoupling::start(table.clone(), input, master, slave, 0)?;
        let mut found = RampIn {
            velocity_difference: velocity,
            acceleration: up,
            deceleration: down,
            duration_s: 0.0,
            peak_velocity: slave.velocity.abs(),
            peak_acceleration: 0.0,
        };
        if let Some(bridge) = coupling.bridge() {
            self.follow(bridge, coupling.place(), &mut found);
        }
        Ok(found)
    }

    /// What ramp and cam reach together.
    fn follow(&self, bridge: &Bridge, place: f64, found: &mut RampIn) {
        let speed = self.speed();
        let factor = self.wish.input.slave_scaling;
        let mut velocity = bridge.velocity();
        let mut from = place;
        for (duration, pull) in bridge.pieces() {
            let way = speed * duration;
            let mut both = [Extremes::NONE; 2];
            along(
                self.curve(),
                from,
                way,
                self.wish.table.periodic,
                &mut |[_, first, second, _], width, gone| {
                    // Time is the way over the speed; a master that stands takes the whole duration at one place.
                    let (per_way, at_once) =
                        if speed == 0.0 { (0.0, duration) } else { (1.0 / speed.abs(), 0.0) };
                    let begin = velocity + pull * gone * per_way;
                    let mut sum: Coefficients = first.map(|c| c * speed * factor);
                    sum[0] += begin;
                    sum[1] += pull * per_way;
                    both[0].join(&extremes(&sum, width), 0.0);
                    both[0].include(0.0, sum[0] + pull * at_once);
                    let mut sum = second.map(|c| c * speed * speed * factor);
                    sum[0] += pull;
                    both[1].join(&extremes(&sum, width), 0.0);
                },
            );
            if duration > 0.0 {
                let [v, a] = both.map(|extremes| Range::from(extremes).magnitude());
                found.peak_velocity = found.peak_velocity.max(v);
                found.peak_acceleration = found.peak_acceleration.max(a);
            }
            found.duration_s += duration;
            velocity += pull * duration;
            from += way;
        }
    }

    fn keeps(&self, ramp: &RampIn) -> bool {
        let SlaveLimits { velocity, acceleration, .. } = self.wish.limits;
        // What the slave moves at from before is not the ramp's doing.
        let velocity = velocity.max(self.wish.slave.velocity.abs());
        ramp.peak_velocity <= velocity * (1.0 + ROUNDING)
            && ramp.peak_acceleration <= acceleration * (1.0 + ROUNDING)
    }

    /// Changes one value after the other as long as that makes the score less.
    fn improved(&self, begin: RampIn, score: &dyn Fn(&RampIn) -> f64) -> Result<RampIn, RampError> {
        let mut best = begin;
        let mut change = FIRST_CHANGE;
        // All three together, and each alone.
        let ways =
            [[1.0, 1.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, -1.0]];
        while change > LAST_CHANGE {
            let mut better = false;
            for way in ways {
                for sign in [1.0, -1.0] {
                    let mut tried = values(&best);
                    for (value, share) in tried.iter_mut().zip(way) {
                        *value *= change.powf(share * sign);
                    }
                    let tried = self.ramp(tried)?;
                    if self.keeps(&tried) && score(&tried) < score(&best) * (1.0 - ROUNDING) {
                        best = tried;
                        better = true;
                    }
                }
            }
            if !better {
                change = change.sqrt();
            }
        }
        Ok(best)
    }
}
