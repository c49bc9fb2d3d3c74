//! Loop closure: the positions of the passive joints of a machine with kinematic loops.
//!
//! A [`Loop`](crate::Loop) requires two points to coincide. The gaps `r` (three coordinates per loop, machine frame, m)
//! become zero by Newton's iteration over the passive joints, damped where it would overshoot (Levenberg and
//! Marquardt):
//!
//! ```text
//! (JᵀJ + λ·1) δ = −Jᵀ r,    J = ∂r/∂(passive joints): for each joint between the base and a point p,
//!                               ±a × (p − o) if it turns about a through o, ±a if it slides along a
//! ```
//!
//! λ is 0 as long as that shrinks the gaps, so convergence is quadratic at the end. Many machines can be assembled in
//! two ways. The assembly of the [rest](JointDrive::Passive) position is kept: the driven joints move to their targets
//! in several parts, none of which moves a joint by more than [`LARGEST_PART`].

mod workspace;

use crate::{Joint, JointDrive, JointKind, Model};
use workspace::{Followers, Gaps, Workspace};

/// Gaps of this size, relative to the size of the machine, are closed: some fifty rounding errors.
const CLOSED: f64 = 1e-14;
/// Gaps of this size are closed too if rounding keeps them from shrinking further.
const CLOSED_BY_ROUNDING: f64 = 1e-13;
/// Enough to come from the other end of the travel; a few do from the cycle before.
const STEPS: usize = 100;
/// No joint moves further in one part of the way, in rad or in parts of the machine's size: where two ways of assembly are
/// nearer to each other, they are not distinguished.
const LARGEST_PART: f64 = 0.1;
/// Of the way from where the axes are to where they go.
const SMALLEST_PART: f64 = 1.0 / 4096.0;
/// λ where there was none, relative to the largest diagonal element of `JᵀJ`.
const FIRST_DAMPING: f64 = 1e-4;
/// λ with which a step is too short to change anything.
const LARGEST_DAMPING: f64 = 1e12;

/// Loops that cannot be closed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LoopError {
    /// No position of the passive joints was found: the axes are where the machine cannot be.
    #[error("the links of the machine cannot be joined with its axes there; {:.6} mm are left open", .0 * 1e3)]
    Open(f64),
    /// An axis position is infinite or not a number, or the model has such numbers in it.
    #[error("a position of an axis or a joint is not a finite number")]
    NotFinite,
    /// Positions to start from that are not one per joint.
    #[error("{given} joint positions to start from, the machine has {expected} joints")]
    Start {
        /// Positions given.
        given: usize,
        /// Joints of the model.
        expected: usize,
    },
}

/// The position of every joint of a machine, kept from one instant to the next so that passive joints are looked for
/// where they have just been.
#[derive(Clone, Debug)]
pub struct JointPositions {
    /// m or rad, one per joint.
    values: Vec<f64>,
    residual: f64,
    steps: usize,
    space: Workspace,
}

impl JointPositions {
    /// The joints of `model` at rest: driven ones in the middle of their limits, or at 0 without, and passive ones where
    /// they [rest](JointDrive::Passive).
    pub fn at_rest(model: &Model) -> Self {
        let passive: Vec<_> = model
            .moving_joints()
            .filter(|(_, joint)| matches!(joint.drive, JointDrive::Passive { .. }))
            .map(|(index, _)| index)
            .collect();
        let at_rest = |joint: &Joint| match (&joint.drive, joint.position_limits) {
            (JointDrive::Passive { rest }, _) => *rest,
            (JointDrive::Axis(_) | JointDrive::Combination(_), Some([lower, upper]))
                if lower.is_finite() && upper.is_finite() =>
            {
                lower.midpoint(upper)
            }
            _ => 0.0,
        };
        let mut values: Vec<_> = model.joints.iter().map(at_rest).collect();
        let followers = Followers::new(model);
        followers.follow(&mut values);
        let space = Workspace::new(model, passive, followers, &values);
        Self { residual: 0.0, steps: 0, space, values }
    }

    /// Takes over `positions`, one per joint, to look for passive joints from there.
    /// Errors: [`LoopError::Start`] and [`LoopError::NotFinite`].
    pub(crate) fn start_from(&mut self, positions: &[f64]) -> Result<(), LoopError> {
        if positions.len() != self.values.len() {
            let (given, expected) = (positions.len(), self.values.len());
            return Err(LoopError::Start { given, expected });
        }
        if !positions.iter().all(|position| position.is_finite()) {
            return Err(LoopError::NotFinite);
        }
        self.values.copy_from_slice(positions);
        self.space.closed.copy_from_slice(positions);
        Ok(())
    }

    /// The positions, m or rad, one per joint.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The largest distance that is left between two points that should be one, m.
    #[cfg(test)]
    pub(crate) fn residual(&self) -> f64 {
        self.residual
    }

    /// Number of steps of the last iteration.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Moves the axes of `model`, the model that these are the joints of, to `axes` (m or rad, machine-file order), and
    /// the passive joints with them: from where the loops were closed last, or from rest, or if neither leads there, in
    /// one go. Allocates only where the machine is singular.
    ///
    /// # Errors
    /// [`LoopError::Open`], with the joints where the gaps are about smallest, and [`LoopError::NotFinite`], with every
    /// joint where it was. The next call begins where the loops were closed last.
    pub fn follow(&mut self, model: &Model, axes: &[f64]) -> Result<(), LoopError> {
        for (index, target) in self.space.target.iter_mut().enumerate() {
            *target = model.joint_position(index, axes);
        }
        if !self.space.target.iter().all(|value| value.is_finite()) {
            return Err(LoopError::NotFinite);
        }
        self.steps = 0;
        if model.loops.is_empty() {
            self.drive(model, 1.0);
            return Ok(());
        }
        self.space.start.copy_from_slice(&self.space.closed);
        let mut found = self.walk(model);
        if !found {
            self.space.start.copy_from_slice(&self.space.rest);
            found = self.walk(model);
        }
        if !found {
            // No way there by degrees: in one go from where the loops were closed last.
            self.values.copy_from_slice(&self.space.closed);
            self.drive(model, 1.0);
            self.close(model)?;
        }
        self.space.closed.copy_from_slice(&self.values);
        Ok(())
    }

    /// Goes from start to target, the loops closed all the way: in one go if that moves no joint far, or else in parts, so
    /// that nothing snaps to the other side. False if there is no such way.
    fn walk(&mut self, model: &Model) -> bool {
        self.values.copy_from_slice(&self.space.start);
        let (mut done, mut part) = (0.0, 1.0);
        while part >= SMALLEST_PART {
            self.space.before.copy_from_slice(&self.values);
            self.drive(model, done + part);
            if self.close(model).is_ok() && self.largest_motion(model) <= LARGEST_PART {
                done += part;
                if done >= 1.0 {
                    return true;
                }
                part = (2.0 * part).min(1.0 - done);
            } else {
                self.values.copy_from_slice(&self.space.before);
                part /= 2.0;
            }
        }
        false
    }

    /// Puts the joints that are not passive `part` (0..=1) of the way from start to target.
    fn drive(&mut self, model: &Model, part: f64) {
        let ways = self.space.start.iter().zip(&self.space.target);
        for ((value, joint), (start, target)) in self.values.iter_mut().zip(&model.joints).zip(ways)
        {
            if !matches!(joint.drive, JointDrive::Passive { .. }) {
                *value = if part < 1.0 { start + (target - start) * part } else { *target };
            }
        }
        self.space.followers.follow(&mut self.values);
    }

    /// Largest motion of any joint since the start of this part: rad, or parts of the machine's size.
    fn largest_motion(&self, model: &Model) -> f64 {
        let ways = self.values.iter().zip(&self.space.before).zip(&model.joints);
        let motion = |((now, before), joint): ((&f64, &f64), &Joint)| match joint.kind {
            JointKind::Revolute => (now - before).abs(),
            JointKind::Prismatic => (now - before).abs() / self.space.size.max(f64::MIN_POSITIVE),
            JointKind::Fixed => 0.0,
        };
        ways.map(motion).fold(0.0, f64::max)
    }

    /// Closes the loops from where the passive joints are.
    fn close(&mut self, model: &Model) -> Result<(), LoopError> {
        let mut gaps = self.space.measure(model, &self.values);
        let mut damping = 0.0;
        let mut steps = 0;
        while gaps.squares.is_finite() && !gaps.are_below(CLOSED) && steps < STEPS {
            steps += 1;
            self.space.differentiate(model);
            let Some(smaller) = self.shrink(model, &gaps, &mut damping) else { break };
            gaps = smaller;
        }
        self.steps += steps;
        self.residual = gaps.largest;
        if !gaps.squares.is_finite() {
            Err(LoopError::NotFinite)
        } else if gaps.are_below(CLOSED_BY_ROUNDING) {
            Ok(())
        } else {
            Err(LoopError::Open(gaps.largest))
        }
    }

    /// One step that makes the gaps smaller, with as little damping as that takes; `None` if there is none.
    fn shrink(&mut self, model: &Model, gaps: &Gaps, damping: &mut f64) -> Option<Gaps> {
        let stiffness = self.space.normal.diagonal().amax();
        while *damping < LARGEST_DAMPING {
            if self.space.solve(*damping * stiffness) {
                self.space.advance(model, &self.values);
                let next = self.space.measure_trial(model);
                if next.squares < gaps.squares {
                    self.values.copy_from_slice(&self.space.trial);
                    *damping = if *damping <= FIRST_DAMPING { 0.0 } else { *damping / 100.0 };
                    return Some(next);
                }
            }
            if gaps.are_below(CLOSED_BY_ROUNDING) {
                return None;
            }
            *damping = (*damping * 10.0).max(FIRST_DAMPING);
        }
        None
    }
}
