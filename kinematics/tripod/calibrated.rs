//! Calibrated tripod: every rod with its own measured length and end points.
//!
//! Six rods that are not quite parallel in pairs tilt the platform a little, differently everywhere. With T the tool tip, R the attitude
//! of the platform, bi the lower rod ends seen from the tip (in the frame of the platform), ai the upper ends with the carriages at height 0
//! and qc the heights of the carriages,
//!
//! ```text
//!   si = T + R·bi − ai − qc·ẑ,   |si| = Li,   i = 1 … 6
//! ```
//!
//! are six equations: for R and q if T is given, for R and T if q is given. Newton's method solves both, starting at
//! the closed form of level pairs, until its steps are as small as rounding. (If the two forward solutions nearly meet,
//! [`Margins::branch`] near 0, the forward solution may converge to the other one; it then reports that the carriages
//! are apart.) Axis positions carry offsets, as in [`Tripod`](super::Tripod); zero pose, branch and singularities are
//! the same.
//!
//! # Derivatives
//!
//! With r = R·b, ω the angular velocity and α the angular acceleration of the platform, s·ṡ = 0 and its derivatives are, with one matrix for all orders,
//!
//! ```text
//!   s·(ṗ + ω×r − q̇·ẑ) = 0
//!   s·(p̈ + α×r − q̈·ẑ) = −ṡ·ṡ − s·(ω×(ω×r))
//!   s·(p⃛ + α̇×r − q⃛·ẑ) = −3·ṡ·s̈ − s·(2·α×(ω×r) + ω×(α×r) + ω×(ω×(ω×r)))
//! ```

use super::ideal::{plane_above, rods_disc};
use super::meet;
use super::rods::Rod;
use crate::error::{DimensionError, ReachOf, all_finite};
use crate::smooth::SmoothMap;
use crate::transform::{Parallel, Transform};
use crate::{AxisDisc, Branch, Coordinate, KinematicsError, Margins, Result, ToolDisc};
use nalgebra::{Const, Isometry3, LU, Matrix6, Rotation3, Translation3, Vector3, Vector6};

use std::f64::consts::TAU;

/// Steps of Newton's method after which there is no solution. Far from singularities five do; at an edge of reach each one halves what is missing.
const STEPS: usize = 64;
/// How far off its length a rod may be in a solution, in parts of its length.
const TOLERANCE: f64 = 32.0 * f64::EPSILON;
/// By how much the level pairs of the closed form may miss, in parts of a squared length: the true rods may reach.
const SLACK: f64 = 0.1;
/// Directions in which the edge of the reach is looked for.
const DIRECTIONS: u32 = 24;
/// Pivots below this, in parts of the largest, mean that the rods do not hold the platform.
const LOOSE: f64 = 1e-7;

/// A tripod whose rods are where they were measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibratedTripod {
    rods: [Rod; 6],
    offsets: Vector3<f64>,
    tool: Vector3<f64>,
}

/// Where everything is.
#[derive(Clone, Copy, Debug)]
struct State {
    tip: Vector3<f64>,
    attitude: Rotation3<f64>,
    heights: Vector3<f64>,
}

/// A rod in a state.
#[derive(Clone, Copy, Debug)]
struct Spoke {
    /// From the upper to the lower end.
    s: Vector3<f64>,
    /// From the tip to the lower end.
    r: Vector3<f64>,
    carriage: usize,
}

impl Spoke {
    fn height(&self, of: &Vector3<f64>) -> f64 {
        of[self.carriage]
    }
}

impl CalibratedTripod {
    /// A tripod with these rods, whose axes are at `offsets` (m) when the carriages are at height 0. Rods come in pairs, carriage 0 first.
    ///
    /// # Errors
    /// [`DimensionError`]; [`DimensionError::Loose`] if the rods would let the platform move, as pairs at no distance do.
    pub fn new(rods: [Rod; 6], offsets: [f64; 3]) -> Result<Self, DimensionError> {
        all_finite(&offsets)?;
        for (index, rod) in rods.iter().enumerate() {
            all_finite(rod.upper.iter().chain(rod.lower.iter()).chain([&rod.length]))?;
            if rod.length <= 0.0 {
                return Err(DimensionError::RodLength { rod: index, length: rod.length });
            }
            if rod.carriage != index / 2 {
                return Err(DimensionError::Loose);
            }
        }
        let tripod = Self { rods, offsets: offsets.into(), tool: Vector3::zeros() };
        if tripod.is_loose() { Err(DimensionError::Loose) } else { Ok(tripod) }
    }

    /// The rods.
    pub const fn rods(&self) -> &[Rod; 6] {
        &self.rods
    }

    /// Axis positions with the carriages at height 0, m.
    pub fn offsets(&self) -> [f64; 3] {
        self.offsets.into()
    }

    /// Pose of the platform in the machine frame with the axes at `axes` (m): it tilts.
    ///
    /// # Errors
    /// As [`Transform::to_tool`].
    pub fn platform(&self, axes: &Vector3<f64>) -> Result<Isometry3<f64>> {
        let state = self.hung_from(axes)?;
        let origin = state.tip - state.attitude * self.tool;
        Ok(Isometry3::from_parts(Translation3::from(origin), state.attitude.into()))
    }

    fn is_loose(&self) -> bool {
        // Below the middle with level rod pairs, if those reach it.
        let Some(start) = self.level(&Vector3::zeros()) else { return false };
        let spokes = self.spokes(&start);
        let Some(size) = self.rods.first().map(|rod| rod.length) else { return true };
        let matrix = tip_given(&spokes).map(|entry| entry / size);
        let pivots = matrix.col_piv_qr().unpack_r().diagonal().abs();
        // Written so that what is not a number is loose, too.
        let firm = pivots.min() > LOOSE * pivots.max();
        !firm
    }

    fn spokes(&self, state: &State) -> [Spoke; 6] {
        self.rods.map(|rod| {
            let r = state.attitude * (rod.lower.coords - self.tool);
            let height = state.heights[rod.carriage];
            let upper = Vector3::new(rod.upper.x, rod.upper.y, rod.upper.z + height);
            Spoke { s: state.tip + r - upper, r, carriage: rod.carriage }
        })
    }

    /// For every pair: where its rod would hang from the carriage if the pair were one, seen from the platform; and
    /// its length.
    fn pairs(&self) -> ([Vector3<f64>; 3], [f64; 3]) {
        let [a, b, c, d, e, f] = &self.rods;
        let pairs = [(a, b), (c, d), (e, f)];
        let middle = |(first, second): (&Rod, &Rod)| {
            ((first.upper - first.lower) + (second.upper - second.lower)) * 0.5 + self.tool
        };
        let length = |(first, second): (&Rod, &Rod)| f64::midpoint(first.length, second.length);
        (pairs.map(middle), pairs.map(length))
    }

    /// The closed form of level rod pairs; `None` far out of reach. Rods that hardly do not reach are taken as almost horizontal: the true ones may.
    fn level(&self, tip: &Vector3<f64>) -> Option<State> {
        let (middles, lengths) = self.pairs();
        let mut heights = Vector3::zeros();
        for ((height, middle), length) in heights.iter_mut().zip(middles).zip(lengths) {
            let beside = tip - middle;
            let squared = length * length - beside.xy().norm_squared();
            let least = 1e-3 * length * length;
            if squared.is_nan() || squared < -SLACK * length * length {
                return None;
            }
            *height = beside.z + squared.max(least).sqrt();
        }
        Some(State { tip: *tip, attitude: Rotation3::identity(), heights })
    }

    /// Newton's method. `matrix` gives the change of the squared lengths with attitude and unknowns, `apply` makes a step.
    /// `Err` with how far off a rod is, m.
    fn close(
        &self,
        mut state: State,
        matrix: impl Fn(&[Spoke; 6]) -> Matrix6<f64>,
        apply: impl Fn(&mut State, &Vector3<f64>),
    ) -> Result<State, f64> {
        let size = self.rods.iter().map(|rod| rod.length).fold(0.0, f64::max);
        let (mut best, mut best_off) = (state, f64::INFINITY);
        let mut tries = 3;
        for _ in 0..STEPS {
            let spokes = self.spokes(&state);
            let mut rest = Vector6::zeros();
            let mut off: f64 = 0.0;
            for ((rest, spoke), rod) in rest.iter_mut().zip(&spokes).zip(&self.rods) {
                let length = spoke.s.norm();
                *rest = (rod.length - length) * f64::midpoint(rod.length, length);
                off = off.max((length - rod.length).abs());
            }
            if off < best_off {
                (best, best_off) = (state, off);
            } else if best_off <= TOLERANCE * size {
                // No nearer than before: that may have been as near as numbers are.
                tries -= 1;
                if tries == 0 {
                    break;
                }
            }
            let Some(step) = matrix(&spokes).lu().solve(&rest) else { break };
            let (turn, shift) = (step.fixed_rows::<3>(0), step.fixed_rows::<3>(3));
            // A longer step than this has left what the matrix describes.
            let longest = (turn.norm() / 0.5).max(shift.norm() / (0.5 * size));
            let scale = 1.0 / longest.max(1.0);
            if !scale.is_finite() {
                break;
            }
            state.attitude = Rotation3::new(turn * scale) * state.attitude;
            apply(&mut state, &(shift * scale));
        }
        let hanging = self.spokes(&best).iter().all(|spoke| spoke.s.z <= 0.0);
        let upright = best.attitude.matrix().m33 > 0.0;
        if best_off <= TOLERANCE * size && hanging && upright { Ok(best) } else { Err(best_off) }
    }

    fn hung_at(&self, tip: &Vector3<f64>) -> Result<State> {
        let start = self.level(tip).ok_or_else(|| self.unreachable(tip, f64::NAN))?;
        self.close(start, tip_given, |state, shift| state.heights += shift)
            .map_err(|off| self.unreachable(tip, off))
    }

    fn hung_from(&self, axes: &Vector3<f64>) -> Result<State> {
        let apart = KinematicsError::Apart((*axes).into());
        let heights = axes - self.offsets;
        let (mut centers, lengths) = self.pairs();
        for (center, height) in centers.iter_mut().zip(&heights) {
            center.z += height;
        }
        let tip = meet::about_below(&centers, lengths, SLACK).ok_or(apart)?;
        let start = State { tip, attitude: Rotation3::identity(), heights };
        self.close(start, axes_given, |state, shift| state.tip += shift).or(Err(apart))
    }

    /// The least way from a reachable place to one that is not, in any of the horizontal directions looked in.
    fn edge(&self, tool: &Vector3<f64>) -> f64 {
        let mut nearest = 2.0 * self.characteristic_length();
        for number in 0..DIRECTIONS {
            let (sin, cos) = (TAU * f64::from(number) / f64::from(DIRECTIONS)).sin_cos();
            let reached =
                |way: f64| self.hung_at(&(tool + Vector3::new(cos, sin, 0.0) * way)).is_ok();
            if reached(nearest) {
                continue;
            }
            let (mut inside, mut outside) = (0.0, nearest);
            while outside - inside > 1e-9 * nearest.max(1e-3) {
                let middle = f64::midpoint(inside, outside);
                if reached(middle) {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            nearest = inside;
        }
        nearest
    }

    #[cold]
    fn unreachable(&self, tip: &Vector3<f64>, off: f64) -> KinematicsError {
        let target = (*tip).into();
        let (middles, lengths) = self.pairs();
        for (carriage, (middle, length)) in middles.into_iter().zip(lengths).enumerate() {
            let distance = (tip - middle).xy().norm();
            if distance > length || distance.is_nan() {
                let (of, reach) = (ReachOf::Rod(carriage), [0.0, length]);
                return KinematicsError::Unreachable { target, of, distance, reach };
            }
        }
        KinematicsError::Unreachable {
            target,
            of: ReachOf::Platform,
            distance: off,
            reach: [0.0, 0.0],
        }
    }

    fn held(&self, state: &State) -> HeldByRods {
        let spokes = self.spokes(state);
        HeldByRods { lu: tip_given(&spokes).lu(), spokes }
    }
}

/// Rows: how half the squared length of each rod changes with the attitude and with the heights.
fn tip_given(spokes: &[Spoke; 6]) -> Matrix6<f64> {
    rows(spokes, |spoke| {
        Vector3::from_fn(|row, _| if row == spoke.carriage { -spoke.s.z } else { 0.0 })
    })
}

/// Rows: how half the squared length of each rod changes with the attitude and with the tip.
fn axes_given(spokes: &[Spoke; 6]) -> Matrix6<f64> {
    rows(spokes, |spoke| spoke.s)
}

fn rows(spokes: &[Spoke; 6], last: impl Fn(&Spoke) -> Vector3<f64>) -> Matrix6<f64> {
    let mut matrix = Matrix6::zeros();
    for (mut row, spoke) in matrix.row_iter_mut().zip(spokes) {
        let turn = spoke.r.cross(&spoke.s);
        for (entry, value) in row.iter_mut().zip(turn.iter().chain(&last(spoke))) {
            *entry = *value;
        }
    }
    matrix
}

/// From the tool to the axes of a calibrated tripod.
#[derive(Clone, Copy, Debug)]
pub struct HeldByRods {
    lu: LU<f64, Const<6>, Const<6>>,
    spokes: [Spoke; 6],
}

/// A derivative of the platform's attitude (as a vector) and of the carriages' heights.
#[derive(Clone, Copy)]
struct Change {
    turn: Vector3<f64>,
    heights: Vector3<f64>,
}

impl HeldByRods {
    /// The changes that make up for `known` per rod.
    fn balance(&self, known: impl Fn(&Spoke) -> f64) -> Change {
        let mut right = Vector6::zeros();
        for (entry, spoke) in right.iter_mut().zip(&self.spokes) {
            *entry = -known(spoke);
        }
        match self.lu.solve(&right) {
            Some(x) => Change {
                turn: x.fixed_rows::<3>(0).into_owned(),
                heights: x.fixed_rows::<3>(3).into_owned(),
            },
            None => Change {
                turn: Vector3::from_element(f64::NAN),
                heights: Vector3::from_element(f64::NAN),
            },
        }
    }

    fn velocity(&self, v: &Vector3<f64>) -> Change {
        self.balance(|spoke| spoke.s.dot(v))
    }

    /// Of what the tool accelerates with `a` while moving with v.
    fn acceleration(&self, v: &Vector3<f64>, first: &Change, a: &Vector3<f64>) -> Change {
        let omega = first.turn;
        self.balance(|spoke| {
            let swing = omega.cross(&spoke.r);
            let closing = v + swing - Vector3::z() * spoke.height(&first.heights);
            spoke.s.dot(&(a + omega.cross(&swing))) + closing.norm_squared()
        })
    }
}

impl SmoothMap<3> for HeldByRods {
    fn is_singular(&self) -> bool {
        !self.lu.is_invertible()
    }

    fn rate(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.velocity(v).heights
    }

    fn solve(&self, rate: &Vector3<f64>) -> Option<Vector3<f64>> {
        let mut right = Vector6::zeros();
        for (entry, spoke) in right.iter_mut().zip(&self.spokes) {
            *entry = spoke.s.z * spoke.height(rate);
        }
        let x = axes_given(&self.spokes).lu().solve(&right)?;
        let tip = x.fixed_rows::<3>(3).into_owned();
        tip.iter().all(|value| value.is_finite()).then_some(tip)
    }

    fn second(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.acceleration(v, &self.velocity(v), &Vector3::zeros()).heights
    }

    fn third(&self, v: &Vector3<f64>, a: &Vector3<f64>) -> Vector3<f64> {
        let first = self.velocity(v);
        let second = self.acceleration(v, &first, a);
        let (omega, alpha) = (first.turn, second.turn);
        let change = self.balance(|spoke| {
            let swing = omega.cross(&spoke.r);
            let pull = omega.cross(&swing);
            let closing = v + swing - Vector3::z() * spoke.height(&first.heights);
            let closing_change =
                a + alpha.cross(&spoke.r) + pull - Vector3::z() * spoke.height(&second.heights);
            let rest = alpha.cross(&swing) * 2.0
                + omega.cross(&alpha.cross(&spoke.r))
                + omega.cross(&pull);
            3.0 * closing.dot(&closing_change) + spoke.s.dot(&rest)
        });
        change.heights
    }
}

impl Transform<3> for CalibratedTripod {
    type Differential = Parallel<HeldByRods>;

    fn coordinates(&self) -> &'static [Coordinate] {
        &Coordinate::TRANSLATIONS
    }

    fn rotary(&self) -> [bool; 3] {
        [false; 3]
    }

    fn to_tool(&self, axes: &Vector3<f64>) -> Result<Vector3<f64>> {
        Ok(self.hung_from(axes)?.tip)
    }

    fn to_axes(&self, tool: &Vector3<f64>) -> Result<Vector3<f64>> {
        Ok(self.hung_at(tool)?.heights + self.offsets)
    }

    fn at_axes(&self, axes: &Vector3<f64>) -> Result<(Vector3<f64>, Self::Differential)> {
        let state = self.hung_from(axes)?;
        Ok((state.tip, Parallel(self.held(&state))))
    }

    fn at_tool(
        &self,
        tool: &Vector3<f64>,
        _near: &Vector3<f64>,
    ) -> Result<(Vector3<f64>, Self::Differential)> {
        let state = self.hung_at(tool)?;
        Ok((state.heights + self.offsets, Parallel(self.held(&state))))
    }

    fn branch(&self) -> Branch {
        Branch::PlatformBelow
    }

    /// The platform tilts, so its way may end before or after a rod is level: the edge is looked for, in
    /// 24 horizontal directions. Beyond reach, of level rod pairs.
    fn margins(&self, tool: &Vector3<f64>) -> Margins {
        let (mut centers, lengths) = self.pairs();
        let left = centers.iter().zip(lengths);
        let left = left.map(|(center, length)| length - (tool - center).xy().norm());
        let level = left.fold(f64::INFINITY, f64::min);
        let Ok(state) = self.hung_at(tool) else {
            return Margins { boundary: level.min(0.0), branch: 0.0 };
        };
        for (center, height) in centers.iter_mut().zip(&state.heights) {
            center.z += height;
        }
        Margins { boundary: self.edge(tool), branch: plane_above(&centers, tool) }
    }

    /// The platform hardly tilts: a disc of level pairs, half as wide.
    fn disc(&self, path: &ToolDisc) -> Option<AxisDisc> {
        let (middles, lengths) = self.pairs();
        let beside = middles.map(|middle| (path.pose.position.coords - middle).xy());
        let [a, b, c] = beside;
        let disc = rods_disc(path, [(a, lengths[0]), (b, lengths[1]), (c, lengths[2])]);
        Some(AxisDisc { radius: 0.5 * disc.radius, is_even: false, ..disc })
    }

    fn characteristic_length(&self) -> f64 {
        self.rods.iter().map(|rod| rod.length).sum::<f64>() / 6.0
    }

    fn holding(self, tip: &Vector3<f64>) -> Self {
        Self { tool: *tip, ..self }
    }
}
