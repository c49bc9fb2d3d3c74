//! Fallback scaling: a profile with limited jerk, scaled down from a guess, for windows where Clarabel finds none.

use super::Planner;
use super::verify::exceeds;
use super::window::{can_be_followed, stretches};
use crate::time_optimal::axis_path::AxisPath;
use crate::time_optimal::profile_segment::ProfileSegment;
use crate::time_optimal::sample::grid;
use crate::time_optimal::smooth::Beginning;
use twin_path::prepare::CheckedElement;

/// So often every value of the first guess is made a mean of its neighbours before it is slowed down.
const SMOOTHED: [usize; 6] = [0, 16, 64, 256, 1024, 4096];
/// It is looked so often how much slower it has to be: all but drag of motors is known after the first.
const LOOKS: u32 = 8;
/// A profile that all but rests on the way would be smoothed to rest around there: c is this part of the largest at least.
const LEAST: f64 = 1e-6;

impl<I, E, A> Planner<I, E, A>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
    A: AxisPath,
{
    /// From rest to rest, within all limits: with u̇ k times what it is on any profile with a continuous ü accelerations are k² times
    /// what they are and jerks k³ times. The fastest that comes of the first guess; none if the window does not begin at rest.
    pub(super) fn slowed(&mut self) -> Option<Vec<ProfileSegment>> {
        if self.beginning != Beginning::Rest {
            return None;
        }
        let mut guess = self.first_guess();
        self.subdivide(&mut guess);
        self.bend(&mut guess);
        let largest = guess.c.iter().copied().fold(0.0, f64::max);
        let mut logs: Vec<f64> = guess.c.iter().map(|c| c.max(LEAST * largest).ln()).collect();
        let mut fastest: Option<(f64, Vec<ProfileSegment>)> = None;
        let mut passes = 0;
        for wanted in SMOOTHED {
            while passes < wanted {
                smooth(&mut logs);
                passes += 1;
            }
            let c: Vec<f64> = logs.iter().map(|log| log.exp()).collect();
            let Some(slowed) = self.slow_down(&c) else { continue };
            let duration = slowed.iter().map(ProfileSegment::duration).sum();
            if fastest.as_ref().is_none_or(|(least, _)| duration < *least) {
                fastest = Some((duration, slowed));
            }
        }
        let (_, slowed) = fastest?;
        // What was asked for in vain is not asked for any more: the next window begins as this one is left.
        for (cell, stretch) in self.cells.iter_mut().zip(&slowed) {
            (cell.tight, cell.dense) = ([1.0; 3], false);
            cell.take_tangents(stretch);
        }
        Some(slowed)
    }

    /// The profile of these c, as fast as the limits let it be.
    fn slow_down(&mut self, c: &[f64]) -> Option<Vec<ProfileSegment>> {
        let grid = grid(&self.sampler, &self.cells);
        let mut profile = self.smooth.profile(&grid, self.beginning, c);
        for _ in 0..LOOKS {
            let found = stretches(&grid, &profile);
            if !can_be_followed(&found) {
                return None;
            }
            let [acceleration, jerk, velocity] = self.worst_of(&found);
            let b = acceleration.recip().min(jerk.powf(-2.0 / 3.0)).min(velocity.powi(-2));
            if !(b.is_finite() && b > 0.0) {
                return None;
            }
            profile.scale(b);
            let slower = stretches(&grid, &profile);
            if !exceeds(self.worst_of(&slower), false) {
                return Some(slower);
            }
        }
        None
    }

    /// The largest acceleration, jerk and velocity, as parts of the limits, those at joints included.
    fn worst_of(&self, stretches: &[ProfileSegment]) -> [f64; 3] {
        let cells = self.cells.iter().zip(stretches);
        cells.fold([0.0; 3], |[a, j, v]: [f64; 3], (cell, stretch)| {
            let [acceleration, jerk, velocity] = self.worst(cell, stretch);
            let (b, _) = stretch.at_position(stretch.length());
            let joint = (b / cell.joint.v2).sqrt();
            [a.max(acceleration), j.max(jerk), v.max(velocity).max(joint)]
        })
    }
}

/// Every value, but the first and the last, the mean of itself and its neighbours.
fn smooth(values: &mut [f64]) {
    let Some(mut before) = values.first().copied() else { return };
    for index in 1..values.len().saturating_sub(1) {
        let Some([here, after]) = values.get_mut(index..index + 2) else { return };
        let mean = (before + *here + *after) / 3.0;
        before = std::mem::replace(here, mean);
    }
}

#[cfg(test)]
#[allow(clippy::expect_used, clippy::panic, reason = "tests")]
mod tests {
    use crate::time_optimal::blended_path::BlendOptions;
    use crate::time_optimal::smooth::Aim;
    use crate::time_optimal::{
        AxisLimits, AxisPath, KinematicPath, Leg, LimitOptions, Planned, Planner,
    };
    use nalgebra::Point3;
    use std::f64::consts::PI;
    use twin_kinematics::AxisVector;
    use twin_kinematics::gantry::Gantry2;
    use twin_path::Place;
    use twin_path::prepare::{CheckError, CheckVelocities};
    use twin_path::{ElementKind, PathElement, Shape};

    const LIMITS: AxisLimits = AxisLimits { velocity: 0.4, acceleration: 3.0, jerk: Some(60.0) };

    /// Along these points, m, rounded within a tolerance, m. Where Clarabel is to find nothing it is asked for more than there is.
    fn planned(points: &[[f64; 2]], tolerance: f64, solvable: bool) -> (Vec<Leg>, u64, u64) {
        let pairs = points.windows(2).zip(1..);
        let elements = pairs.map(|(pair, line)| {
            let [start, end] = [pair[0], pair[1]].map(|[x, y]| Point3::new(x, y, 0.0));
            let place = Place { line, block: None };
            let made = PathElement::new(place, ElementKind::Cut, Shape::Line { start, end });
            Ok::<_, CheckError>(PathElement {
                feed: 0.3,
                acceleration: 20.0,
                deceleration: 20.0,
                ..made
            })
        });
        let axes = KinematicPath::new(
            Gantry2::new([0.0; 2]).expect("a gantry"),
            vec![LIMITS; 2],
            AxisVector::zeros(2),
        );
        let options = LimitOptions::new(BlendOptions::new(tolerance));
        let mut planner = Planner::new(CheckVelocities::new(elements, PI), axes, options);
        if !solvable {
            planner.smooth.aim = Aim::Slowest;
            planner.smooth.floors = vec![1e9; 100_000];
        }
        let legs = planner.by_ref().map(|planned| match planned {
            Ok(Planned::Leg(leg)) => leg,
            other => panic!("{other:?}"),
        });
        let legs = legs.collect();
        (legs, planner.effort().failed, planner.effort().windows)
    }

    fn duration(legs: &[Leg]) -> f64 {
        legs.iter().map(|leg| leg.stretch.duration()).sum()
    }

    /// All of the path, from rest to rest, with no step of u̇ or ü, and no axis beyond its limits.
    fn check(legs: &[Leg], length: f64) {
        let axes = KinematicPath::new(
            Gantry2::new([0.0; 2]).expect("a gantry"),
            vec![LIMITS; 2],
            AxisVector::zeros(2),
        );
        let gone: f64 = legs.iter().map(|leg| leg.stretch.length()).sum();
        assert!((gone - length).abs() <= 1e-9, "{gone} of {length}");
        let mut last = (0.0, 0.0);
        for leg in legs {
            let begins = leg.stretch.at_position(0.0);
            assert!((begins.0.sqrt() - last.0).abs() <= 1e-9, "{begins:?} after {last:?}");
            assert!((begins.1 - last.1).abs() <= 1e-6, "{begins:?} after {last:?}");
            let (b, a) = leg.stretch.at_position(leg.stretch.length());
            last = (b.sqrt(), a);
            // Between the ends, where the third derivative of the path has a step.
            for part in 0..10_u8 {
                let u = leg.stretch.length() * (f64::from(part) + 0.5) / 10.0;
                let point = axes.axes(&leg.element, leg.from + u, &leg.start).expect("reached");
                let (b, a) = leg.stretch.at_position(u);
                let (v, jerk) = (b.sqrt(), leg.stretch.jerk_at(u));
                let rates = &point.rates;
                let axes = rates.first.iter().zip(rates.second.iter()).zip(rates.third.iter());
                for ((first, second), third) in axes {
                    assert!((first * v).abs() <= 1.001 * LIMITS.velocity);
                    assert!((first * a + second * b).abs() <= 1.001 * LIMITS.acceleration);
                    let jerk = first * jerk + 3.0 * second * a * v + third * b * v;
                    assert!(jerk.abs() <= 1.05 * 60.0, "{jerk} in {leg:?}");
                }
            }
        }
        assert!(last.0 <= 1e-6, "{last:?}");
    }

    #[test]
    fn without_clarabel_the_path_is_gone_within_the_limits() {
        let teeth: Vec<[f64; 2]> = (0..24_u8)
            .map(|tooth| [0.01 * f64::from(tooth), 0.02 * f64::from(tooth % 2)])
            .collect();
        for points in [vec![[0.0, 0.0], [0.3, 0.1]], teeth] {
            let length =
                points.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum();
            let (legs, failed, windows) = planned(&points, 1e-4, false);
            check(&legs, length);
            assert!(failed > 0 && failed == windows, "{failed} of {windows}");
            let (fastest, none, _) = planned(&points, 1e-4, true);
            check(&fastest, length);
            assert_eq!(none, 0);
            let longer = duration(&legs) / duration(&fastest);
            assert!((1.0..3.0).contains(&longer), "{longer}");
        }
    }

    /// One degree that is not rounded: an axis takes the step of its velocity within a cycle of 1 ms.
    #[test]
    fn kinks_are_passed_slowly_enough() {
        let turn = 1_f64.to_radians();
        let points = [[0.0, 0.0], [0.2, 0.0], [0.2 + 0.2 * turn.cos(), 0.2 * turn.sin()]];
        for solvable in [false, true] {
            let (legs, _, _) = planned(&points, 0.0, solvable);
            let pair =
                legs.windows(2).find(|pair| pair[0].element.place() != pair[1].element.place());
            let (b, _) = pair.expect("two lines")[1].stretch.at_position(0.0);
            let step = b.sqrt() * turn.sin();
            assert!(step <= 1.0001e-3 * LIMITS.acceleration, "{step} m/s, solvable: {solvable}");
        }
    }
}
