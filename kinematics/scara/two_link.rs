//! SCARA with two arms in a plane (`SMC_TRAFO_Scara2`, `SMC_TRAFOF_Scara2`; SoftMotion manual 8.2.4).
//!
//! ```text
//!   y ▲            ● tool tip (x, y)
//!     │           ╱
//!     │       L2 ╱ ) β, from the first arm's direction
//!     │         ╱  ─ ─ ─
//!     │        ◯ elbow
//!     │   L1  ╱
//!     │     ╱
//!     │   ╱ ) α, from +x
//!     ◯──────────────▶ x
//!   first arm's axis = origin of the machine frame
//! ```
//!
//! Zero pose: α = β = 0, both arms stretched along +x. Both angles count counter-clockwise about +z, and β is relative
//! to the first arm. Axis positions carry the offsets of the drives, dA = α + oA and dB = β + oB. The transform does
//! not use z. `chain.rs` derives the angles from the tip.
//!
//! Branch: `bElbowLow` is β ≥ 0 ([`Elbow::Low`]: seen from the base, the elbow lies to the right of the line to the
//! tool tip), otherwise β ≤ 0. It is part of the value and no call changes it.
//!
//! A tool offset from the end of the second arm is part of that arm: the frame of the flange has x along the arm, y to
//! its left. β then counts from the line between the elbow and the tip, also for the branch and the edges of the reach;
//! the axis B still counts from the arm.
//!
//! # Reach and singularities
//!
//! The tool reaches the ring |L1 − L2| ≤ r ≤ L1 + L2, its edges included. A target whose distance is off an edge by no
//! more than rounding (four units in the last place of L1 + L2, some 10⁻¹⁵ m) counts as on the edge; anything farther
//! is [`KinematicsError::Unreachable`]. On an edge sin β = 0: the position has one answer, but the axes cannot follow a
//! velocity ([`KinematicsError::Singular`] unless the tool is at rest), and the direction of their motion is undefined.
//! With L1 = L2 the inner edge is the point r = 0, where α is free: the first arm then stays where `near` has it.

use super::chain::{Bent, Pair, TwoArms};
use crate::disc::Square;
use crate::error::{DimensionError, ReachOf, all_finite};
use crate::smooth::SmoothMap;
use crate::transform::{Serial, Transform};
use crate::{AxisDisc, AxisVector, Branch, Coordinate, KinematicsError, Margins, Result, ToolDisc};
use nalgebra::{Vector2, Vector3};

/// Bend of the elbow of a SCARA.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Elbow {
    /// β ≥ 0: `bElbowLow`.
    Low,
    /// β ≤ 0.
    High,
}

impl Elbow {
    pub(super) const fn sign(self) -> f64 {
        match self {
            Self::Low => 1.0,
            Self::High => -1.0,
        }
    }

    pub(super) const fn branch(self) -> Branch {
        match self {
            Self::Low => Branch::ElbowLow,
            Self::High => Branch::ElbowHigh,
        }
    }

    /// Of an elbow bent by `beta`: stretched and folded arms count as low.
    pub(super) fn of(beta: f64) -> Self {
        if beta.sin() >= 0.0 { Self::Low } else { Self::High }
    }
}

/// A SCARA with two arms in the x-y plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scara2 {
    arms: [f64; 2],
    offsets: [f64; 2],
    elbow: Elbow,
    /// The second reaches to the tip of the tool.
    chain: TwoArms,
    /// Axis positions less these are α and β: `offsets`, unless a tool is beside the second arm.
    zeros: Vector2<f64>,
}

impl Scara2 {
    /// A SCARA with arms of the lengths `arms` (m) whose axes are at `offsets` (rad: `dOffsetA`, `dOffsetB`) when both
    /// arms are stretched along +x.
    ///
    /// # Errors
    /// [`DimensionError::ArmLength`] if an arm is not longer than 0, [`DimensionError::NotFinite`].
    pub fn new(arms: [f64; 2], offsets: [f64; 2], elbow: Elbow) -> Result<Self, DimensionError> {
        all_finite(arms.iter().chain(&offsets))?;
        check_arms(&arms)?;
        Ok(Self {
            arms,
            offsets,
            elbow,
            chain: TwoArms::new(arms[0], arms[1], elbow.sign()),
            zeros: offsets.into(),
        })
    }

    /// Lengths of the first and second arm, m.
    pub const fn arms(&self) -> [f64; 2] {
        self.arms
    }

    /// Axis positions with both arms stretched along +x, rad.
    pub const fn offsets(&self) -> [f64; 2] {
        self.offsets
    }

    /// Bend of the elbow.
    pub const fn elbow(&self) -> Elbow {
        self.elbow
    }

    /// Smallest and largest distance of the tool tip from the first arm's axis, m.
    pub fn reach(&self) -> [f64; 2] {
        self.chain.reach()
    }

    #[inline]
    fn bend(&self, tool: &Vector2<f64>) -> Result<Bent> {
        self.chain.bend(tool.x, tool.y).ok_or_else(|| self.unreachable(tool))
    }

    #[cold]
    fn unreachable(&self, tool: &Vector2<f64>) -> KinematicsError {
        KinematicsError::Unreachable {
            target: [tool.x, tool.y, 0.0],
            of: ReachOf::Arms,
            distance: tool.x.hypot(tool.y),
            reach: self.reach(),
        }
    }

    #[inline]
    fn axes(&self, bent: &Bent) -> Vector2<f64> {
        Vector2::from(bent.angles()) + self.zeros
    }

    #[inline]
    fn near(&self, bent: &Bent, near: &Vector2<f64>) -> Vector2<f64> {
        let mut axes = self.axes(bent);
        self.turn_to(&mut axes, near);
        if bent.alpha_is_free() {
            axes.x = near.x;
        }
        axes
    }

    #[inline]
    fn pair(&self, axes: &Vector2<f64>) -> Pair {
        let angles = axes - self.zeros;
        Pair::at(&self.chain, angles.x, angles.y)
    }
}

/// Every arm must have a length.
pub(super) fn check_arms(arms: &[f64]) -> Result<(), DimensionError> {
    match arms.iter().enumerate().find(|(_, length)| **length <= 0.0) {
        Some((arm, &length)) => Err(DimensionError::ArmLength { arm, length }),
        None => Ok(()),
    }
}

/// From the axes of two arms to the tool.
#[derive(Clone, Copy, Debug)]
pub struct TwoLinks(Pair);

impl SmoothMap<2> for TwoLinks {
    #[inline]
    fn rate(&self, v: &Vector2<f64>) -> Vector2<f64> {
        self.0.rate(v.x, v.x + v.y)
    }

    #[inline]
    fn solve(&self, rate: &Vector2<f64>) -> Option<Vector2<f64>> {
        let [nu, omega] = self.0.solve(rate)?;
        Some(Vector2::new(nu, omega - nu))
    }

    #[inline]
    fn second(&self, v: &Vector2<f64>) -> Vector2<f64> {
        self.0.second(v.x, v.x + v.y)
    }

    #[inline]
    fn third(&self, v: &Vector2<f64>, a: &Vector2<f64>) -> Vector2<f64> {
        self.0.third([v.x, v.x + v.y], [a.x, a.x + a.y])
    }
}

impl Transform<2> for Scara2 {
    type Differential = Serial<TwoLinks>;

    fn coordinates(&self) -> &'static [Coordinate] {
        &[Coordinate::X, Coordinate::Y]
    }

    fn rotary(&self) -> [bool; 2] {
        [true; 2]
    }

    #[inline]
    fn to_tool(&self, axes: &Vector2<f64>) -> Result<Vector2<f64>> {
        Ok(self.pair(axes).end())
    }

    #[inline]
    fn to_axes(&self, tool: &Vector2<f64>) -> Result<Vector2<f64>> {
        Ok(self.axes(&self.bend(tool)?))
    }

    #[inline]
    fn to_axes_near(&self, tool: &Vector2<f64>, near: &Vector2<f64>) -> Result<Vector2<f64>> {
        Ok(self.near(&self.bend(tool)?, near))
    }

    #[inline]
    fn at_axes(&self, axes: &Vector2<f64>) -> Result<(Vector2<f64>, Self::Differential)> {
        let pair = self.pair(axes);
        Ok((pair.end(), Serial(TwoLinks(pair))))
    }

    #[inline]
    fn at_tool(
        &self,
        tool: &Vector2<f64>,
        near: &Vector2<f64>,
    ) -> Result<(Vector2<f64>, Self::Differential)> {
        let bent = self.bend(tool)?;
        Ok((self.near(&bent, near), Serial(TwoLinks(bent.vectors()))))
    }

    fn branch(&self) -> Branch {
        self.elbow.branch()
    }

    fn branch_at(&self, axes: &Vector2<f64>) -> Branch {
        Elbow::of(axes.y - self.zeros.y).branch()
    }

    fn margins(&self, tool: &Vector2<f64>) -> Margins {
        let boundary = self.chain.margin(tool.norm());
        Margins { boundary, branch: boundary }
    }

    fn disc(&self, path: &ToolDisc) -> Option<AxisDisc> {
        let (tip, rate) = (path.pose.position.coords.xy(), path.rate.xy());
        let wrist = Square {
            size: tip.norm(),
            along: tip.dot(&rate).abs(),
            rate: rate.norm(),
            bend: path.bend.xy().norm(),
        };
        let (radius, change) = self.chain.disc(&wrist, path.radius);
        let change = AxisVector::from_values(change);
        Some(AxisDisc { radius, change, is_even: path.is_upright() })
    }

    fn characteristic_length(&self) -> f64 {
        self.chain.first + self.chain.second
    }

    fn holding(self, tip: &Vector3<f64>) -> Self {
        let [first, second] = self.arms;
        let arm = Vector2::new(second + tip.x, tip.y);
        let zeros = Vector2::new(self.offsets[0], self.offsets[1] - arm.y.atan2(arm.x));
        Self { chain: TwoArms::new(first, arm.norm(), self.elbow.sign()), zeros, ..self }
    }
}
