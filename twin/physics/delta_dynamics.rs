//! Delta dynamics: equation of motion of a tripod with a level platform, in closed form.
//!
//! **Position.** Both rods of a pair share their direction s, |s| = L, from the carriage down to the platform, which
//! does not turn. Let t be the pair's carriage as seen from the middle of the platform, h its height, and p = (w, z)
//! the position of the platform. Then s = (w − t, z − h). All |t| have the same length e, and Σt = 0. With ζ and δ the
//! heights of z and of the h above the mean of the h, the three equations |s|² = L² are
//!
//! ```text
//! w = a·ζ + b,  a = −2·Σδ·t / 3e²,  b = Σδ²·t / 3e²      (1 + a²)·ζ² + 2·a·b·ζ + b² + Σδ²/3 + e² − L² = 0
//! ```
//!
//! The lower ζ is the machine's. The rods never point up: that would be another way of assembly.
//!
//! **Motion.** With the positions q of the carriages and K the matrix of the rows s/sz,
//!
//! ```text
//! q̇ = K·ṗ      q̈ = K·p̈ + k,  k = ṡ·ṡ/sz
//! ```
//!
//! Each carriage has the inertia A: its mass, its rotor and m₁₁ of its rods. b = m₁₂ of its rods couples it to the
//! platform. The platform has the inertia μ: its mass and m₂₂ of all rods (see `tripod`). W and w are the masses
//! that hang on carriage and platform. The efforts are
//!
//! ```text
//! τ = A·q̈ + b·p̈z − gz·W + K⁻ᵀ·F      F = μ·p̈ + ẑ·(b·q̈) − g·w
//! ```
//!
//! Multiplied by Kᵀ and with q̈ inserted, this is a symmetric system of three equations for p̈:
//!
//! ```text
//! (Kᵀ·A·K + Kᵀ·b·ẑᵀ + ẑ·bᵀ·K + μ)·p̈ = Kᵀ·(τ + gz·W − A·k) − ẑ·(b·k) + g·w
//! ```
//!
//! Its matrix N also gives the mobility of the carriages, K·N⁻¹·Kᵀ. Only three-by-three matrices of the platform are
//! inverted.

use nalgebra::{Matrix3, Vector2, Vector3};

use crate::bodies::MassProperties;
use crate::dynamics::Dynamics;
use crate::joint::{JointMatrix, JointVector};
use crate::linkage::{Carriage, RodBody};

/// A tripod with a level platform, and additional axes.
#[derive(Clone, Debug)]
pub(super) struct DeltaDynamics {
    axes: [usize; 3],
    /// t, m.
    towers: [Vector2<f64>; 3],
    /// Of the middle of a carriage's rod ends above that of the platform, with the carriage at 0, m.
    above: f64,
    /// 1/3e², 1/m².
    scale: f64,
    /// L² − e², m².
    reach: f64,
    gravity: Vector3<f64>,
    /// A, kg.
    carried: Vector3<f64>,
    /// b, kg.
    shared: Vector3<f64>,
    /// μ, kg.
    platform: f64,
    /// W and w, kg.
    hanging: (Vector3<f64>, f64),
    /// Axes that have nothing to do with the tool; 1 in the place of the inertia of the carriages.
    others: Option<Dynamics>,
}

/// The rods at one place.
struct Place {
    /// K.
    matrix: Matrix3<f64>,
    /// 1/sz.
    inverse: Vector3<f64>,
}

impl Place {
    /// The rates of the carriages with the platform moving so.
    #[inline]
    fn rates(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.matrix * v
    }

    /// And back; what is not a number where the rods do not hold the platform.
    #[inline]
    fn shift(&self, rates: &Vector3<f64>) -> Vector3<f64> {
        let k = &self.matrix;
        // The third column is 1.
        let (x1, y1, q1) = (k.m21 - k.m11, k.m22 - k.m12, rates.y - rates.x);
        let (x2, y2, q2) = (k.m31 - k.m11, k.m32 - k.m12, rates.z - rates.x);
        let inverse = 1.0 / (x1 * y2 - x2 * y1);
        let (x, y) = ((q1 * y2 - q2 * y1) * inverse, (x1 * q2 - x2 * q1) * inverse);
        Vector3::new(x, y, rates.x - (k.m11 * x + k.m12 * y))
    }

    /// k.
    #[inline]
    fn bend(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let across = v.x * v.x + v.y * v.y;
        let rise = self.matrix.column(0) * v.x + self.matrix.column(1) * v.y;
        (rise.component_mul(&rise)).add_scalar(across).component_mul(&self.inverse)
    }
}

impl DeltaDynamics {
    /// From its parts, with `armature` (kg) on every axis; `others` include their rotors.
    pub(super) fn new(
        gravity: Vector3<f64>,
        armature: &JointVector,
        (carriages, rods, platform): (&[Carriage; 3], &[RodBody; 6], &MassProperties),
        others: Option<Dynamics>,
    ) -> Self {
        let axes = carriages.map(|carriage| carriage.axis);
        let mut carried = Vector3::from(carriages.map(|carriage| carriage.mass));
        let (mut above, mut below) = (carried, platform.mass);
        carried += Vector3::from(axes.map(|axis| armature[axis]));
        let (mut shared, mut moved) = (Vector3::zeros(), platform.mass);
        for rod in rods {
            let [upper, both, lower] = rod.masses;
            let [weight_above, weight_below] = rod.shares;
            for (sum, part) in
                [(&mut carried, upper), (&mut shared, both), (&mut above, weight_above)]
            {
                sum[rod.carriage] += part;
            }
            moved += lower;
            below += weight_below;
        }
        let [first, _, second, _, third, _] = rods;
        let towers = [first, second, third].map(|rod| (rod.upper - rod.lower).xy());
        let squared = towers.iter().map(Vector2::norm_squared).sum::<f64>() / 3.0;
        Self {
            axes,
            towers,
            above: first.upper.z - first.lower.z,
            scale: 1.0 / (3.0 * squared),
            reach: first.length * first.length - squared,
            gravity,
            carried,
            shared,
            platform: moved,
            hanging: (above, below),
            others,
        }
    }

    /// Accelerations of the axes under `effort`; `None` at singular positions, or if an axis moves no inertia.
    pub(super) fn acceleration(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        effort: &JointVector,
    ) -> Option<JointVector> {
        let place = self.place(position)?;
        let found = self.carriages(&place, &self.inertia(&place), velocity, effort)?;
        let others = match &mut self.others {
            Some(others) => others.acceleration(position, velocity, effort)?,
            None => JointVector::zeros(),
        };
        Some(self.with_carriages(others, &found))
    }

    /// As [`Self::acceleration`], and the inverse of the inertia, with 1 on its diagonal where the machine has no axis.
    pub(super) fn acceleration_and_mobility(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        effort: &JointVector,
    ) -> Option<(JointVector, JointMatrix)> {
        let place = self.place(position)?;
        let inertia = self.inertia(&place);
        let found = self.carriages(&place, &inertia, velocity, effort)?;
        let (others, mut mobility) = match &mut self.others {
            Some(others) => others.acceleration_and_mobility(position, velocity, effort)?,
            None => (JointVector::zeros(), JointMatrix::identity()),
        };
        let block = place.matrix * inertia.try_inverse()? * place.matrix.transpose();
        for (row, axis) in block.row_iter().zip(self.axes) {
            for (value, other) in row.iter().zip(self.axes) {
                mobility[(axis, other)] = *value;
            }
        }
        Some((self.with_carriages(others, &found), mobility))
    }

    /// The efforts that give the axes `acceleration`; `None` where the rods do not meet or hold nothing.
    pub(super) fn inverse_dynamics(
        &mut self,
        position: &JointVector,
        velocity: &JointVector,
        acceleration: &JointVector,
    ) -> Option<JointVector> {
        let place = self.place(position)?;
        let changes = self.of_carriages(acceleration);
        let shift = place.shift(&self.of_carriages(velocity));
        let change = place.shift(&(changes - place.bend(&shift)));
        let (above, below) = self.hanging;
        let mut force = change * self.platform - self.gravity * below;
        force.z += self.shared.dot(&changes);
        let pulls = self.carried.component_mul(&changes) + self.shared * change.z
            - above * self.gravity.z
            + solve(&place.matrix.transpose(), &force)?;
        let others = match &mut self.others {
            Some(others) => others.inverse_dynamics(position, velocity, acceleration),
            None => JointVector::zeros(),
        };
        Some(self.with_carriages(others, &pulls))
    }

    /// Directions of the rods; `None` if they do not meet, or one of them is level.
    #[inline]
    fn place(&self, position: &JointVector) -> Option<Place> {
        let heights = self.of_carriages(position).add_scalar(self.above);
        let mean = heights.sum() / 3.0;
        let above = heights.add_scalar(-mean);
        let [t1, t2, t3] = &self.towers;
        let squares = above.component_mul(&above);
        let a = (t1 * above.x + t2 * above.y + t3 * above.z) * (-2.0 * self.scale);
        let b = (t1 * squares.x + t2 * squares.y + t3 * squares.z) * self.scale;
        let (square, half) = (1.0 + a.norm_squared(), a.dot(&b));
        let rest = b.norm_squared() + squares.sum() / 3.0 - self.reach;
        let root = (half * half - square * rest).sqrt();
        let below = -(half + root) / square;
        let w = a * below + b;
        let drop = Vector3::repeat(below) - above;
        // Written so that what is not a number is nowhere.
        if !(drop.x < 0.0 && drop.y < 0.0 && drop.z < 0.0) {
            return None;
        }
        let inverse = Vector3::new(1.0 / drop.x, 1.0 / drop.y, 1.0 / drop.z);
        let [r1, r2, r3] = [(w - t1) * inverse.x, (w - t2) * inverse.y, (w - t3) * inverse.z];
        let matrix = Matrix3::new(r1.x, r1.y, 1.0, r2.x, r2.y, 1.0, r3.x, r3.y, 1.0);
        Some(Place { matrix, inverse })
    }

    /// N.
    #[inline]
    fn inertia(&self, Place { matrix, .. }: &Place) -> Matrix3<f64> {
        let [x, y] = [matrix.column(0), matrix.column(1)];
        let [along_x, along_y] = [x.component_mul(&self.carried), y.component_mul(&self.carried)];
        let (xx, xy, yy) = (along_x.dot(&x), along_x.dot(&y), along_y.dot(&y));
        let (xz, yz) = (along_x.sum() + self.shared.dot(&x), along_y.sum() + self.shared.dot(&y));
        let zz = self.carried.sum() + 2.0 * self.shared.sum();
        let platform = Matrix3::from_diagonal_element(self.platform);
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) + platform
    }

    /// The accelerations of the carriages.
    fn carriages(
        &self,
        place: &Place,
        inertia: &Matrix3<f64>,
        velocity: &JointVector,
        effort: &JointVector,
    ) -> Option<Vector3<f64>> {
        let bend = place.bend(&place.shift(&self.of_carriages(velocity)));
        let (above, below) = self.hanging;
        let pulls =
            self.of_carriages(effort) + above * self.gravity.z - self.carried.component_mul(&bend);
        let mut force = place.matrix.tr_mul(&pulls) + self.gravity * below;
        force.z -= self.shared.dot(&bend);
        Some(place.rates(&solve(inertia, &force)?) + bend)
    }

    /// The values of the carriages.
    #[inline]
    fn of_carriages(&self, values: &JointVector) -> Vector3<f64> {
        let [a, b, c] = self.axes;
        Vector3::new(values[a], values[b], values[c])
    }

    fn with_carriages(&self, mut others: JointVector, carriages: &Vector3<f64>) -> JointVector {
        for (axis, value) in self.axes.into_iter().zip(carriages) {
            others[axis] = *value;
        }
        others
    }
}

/// The v with `matrix`·v = `values`; `None` if there is none, or no single one.
#[inline]
fn solve(m: &Matrix3<f64>, values: &Vector3<f64>) -> Option<Vector3<f64>> {
    let first = Vector3::new(m.m11, m.m12, m.m13);
    let second = Vector3::new(m.m21, m.m22, m.m23);
    let third = Vector3::new(m.m31, m.m32, m.m33);
    let cross = second.cross(&third);
    let sum = cross * values.x + third.cross(&first) * values.y + first.cross(&second) * values.z;
    let result = sum * (1.0 / first.dot(&cross));
    (result.x.is_finite() && result.y.is_finite() && result.z.is_finite()).then_some(result)
}
