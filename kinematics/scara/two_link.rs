//! Two arms in a plane (`SMC_TRAFO_Scara2`, `SMC_TRAFOF_Scara2`; SoftMotion manual 8.2.4).
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
//! to the first arm. Axis positions carry the offsets of the drives, dA = α + oA and dB = β + oB. z is not this
//! transform's business.
//!
//! Branch: `bElbowLow` is β ≥ 0 ([`Elbow::Low`]: seen from the base, the elbow lies to the right of the line to the
//! tool tip), otherwise β ≤ 0. It is part of the value and no call changes it.
//!
//! # Derivation
//!
//! With r² = x² + y², the law of cosines gives c = cos β = (r² − L1² − L2²) / (2·L1·L2), the manual's formula. An arc
//! cosine loses half the digits where the arms are nearly stretched or folded, so the two factors of
//! (2·L1·L2·sin β)² = ((L1 + L2)² − r²)·(r² − (L1 − L2)²) are taken instead; they are also the test of reach:
//!
//! ```text
//!   o = (L1 + L2)² − r²,  i = r² − (L1 − L2)²,  k = ±√(o·i) = 2·L1·L2·sin β
//!   β = atan2(k, (i − o)/2)
//!   α = atan2(y, x) − atan2(L2·sin β, L1 + L2·cos β)
//!     = atan2(y·m − x·k, x·m + y·k)   with m = r² + L1² − L2² = 2·L1·(L1 + L2·cos β)
//! ```
//!
//! With u = (cos α, sin α), w = (cos(α+β), sin(α+β)), ω = α̇ + β̇ and p = (x, y):
//!
//! ```text
//!   ṗ = J·(α̇, β̇),  J = [ −y  −L2·wy ]   det J = L1·L2·sin β
//!                       [  x   L2·wx ]
//!   α̇ = (w·ṗ) / (L1·sin β),  β̇ = −(p·ṗ) / (L1·L2·sin β)
//!   J·(α̈, β̈) = p̈ + L1·α̇²·u + L2·ω²·w
//! ```
//!
//! # Reach and singularities
//!
//! The tool reaches the ring |L1 − L2| ≤ r ≤ L1 + L2, its edges included. A target whose distance is off an edge by
//! no more than rounding (four units in the last place of L1 + L2, some 10⁻¹⁵ m) counts as on the edge; anything farther is
//! [`KinematicsError::Unreachable`]. On an edge sin β = 0: the position has one answer, but the axes cannot follow a
//! velocity ([`KinematicsError::Singular`] unless the tool is at rest), nor is it known there which way they would go.
//! With L1 = L2 the inner edge is the point r = 0, where α is free: the first arm then stays where `near` has it.

use crate::{
    AxisMotion, AxisVector, Coordinate, Kinematics, KinematicsError, Pose, ToolMotion, machine_axes,
};
use nalgebra::{Matrix2, Vector2};
use std::f64::consts::TAU;

/// How far off an edge of the reach counts as rounding, in parts of L1 + L2: four units in the last place.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Which way the elbow of a SCARA bends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Elbow {
    /// β ≥ 0: `bElbowLow`.
    Low,
    /// β ≤ 0.
    High,
}

/// A SCARA with two arms in the x-y plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scara2 {
    arms: [f64; 2],
    offsets: [f64; 2],
    elbow: Elbow,
    /// (L1 + L2)²; this and what follows is derived from the above once.
    outer_squared: f64,
    /// (L1 − L2)².
    inner_squared: f64,
    /// L1² − L2².
    difference: f64,
    /// What counts as rounding in the squares of the outer and the inner distance.
    rounding: [f64; 2],
    /// Sign of β.
    sign: f64,
}

/// The arms at one target.
struct Arms {
    alpha: f64,
    beta: f64,
    /// At an edge of the reach, give or take rounding.
    at_edge: bool,
}

impl Scara2 {
    /// A SCARA with arms of the lengths `arms` (m) whose axes are at `offsets` (rad: `dOffsetA`, `dOffsetB`) when both
    /// arms are stretched along +x.
    ///
    /// # Errors
    /// [`KinematicsError::ArmLength`] if an arm is not longer than 0, [`KinematicsError::NotFinite`].
    pub fn new(arms: [f64; 2], offsets: [f64; 2], elbow: Elbow) -> Result<Self, KinematicsError> {
        if !arms.iter().chain(&offsets).all(|value| value.is_finite()) {
            return Err(KinematicsError::NotFinite);
        }
        for (arm, &length) in arms.iter().enumerate() {
            if length <= 0.0 {
                return Err(KinematicsError::ArmLength { arm, length });
            }
        }
        let (sum, gap) = (arms[0] + arms[1], arms[0] - arms[1]);
        let tolerance = ROUNDING * sum;
        let square_tolerance = |edge: f64| (2.0 * edge + tolerance) * tolerance;
        Ok(Self {
            arms,
            offsets,
            elbow,
            outer_squared: sum * sum,
            inner_squared: gap * gap,
            difference: sum * gap,
            rounding: [square_tolerance(sum), square_tolerance(gap.abs())],
            sign: if elbow == Elbow::Low { 1.0 } else { -1.0 },
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

    /// Which way the elbow bends.
    pub const fn elbow(&self) -> Elbow {
        self.elbow
    }

    /// Smallest and largest distance of the tool tip from the first arm's axis, m.
    pub fn reach(&self) -> [f64; 2] {
        [(self.arms[0] - self.arms[1]).abs(), self.arms[0] + self.arms[1]]
    }

    /// The axis positions (rad) that put the tool tip at `x`, `y` (m, machine frame), with α and β in −π..=π: the core
    /// of [`Kinematics::inverse`]. At r = 0 (arms of equal length) α is 0.
    ///
    /// # Errors
    /// [`KinematicsError::Unreachable`]; also for coordinates that are not finite.
    #[inline]
    pub fn solve(&self, x: f64, y: f64) -> Result<[f64; 2], KinematicsError> {
        let arms = self.arms_at(x, y)?;
        Ok([arms.alpha + self.offsets[0], arms.beta + self.offsets[1]])
    }

    /// The tool tip x, y (m, machine frame) at the axis positions `axes` (rad): the core of [`Kinematics::forward`].
    #[inline]
    pub fn tip(&self, axes: [f64; 2]) -> [f64; 2] {
        let [u, w] = self.directions(axes);
        let tip = u * self.arms[0] + w * self.arms[1];
        [tip.x, tip.y]
    }

    /// How the tool tip moves with the axes: column i is its velocity (m/s) per rad/s of axis i.
    pub fn jacobian(&self, axes: [f64; 2]) -> Matrix2<f64> {
        let [u, w] = self.directions(axes);
        let second = Vector2::new(-w.y, w.x) * self.arms[1];
        let first = Vector2::new(-u.y, u.x) * self.arms[0] + second;
        Matrix2::from_columns(&[first, second])
    }

    /// Unit vectors along the first and the second arm.
    #[inline]
    fn directions(&self, axes: [f64; 2]) -> [Vector2<f64>; 2] {
        let alpha = axes[0] - self.offsets[0];
        let (alpha_sin, alpha_cos) = alpha.sin_cos();
        let (sin, cos) = (alpha + (axes[1] - self.offsets[1])).sin_cos();
        [Vector2::new(alpha_cos, alpha_sin), Vector2::new(cos, sin)]
    }

    #[inline]
    fn arms_at(&self, x: f64, y: f64) -> Result<Arms, KinematicsError> {
        let r_squared = x * x + y * y;
        let outer = self.outer_squared - r_squared;
        let inner = r_squared - self.inner_squared;
        // Written so that NaN is unreachable too.
        if !(outer >= -self.rounding[0] && inner >= -self.rounding[1]) {
            return Err(self.unreachable(x, y));
        }
        let k = self.sign * (outer.max(0.0) * inner.max(0.0)).sqrt();
        let m = r_squared + self.difference;
        // The two zeros of a floating-point number must not turn an arm by half a turn.
        let alpha = if r_squared > 0.0 { (y * m - x * k).atan2(x * m + y * k) } else { 0.0 };
        let beta = k.atan2(0.5 * (inner - outer));
        Ok(Arms { alpha, beta, at_edge: outer <= self.rounding[0] || inner <= self.rounding[1] })
    }

    #[cold]
    fn unreachable(&self, x: f64, y: f64) -> KinematicsError {
        KinematicsError::Unreachable {
            target: [x, y, 0.0],
            distance: x.hypot(y),
            reach: self.reach(),
        }
    }

    /// The axis positions at `pose` and whether the arms are stretched or folded.
    fn position(
        &self,
        pose: &Pose,
        near: &AxisVector,
    ) -> Result<([f64; 2], bool), KinematicsError> {
        let &[near_first, near_second] = &**near else {
            return Err(KinematicsError::AxisCount { given: near.len(), expected: 2 });
        };
        if !pose.is_finite() || !near.is_finite() {
            return Err(KinematicsError::NotFinite);
        }
        let [x, y, z] = [pose.position.x, pose.position.y, pose.position.z];
        if z.abs() > machine_axes::ABSENT {
            return Err(KinematicsError::NoAxis { coordinate: Coordinate::Z, value: z });
        }
        let arms = self.arms_at(x, y)?;
        let first = if x == 0.0 && y == 0.0 {
            near_first
        } else {
            within_half_a_turn(arms.alpha + self.offsets[0], near_first)
        };
        let second = within_half_a_turn(arms.beta + self.offsets[1], near_second);
        Ok(([first, second], arms.at_edge))
    }
}

/// `angle` plus the whole turns that bring it closest to `near`.
fn within_half_a_turn(angle: f64, near: f64) -> f64 {
    angle + TAU * ((near - angle) / TAU).round()
}

impl Kinematics for Scara2 {
    fn axis_count(&self) -> usize {
        2
    }

    fn coordinates(&self) -> &[Coordinate] {
        &[Coordinate::X, Coordinate::Y]
    }

    fn forward(&self, axes: &AxisVector) -> Result<Pose, KinematicsError> {
        let &[first, second] = &**axes else {
            return Err(KinematicsError::AxisCount { given: axes.len(), expected: 2 });
        };
        if !axes.is_finite() {
            return Err(KinematicsError::NotFinite);
        }
        let [x, y] = self.tip([first, second]);
        Ok(Pose::at(x, y, 0.0))
    }

    fn inverse(&self, pose: &Pose, near: &AxisVector) -> Result<AxisVector, KinematicsError> {
        let (position, _) = self.position(pose, near)?;
        Ok(AxisVector::from_values(position))
    }

    fn inverse_motion(
        &self,
        tool: &ToolMotion,
        near: &AxisVector,
    ) -> Result<AxisMotion, KinematicsError> {
        if !tool.is_finite() {
            return Err(KinematicsError::NotFinite);
        }
        let (position, at_edge) = self.position(&tool.pose, near)?;
        let (tool_velocity, tool_acceleration) = (tool.velocity.xy(), tool.acceleration.xy());
        let at_rest = AxisMotion::at_rest(AxisVector::from_values(position));
        if tool_velocity == Vector2::zeros() && tool_acceleration == Vector2::zeros() {
            return Ok(at_rest);
        }
        let target = tool.pose.position;
        let singular = KinematicsError::Singular { target: target.into() };
        if at_edge {
            return Err(singular);
        }
        let [u, w] = self.directions(position);
        let tip = target.xy().coords;
        let scale = 1.0 / (self.arms[0] * (position[1] - self.offsets[1]).sin());
        let rates = |tip_rate: &Vector2<f64>| {
            [w.dot(tip_rate) * scale, -tip.dot(tip_rate) * scale / self.arms[1]]
        };
        let velocity = rates(&tool_velocity);
        let turn = velocity[0] + velocity[1];
        let centripetal =
            u * (self.arms[0] * velocity[0] * velocity[0]) + w * (self.arms[1] * turn * turn);
        let motion = AxisMotion {
            position: at_rest.position,
            velocity: AxisVector::from_values(velocity),
            acceleration: AxisVector::from_values(rates(&(tool_acceleration + centripetal))),
        };
        if motion.is_finite() { Ok(motion) } else { Err(singular) }
    }
}
