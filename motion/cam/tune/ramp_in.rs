//! What `MC_CamIn` should be given for a start with a ramp (`VelocityDiff`, `Acceleration`, `Deceleration`, manual 4.6.1
//! and 5.4): so that the slave is on its cam soonest, or comes onto it in a given time as gently as can be.
//!
//! The ramp is added to the cam, which goes on meanwhile, so both together have to keep the limits of the axis. While the
//! master moves evenly the cam's velocity and acceleration are polynomials of time and those of the ramp lines or, with
//! limited jerk, parabolas piece by piece: what both together reach is found exactly.
//!
//! First the ramp gets what the cam leaves over on the way the master makes meanwhile. The quicker the ramp, the shorter
//! that way and the more is left over, so this is repeated. From the best of these each of the three values is changed as
//! long as that is better; whether it is, and keeps the limits, is always found exactly.

use super::super::coupling::CamCoupling;
use super::super::curve::{Curve, CurveExtremes, Range};
use super::super::polynomial::{Coefficients, Extremes, extremes, value};
use super::super::selection::{CamInput, StartMode};
use super::along::{along, extremes_along};
pub use super::ramp_wish::{RampError, RampGoal, RampIn, RampWish};
use crate::axis::gear::{Approach, Gap};
use crate::axis::profile::{AxisLimits, RampType};
use crate::cam::SlaveLimits;

/// Rounds in which the way of the master gets shorter.
const ROUNDS: usize = 50;
/// The first change of a value that is tried, as a factor.
const FIRST_CHANGE: f64 = 1.5;
/// The last one: what is gained by less is not looked for.
const LAST_CHANGE: f64 = 1.0 + 1e-7;
/// The gentlest ramp that is tried, as a part of the limits.
const LEAST: f64 = 1.0 / 8_388_608.0;
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
    let jerk = wish.limits.jerk;
    match wish.ramp {
        RampType::Sigmoid => return Err(RampError::Sigmoid),
        RampType::Parabolic if !(jerk.is_finite() && jerk > 0.0) => {
            return Err(RampError::NoLimit { what: "jerk", value: jerk });
        }
        RampType::Parabolic | RampType::Trapezoid => {}
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
        if tried.duration_s <= within_s && problem.keeps(&tried) {
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

/// The motion of a ramp.
#[derive(Debug)]
struct Way {
    /// Where the master is on the scale of the cam when it begins.
    place: f64,
    /// The slave's velocity beside the cam's, u/s.
    velocity: f64,
    /// How long each stretch takes, s, its acceleration at the beginning, u/s², and its jerk, u/s³.
    pieces: Vec<[f64; 3]>,
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
        // Steps as large as the jerk allows, and so slow that between them is a cycle or more.
        let pull = acceleration.min(self.wish.limits.jerk * self.wish.cycle_s);
        let steps = self.wish.ramp == RampType::Trapezoid && self.wish.limits.jerk.is_finite();
        let slower = if steps { 48 } else { 0 };
        for halvings in 0..slower {
            let part = 0.5_f64.powf(f64::from(halvings) / 2.0);
            take(&mut best, self.ramp([velocity * part, pull, pull])?);
        }
        let hardest = self.ramp([velocity, acceleration, acceleration])?;
        let gentlest =
            self.ramp([velocity, acceleration, acceleration].map(|limit| limit * LEAST))?;
        best.ok_or_else(|| {
            let [v, a] = peaks;
            let [least, greatest] = hardest.positions;
            let [low, high] = self.wish.position;
            let jerk = self.wish.limits.jerk;
            if v < velocity && a < acceleration && least < low {
                RampError::Beyond { what: "position", reached: least, limit: low }
            } else if v < velocity && a < acceleration && greatest > high {
                RampError::Beyond { what: "position", reached: greatest, limit: high }
            } else if v < velocity && a < acceleration && self.jerk(&gentlest) > jerk {
                RampError::Beyond { what: "jerk", reached: self.jerk(&gentlest), limit: jerk }
            } else if v >= velocity {
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
    fn ramp(&self, values: [f64; 3]) -> Result<RampIn, RampError> {
        let [velocity_difference, acceleration, deceleration] = values;
        let slave = self.wish.slave;
        let mut found = RampIn {
            velocity_difference,
            acceleration,
            deceleration,
            duration_s: 0.0,
            peak_velocity: slave.velocity.abs(),
            peak_acceleration: 0.0,
            peak_jerk: 0.0,
            peak_cam_jerk: 0.0,
            positions: [slave.position; 2],
        };
        if let Some(way) = self.way(values)? {
            self.follow(&way, &mut found);
        }
        Ok(found)
    }

    /// The motion of a ramp of these values, on top of the cam's; none if there is nothing to go.
    fn way(
        &self,
        [velocity, acceleration, deceleration]: [f64; 3],
    ) -> Result<Option<Way>, RampError> {
        let RampWish { table, input, master, slave, limits, ramp, .. } = self.wish;
        let mode = match input.start_mode {
            StartMode::Absolute | StartMode::Relative => StartMode::RampIn,
            directed => directed,
        };
        if *ramp == RampType::Trapezoid {
            let input = CamInput {
                start_mode: mode,
                velocity_difference: velocity,
                acceleration,
                deceleration,
                ..*input
            };
            let coupling = CamCoupling::start(table.clone(), input, master, slave, 0)?;
            return Ok(coupling.bridge().map(|bridge| Way {
                place: coupling.place(),
                velocity: bridge.velocity(),
                pieces: bridge.pieces().map(|(duration, pull)| [duration, pull, 0.0]).to_vec(),
            }));
        }
        let input = CamInput { start_mode: StartMode::Absolute, ..*input };
        let coupling = CamCoupling::start(table.clone(), input, master, slave, 0)?;
        let on_cam = coupling.output().slave;
        let gap = Gap {
            distance: on_cam.position - slave.position,
            velocity: slave.velocity - on_cam.velocity,
            acceleration: slave.acceleration - on_cam.acceleration,
            period: table.slave_period,
            mode,
        };
        let limits = AxisLimits { velocity, acceleration, deceleration, jerk: limits.jerk };
        let (approach, _) = Approach::new(gap, limits, *ramp)?;
        let pieces = approach.profile().stretches().map(Iterator::collect);
        Ok(pieces.map(|pieces| Way { place: coupling.place(), velocity: gap.velocity, pieces }))
    }

    /// What ramp and cam reach together.
    fn follow(&self, way: &Way, found: &mut RampIn) {
        let speed = self.speed();
        let factor = self.wish.input.slave_scaling;
        let Way { mut velocity, place, .. } = *way;
        let mut from = place;
        let mut position = self.wish.slave.position;
        let mut jerks = [Extremes::NONE; 2];
        // The slave comes without acceleration, and the cam has its own from the start on.
        let table = &self.wish.table;
        let here = self.curve();
        let here = if table.periodic { here.repeated(place) } else { here.at(place) };
        let mut changes = vec![(0.0, -here.acceleration * speed * speed * factor)];
        for [duration, pull, jerk] in way.pieces.iter().copied() {
            let distance = speed * duration;
            if duration > 0.0 {
                changes.push((found.duration_s, pull));
            }
            let mut both = [Extremes::NONE; 2];
            let mut reached = Extremes::NONE;
            along(
                self.curve(),
                from,
                distance,
                self.wish.table.periodic,
                &mut |[y, first, second, third], width, gone| {
                    // Time is the way over the speed; a master that stands takes the whole duration at one place.
                    let stands = speed == 0.0;
                    let (rate, width) =
                        if stands { (1.0, duration) } else { (1.0 / speed.abs(), width) };
                    let since = if stands { 0.0 } else { gone * rate };
                    // What the cam does over the way, or at its place over the time.
                    let of_cam = |c: Coefficients, by: f64| {
                        let c = c.map(|c| c * by);
                        if stands { [c[0], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0] } else { c }
                    };
                    let pulled = pull + jerk * since;
                    let begin = velocity + since * (pull + jerk * since / 2.0);
                    let mut sum = of_cam(first, speed * factor);
                    sum[0] += begin;
                    sum[1] += pulled * rate;
                    sum[2] += jerk / 2.0 * rate * rate;
                    both[0].join(&extremes(&sum, width), 0.0);
                    let mut sum = of_cam(second, speed * speed * factor);
                    sum[0] += pulled;
                    sum[1] += jerk * rate;
                    both[1].join(&extremes(&sum, width), 0.0);
                    let mut sum = of_cam(third, speed.powi(3) * factor);
                    jerks[0].join(&extremes(&sum, width), 0.0);
                    sum[0] += jerk;
                    jerks[1].join(&extremes(&sum, width), 0.0);
                    // From where the stretch begins on.
                    let mut sum = of_cam(y, factor);
                    sum[0] = position;
                    sum[1] += begin * rate;
                    sum[2] += pulled / 2.0 * rate * rate;
                    sum[3] += jerk / 6.0 * rate.powi(3);
                    reached.join(&extremes(&sum, width), 0.0);
                    position = value(&sum, width);
                },
            );
            if duration > 0.0 {
                let [v, a] = both.map(|extremes| Range::from(extremes).magnitude());
                found.peak_velocity = found.peak_velocity.max(v);
                found.peak_acceleration = found.peak_acceleration.max(a);
                let [least, greatest] = &mut found.positions;
                (*least, *greatest) = (least.min(reached.min), greatest.max(reached.max));
            }
            found.duration_s += duration;
            velocity += duration * (pull + jerk * duration / 2.0);
            from += distance;
        }
        if way.pieces.is_empty() {
            return;
        }
        changes.push((found.duration_s, 0.0));
        let [of_cam, of_both] = jerks.map(|extremes| Range::from(extremes).magnitude());
        found.peak_cam_jerk = of_cam;
        found.peak_jerk = match self.wish.ramp {
            RampType::Trapezoid => self.step(&changes) / self.wish.cycle_s + of_cam,
            RampType::Sigmoid | RampType::Parabolic => of_both,
        };
    }

    /// The largest change of the ramp's acceleration within a cycle, of its times and values from then on.
    fn step(&self, changes: &[(f64, f64)]) -> f64 {
        let mut largest = 0.0_f64;
        for (index, (_, before)) in changes.iter().enumerate() {
            let mut after = changes.iter().skip(index + 1);
            let Some((from, value)) = after.next() else { break };
            largest = largest.max((value - before).abs());
            // What follows less than a cycle later changes it in the same one.
            let at_once = after.take_while(|(at, _)| at - from < self.wish.cycle_s);
            largest = at_once.fold(largest, |most, (_, value)| most.max((value - before).abs()));
        }
        largest
    }

    /// The jerk that is held against the limit. A parabolic ramp has that of the limit itself.
    fn jerk(&self, ramp: &RampIn) -> f64 {
        if self.wish.ramp == RampType::Parabolic { ramp.peak_cam_jerk } else { ramp.peak_jerk }
    }

    fn keeps(&self, ramp: &RampIn) -> bool {
        let SlaveLimits { velocity, acceleration, .. } = self.wish.limits;
        // What the slave moves at from before is not the ramp's doing.
        let velocity = velocity.max(self.wish.slave.velocity.abs());
        let [low, high] = self.wish.position;
        let [least, greatest] = ramp.positions;
        let room = ROUNDING * least.abs().max(greatest.abs());
        least >= low - room
            && greatest <= high + room
            && self.jerk(ramp) <= self.wish.limits.jerk * (1.0 + ROUNDING)
            && ramp.peak_velocity <= velocity * (1.0 + ROUNDING)
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
