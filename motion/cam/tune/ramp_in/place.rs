//! A place in the search for a ramp: its values, and all that it is judged by.

use super::course::{Course, Reached, Stretch};
use super::problem::{Problem, Values};
use super::wish::RampIn;
use crate::{Quantity, SlaveLimits};

/// So far from its limits a ramp stays, as a part of them, so that the last digits of a program keep them.
const MARGIN: f64 = 1e-7;

/// What a ramp is compared by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    /// The peak that is to be small; the duration if none.
    pub(super) least: Option<Quantity>,
    /// It takes so long at most, s.
    pub(super) within_s: f64,
}

impl Aim {
    /// What is to be small.
    pub(super) fn of(&self, ramp: &RampIn) -> f64 {
        match self.least {
            None => ramp.duration_s,
            Some(Quantity::Velocity) => ramp.peak_velocity,
            Some(Quantity::Acceleration) => ramp.peak_acceleration,
            Some(Quantity::Jerk) => ramp.peak_jerk,
        }
    }
}

/// What a part of a place is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum What {
    Duration,
    /// Least position, its sign turned.
    Low,
    /// Greatest position.
    High,
    /// Velocity, acceleration or jerk; of the least one the sign is turned.
    Peak(usize, bool),
    /// The jerk of a step of the acceleration.
    Step,
}

/// A part of what a place is judged by: it changes smoothly with the values.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// On which stretch of the ramp, if it is on one, and beside which piece of the cam.
    stretch: usize,
    piece: i64,
    what: What,
    pub(super) value: f64,
}

/// A ramp and what it is judged by.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// Logarithms of its values.
    pub(super) at: Values,
    pub(super) stretches: Vec<Stretch>,
    /// In the order of their stretches, pieces and kinds.
    pub(super) parts: Vec<Part>,
    pub(super) aim: f64,
    /// How far it is beyond the limit that it exceeds most, as a part of it; 0 if it keeps all of them.
    pub(super) excess: f64,
}

/// By what a place is judged.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judge {
    aim: Aim,
    limits: [f64; 3],
    position: [f64; 2],
    span: f64,
    limited: bool,
    cycle_s: f64,
}

impl Judge {
    pub(super) fn new(problem: &Problem<'_>, aim: Aim) -> Self {
        let wish = problem.wish;
        let SlaveLimits { velocity, acceleration, jerk } = wish.limits;
        let velocity = velocity.max(wish.slave.velocity.abs());
        Self {
            aim,
            limits: [velocity, acceleration, jerk],
            position: wish.position,
            span: problem.span(),
            limited: problem.limited(),
            cycle_s: wish.cycle_s,
        }
    }

    pub(super) fn place(&self, at: Values, course: &Course) -> Place {
        let Course { ramp, stretches, reached, steps } = course;
        let part = |what, value| Part { stretch: 0, piece: i64::MIN, what, value };
        let [least, greatest] = ramp.positions;
        let mut parts = vec![
            part(What::Duration, ramp.duration_s),
            part(What::Low, -least),
            part(What::High, greatest),
        ];
        for Reached { stretch, piece, ends } in reached {
            for (index, [least, most]) in ends.iter().enumerate() {
                let part = |upper, value| Part {
                    stretch: stretch + 1,
                    piece: *piece,
                    what: What::Peak(index, upper),
                    value,
                };
                // With trapezoid ramps the jerk is that of their steps.
                if index < 2 || self.limited {
                    parts.extend([part(false, -least), part(true, *most)]);
                }
            }
        }
        if !self.limited {
            let jerk = |(stretch, step): (usize, &f64)| Part {
                stretch: stretch + 1,
                piece: i64::MAX,
                what: What::Step,
                value: step / self.cycle_s + ramp.peak_cam_jerk,
            };
            parts.extend(steps.iter().enumerate().map(jerk));
            parts.sort_by_key(|part| (part.stretch, part.piece, part.what));
        }
        let aims = parts.iter().filter(|part| self.aims(part)).map(|part| part.value);
        let aim = aims.fold(f64::NEG_INFINITY, f64::max);
        let beyond = |part: &Part| self.exceeds(part).map(|[by, to]| by * part.value + to);
        let excess = parts.iter().filter_map(beyond).fold(0.0, f64::max);
        Place { at, stretches: stretches.clone(), parts, aim, excess }
    }

    /// Whether a part belongs to the aim: the greatest of these is to be small.
    pub(super) fn aims(&self, part: &Part) -> bool {
        match part.what {
            What::Duration => self.aim.least.is_none(),
            What::Low | What::High => false,
            What::Peak(0, _) => self.aim.least == Some(Quantity::Velocity),
            What::Peak(1, _) => self.aim.least == Some(Quantity::Acceleration),
            // With trapezoid ramps that of the steps alone.
            What::Peak(..) => self.aim.least == Some(Quantity::Jerk) && self.limited,
            What::Step => self.aim.least == Some(Quantity::Jerk),
        }
    }

    /// How far a part is beyond its limit, more than 0 if it is: by which factor of its value, and what is added.
    pub(super) fn exceeds(&self, part: &Part) -> Option<[f64; 2]> {
        let [low, high] = self.position;
        let (unit, limit) = match part.what {
            What::Duration => (self.aim.within_s, self.aim.within_s),
            What::Low => (self.span, -low),
            What::High => (self.span, high),
            What::Peak(index, _) => [*self.limits.get(index)?; 2].into(),
            What::Step => [self.limits[2]; 2].into(),
        };
        limit.is_finite().then(|| [1.0 / unit, MARGIN - limit / unit])
    }
}

impl Place {
    /// Which stretch of another place each of this one's is, from 1 on: where one of them has a stretch more than the other, it is
    /// a short one.
    pub(super) fn matched(&self, other: &Self) -> Vec<usize> {
        let mut found = vec![0];
        let mut theirs = other.stretches.iter().enumerate().peekable();
        for stretch in &self.stretches {
            let mut same = usize::MAX;
            while let Some((index, candidate)) = theirs.peek() {
                if candidate.kind == stretch.kind {
                    same = index + 1;
                    theirs.next();
                    break;
                }
                if candidate.duration > stretch.duration {
                    break;
                }
                theirs.next();
            }
            found.push(same);
        }
        // The end.
        found.push(other.stretches.len() + 1);
        found
    }

    /// The value of a part of another place here, with the stretches of both matched.
    pub(super) fn value(&self, part: &Part, matched: &[usize]) -> Option<f64> {
        let stretch = *matched.get(part.stretch)?;
        let key = (stretch, part.piece, part.what);
        let found =
            self.parts.binary_search_by(|part| (part.stretch, part.piece, part.what).cmp(&key));
        Some(self.parts.get(found.ok()?)?.value)
    }
}
