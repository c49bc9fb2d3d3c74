//! Extent of the workspace: a box around the reachable tool positions, found by sampling the axis positions.

use super::space::Space;
use nalgebra::{Point3, Vector3};
use std::f64::consts::PI;
use twin_kinematics::{AxisVector, Kinematics};
use twin_machine::Axis;
use twin_machine::axis_kind::AxisKind;

/// Axis positions that are looked at, all axes together.
const SAMPLES: f64 = 60_000.0;
/// Positions of one axis, at most.
const MOST: f64 = 65.0;
/// Tolerance of axis positions on the same branch, m or rad: near singularities, the root of rounding.
const SAME: f64 = 1e-6;
/// The search for the farthest point ends when the steps are this small, as a part of the axis's range.
const FINEST: f64 = 1e-11;
/// Steps of the search, at most.
const STEPS: u32 = 4000;

/// An upright box in the machine frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Smallest coordinates, m.
    pub min: Point3<f64>,
    /// Largest coordinates, m.
    pub max: Point3<f64>,
}

impl Extent {
    /// The smallest box around both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.inf(&other.min), max: self.max.sup(&other.max) }
    }

    /// The middle.
    pub fn center(&self) -> Point3<f64> {
        nalgebra::center(&self.min, &self.max)
    }

    /// Length of the sides, m.
    pub fn sides(&self) -> Vector3<f64> {
        self.max - self.min
    }
}

/// Sweep of the tool over ranges of all axes.
#[derive(Clone, Debug)]
pub struct Sweep<'s, 'm> {
    space: &'s Space<'m>,
    ranges: Vec<[f64; 2]>,
    /// Axes that move the tool.
    moving: Vec<usize>,
}

#[expect(clippy::indexing_slicing, reason = "moving axes are indices of the ranges")]
impl<'s, 'm> Sweep<'s, 'm> {
    /// Every axis within its software limits.
    pub fn within_limits(space: &'s Space<'m>) -> Self {
        Self::over(space, space.machine().axes.iter().map(|axis| axis.position_limits).collect())
    }

    /// Every rotary axis through a whole turn, the others within their software limits.
    pub fn whole_turns(space: &'s Space<'m>) -> Self {
        let range = |axis: &Axis| {
            let [low, high] = axis.position_limits;
            let middle = low.midpoint(high);
            match axis.kind {
                AxisKind::Rotary => [low.min(middle - PI), high.max(middle + PI)],
                AxisKind::Linear => [low, high],
            }
        };
        Self::over(space, space.machine().axes.iter().map(range).collect())
    }

    fn over(space: &'s Space<'m>, ranges: Vec<[f64; 2]>) -> Self {
        let moves = |axis: &usize| space.machine().kinematics.moves_tool(*axis);
        let moving = (0..ranges.len()).filter(moves).collect();
        Self { space, ranges, moving }
    }

    /// The box around every place of the tool; `None` if there is none.
    pub fn extent(&self) -> Option<Extent> {
        let count = SAMPLES.powf(1.0 / f64::from(self.dimensions().max(1))).floor().min(MOST);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "2 to 65")]
        let count = count.max(2.0) as u32;
        let mut best: [Option<(f64, AxisVector)>; 6] = [None; 6];
        self.each(count, &mut |axes, position| {
            for (side, best) in best.iter_mut().enumerate() {
                let value = outward(side, position);
                if best.is_none_or(|(most, _)| value > most) {
                    *best = Some((value, *axes));
                }
            }
        });
        let mut farthest = [0.0; 6];
        for (side, (best, farthest)) in best.into_iter().zip(&mut farthest).enumerate() {
            let (value, axes) = best?;
            *farthest = self.climb(side, value, axes, count);
        }
        let [right, left, behind, before, above, below] = farthest;
        Some(Extent {
            min: Point3::new(-left, -before, -below),
            max: Point3::new(right, behind, above),
        })
    }

    /// Number of axes that move the tool.
    fn dimensions(&self) -> u32 {
        u32::try_from(self.moving.len()).unwrap_or(u32::MAX)
    }

    fn at(&self, position: impl Fn([f64; 2]) -> f64) -> AxisVector {
        AxisVector::from_values(self.ranges.iter().map(|range| position(*range)))
    }

    /// Tool position at `axes`, if the transform would choose them: not on another branch.
    fn tool(&self, axes: &AxisVector) -> Option<Point3<f64>> {
        let kinematics = &self.space.machine().kinematics;
        let pose = kinematics.forward(axes).ok()?;
        let back = kinematics.inverse(&pose, axes).ok()?;
        let same = axes.iter().zip(back.iter()).all(|(one, other)| (one - other).abs() <= SAME);
        same.then_some(pose.position)
    }

    /// Goes through `count` positions of every axis that moves the tool.
    fn each(&self, count: u32, visit: &mut dyn FnMut(&AxisVector, &Point3<f64>)) {
        let mut axes = self.at(|[low, high]| low.midpoint(high));
        let all = count.saturating_pow(self.dimensions());
        for number in 0..all {
            let mut rest = number;
            for &index in &self.moving {
                let part = f64::from(rest % count) / f64::from(count - 1);
                rest /= count;
                let [low, high] = self.ranges[index];
                axes[index] = low + part * (high - low);
            }
            if let Some(position) = self.tool(&axes) {
                visit(&axes, &position);
            }
        }
    }

    /// Pattern search for the farthest point on one side from `axes` on: all combinations of axis steps, halved
    /// where none improves.
    fn climb(&self, side: usize, mut value: f64, mut axes: AxisVector, count: u32) -> f64 {
        let mut part = 1.0 / f64::from(count.max(2) - 1);
        for _ in 0..STEPS {
            let mut farther = None;
            for combination in 0..3_u32.saturating_pow(self.dimensions()) {
                let mut moved = axes;
                let mut rest = combination;
                for &index in &self.moving {
                    // 0, 1, 2: stay, forth, back.
                    let step = [0.0, part, -part][rest as usize % 3];
                    rest /= 3;
                    let [low, high] = self.ranges[index];
                    moved[index] = (moved[index] + step * (high - low)).clamp(low, high);
                }
                let reached = self.tool(&moved).map(|position| outward(side, &position));
                if let Some(reached) = reached.filter(|reached| *reached > value) {
                    value = reached;
                    farther = Some(moved);
                }
            }
            match farther {
                Some(moved) => axes = moved,
                None if part < FINEST => break,
                None => part /= 2.0,
            }
        }
        value
    }
}

/// Coordinate of a point towards a side: +x, −x, +y, −y, +z, −z.
#[expect(clippy::indexing_slicing, reason = "six sides of three coordinates")]
fn outward(side: usize, position: &Point3<f64>) -> f64 {
    let value = position.coords[side / 2];
    if side.is_multiple_of(2) { value } else { -value }
}
