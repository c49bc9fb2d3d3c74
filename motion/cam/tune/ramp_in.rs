//! What `MC_CamIn` should be given for a start with a ramp (`VelocityDiff`, `Acceleration`, `Deceleration`, manual 4.6.1
//! and 5.4): so that the slave is on its cam soonest, or comes onto it in a given time as gently as can be.
//!
//! The ramp is added to the cam, which goes on meanwhile, so both together have to keep the limits of the axis. While the
//! master moves evenly the cam's velocity and acceleration are polynomials of time and those of the ramp lines or, with
//! limited jerk, parabolas or sines piece by piece: what both together reach is found exactly
//! (`motion/cam/tune/ramp_course.rs`).
//!
//! First the ramp gets what the cam leaves over on the way the master makes meanwhile. The quicker the ramp, the shorter
//! that way and the more is left over, so this is repeated. From the best of these each of the three values is changed as
//! long as that is better, which says where about ramps are. The best of them is looked for from there, in all values at once
//! (`motion/cam/tune/ramp_search.rs`); whether one is better, and keeps the limits, is always found exactly.

use super::super::coupling::CamCoupling;
use super::super::curve::{Curve, CurveExtremes};
use super::super::selection::{CamInput, StartMode};
use super::along::extremes_along;
use super::ramp_course::{Course, Way};
use super::ramp_search::Aim;
pub use super::ramp_wish::{Held, RampError, RampGoal, RampIn, RampWish};
use crate::axis::gear::{Approach, Gap};
use crate::axis::profile::{AxisLimits, RampType};
use crate::cam::SlaveLimits;

/// A ramp that takes longer, s, is asked for by mistake.
const LONGEST_S: f64 = 3600.0;
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
/// A ramp that is sooner by this part is sooner.
const HELD: f64 = 1e-3;
/// What is known of a ramp's values: less than this part is what the search left over.
const NEAT: f64 = 1e-7;

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
    if wish.ramp != RampType::Trapezoid && !(jerk.is_finite() && jerk > 0.0) {
        return Err(RampError::NoLimit { what: "jerk", value: jerk });
    }
    let most = match wish.goal {
        RampGoal::Soonest => f64::INFINITY,
        RampGoal::Gentlest { .. } => wish.limits.velocity,
    };
    let problem = Problem { wish, most };
    let begin = problem.improved(problem.soonest()?, &WAYS, &|ramp| ramp.duration_s)?;
    let soonest = match wish.goal {
        // A ramp that is soon enough is a begin as good as any.
        RampGoal::Gentlest { within_s, .. } if begin.duration_s <= within_s => begin,
        _ => problem.sooner(begin)?,
    };
    match wish.goal {
        RampGoal::Soonest if soonest.duration_s > LONGEST_S => {
            Err(RampError::TooLong { soonest_s: soonest.duration_s, most_s: LONGEST_S })
        }
        RampGoal::Soonest => problem.neat(problem.modest(soonest)?, f64::INFINITY),
        RampGoal::Gentlest { within_s, .. } if soonest.duration_s > within_s => {
            let free = Problem { most: f64::INFINITY, ..problem };
            let free_s = free.sooner(soonest)?.duration_s;
            let sooner = free_s < soonest.duration_s * (1.0 - HELD);
            let held = sooner.then_some(Held { velocity: most, free_s });
            Err(RampError::TooLate { soonest_s: soonest.duration_s, within_s, held })
        }
        RampGoal::Gentlest { within_s, least } => {
            problem.neat(problem.modest(problem.gentlest(&soonest, within_s, least)?)?, within_s)
        }
    }
}

/// What a ramp is made of: velocity, acceleration, deceleration and jerk.
pub(super) type Values = [f64; 4];

/// Which values are changed together: all of them, each alone, and one acceleration against the other.
pub(super) const WAYS: [Values; 5] = [
    [1.0, 1.0, 1.0, 0.0],
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [0.0, 1.0, -1.0, 0.0],
];
/// The same where the jerk is to be found as well.
pub(super) const WAYS_WITH_JERK: [Values; 9] = [
    [1.0, 1.0, 1.0, 0.0],
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [0.0, 1.0, -1.0, 0.0],
    [0.0, 0.0, 0.0, 1.0],
    [0.0, 1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0, -1.0],
    [1.0, 0.0, 0.0, -1.0],
];

fn values(ramp: &RampIn) -> Values {
    [ramp.velocity_difference, ramp.acceleration, ramp.deceleration, ramp.ramp_jerk]
}

#[derive(Clone, Copy)]
pub(super) struct Problem<'a> {
    pub(super) wish: &'a RampWish,
    /// `VelocityDiff` is no more: a gentle ramp has none beyond the axis's own velocity, even where the cam comes towards the
    /// slave, which then stays below it.
    pub(super) most: f64,
}

impl Problem<'_> {
    /// The soonest of all, of which `begin` is one.
    fn sooner(&self, begin: RampIn) -> Result<RampIn, RampError> {
        let found = self.searched(begin, Aim { least: None, within_s: f64::INFINITY })?;
        self.improved(found, &WAYS, &|ramp| ramp.duration_s)
    }

    pub(super) fn curve(&self) -> &Curve {
        self.wish.table.cam.curve()
    }

    /// How fast the master moves on the scale of the cam.
    pub(super) fn speed(&self) -> f64 {
        self.wish.master.velocity * self.wish.input.master_scaling
    }

    /// The best of what the cam leaves over, way by way, and of parts of the limits.
    fn soonest(&self) -> Result<RampIn, RampError> {
        let SlaveLimits { velocity, acceleration, jerk } = self.wish.limits;
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
            let found = self.ramp([most, pull, pull, jerk])?;
            let before = best.map_or(f64::INFINITY, |best| best.duration_s);
            take(&mut best, found);
            if before - found.duration_s <= 1e-9 * found.duration_s {
                break;
            }
            peaks = self.cam_peaks(Some(found.duration_s))?;
        }
        for halvings in 0..24 {
            let part = 0.5_f64.powi(halvings);
            let pull = acceleration * part;
            take(&mut best, self.ramp([velocity * part, pull, pull, jerk])?);
        }
        // Steps as large as the jerk allows, and so slow that between them is a cycle or more.
        let pull = acceleration.min(jerk * self.wish.cycle_s);
        let steps = self.wish.ramp == RampType::Trapezoid && jerk.is_finite();
        let slower = if steps { 48 } else { 0 };
        for halvings in 0..slower {
            let part = 0.5_f64.powf(f64::from(halvings) / 2.0);
            take(&mut best, self.ramp([velocity * part, pull, pull, jerk])?);
        }
        let hardest = self.ramp([velocity, acceleration, acceleration, jerk])?;
        let [v, a] = [velocity * LEAST, acceleration * LEAST];
        let gentlest = self.ramp([v, a, a, jerk])?;
        if best.is_none() {
            // Where the cam alone breaks the limits meanwhile that is what is to be said.
            best = self.entered(&hardest)?;
            if let Some(found) = best {
                let [v, a] = self.cam_peaks(Some(found.duration_s))?;
                best = best.filter(|_| v < velocity && a < acceleration);
            }
        }
        best.ok_or_else(|| {
            let [v, a] = peaks;
            let [least, greatest] = hardest.positions;
            let [low, high] = self.wish.position;
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
    pub(super) fn ramp(&self, values: Values) -> Result<RampIn, RampError> {
        Ok(self.course(values)?.ramp)
    }

    /// The same, stretch by stretch.
    pub(super) fn course(&self, values: Values) -> Result<Course, RampError> {
        let [velocity_difference, acceleration, deceleration, ramp_jerk] = values;
        let slave = self.wish.slave;
        let ramp = RampIn {
            velocity_difference,
            acceleration,
            deceleration,
            ramp_jerk,
            duration_s: 0.0,
            peak_velocity: slave.velocity.abs(),
            peak_acceleration: 0.0,
            peak_jerk: 0.0,
            peak_cam_jerk: 0.0,
            positions: [slave.position; 2],
        };
        let mut course = Course { ramp, stretches: Vec::new(), steps: Vec::new() };
        if let Some(way) = self.way(values)? {
            self.follow(&way, &mut course);
        }
        Ok(course)
    }

    /// The motion of a ramp of these values, on top of the cam's; none if there is nothing to go.
    pub(super) fn way(
        &self,
        [velocity, acceleration, deceleration, jerk]: Values,
    ) -> Result<Option<Way>, RampError> {
        let RampWish { table, input, master, slave, ramp, .. } = self.wish;
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
                pieces: bridge.pieces().map(|(duration, pull)| [duration, pull, 0.0, 0.0]).to_vec(),
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
        let limits = AxisLimits { velocity, acceleration, deceleration, jerk };
        let (approach, _) = Approach::new(gap, limits, *ramp)?;
        let pieces = approach.profile().stretches().collect();
        Ok(Some(Way { place: coupling.place(), velocity: gap.velocity, pieces }))
    }

    /// The jerk that is held against the limit. A ramp with limited jerk has at most that of the limit itself.
    fn jerk(&self, ramp: &RampIn) -> f64 {
        match self.wish.ramp {
            RampType::Trapezoid => ramp.peak_jerk,
            RampType::Sigmoid | RampType::Parabolic => ramp.peak_cam_jerk,
        }
    }

    pub(super) fn keeps(&self, ramp: &RampIn) -> bool {
        let SlaveLimits { velocity, acceleration, jerk } = self.wish.limits;
        // What the slave moves at from before is not the ramp's doing.
        let velocity = velocity.max(self.wish.slave.velocity.abs());
        let [low, high] = self.wish.position;
        let [least, greatest] = ramp.positions;
        let room = ROUNDING * least.abs().max(greatest.abs());
        let limited = self.wish.ramp != RampType::Trapezoid;
        least >= low - room
            && greatest <= high + room
            && self.jerk(ramp) <= jerk * (1.0 + ROUNDING)
            && !(limited && ramp.ramp_jerk > jerk)
            && ramp.peak_velocity <= velocity * (1.0 + ROUNDING)
            && ramp.peak_acceleration <= acceleration * (1.0 + ROUNDING)
    }

    /// With accelerations that are not beyond the limit of the axis, if that changes nothing: where the jerk says how quick a
    /// ramp is, these do not.
    fn modest(&self, ramp: RampIn) -> Result<RampIn, RampError> {
        let most = self.wish.limits.acceleration;
        let [velocity, up, down, jerk] = values(&ramp);
        let tried = self.ramp([velocity, up.min(most), down.min(most), jerk])?;
        let same = |one: f64, other: f64| one <= other * (1.0 + ROUNDING);
        let as_good = same(tried.duration_s, ramp.duration_s)
            && same(tried.peak_velocity, ramp.peak_velocity)
            && same(tried.peak_acceleration, ramp.peak_acceleration)
            && same(tried.peak_jerk, ramp.peak_jerk);
        Ok(if as_good && self.keeps(&tried) { tried } else { ramp })
    }

    /// With as few digits as change nothing that the search could tell: 2 in place of 1.999999967. The jerk, which is the
    /// axis's, stays as it is.
    fn neat(&self, ramp: RampIn, within_s: f64) -> Result<RampIn, RampError> {
        let same = |one: f64, other: f64| one <= other * (1.0 + NEAT);
        let mut best = ramp;
        for index in 0..3 {
            for digits in 1..9 {
                let mut tried = values(&best);
                let Some(value) = tried.get_mut(index) else { break };
                *value = format!("{value:.digits$e}").parse().unwrap_or(*value);
                let tried = self.ramp(tried)?;
                let as_good = tried.duration_s <= within_s
                    && same(tried.duration_s, ramp.duration_s)
                    && same(tried.peak_velocity, ramp.peak_velocity)
                    && same(tried.peak_acceleration, ramp.peak_acceleration)
                    && same(tried.peak_jerk, ramp.peak_jerk);
                if as_good && self.keeps(&tried) && tried.velocity_difference <= self.most {
                    best = tried;
                    break;
                }
            }
        }
        Ok(best)
    }

    /// Changes one value after the other as long as that makes the score less.
    pub(super) fn improved(
        &self,
        begin: RampIn,
        ways: &[Values],
        score: &dyn Fn(&RampIn) -> f64,
    ) -> Result<RampIn, RampError> {
        let mut best = begin;
        let mut change = FIRST_CHANGE;
        while change > LAST_CHANGE {
            let mut better = false;
            for way in ways {
                for sign in [1.0, -1.0] {
                    let mut tried = values(&best);
                    for (value, share) in tried.iter_mut().zip(way) {
                        *value *= change.powf(share * sign);
                    }
                    tried[0] = tried[0].min(self.most);
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
