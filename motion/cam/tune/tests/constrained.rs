//! Offsets and scalings within limits: in closed form, and against grids over all that the limits leave.

use super::{PEAK, Random, VELOCITY, at_rest, lift};
use crate::tune::{
    Bound, Constrained, ConstraintError, Constraints, Free, Objective, Sample, constrained_fit,
};
use crate::{Curve, Factors, MasterMotion, Quantity, SlaveLimits};

const NONE: Free = Free::NONE;
const SLAVE: Free = Free { slave_offset: true, slave_scaling: true, ..NONE };

const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

fn wish(from: [f64; 4], free: Free) -> Constraints {
    let master = MasterMotion { velocity: VELOCITY, acceleration: 0.0, jerk: 0.0 };
    let sought = free.list().map(|free| free.then_some(ANY));
    Constraints { sought, ..Constraints::new(from, master, true) }
}

/// With `MasterScaling` within an interval.
fn within(ends: [f64; 2], mut wish: Constraints) -> Constraints {
    wish.sought[1] = wish.sought[1].map(|_| ends);
    wish
}

fn bounded(
    curve: &Curve,
    samples: &[Sample],
    wish: &Constraints,
) -> Result<Constrained, ConstraintError> {
    constrained_fit(curve, Objective::Error(samples), wish)
}

/// What a coupling makes of the master at even places of some turns.
fn samples(curve: &Curve, [offset, scaling, shift, factor]: [f64; 4], turns: f64) -> Vec<Sample> {
    let at = |index: u32| {
        let master = turns * 360.0 * (f64::from(index) + 0.5) / 240.0;
        let y = curve.repeated(master * scaling + offset).position;
        Sample { master, slave: factor * y + shift, weight: 1.0 }
    };
    (0..240).map(at).collect()
}

fn rms(curve: &Curve, samples: &[Sample], [offset, scaling, shift, factor]: [f64; 4]) -> f64 {
    let square = |one: &Sample| {
        let y = curve.repeated(one.master * scaling + offset).position;
        (factor * y + shift - one.slave).powi(2)
    };
    (samples.iter().map(square).sum::<f64>() / 240.0).sqrt()
}

/// Whether limits are kept, by what `SMC_CAMBounds` gives.
fn kept(curve: &Curve, wish: &Constraints, values: [f64; 4]) -> bool {
    let bounds = curve.bounds(&wish.master, Factors { master: values[1], slave: values[3] });
    let SlaveLimits { velocity, acceleration, jerk } = wish.limits;
    let all = [
        (bounds.velocity, [-velocity, velocity]),
        (bounds.acceleration, [-acceleration, acceleration]),
        (bounds.jerk, [-jerk, jerk]),
        (bounds.position, wish.position.map(|limit| limit - values[2])),
    ];
    all.into_iter().all(|(range, [low, high])| {
        let room = 1e-11 * (range.max - range.min).max(1.0);
        range.min >= low - room && range.max <= high + room
    }) && wish.sought[1].is_none_or(|[least, greatest]| (least..=greatest).contains(&values[1]))
}

/// Of a slave with a gain of 0.9 that should go 1: its set-point is 1/0.9, and the largest scaling is the limit over the peak.
#[test]
fn a_gain_with_a_limit_that_binds() {
    let curve = lift();
    let from = [0.0, 1.0, 0.0, 1.0 / 0.9];
    let samples = samples(&curve, from, 1.0);
    let y: Vec<f64> = samples.iter().map(|one| one.slave * 0.9).collect();
    let mean = y.iter().sum::<f64>() / 240.0;
    let square = y.iter().map(|y| y * y).sum::<f64>() / 240.0;
    let peak = PEAK * VELOCITY.powi(2);
    let limit = 1.05 * peak;
    let limits = SlaveLimits { acceleration: limit, ..SlaveLimits::NONE };
    let by = Bound::Limit { quantity: Quantity::Acceleration, limit };
    // The scaling alone.
    let alone = Constraints { limits, ..wish(from, Free { slave_scaling: true, ..NONE }) };
    let found = bounded(&curve, &samples, &alone).expect("a scaling");
    assert!((found.values[3] / 1.05 - 1.0).abs() < 1e-12, "{found:?}");
    let less = 1.0 / 0.9 - 1.05;
    assert!((found.after / (less * square.sqrt()) - 1.0).abs() < 1e-9, "{found:?}");
    assert_eq!(found.held, [vec![], vec![], vec![], vec![by]]);
    // With the offset its mean is made good.
    let both = Constraints { limits, ..wish(from, SLAVE) };
    let found = bounded(&curve, &samples, &both).expect("both");
    assert!((found.values[3] / 1.05 - 1.0).abs() < 1e-12, "{found:?}");
    assert!((found.values[2] / (less * mean) - 1.0).abs() < 1e-9, "{found:?}");
    let spread = (square - mean * mean).sqrt();
    assert!((found.after / (less * spread) - 1.0).abs() < 1e-9, "{found:?}");
    assert_eq!(found.held, [vec![], vec![], vec![], vec![by]]);
    // Where a limit of the position holds it, too, 100 · s + b = 106, the scaling falls so that the offset may rise: with z = 100 − y
    // the error is e − d · z, where e = 100/0.9 − 106 is what is missing at the top, and d = 1/0.9 − s.
    let position = [f64::NEG_INFINITY, 106.0];
    let found = bounded(&curve, &samples, &Constraints { position, ..both.clone() }).expect("both");
    let missing = 100.0 / 0.9 - 106.0;
    let d = missing * (100.0 - mean) / (1e4 - 200.0 * mean + square);
    assert!(d > less, "{d} {less}");
    assert!((found.values[3] - (1.0 / 0.9 - d)).abs() < 1e-9, "{found:?}");
    assert!((found.values[2] - (106.0 - 100.0 * found.values[3])).abs() < 1e-9, "{found:?}");
    let held = vec![Bound::Position { limit: 106.0 }];
    assert_eq!(found.held, [vec![], vec![], held.clone(), held]);
    // Below that the acceleration holds the scaling, and the position the offset next to it.
    let acceleration = 1.03 * peak;
    let limits = SlaveLimits { acceleration, ..SlaveLimits::NONE };
    let found = bounded(&curve, &samples, &Constraints { limits, position, ..both.clone() });
    let found = found.expect("both");
    assert!((found.values[3] / 1.03 - 1.0).abs() < 1e-12, "{found:?}");
    assert!((found.values[2] - 3.0).abs() < 1e-9, "{found:?}");
    let by = Bound::Limit { quantity: Quantity::Acceleration, limit: acceleration };
    let held = vec![Bound::Position { limit: 106.0 }];
    assert_eq!(found.held, [vec![], vec![], held, vec![by]]);
    // Two limits of the position alone leave a stroke, 3 to 104; without the lower one the offset would be less than 3.
    let stroke = Constraints { position: [3.0, 104.0], ..wish(from, SLAVE) };
    let found = bounded(&curve, &samples, &stroke).expect("both");
    assert!((found.values[3] - 1.01).abs() < 1e-9, "{found:?}");
    assert!((found.values[2] - 3.0).abs() < 1e-9, "{found:?}");
    assert_eq!((found.held[2].len(), found.held[3].len()), (2, 2), "{found:?}");
    // What keeps the limits stays, bit for bit.
    let wide = wish(from, SLAVE);
    assert_eq!(bounded(&curve, &samples, &wide).expect("kept").values, from);
}

#[test]
fn what_leaves_nothing_is_reported() {
    let curve = lift();
    let from = [0.0, 1.0, 0.0, 1.0];
    let samples = samples(&curve, from, 1.0);
    let acceleration = 1.0;
    let limits = SlaveLimits { acceleration, ..SlaveLimits::NONE };
    for (free, limits, position, unknown) in [
        (Free { slave_offset: true, ..NONE }, limits, [-1e9, 1e9], "SlaveOffset"),
        (Free { slave_offset: true, ..NONE }, SlaveLimits::NONE, [20.0, 90.0], "SlaveOffset"),
        (Free { slave_scaling: true, ..NONE }, SlaveLimits::NONE, [20.0, 90.0], "SlaveScaling"),
        (Free { master_scaling: true, ..NONE }, SlaveLimits::NONE, [0.0, 90.0], "MasterScaling"),
    ] {
        let task = Constraints { limits, position, ..wish(from, free) };
        let found = bounded(&curve, &samples, &task);
        let Err(ConstraintError::Contradictory { unknown: named, one, .. }) = found else {
            panic!("{found:?}");
        };
        assert_eq!(named, unknown);
        assert_ne!(one, Bound::Given);
    }
}

/// Steps of a grid along each value.
const STEPS: u32 = 16;

/// Nothing of a grid over all and of one around what was found is better by more than rounding.
fn refuse_better(
    curve: &Curve,
    task: &Constraints,
    found: &Constrained,
    all: [[f64; 2]; 4],
    cost: &dyn Fn([f64; 4]) -> f64,
) {
    assert!(kept(curve, task, found.values), "{task:?} {found:?}");
    let free = task.sought.map(|sought| sought.is_some());
    let near = |part: f64| {
        let mut ends = all;
        for ((end, value), [low, high]) in ends.iter_mut().zip(found.values).zip(all) {
            *end = [value - part * (high - low), value + part * (high - low)];
        }
        ends
    };
    let mut tried = 0;
    for ends in [all, near(0.05), near(1e-3)] {
        let count = |index: usize| if free[index] { STEPS } else { 0 };
        let at = |index: usize, step: u32| {
            let [low, high] = ends[index];
            if free[index] {
                low + (high - low) * f64::from(step) / f64::from(STEPS)
            } else {
                task.from[index]
            }
        };
        for a in 0..=count(0) {
            for b in 0..=count(1) {
                for c in 0..=count(2) {
                    for d in 0..=count(3) {
                        let values = [at(0, a), at(1, b), at(2, c), at(3, d)];
                        if kept(curve, task, values) {
                            tried += 1;
                            let left = cost(values);
                            let worse = found.after <= left * (1.0 + 1e-7) + 1e-9;
                            assert!(worse, "{task:?} {found:?}: {values:?} leaves {left}");
                        }
                    }
                }
            }
        }
    }
    assert!(tried > 5, "{task:?} {found:?}: {tried} of the grid keep the limits");
}

fn random_task(random: &mut Random, curve: &Curve, from: [f64; 4], free: Free) -> Constraints {
    let master = MasterMotion {
        velocity: random.between(100.0, 400.0),
        acceleration: if random.share() < 0.5 { 0.0 } else { random.between(0.0, 500.0) },
        jerk: 0.0,
    };
    let mut task = Constraints { master, ..wish(from, free) };
    let factors = Factors { master: from[1], slave: from[3] };
    let mut of = |quantity| {
        let part = if random.share() < 0.5 { f64::INFINITY } else { random.between(0.8, 1.1) };
        part * curve.peak(quantity, &master, factors).value
    };
    let [velocity, acceleration, jerk] = Quantity::ALL.map(&mut of);
    task.limits = SlaveLimits { velocity, acceleration, jerk };
    if random.share() < 0.7 {
        let low = from[2] + random.between(-4.0, 4.0);
        task.position = [low, low + 100.0 * from[3] * random.between(0.9, 1.1)];
    }
    task
}

#[test]
fn no_grid_finds_a_smaller_error() {
    let curve = at_rest(&[(0.0, 0.0), (120.0, 70.0), (180.0, 100.0), (360.0, 0.0)]);
    let mut random = Random(11);
    let mut changed = 0;
    for round in 0..24 {
        let from = [10.0, 1.0, random.between(-5.0, 5.0), random.between(0.9, 1.2)];
        let turns = if random.share() < 0.5 { 1.0 } else { 0.4 };
        let free = match round % 4 {
            0 => Free { slave_scaling: true, ..NONE },
            1 => SLAVE,
            2 => Free { master_offset: true, ..SLAVE },
            _ => Free { master_scaling: true, ..SLAVE },
        };
        let task = random_task(&mut random, &curve, from, free);
        let samples = samples(&curve, from, turns);
        let found = match bounded(&curve, &samples, &task) {
            Ok(found) => found,
            // A scaling alone need not leave anything.
            Err(ConstraintError::Contradictory { .. }) if round % 4 == 0 => continue,
            Err(error) => panic!("{task:?}: {error}"),
        };
        changed += u32::from(found.values != from);
        let [offset, scaling, shift, factor] = from;
        let all = [
            [offset - 30.0, offset + 30.0],
            [0.5 * scaling, 1.2 * scaling],
            [shift - 30.0, shift + 30.0],
            [0.5 * factor, 1.1 * factor],
        ];
        assert!((rms(&curve, &samples, found.values) - found.after).abs() < 1e-9, "{found:?}");
        refuse_better(&curve, &task, &found, all, &|values| rms(&curve, &samples, values));
    }
    assert!(changed > 12, "{changed}");
}

/// Where the least error within the limits is that of a slave at rest, that is reported; and the offset is never further than
/// half a turn from where it was, however little the slave moves.
#[test]
fn limits_that_leave_next_to_nothing() {
    let curve = lift();
    let from = [13.6, 1.0, 0.5, 1.0];
    let run = samples(&curve, from, 3.0);
    let free = Free { master_offset: true, ..SLAVE };
    // Nearly all of the slave's way lies above 10: a slave that stays there is nearer than one that goes its way below.
    let low = Constraints { position: [f64::NEG_INFINITY, 10.0], ..wish(from, free) };
    match bounded(&curve, &run, &low) {
        Err(ConstraintError::AtRest { unknown: "SlaveScaling" }) => {}
        other => panic!("{other:?}"),
    }
    for velocity in [20.0, 5.0, 1.0] {
        let limits = SlaveLimits { velocity, ..SlaveLimits::NONE };
        for free in [free, Free { master_scaling: true, ..free }] {
            let task = Constraints { limits, ..wish(from, free) };
            if let Ok(found) = bounded(&curve, &run, &task) {
                assert!(kept(&curve, &task, found.values), "{velocity}: {found:?}");
                assert!((found.values[0] - from[0]).abs() <= 180.0, "{velocity}: {found:?}");
            }
        }
    }
}

/// A scaling is looked for within its interval alone, and the end of it is reported.
#[test]
fn the_interval_of_a_scaling_is_kept() {
    let curve = lift();
    let from = [0.0, 1.0, 0.0, 1.0];
    let peak = PEAK * VELOCITY.powi(2);
    let limits = SlaveLimits { acceleration: 0.5 * peak, ..SlaveLimits::NONE };
    let both = Free { master_scaling: true, slave_scaling: true, ..NONE };
    let task = within([0.95, 1.05], Constraints { limits, ..wish(from, both) });
    let run = samples(&curve, from, 0.9);
    let found = bounded(&curve, &run, &task).expect("a fit");
    assert!(kept(&curve, &task, found.values), "{found:?}");
    let end = found.values[1];
    assert!((end - 0.95).abs() < 1e-12 || end > 0.95, "{found:?}");
    let by = Bound::Interval { end: 0.95 };
    assert_eq!(found.held[1].contains(&by), end == 0.95, "{found:?}");
    let alone = Constraints { sought: [None, task.sought[1], None, None], ..task };
    let error = bounded(&curve, &run, &alone).expect_err("beyond").to_string();
    assert!(error.contains("acceleration") && error.contains("0.95"), "{error}");
}
