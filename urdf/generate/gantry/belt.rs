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
    /// Lower and upper x and y of the flange, machine frame, m. Derived: as far as the motors' limits let each go.
    pub travel: Option<[[f64; 2]; 2]>,
}

impl HBelt {
    /// The manual's belt: x = (a − b)/2, y = (a + b)/2, before offsets.
    pub fn new(motors: [MachineJoint; 2]) -> Self {
        Self { motors, factors: [[0.5, -0.5], [0.5, 0.5]], travel: None }
    }

    /// The joints of bridge and carriage.
    fn joints(&self, offsets: [f64; 2]) -> Result<[Driven; 2], DimensionError> {
        let [[xa, xb], [ya, yb]] = self.factors;
        let halves =
            [xa, xb, ya, yb].iter().all(|factor| factor.abs().to_bits() == 0.5_f64.to_bits());
        // Halves are exact, and so is the determinant.
        if !halves || xa * yb - xb * ya == 0.0 {
            return Err(DimensionError::Belt(self.factors));
        }
        let [travel_x, travel_y] = match self.travel {
            Some([x, y]) => [Some(x), Some(y)],
            None => [None; 2],
        };
        let [offset_x, offset_y] = offsets;
        Ok([
            self.joint("bridge", [xa, xb], travel_x, offset_x)?,
            self.joint("carriage", [ya, yb], travel_y, offset_y)?,
        ])
    }

    fn joint(
        &self,
        name: &str,
        factors: [f64; 2],
        travel: Option<[f64; 2]>,
        offset: f64,
    ) -> Result<Driven, DimensionError> {
        let [a, b] = &self.motors;
        let [of_a, of_b] = factors;
        let span = |joint: &MachineJoint, factor: f64| {
            let [one, other] = joint.position_limits.map(|limit| factor * limit);
            [one.min(other), one.max(other)]
        };
        let ([low_a, high_a], [low_b, high_b]) = (span(a, of_a), span(b, of_b));
        let position_limits = travel
            .map_or([low_a + low_b, high_a + high_b], |travel| travel.map(|end| end + offset));
        let [lower, upper] = position_limits;
        if !(lower.is_finite() && upper.is_finite() && lower < upper) {
            return Err(DimensionError::Limits { joint: name.to_owned(), lower, upper });
        }
        let parts = vec![(a.machine_axis, of_a), (b.machine_axis, of_b)];
        let both = |one: Option<f64>, other: Option<f64>| Some(one? + other?);
        Ok(Driven {
            name: name.to_owned(),
            drive: JointDrive::Combination(parts),
            position_limits: Some(position_limits),
            // Half of each motor's speed, and, by virtual work, all of each motor's force.
            velocity_limit: both(a.velocity_limit, b.velocity_limit).map(|sum| 0.5 * sum),
            effort_limit: both(a.effort_limit, b.effort_limit),
        })
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

    /// The joints of bridge and carriage, in addition to `others` of the machine. `offsets` are those of x and y.
    pub(super) fn joints<'a>(
        &'a self,
        others: impl Iterator<Item = &'a MachineJoint> + Clone,
        offsets: [f64; 2],
    ) -> Result<[Driven; 2], DimensionError> {
        check_joints(self.axes().iter().chain(others.clone()))?;
        match self {
            Self::Axes([x, y]) => Ok([x.driven(), y.driven()]),
            Self::HBelt(belt) => {
                let joints = belt.joints(offsets)?;
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
