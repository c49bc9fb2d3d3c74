//! SCARA with three arms in a plane, the last one held in a direction (`SMC_TRAFO_Scara3`, `SMC_TRAFOF_Scara3`;
//! SoftMotion manual 8.2.5).
//!
//! ```text
//!   y ▲            wrist  L3
//!     │           ◯────────● tool tip (x, y), direction δ of the last arm, from +x
//!     │       L2 ╱ ) γ
//!     │         ╱
//!     │        ◯ ) β
//!     │   L1  ╱
//!     │     ╱ ) α, from +x
//!     ◯──────────────▶ x
//!   first arm's axis = origin of the machine frame
//! ```
//!
//! Zero pose: α = β = γ = 0, all arms stretched along +x. All angles count counter-clockwise about +z, β and γ relative
//! to the arm before. dA = α + oA, dB = β + oB, dC = γ + oC. L3 may be 0: the tool then turns about its own axis. The
//! transform does not use z.
//!
//! The wrist is at (x − L3·cos δ, y − L3·sin δ); from there on α and β are those of [`Scara2`](super::Scara2), with its branches, its reach
//! (of the wrist) and its singularities, and γ = δ − α − β.
//!
//! A tool offset from the end of the last arm turns with it: the frame of the flange has x along the arm, y to its
//! left. The direction remains that of the arm.

use super::chain::{Bent, Pair, TwoArms, turned};
use super::two_link::{Elbow, check_arms};
use crate::disc::Square;
use crate::error::{DimensionError, ReachOf, all_finite};
use crate::smooth::SmoothMap;
use crate::transform::{Serial, Transform};
use crate::{AxisDisc, AxisVector, Branch, Coordinate, KinematicsError, Margins, Result, ToolDisc};
use nalgebra::{Vector2, Vector3};
use std::f64::consts::E;

/// A SCARA with three arms in the x-y plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scara3 {
    arms: [f64; 3],
    offsets: Vector3<f64>,
    elbow: Elbow,
    chain: TwoArms,
    /// From the wrist to the tool tip with δ = 0.
    hand: Vector2<f64>,
}

impl Scara3 {
    /// A SCARA with arms of the lengths `arms` (m) whose axes are at `offsets` (rad: `dOffsetA`, `dOffsetB`, `dOffsetC`) when all
    /// arms are stretched along +x.
    ///
    /// # Errors
    /// [`DimensionError::ArmLength`] if one of the first two arms is not longer than 0 or the third is shorter than
    /// that, [`DimensionError::NotFinite`].
    pub fn new(arms: [f64; 3], offsets: [f64; 3], elbow: Elbow) -> Result<Self, DimensionError> {
        all_finite(arms.iter().chain(&offsets))?;
        let [first, second, third] = arms;
        check_arms(&[first, second])?;
        if third < 0.0 {
            return Err(DimensionError::ArmLength { arm: 2, length: third });
        }
        Ok(Self {
            arms,
            offsets: offsets.into(),
            elbow,
            chain: TwoArms::new(first, second, elbow.sign()),
            hand: Vector2::new(third, 0.0),
        })
    }

    /// Lengths of the arms, m.
    pub const fn arms(&self) -> [f64; 3] {
        self.arms
    }

    /// Axis positions with all arms stretched along +x, rad.
    pub fn offsets(&self) -> [f64; 3] {
        self.offsets.into()
    }

    /// Bend of the elbow.
    pub const fn elbow(&self) -> Elbow {
        self.elbow
    }

    /// Smallest and largest distance of the wrist from the first arm's axis, m.
    pub(crate) fn wrist_reach(&self) -> [f64; 2] {
        self.chain.reach()
    }

    /// From the wrist to the tip with the last arm in the direction δ.
    #[inline]
    fn hand_at(&self, direction: f64) -> Vector2<f64> {
        let (sin, cos) = direction.sin_cos();
        let (x, y) = (self.hand.x, self.hand.y);
        Vector2::new(x * cos - y * sin, x * sin + y * cos)
    }

    #[inline]
    fn bend(&self, tool: &Vector3<f64>) -> Result<(Bent, Vector2<f64>)> {
        let hand = self.hand_at(tool.z);
        let bent = self.chain.bend(tool.x - hand.x, tool.y - hand.y);
        Ok((bent.ok_or_else(|| self.unreachable(tool, hand))?, hand))
    }

    #[cold]
    fn unreachable(&self, tool: &Vector3<f64>, hand: Vector2<f64>) -> KinematicsError {
        KinematicsError::Unreachable {
            target: [tool.x, tool.y, 0.0],
            of: ReachOf::Wrist,
            distance: (tool.x - hand.x).hypot(tool.y - hand.y),
            reach: self.wrist_reach(),
        }
    }

    #[inline]
    fn axes(&self, bent: &Bent, direction: f64) -> Vector3<f64> {
        let [alpha, beta] = bent.angles();
        Vector3::new(alpha, beta, direction - alpha - beta) + self.offsets
    }

    #[inline]
    fn near(&self, bent: &Bent, direction: f64, near: &Vector3<f64>) -> Vector3<f64> {
        let mut axes = self.axes(bent, direction);
        if bent.alpha_is_free() {
            // The last arm keeps its direction.
            axes.z += axes.x - near.x;
            axes.x = near.x;
        }
        self.turn_to(&mut axes, near);
        axes
    }

    #[inline]
    fn links(&self, axes: &Vector3<f64>) -> (Vector3<f64>, ThreeLinks) {
        let angles = axes - self.offsets;
        let direction = angles.sum();
        let links = ThreeLinks {
            arms: Pair::at(&self.chain, angles.x, angles.y),
            hand: self.hand_at(direction),
        };
        let tip = links.arms.end() + links.hand;
        (Vector3::new(tip.x, tip.y, direction), links)
    }
}

/// From the axes of three arms to the tool.
#[derive(Clone, Copy, Debug)]
pub struct ThreeLinks {
    arms: Pair,
    hand: Vector2<f64>,
}

/// The rates at which the three arms turn.
#[inline]
fn turning(v: &Vector3<f64>) -> [f64; 3] {
    [v.x, v.x + v.y, v.x + v.y + v.z]
}

#[inline]
fn with_direction(tip: Vector2<f64>, direction: f64) -> Vector3<f64> {
    Vector3::new(tip.x, tip.y, direction)
}

impl SmoothMap<3> for ThreeLinks {
    #[inline]
    fn rate(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let [nu, omega, delta] = turning(v);
        with_direction(self.arms.rate(nu, omega) + turned(self.hand) * delta, delta)
    }

    #[inline]
    fn solve(&self, rate: &Vector3<f64>) -> Option<Vector3<f64>> {
        let wrist = rate.xy() - turned(self.hand) * rate.z;
        let [nu, omega] = self.arms.solve(&wrist)?;
        Some(Vector3::new(nu, omega - nu, rate.z - omega))
    }

    #[inline]
    fn second(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let [nu, omega, delta] = turning(v);
        with_direction(self.arms.second(nu, omega) - self.hand * (delta * delta), 0.0)
    }

    #[inline]
    fn third(&self, v: &Vector3<f64>, a: &Vector3<f64>) -> Vector3<f64> {
        let ([nu, omega, delta], [nu_change, omega_change, delta_change]) =
            (turning(v), turning(a));
        let hand = self.hand * (-3.0 * delta * delta_change)
            + turned(self.hand) * (-delta * delta * delta);
        with_direction(self.arms.third([nu, omega], [nu_change, omega_change]) + hand, 0.0)
    }
}

impl Transform<3> for Scara3 {
    type Differential = Serial<ThreeLinks>;

    fn coordinates(&self) -> &'static [Coordinate] {
        &[Coordinate::X, Coordinate::Y, Coordinate::Direction]
    }

    fn rotary(&self) -> [bool; 3] {
        [true; 3]
    }

    #[inline]
    fn to_tool(&self, axes: &Vector3<f64>) -> Result<Vector3<f64>> {
        Ok(self.links(axes).0)
    }

    #[inline]
    fn to_axes(&self, tool: &Vector3<f64>) -> Result<Vector3<f64>> {
        let (bent, _) = self.bend(tool)?;
        Ok(self.axes(&bent, tool.z))
    }

    #[inline]
    fn to_axes_near(&self, tool: &Vector3<f64>, near: &Vector3<f64>) -> Result<Vector3<f64>> {
        let (bent, _) = self.bend(tool)?;
        Ok(self.near(&bent, tool.z, near))
    }

    #[inline]
    fn at_axes(&self, axes: &Vector3<f64>) -> Result<(Vector3<f64>, Self::Differential)> {
        let (tool, links) = self.links(axes);
        Ok((tool, Serial(links)))
    }

    #[inline]
    fn at_tool(
        &self,
        tool: &Vector3<f64>,
        near: &Vector3<f64>,
    ) -> Result<(Vector3<f64>, Self::Differential)> {
        let (bent, hand) = self.bend(tool)?;
        let axes = self.near(&bent, tool.z, near);
        Ok((axes, Serial(ThreeLinks { arms: bent.vectors(), hand })))
    }

    fn branch(&self) -> Branch {
        self.elbow.branch()
    }

    fn branch_at(&self, axes: &Vector3<f64>) -> Branch {
        Elbow::of(axes.y - self.offsets.y).branch()
    }

    fn margins(&self, tool: &Vector3<f64>) -> Margins {
        let boundary = self.chain.margin((tool.xy() - self.hand_at(tool.z)).norm());
        Margins { boundary, branch: boundary }
    }

    fn disc(&self, path: &ToolDisc) -> Option<AxisDisc> {
        let hand = self.hand_at(path.pose.direction);
        let wrist = path.pose.position.coords.xy() - hand;
        let rate = path.rate.xy() - turned(hand) * path.turn_rate;
        // Within a turn of one radian e^z − 1 − z is at most ½·e·z².
        let swing = hand.norm() * E * (path.turn_bend + path.turn_rate * path.turn_rate);
        let square = Square {
            size: wrist.norm(),
            along: wrist.dot(&rate).abs(),
            rate: rate.norm(),
            bend: path.bend.xy().norm() + 2.0 * swing,
        };
        let (radius, [alpha, beta]) = self.chain.disc(&square, path.little_turn());
        let change = [alpha, beta, alpha + beta + path.turn(radius)];
        let change = AxisVector::from_values(change);
        Some(AxisDisc { radius, change, is_even: path.is_upright() })
    }

    fn characteristic_length(&self) -> f64 {
        self.arms.iter().sum()
    }

    fn holding(self, tip: &Vector3<f64>) -> Self {
        Self { hand: Vector2::new(self.arms[2] + tip.x, tip.y), ..self }
    }
}
