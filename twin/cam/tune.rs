//! Tuning a cam from a recorded run, limits and tolerances (`twin tune cam`): what is found, and the lines that apply it.

use super::CamFile;
use super::check::CamUse;
use super::edit::Change;
use super::run::RecordedRun;
use std::sync::Arc;
use twin_motion::cam::tune::{
    DeadTime, Estimate, Fit, FitError, FitOptions, Free, RampError, RampGoal, RampIn, RampWish,
    ReshapeError, Sample, Switching, Tolerance, Wish, dead_time, fit, ramp_in, reshape, soften,
};
use twin_motion::cam::{
    Action, AxisState, CamTable, Element, Knot, Passage, Quantity, Shape, SlaveLimits, Source,
    StartMode, Tappet,
};

/// Why something is not tuned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TuneError {
    /// Offsets and scalings.
    #[error("offsets and scalings: {0}")]
    Fit(#[source] FitError),
    /// The dead time of tappets.
    #[error("dead time of the tappets: {0}")]
    DeadTime(#[source] FitError),
    /// The shape.
    #[error("shape: {0}")]
    Reshape(#[from] ReshapeError),
    /// The ramp.
    #[error("ramp: {0}")]
    Ramp(#[from] RampError),
    /// A table has no points to move.
    #[error("a table has no points that could be moved: only points of `elements` are")]
    NoPoints,
    /// A point that is to be moved is not there.
    #[error("no point stands at master {0}; ends of lines stay where they are")]
    NoPoint(f64),
    /// No scaling keeps the limits.
    #[error("no {what} keeps the limits: {why}")]
    NoRoom {
        /// Offset or scaling.
        what: &'static str,
        /// Why.
        why: String,
    },
}

/// Finds offsets and scalings in a run, beginning with those in use.
///
/// # Errors
/// [`TuneError::Fit`] if the run does not say them, or contradicts the cam or itself.
pub fn fit_run(
    file: &CamFile,
    using: &CamUse,
    run: &RecordedRun,
    free: Free,
    scaling_range: f64,
) -> Result<Fit, TuneError> {
    let input = &using.coupling.input;
    let options = FitOptions {
        free,
        master_offset: input.master_offset,
        master_scaling: input.master_scaling,
        scaling_range,
        slave_offset: input.slave_offset,
        slave_scaling: input.slave_scaling,
        repeated: using.repeated,
    };
    let samples: Vec<_> = run
        .samples
        .iter()
        .map(|sample| Sample { master: sample.master, slave: sample.slave, weight: 1.0 })
        .collect();
    fit(file.cam.curve(), &samples, &options).map_err(TuneError::Fit)
}

/// How far the slave of a run was from the cam: master and error of each sample.
pub fn errors(file: &CamFile, using: &CamUse, run: &RecordedRun) -> Vec<(f64, f64)> {
    let input = &using.coupling.input;
    let curve = file.cam.curve();
    let error = |sample: &super::run::RunSample| {
        let x = sample.master * input.master_scaling + input.master_offset;
        let y = if using.repeated { curve.repeated(x) } else { curve.at(x) };
        (sample.master, sample.slave - using.slave_at(y.position))
    };
    run.samples.iter().map(error).collect()
}

/// Root mean square.
pub fn rms(errors: &[(f64, f64)]) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let count = errors.len().max(1) as f64;
    (errors.iter().map(|(_, error)| error * error).sum::<f64>() / count).sqrt()
}

/// What the outputs of a run tell of the tappets that switch them.
///
/// An output that changes between two samples is taken to change half way between, and the tappet to be passed when the
/// master, on straight lines between the samples, was there. Whose tappet it was is the nearest one that switches so in the
/// master's direction.
pub fn switchings(file: &CamFile, using: &CamUse, run: &RecordedRun) -> Vec<Switching> {
    let input = &using.coupling.input;
    let places: Vec<_> = run
        .samples
        .iter()
        .map(|sample| (sample.time_s, sample.master * input.master_scaling + input.master_offset))
        .collect();
    let mut seen = Vec::new();
    for (index, pair) in run.samples.windows(2).enumerate() {
        let ([before, after], Some([from, to])) = (pair, places.get(index..index + 2)) else {
            continue;
        };
        let velocity =
            f64::midpoint(run.velocity(index), run.velocity(index + 1)) * input.master_scaling;
        if velocity == 0.0 || !velocity.is_finite() {
            continue;
        }
        let (time, place) = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
        for ((group, was), is) in run.groups.iter().zip(&before.outputs).zip(&after.outputs) {
            let Some((far, delay)) =
                nearest(file, using, (*group, *is), place, velocity).filter(|_| was != is)
            else {
                continue;
            };
            let target = place - far - velocity * delay;
            if let Some(passed) = passage(&places, index, target, velocity) {
                let distance = velocity * (time - passed - delay);
                // The time of a switching is known to half that between two samples: its place to that times the velocity.
                seen.push(Switching { velocity, distance, weight: 1.0 / (velocity * velocity) });
            }
        }
    }
    seen
}

/// How far behind the nearest tappet of a group that switches so a place is, and the tappet's own delay, s.
fn nearest(
    file: &CamFile,
    using: &CamUse,
    (group, on): (i16, bool),
    place: f64,
    velocity: f64,
) -> Option<(f64, f64)> {
    let curve = file.cam.curve();
    let width = curve.end() - curve.start();
    let behind = |tappet: &Tappet| {
        let delay = match (tappet.action, on) {
            (Action::On | Action::Invert, true) | (Action::Off | Action::Invert, false) => 0.0,
            #[expect(clippy::cast_precision_loss, reason = "a day at most")]
            (Action::Timed { delay_ns, .. }, true) => delay_ns as f64 * 1e-9,
            _ => return None,
        };
        let passes = match tappet.passage {
            Passage::Every => true,
            Passage::Positive => velocity > 0.0,
            Passage::Negative => velocity < 0.0,
        };
        let far = place - tappet.master - velocity * delay;
        let far = if using.repeated { far - (far / width).round() * width } else { far };
        passes.then_some((far, delay))
    };
    let tappets = file.cam.tappets().iter().filter(|tappet| tappet.group == group);
    tappets.filter_map(behind).min_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
}

/// When the master was at `target` last before the sample behind `index`; a little later, if it comes there later only.
fn passage(places: &[(f64, f64)], index: usize, target: f64, velocity: f64) -> Option<f64> {
    let beyond = |place: f64| (place - target) * velocity.signum() >= 0.0;
    let between = |from: &(f64, f64), to: &(f64, f64)| {
        let share = (target - from.1) / (to.1 - from.1);
        from.0 + share * (to.0 - from.0)
    };
    let crosses =
        |pair: &&[(f64, f64)]| matches!(pair, [from, to] if !beyond(from.1) && beyond(to.1));
    let time = |pair: &[(f64, f64)]| match pair {
        [from, to] => Some(between(from, to)),
        _ => None,
    };
    let before = places.get(..index + 2)?.windows(2).rev().find(crosses);
    before.or_else(|| places.get(index..)?.windows(2).find(crosses)).and_then(time)
}

/// The dead time of what tappets switch, the compensation in use included: what `DeadTimeCompensation` should be.
///
/// # Errors
/// [`TuneError::DeadTime`] if too few switchings were seen.
pub fn tappet_dead_time(using: &CamUse, seen: &[Switching]) -> Result<DeadTime, TuneError> {
    let found = dead_time(seen, false).map_err(TuneError::DeadTime)?;
    let time = found.dead_time_s;
    let dead_time_s = Estimate { value: time.value + using.coupling.dead_time_s, ..time };
    Ok(DeadTime { dead_time_s, ..found })
}

/// A shape before and after, with what it was made for.
#[derive(Clone, Debug, PartialEq)]
pub struct Shaped {
    /// The points.
    pub knots: Vec<Knot>,
    /// The largest velocity of the master, or the peak of the slave, before.
    pub before: f64,
    /// The same afterwards.
    pub after: f64,
    /// What limits it now, and where the master is then.
    pub limited: Option<(Quantity, f64)>,
    /// Linear programs that were solved.
    pub programs: usize,
}

/// What a shape is to be best in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeGoal {
    /// The largest velocity of the master.
    Speed,
    /// The smallest peak of the slave's acceleration or jerk at the master's velocity.
    Peak(Quantity),
}

/// Which points may be moved, and by how much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointTolerance {
    /// Where the point stands; `None`: all of them.
    pub master: Option<f64>,
    /// By how much.
    pub tolerance: Tolerance,
}

/// Moves points of the cam. The slave stays where it is at every tappet, and points keep their masters.
///
/// # Errors
/// [`TuneError`] if there are no such points, or nothing says what is better.
pub fn shape(
    file: &CamFile,
    using: &CamUse,
    points: &[PointTolerance],
    goal: ShapeGoal,
) -> Result<Shaped, TuneError> {
    let Shape::Polynomial(knots) = file.cam.shape() else { return Err(TuneError::NoPoints) };
    let tolerances = tolerances(file.source.as_ref(), knots, points)?;
    let factors = using.factors();
    let (fast, far) = (factors.master.abs(), factors.slave.abs());
    let SlaveLimits { velocity, acceleration, jerk } = using.limits.motion;
    // On the scale of the cam: the limits of y, and the master as the cam sees it.
    let wish = Wish {
        tolerances,
        held: file.cam.tappets().iter().map(|tappet| tappet.master).collect(),
        limits: SlaveLimits {
            velocity: velocity / far,
            acceleration: acceleration / far,
            jerk: jerk / far,
        },
        master_acceleration: using.master.acceleration * fast,
        repeated: using.repeated,
    };
    match goal {
        ShapeGoal::Speed => {
            let found = reshape(knots, &wish)?;
            Ok(Shaped {
                knots: found.knots,
                before: found.before.value / fast,
                after: found.after.value / fast,
                limited: found
                    .after
                    .limited
                    .map(|(quantity, place)| (quantity, using.master_at(place))),
                programs: found.programs,
            })
        }
        ShapeGoal::Peak(quantity) => {
            let found = soften(knots, &wish, quantity, using.master.velocity * fast)?;
            Ok(Shaped {
                knots: found.knots,
                before: found.before.value * far,
                after: found.after.value * far,
                limited: Some((quantity, using.master_at(found.after.master))),
                programs: found.programs,
            })
        }
    }
}

/// One for every point; the ends of lines have none.
fn tolerances(
    source: Option<&Source>,
    knots: &[Knot],
    points: &[PointTolerance],
) -> Result<Vec<Tolerance>, TuneError> {
    let on_line = |master: f64| {
        source.is_some_and(|source| {
            source.elements.iter().any(|element| match element {
                Element::Line { from, to } => from[0] == master || to[0] == master,
                Element::Point(_) => false,
            })
        })
    };
    let mut found = vec![Tolerance::default(); knots.len()];
    for point in points {
        let mut any = false;
        for (slot, knot) in found.iter_mut().zip(knots) {
            let meant = point
                .master
                .is_none_or(|master| (master - knot.master).abs() <= 1e-9 * master.abs().max(1.0));
            if meant && !on_line(knot.master) {
                *slot = point.tolerance;
                any = true;
            }
        }
        if let (false, Some(master)) = (any, point.master) {
            return Err(TuneError::NoPoint(master));
        }
    }
    Ok(found)
}

/// Finds a ramp for a start.
///
/// # Errors
/// [`TuneError::Ramp`] if there is none within the limits.
pub fn ramp(
    file: &CamFile,
    using: &CamUse,
    master: f64,
    slave: AxisState,
    goal: RampGoal,
) -> Result<RampIn, TuneError> {
    let mut table = CamTable::new(Arc::new(file.cam.clone()));
    table.periodic = using.repeated;
    table.slave_period = file.period.filter(|_| file.cam.curve().rise() != 0.0);
    let mut input = using.coupling.input;
    if matches!(input.start_mode, StartMode::Absolute | StartMode::Relative) {
        input.start_mode = StartMode::RampIn;
    }
    let velocity = using.master.velocity;
    let master = AxisState { position: master, velocity, acceleration: 0.0 };
    let limits = using.limits.motion;
    Ok(ramp_in(&RampWish { table, input, master, slave, limits, goal })?)
}

/// The nearest offset and scalings with which the cam keeps the limits, at the motion of the master: what is free is changed
/// by as little as can be, the scalings are made smaller only.
///
/// # Errors
/// [`TuneError::NoRoom`] if nothing does.
pub fn within_limits(file: &CamFile, using: &CamUse, free: Free) -> Result<CamUse, TuneError> {
    let mut found = *using;
    let curve = file.cam.curve();
    let peak = |using: &CamUse| {
        Quantity::ALL.map(|quantity| {
            let limit = match quantity {
                Quantity::Velocity => using.limits.motion.velocity,
                Quantity::Acceleration => using.limits.motion.acceleration,
                Quantity::Jerk => using.limits.motion.jerk,
            };
            curve.peak(quantity, &using.master, using.factors()).value / limit
        })
    };
    let worst = |using: &CamUse| peak(using).into_iter().fold(0.0, f64::max);
    if free.master_scaling {
        // All peaks grow with the scaling: halve until the largest one that keeps them is known to the last digit.
        let scaled = |share: f64| {
            let mut scaled = *using;
            scaled.coupling.input.master_scaling *= share;
            scaled
        };
        let (mut low, mut high) = (0.0, 1.0);
        if worst(&scaled(1.0)) <= 1.0 {
            low = 1.0;
        }
        while high - low > 1e-15 {
            let middle = f64::midpoint(low, high);
            if worst(&scaled(middle)) <= 1.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        found = scaled(low);
    }
    let position = curve.extremes().position;
    let [low, high] = found.limits.position;
    let height = position.max - position.min;
    if free.slave_scaling {
        // Peaks are proportional to it.
        let mut share = 1.0 / worst(&found).max(1.0);
        if free.slave_offset && (high - low).is_finite() {
            let scaling = found.coupling.input.slave_scaling.abs();
            share = share.min((high - low) / (height * scaling)).min(1.0);
        }
        found.coupling.input.slave_scaling *= share * (1.0 - 2.0 * f64::EPSILON);
        if share == 1.0 {
            found.coupling.input.slave_scaling = using.coupling.input.slave_scaling;
        }
    }
    if free.slave_offset {
        let ends = [position.min, position.max].map(|y| found.slave_at(y));
        let [bottom, top] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        if top - bottom > (high - low) * (1.0 + 1e-12) {
            let why =
                format!("the cam is {} high, the way of the slave {}", top - bottom, high - low);
            return Err(TuneError::NoRoom { what: "SlaveOffset", why });
        }
        let by = if bottom < low {
            low - bottom
        } else if top > high {
            high - top
        } else {
            0.0
        };
        found.coupling.input.slave_offset += by;
    }
    let names = ["velocity", "acceleration", "jerk"];
    for (part, name) in peak(&found).into_iter().zip(names) {
        if part > 1.0 + 1e-9 && (free.master_scaling || free.slave_scaling) {
            let why = format!("the slave's {name} is {:.1} % of its limit", part * 100.0);
            return Err(TuneError::NoRoom { what: "scaling", why });
        }
    }
    Ok(found)
}

/// What brings the text of the cam's file from one use and shape to another.
pub fn changes(before: &CamUse, after: &CamUse, shape: Option<(&CamFile, &[Knot])>) -> Vec<Change> {
    let mut changes = Vec::new();
    if let Some((file, knots)) = shape
        && let Shape::Polynomial(old) = file.cam.shape()
    {
        let stands = |knot: &Knot| {
            file.source.as_ref().is_none_or(|source| {
                source.elements.iter().any(
                    |element| matches!(element, Element::Point(point) if point.master == knot.master),
                )
            })
        };
        let moved = old.iter().zip(knots).filter(|(old, new)| old != new);
        changes.extend(moved.filter(|(_, new)| stands(new)).map(|(_, new)| Change::Point(*new)));
    }
    let pairs = before.coupling.numbers().into_iter().zip(after.coupling.numbers());
    for ((key, _, old), (_, _, new)) in pairs {
        if old.to_bits() != new.to_bits() {
            changes.push(Change::Coupling(key, new));
        }
    }
    if before.coupling.start_mode() != after.coupling.start_mode() {
        changes.push(Change::CouplingWord("start_mode", after.coupling.start_mode()));
    }
    changes
}
