//! Axis efforts along a path, linear in the path acceleration, squared path speed and path speed of a feed plan.
//!
//! With a path parameter s, axis positions q(s) and q̇ = q′·ṡ, q̈ = q′·s̈ + q″·ṡ², the equation of motion
//! `effort = M(q)·q̈ + C(q, q̇)·q̇ + g(q) + friction` becomes, per axis,
//!
//! ```text
//! effort = m·s̈ + c·ṡ² + g + d·q′·ṡ ± f      m = M·q′ (rotors included), c = M·q″ + C(q, q′)·q′
//! ```
//!
//! Friction is treated so that the result is never optimistic:
//!
//! - Viscous friction d·q′·ṡ is counted where the motor has to overcome it, and not where it helps to brake.
//! - Dry friction ±f has the sign of the velocity, which may change anywhere between two points of a plan, and any value
//!   in between at rest: all of it is counted against both limits, everywhere.

use nalgebra::Vector3;
use twin_kinematics::{AxisVector, MAX_AXES};
use twin_urdf::Model;

use crate::checked;
use crate::dynamics::Dynamics;
use crate::equation::Equation;
use crate::error::{PhysicsError, Result};
use crate::joint::{JointVector, joint_vector};

/// The drive of an axis as its efforts along a path see it; everything behind the gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLoad {
    /// Largest force or torque, N or Nm; infinite for no limit.
    pub effort_limit: f64,
    /// Dry friction, N or Nm.
    pub coulomb_friction: f64,
    /// Friction proportional to velocity, N·s/m or Nm·s/rad.
    pub viscous_friction: f64,
    /// Rotor and gear inertia as felt at the axis, kg or kg·m².
    pub armature: f64,
    /// Part of the velocity that is left to the override, from 0 to below 1.
    pub headroom: f64,
}

impl AxisLoad {
    /// The first field out of range, by name.
    fn out_of_range(&self) -> Option<(&'static str, f64)> {
        let finite = 0.0..=f64::MAX;
        let ranges = [
            ("effort_limit", self.effort_limit, 0.0..=f64::INFINITY),
            ("coulomb_friction", self.coulomb_friction, finite.clone()),
            ("viscous_friction", self.viscous_friction, finite.clone()),
            ("armature", self.armature, finite),
            ("headroom", self.headroom, 0.0..=0.999),
        ];
        let wrong = ranges.into_iter().find(|(_, value, range)| !range.contains(value));
        wrong.map(|(name, value, _)| (name, value))
    }
}

/// The equation of motion of a machine, evaluated along paths.
#[derive(Clone, Debug)]
pub struct PathDynamics {
    equation: Equation,
    /// A tree without gravity, so that weight takes no digits from the rest; none for a tripod.
    weightless: Option<Dynamics>,
    loads: Vec<AxisLoad>,
}

impl PathDynamics {
    /// Of `model` under `gravity` (m/s², machine frame), with one of `loads` per machine axis.
    ///
    /// # Errors
    /// [`PhysicsError`] if the model is neither a tree of links that the machine's axes move, each one joint or several
    /// together, nor a tripod, or if a number is out of range.
    pub fn new(model: &Model, loads: &[AxisLoad], gravity: Vector3<f64>) -> Result<Self> {
        for (axis, load) in loads.iter().enumerate() {
            if let Some((parameter, value)) = load.out_of_range() {
                return Err(PhysicsError::DriveParameter { axis, parameter, value });
            }
        }
        let armature = joint_vector(loads.iter().map(|load| load.armature));
        let equation = Equation::new(model, loads.len(), gravity, armature)?;
        let weightless = match &equation {
            Equation::Tree(_) => {
                Some(Dynamics::new(model, loads.len(), Vector3::zeros(), armature)?)
            }
            Equation::Tripod(_) => None,
        };
        Ok(Self { equation, weightless, loads: loads.to_vec() })
    }

    /// True for each axis whose motor has enough effort at every place for every motion within `limits`: velocity and acceleration
    /// of every axis, SI. False for machines with rotary joints, where it is not known.
    pub fn always_enough(&self, limits: &[[f64; 2]]) -> Vec<bool> {
        let Equation::Tree(tree) = &self.equation else { return vec![false; self.loads.len()] };
        let Some((inertia, weight)) = tree.uniform() else { return vec![false; self.loads.len()] };
        let enough = |(axis, load): (usize, &AxisLoad)| {
            let moves =
                limits.iter().enumerate().map(|(other, [_, most])| match inertia[(axis, other)] {
                    0.0 => 0.0,
                    inertia => inertia.abs() * most,
                });
            let velocity = limits.get(axis).map_or(f64::INFINITY, |[velocity, _]| *velocity);
            let drag =
                if load.viscous_friction > 0.0 { load.viscous_friction * velocity } else { 0.0 };
            let left = 1.0 - load.headroom;
            let spare = load.effort_limit - weight[axis].abs() - load.coulomb_friction;
            moves.sum::<f64>() + left * drag <= left * left * spare
        };
        self.loads.iter().enumerate().map(enough).collect()
    }

    /// At `position` (m or rad), where the derivatives of the positions by the path parameter are `first` (q′) and
    /// `second` (q″).
    ///
    /// # Errors
    /// [`PhysicsError::AxisCount`], [`PhysicsError::Input`], and [`PhysicsError::Apart`] where no platform can be.
    pub fn at(
        &mut self,
        position: &AxisVector,
        first: &AxisVector,
        second: &AxisVector,
    ) -> Result<TorqueAlongPath> {
        let [position, first, second] =
            [position, first, second].map(|values| checked(values, self.loads.len(), 0));
        let (position, first, second) = (position?, first?, second?);
        let [inertia, centrifugal, weight] = self.efforts(&position, &first, &second)?;
        let mut axes = [AxisEffort::default(); MAX_AXES];
        for (axis, (slot, load)) in axes.iter_mut().zip(&self.loads).enumerate() {
            *slot = AxisEffort {
                inertia: inertia[axis],
                centrifugal: centrifugal[axis],
                weight: weight[axis],
                viscous: load.viscous_friction * first[axis],
                dry: load.coulomb_friction,
                limit: load.effort_limit,
                left: 1.0 - load.headroom,
            };
        }
        Ok(TorqueAlongPath { axes, count: self.loads.len() })
    }

    /// Efforts per unit of s̈, per unit of ṡ², and against gravity.
    fn efforts(
        &mut self,
        position: &JointVector,
        first: &JointVector,
        second: &JointVector,
    ) -> Result<[JointVector; 3]> {
        let zero = JointVector::zeros();
        match (&mut self.equation, &mut self.weightless) {
            (Equation::Tree(weighty), Some(weightless)) => Ok([
                weightless.inverse_dynamics(position, &zero, first),
                weightless.inverse_dynamics(position, first, second),
                weighty.inverse_dynamics(position, &zero, &zero),
            ]),
            (Equation::Tripod(tripod), _) => {
                let state = tripod.state(position)?;
                let weight = tripod.additional_efforts(position, &zero, &zero);
                Ok([
                    tripod.efforts(&state, &zero, first, false)
                        + tripod.additional_efforts(position, &zero, first)
                        - weight,
                    tripod.efforts(&state, first, second, false)
                        + tripod.additional_efforts(position, first, second)
                        - weight,
                    tripod.efforts(&state, &zero, &zero, true) + weight,
                ])
            }
            (Equation::Tree(_), None) => Err(PhysicsError::Apart),
        }
    }
}

/// The bound `acceleration`·s̈ + `speed_v2`·ṡ² + `speed`·ṡ ≤ `limit`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffortRow {
    /// The axis whose motor it is.
    pub axis: usize,
    /// Coefficient of s̈.
    pub acceleration: f64,
    /// Coefficient of ṡ².
    pub(crate) speed_v2: f64,
    /// Coefficient of ṡ, at least 0.
    pub speed: f64,
    /// Remaining effort of the motor, N or Nm; below 0 where weight and dry friction alone exceed it.
    pub limit: f64,
}

impl EffortRow {
    /// The coefficients of s̈, ṡ² and ṡ as parts of the limit.
    pub fn per_limit(&self) -> [f64; 3] {
        [self.acceleration, self.speed_v2, self.speed].map(|part| part / self.limit)
    }
}

/// Effort of one axis at one point of a path: coefficients in N or Nm per unit of their variable.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisEffort {
    /// m: per unit of s̈.
    pub inertia: f64,
    /// c: per unit of ṡ², without viscous friction.
    pub centrifugal: f64,
    /// g: what holds the axis against gravity.
    pub weight: f64,
    /// d·q′: viscous friction per unit of ṡ, with the sign of the motion.
    pub viscous: f64,
    /// f: dry friction, of either sign.
    pub dry: f64,
    /// Largest effort of the motor; infinite for no limit.
    pub limit: f64,
    /// Part of the velocity that a plan may use: 1 less the headroom of the override.
    left: f64,
}

impl AxisEffort {
    /// Motor effort at the path acceleration s̈ and the path speed ṡ, without dry friction, N or Nm.
    pub fn effort(&self, acceleration: f64, speed: f64) -> f64 {
        self.inertia * acceleration
            + (self.centrifugal * speed + self.viscous) * speed
            + self.weight
    }

    /// True if the motor can hold the axis here, dry friction against it.
    pub fn holds(&self) -> bool {
        self.spare().into_iter().all(|spare| spare >= 0.0)
    }

    /// Largest constant ṡ; infinite where no speed is too high.
    pub fn largest_constant_speed(&self) -> f64 {
        let ways = [1.0, -1.0].into_iter().zip(self.spare()).zip(self.drag());
        let speeds = ways.map(|((sign, spare), drag)| {
            // c·ṡ² + d·ṡ ≤ spare, both sides with the headroom taken off as in the rows.
            let (square, linear) = (sign * self.centrifugal, self.left * drag);
            let spare = self.left * self.left * spare.max(0.0);
            let root = linear * linear + 4.0 * square * spare;
            let slowing = linear + root.max(0.0).sqrt();
            if root < 0.0 || slowing <= 0.0 { f64::INFINITY } else { 2.0 * spare / slowing }
        });
        speeds.fold(f64::INFINITY, f64::min)
    }

    /// Effort left by weight and dry friction, upwards and downwards.
    fn spare(&self) -> [f64; 2] {
        [self.limit - self.weight - self.dry, self.limit + self.weight - self.dry]
    }

    /// Viscous friction per unit of ṡ where it is to be overcome, upwards and downwards.
    fn drag(&self) -> [f64; 2] {
        [self.viscous.max(0.0), (-self.viscous).max(0.0)]
    }

    /// Largest ṡ at which the motor overcomes weight and friction without acceleration, at every override within
    /// the headroom; infinite without viscous friction or without a limit.
    ///
    /// With [`Self::rows`] it keeps the motor within its limit at every constant override up to 1 / (1 − headroom):
    /// dynamic efforts fall with the square of the override, viscous friction with itself, weight not at all.
    pub fn largest_speed(&self) -> f64 {
        let ways = self.spare().into_iter().zip(self.drag()).filter(|(_, drag)| *drag > 0.0);
        let speeds = ways.map(|(spare, drag)| (self.left * spare / drag).max(0.0));
        speeds.fold(f64::INFINITY, f64::min)
    }

    /// The limits of the motor upwards and downwards.
    ///
    /// At an override k, rows and limits are those of k²·(m·s̈ + c·ṡ²) + k·d·q′·ṡ + g ± f at the largest k.
    pub fn rows(&self, axis: usize) -> [EffortRow; 2] {
        let [up, down] = self.spare();
        let [drag_up, drag_down] = self.drag();
        let row = |sign: f64, spare: f64, drag: f64| EffortRow {
            axis,
            acceleration: sign * self.inertia,
            speed_v2: sign * self.centrifugal,
            speed: self.left * drag,
            limit: self.left * self.left * spare,
        };
        [row(1.0, up, drag_up), row(-1.0, down, drag_down)]
    }
}

/// The efforts of all axes at one point of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueAlongPath {
    axes: [AxisEffort; MAX_AXES],
    count: usize,
}

impl TorqueAlongPath {
    /// Of every axis, in machine-file order.
    pub fn axes(&self) -> &[AxisEffort] {
        self.axes.get(..self.count).unwrap_or_default()
    }

    /// Those whose motor has a limit, with the number of the axis. They are the same at every point.
    pub fn limited(&self) -> impl Iterator<Item = (usize, &AxisEffort)> {
        self.axes().iter().enumerate().filter(|(_, effort)| effort.limit.is_finite())
    }

    /// Two rows per limited axis: [`AxisEffort::rows`].
    pub fn rows(&self) -> impl Iterator<Item = EffortRow> {
        self.limited().flat_map(|(axis, effort)| effort.rows(axis))
    }

    /// The smallest [`AxisEffort::largest_speed`] and its axis; `None` if no motor limits the speed alone.
    pub fn largest_speed(&self) -> Option<(f64, usize)> {
        self.limited()
            .map(|(axis, effort)| (effort.largest_speed(), axis))
            .filter(|(speed, _)| speed.is_finite())
            .min_by(|one, other| one.0.total_cmp(&other.0))
    }

    /// An axis that its motor cannot hold here.
    pub fn overloaded(&self) -> Option<usize> {
        self.limited().find(|(_, effort)| !effort.holds()).map(|(axis, _)| axis)
    }
}
