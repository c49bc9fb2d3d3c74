//! Plane drive of a gantry: separate axes, or an H belt with two fixed motors (manual 8.2.3).

use crate::generate::{Driven, MachineJoint, check_joints};
use crate::{DimensionError, JointDrive};

/// Drive of bridge and carriage of a gantry.
#[derive(Clone, Debug, PartialEq)]
pub enum PlaneDrive {
    /// An axis each, along x and along y (m, N).
    Axes([MachineJoint; 2]),
    /// Two motors on one belt.
    HBelt(HBelt),
}

impl Default for PlaneDrive {
    fn default() -> Self {
        Self::Axes(Default::default())
    }
}

/// Two fixed motors on one belt: both in the same direction move the one, in opposite directions the other coordinate
/// (manual, 8.2.3, `SMC_TRAFO_GantryH2`).
///
/// ```text
/// position of the bridge   = factors[0][0]·a + factors[0][1]·b = x + offset
/// position of the carriage = factors[1][0]·a + factors[1][1]·b = y + offset
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HBelt {
    /// The motors A and B: axis position in m of belt, N.
    pub motors: [MachineJoint; 2],
    /// Contributions of A and B (columns) to x and y (rows); each is ±0.5.
    pub factors: [[f64; 2]; 2],
}

impl HBelt {
    /// The manual's belt: x = (a − b)/2, y = (a + b)/2, before offsets.
    pub fn new(motors: [MachineJoint; 2]) -> Self {
        Self { motors, factors: [[0.5, -0.5], [0.5, 0.5]] }
    }

    /// The joints of bridge and carriage.
    fn joints(&self) -> Result<[Driven; 2], DimensionError> {
        let [[xa, xb], [ya, yb]] = self.factors;
        let halves =
            [xa, xb, ya, yb].iter().all(|factor| factor.abs().to_bits() == 0.5_f64.to_bits());
        // Halves are exact, and so is the determinant.
        if !halves || xa * yb - xb * ya == 0.0 {
            return Err(DimensionError::Belt(self.factors));
        }
        Ok([self.joint("bridge", [xa, xb]), self.joint("carriage", [ya, yb])])
    }

    /// It goes as far as the limits of both motors let it.
    fn joint(&self, name: &str, factors: [f64; 2]) -> Driven {
        let [a, b] = &self.motors;
        let [of_a, of_b] = factors;
        let span = |joint: &MachineJoint, factor: f64| {
            let [one, other] = joint.position_limits.map(|limit| factor * limit);
            [one.min(other), one.max(other)]
        };
        let ([low_a, high_a], [low_b, high_b]) = (span(a, of_a), span(b, of_b));
        let parts = vec![(a.machine_axis, of_a), (b.machine_axis, of_b)];
        let both = |one: Option<f64>, other: Option<f64>| Some(one? + other?);
        Driven {
            name: name.to_owned(),
            drive: JointDrive::Combination(parts),
            position_limits: Some([low_a + low_b, high_a + high_b]),
            // Half of each motor's speed, and, by virtual work, all of each motor's force.
            velocity_limit: both(a.velocity_limit, b.velocity_limit).map(|sum| 0.5 * sum),
            effort_limit: both(a.effort_limit, b.effort_limit),
        }
    }
}

impl PlaneDrive {
    /// The machine axes in it.
    pub(super) fn axes(&self) -> &[MachineJoint; 2] {
        match self {
            Self::Axes(axes) => axes,
            Self::HBelt(belt) => &belt.motors,
        }
    }

    /// The joints of bridge and carriage, in addition to `others` of the machine.
    pub(super) fn joints<'a>(
        &'a self,
        others: impl Iterator<Item = &'a MachineJoint> + Clone,
    ) -> Result<[Driven; 2], DimensionError> {
        check_joints(self.axes().iter().chain(others.clone()))?;
        match self {
            Self::Axes([x, y]) => Ok([x.driven(), y.driven()]),
            Self::HBelt(belt) => {
                let joints = belt.joints()?;
                for other in others {
                    if let Some(joint) = joints.iter().find(|joint| joint.name == other.name) {
                        let joints = [joint.name.clone(), other.name.clone()];
                        return Err(DimensionError::JointTwice(joints));
                    }
                }
                Ok(joints)
            }
        }
    }
}
