//! The best of all ramps: on a grid first, then from its best places that are apart by linear programs.
//!
//! Where the cam moves meanwhile there are several valleys, and the best ramp mostly lies in a corner where two or three limits
//! hold at once: no single value can be changed there for the better. What each stretch of the ramp reaches is a smooth
//! function of the logarithms of the values, though. So all of them are taken for linear within a region, a linear program
//! (Clarabel) finds the best place in it, and the region grows or shrinks with how true that was. In a corner this gains twice
//! the digits with each step. What breaks limits is made up for by its excess, so that a valley may be entered from outside.
//!
//! Nothing is taken but what keeps the limits by its exact peaks.

use super::super::bounds::{Quantity, SlaveLimits};
use super::ramp_course::Course;
use super::ramp_in::{Problem, Values};
use super::ramp_program::{DEAR, Place, Slope, program};
use super::ramp_wish::{RampError, RampIn};
use crate::axis::profile::RampType;

/// What a ramp is compared by: its duration, or one of its peaks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    /// The duration if none.
    pub(super) least: Option<Quantity>,
    /// It takes so long at most, s.
    pub(super) within_s: f64,
}

/// Places of the grid for velocity, acceleration and deceleration, and for the jerk: as powers of 2.
const GRID: [&[f64]; 4] = [
    &[-4.0, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0],
    &[-5.0, -4.0, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0],
    &[-5.0, -4.0, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0],
    &[0.0],
];
/// The same where the jerk is to be found as well.
const GRID_WITH_JERK: [&[f64]; 4] = [
    &[-3.0, -1.5, 0.0, 1.5],
    &[-4.0, -2.0, -0.7, 0.7, 2.0],
    &[-4.0, -2.0, -0.7, 0.7, 2.0],
    &[-4.0, -2.5, -1.0, 0.0, 1.0, 2.5],
];
/// What an excess over a limit costs, as a part of the aim, when places of the grid are chosen: the cheap ones come near to
/// the corners, the dear ones keep the limits.
const COSTS: [f64; 4] = [0.3, 1.0, 3.0, 30.0];
/// So many places for each of them.
const PLACES: usize = 7;
/// Places are apart if a value differs by this much, as a logarithm.
const APART: f64 = 0.9;
/// Accelerations at the centre of the grid are unequal by this factor at most.
const UNEQUAL: f64 = 8.0;
/// Parts of the velocity that the best one reaches.
const SLOWER: [f64; 3] = [0.98, 0.9, 0.75];
/// The region at the begin, as a logarithm, the largest and the smallest one.
const REGION: [f64; 3] = [0.5, 1.0, 1e-7];
/// Steps from one place on.
const STEPS: usize = 40;
/// In a region smaller than the first what is worse than the best by the second is given up.
const HOPELESS: [f64; 2] = [2e-2, 0.03];
/// For derivatives.
const NEAR: f64 = 1e-6;
/// Stretches of a ramp at most.
const STRETCHES: usize = 16;

struct Search<'a> {
    problem: &'a Problem<'a>,
    aim: Aim,
    /// What parts of the aim are of.
    unit: f64,
    /// Of positions.
    span: f64,
    /// Values that are looked for: with or without the jerk.
    unknowns: usize,
    /// The best one that keeps all limits, and its aim.
    best: (f64, RampIn),
}

impl Problem<'_> {
    /// The soonest ramp, where none is known that keeps the limits; `hardest` takes all of them. None if none is found.
    pub(super) fn entered(&self, hardest: &RampIn) -> Result<Option<RampIn>, RampError> {
        let begin = RampIn {
            velocity_difference: hardest.velocity_difference / 2.0,
            acceleration: hardest.acceleration / 4.0,
            deceleration: hardest.deceleration / 4.0,
            ..*hardest
        };
        let aim = Aim { least: None, within_s: f64::INFINITY };
        let Some(mut search) = self.search(begin, aim) else { return Ok(None) };
        search.best.0 = f64::INFINITY;
        search.run()?;
        let (found, ramp) = search.best;
        Ok(found.is_finite().then_some(ramp))
    }

    /// The best ramp by an aim, of which `begin` is one.
    pub(super) fn searched(&self, begin: RampIn, aim: Aim) -> Result<RampIn, RampError> {
        let Some(mut search) = self.search(begin, aim) else { return Ok(begin) };
        search.run()?;
        Ok(search.best.1)
    }

    /// A search; none where there is nothing to be gained.
    fn search(&self, begin: RampIn, aim: Aim) -> Option<Search<'_>> {
        let with_jerk = aim.least == Some(Quantity::Jerk) && self.wish.ramp != RampType::Trapezoid;
        let unit = match aim.least {
            None => begin.duration_s,
            Some(Quantity::Velocity) => begin.peak_velocity,
            Some(Quantity::Acceleration) => begin.peak_acceleration,
            Some(Quantity::Jerk) => begin.peak_jerk,
        };
        let [least, most] = begin.positions;
        (unit > 0.0 && unit.is_finite()).then(|| Search {
            problem: self,
            aim,
            unit,
            span: (most - least).max(1e-9 * most.abs().max(least.abs())).max(f64::MIN_POSITIVE),
            unknowns: if with_jerk { 4 } else { 3 },
            best: (1.0, begin),
        })
    }
}

impl Search<'_> {
    fn run(&mut self) -> Result<(), RampError> {
        let begin = self.best.1;
        // Much more than the limits says nothing of a ramp that never gets there.
        let SlaveLimits { velocity, acceleration, .. } = self.problem.wish.limits;
        let pulls = [begin.acceleration, begin.deceleration].map(|it| it.min(2.0 * acceleration));
        // Nor does one that is next to nothing.
        let least = pulls[0].max(pulls[1]) / UNEQUAL;
        let [up, down] = pulls.map(|pull| pull.max(least));
        let most = begin.velocity_difference.min(2.0 * velocity);
        let centre = [most, up, down, begin.ramp_jerk];
        let grid = if self.unknowns == 4 { GRID_WITH_JERK } else { GRID };
        let mut places = Vec::new();
        for velocity in grid[0] {
            for up in grid[1] {
                for down in grid[2] {
                    for jerk in grid[3] {
                        let mut at = centre.map(f64::ln);
                        for (at, power) in at.iter_mut().zip([velocity, up, down, jerk]) {
                            *at += power * std::f64::consts::LN_2;
                        }
                        places.extend(self.place(at));
                    }
                }
            }
        }
        let mut chosen: Vec<Values> = vec![centre.map(f64::ln)];
        for cost in COSTS {
            places.sort_by(|one, other| one.cost(cost).total_cmp(&other.cost(cost)));
            let mut more = 0;
            for place in &places {
                let near = |other: &Values| {
                    let apart = place.at.iter().zip(other).map(|(one, other)| (one - other).abs());
                    apart.fold(0.0, f64::max) < APART
                };
                if !chosen.iter().any(near) {
                    chosen.push(place.at);
                    more += 1;
                }
                if more == PLACES {
                    break;
                }
            }
        }
        for at in chosen {
            self.descend(at);
        }
        // A velocity that is not reached changes nothing: what is a little slower is looked for from there.
        let best = self.best.1;
        let values =
            [best.velocity_difference, best.acceleration, best.deceleration, best.ramp_jerk];
        if let Some(way) = self.problem.way(values)?.filter(|_| self.best.0.is_finite()) {
            for part in SLOWER {
                let [_, others @ ..] = values.map(f64::ln);
                let [up, down, jerk] = others;
                self.descend([(way.reached() * part).ln(), up, down, jerk]);
            }
        }
        Ok(())
    }

    /// What the values are at most, as logarithms.
    fn most(&self) -> Values {
        let none = f64::INFINITY;
        [self.problem.most.ln(), none, none, self.problem.wish.limits.jerk.ln()]
    }

    /// A ramp; none if its values make none.
    fn place(&mut self, mut at: Values) -> Option<Place> {
        for (at, most) in at.iter_mut().zip(self.most()) {
            *at = at.min(most);
        }
        let mut values = at.map(f64::exp);
        if self.unknowns < 4 {
            values[3] = self.best.1.ramp_jerk;
        } else {
            values[3] = values[3].min(self.problem.wish.limits.jerk);
        }
        values[0] = values[0].min(self.problem.most);
        let course = self.problem.course(values).ok()?;
        let ramp = course.ramp;
        let (aims, beyond) = (self.aims(&course), self.beyond(&course));
        let place = Place { at, aims, beyond };
        let aim = match self.aim.least {
            None => ramp.duration_s,
            Some(Quantity::Velocity) => ramp.peak_velocity,
            Some(Quantity::Acceleration) => ramp.peak_acceleration,
            Some(Quantity::Jerk) => ramp.peak_jerk,
        } / self.unit;
        let in_time = ramp.duration_s <= self.aim.within_s;
        if aim < self.best.0 && in_time && self.problem.keeps(&ramp) {
            self.best = (aim, ramp);
        }
        place.aim().is_finite().then_some(place)
    }

    /// What the aim is the greatest of.
    fn aims(&self, course: &Course) -> Vec<Option<f64>> {
        let Course { ramp, stretches, steps } = course;
        let trapezoid = self.problem.wish.ramp == RampType::Trapezoid;
        let index = match self.aim.least {
            None => return vec![Some(ramp.duration_s / self.unit)],
            Some(Quantity::Jerk) if trapezoid => {
                let jerk = |step: &f64| step / self.problem.wish.cycle_s + ramp.peak_cam_jerk;
                return steps.iter().map(|step| Some(jerk(step) / self.unit)).collect();
            }
            Some(Quantity::Velocity) => 0,
            Some(Quantity::Acceleration) => 1,
            Some(Quantity::Jerk) => 2,
        };
        let sides = stretches.iter().flat_map(|stretch| {
            let [least, most] = stretch
                .and_then(|all| all.get(index).copied())
                .map_or([None; 2], |ends| ends.map(Some));
            [least.map(|least| -least / self.unit), most.map(|most| most / self.unit)]
        });
        sides.collect()
    }

    /// By which part limits are exceeded, below 0 where they are kept.
    fn beyond(&self, course: &Course) -> Vec<Option<f64>> {
        let Course { ramp, stretches, steps } = course;
        let wish = self.problem.wish;
        let SlaveLimits { velocity, acceleration, jerk } = wish.limits;
        let velocity = velocity.max(wish.slave.velocity.abs());
        let part = |value: f64, limit: f64| limit.is_finite().then_some(value / limit - 1.0);
        let [low, high] = wish.position;
        let [least, greatest] = ramp.positions;
        let limited = wish.ramp != RampType::Trapezoid;
        let mut parts = vec![
            part(ramp.duration_s, self.aim.within_s),
            low.is_finite().then_some((low - least) / self.span),
            high.is_finite().then_some((greatest - high) / self.span),
            part(ramp.peak_cam_jerk, jerk).filter(|_| limited),
        ];
        for index in 0..STRETCHES {
            let limits = [velocity, acceleration];
            let reached = stretches.get(index).copied().flatten().map(|[v, a, _]| [v, a]);
            let sides = reached.map(|reached| {
                let pairs = reached.into_iter().zip(limits);
                pairs.flat_map(|([least, most], limit)| [part(-least, limit), part(most, limit)])
            });
            match sides {
                Some(sides) => parts.extend(sides),
                None => parts.extend([None; 4]),
            }
        }
        if !limited {
            let of_cam = ramp.peak_cam_jerk;
            parts.extend(steps.iter().map(|step| part(step / wish.cycle_s + of_cam, jerk)));
        }
        parts
    }

    /// From a place on as long as that is better.
    fn descend(&mut self, at: Values) {
        let Some(mut place) = self.place(at) else { return };
        let [mut region, largest, smallest] = REGION;
        for _ in 0..STEPS {
            let slopes = self.slopes(&place);
            let Some((by, promised)) = program(&place, &slopes, &self.most(), region) else {
                return;
            };
            let mut next = place.at;
            for (next, by) in next.iter_mut().zip(by) {
                *next += by;
            }
            let next = self.place(next);
            let gained =
                next.as_ref().map_or(f64::NEG_INFINITY, |next| place.cost(DEAR) - next.cost(DEAR));
            if gained > 0.7 * promised {
                region = (2.0 * region).min(largest);
            } else if gained < 0.2 * promised {
                region /= 4.0;
            }
            if let Some(next) = next.filter(|_| gained > 0.0) {
                place = next;
            }
            let [small, worse] = HOPELESS;
            let hopeless = region < small && place.cost(DEAR) > self.best.0 * (1.0 + worse);
            if region < smallest || promised < 1e-9 || hopeless {
                return;
            }
        }
    }

    /// How all parts change with each of the values.
    fn slopes(&mut self, place: &Place) -> Vec<Slope> {
        let mut slopes = Vec::with_capacity(self.unknowns);
        for index in 0..self.unknowns {
            let mut found = None;
            // On the other side where this one is no ramp of the same stretches.
            for near in [-NEAR, NEAR] {
                let mut at = place.at;
                if let Some(at) = at.get_mut(index) {
                    *at += near;
                }
                let Some(other) = self.place(at) else { continue };
                let same = shape(&other) == shape(place);
                if same || found.is_none() {
                    let slope = |one: &[Option<f64>], other: &[Option<f64>]| {
                        let pairs = (0..one.len()).map(|index| {
                            let of = |parts: &[Option<f64>]| parts.get(index).copied().flatten();
                            Some((of(other)? - of(one)?) / near)
                        });
                        pairs.map(|slope| slope.unwrap_or(0.0)).collect()
                    };
                    found = Some(Slope {
                        aims: slope(&place.aims, &other.aims),
                        beyond: slope(&place.beyond, &other.beyond),
                    });
                }
                if same {
                    break;
                }
            }
            slopes.push(found.unwrap_or_default());
        }
        slopes
    }
}

/// Which parts there are.
fn shape(place: &Place) -> (Vec<bool>, Vec<bool>) {
    let there = |parts: &[Option<f64>]| parts.iter().map(Option::is_some).collect();
    (there(&place.aims), there(&place.beyond))
}
