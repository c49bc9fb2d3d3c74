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
//! Far from the edge of reach, two steps of the third order find R and q: the second derivative of |si|² corrects the step. The result
//! counts if every rod has its length; otherwise Newton's method decides.
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
//!
//! If T is given, each rod has the equation n·ω − sz·q̇ = −k, with n = r×s. Across a pair (each times the other's sz, subtracted) q̇ drops
//! out: three equations give ω. Along it (each times its own sz, added) the pair gives q̇.

#![expect(
    clippy::inline_always,
    reason = "pairs of rods stay in registers only if all of it is in one place: half of the time"
)]

use super::ideal::{plane_above, rods_disc};
use super::meet;
use super::rods::Rod;
use crate::error::{DimensionError, ReachOf, all_finite};
use crate::smooth::SmoothMap;
use crate::transform::{Parallel, Transform};
use crate::{AxisDisc, Branch, Coordinate, KinematicsError, Margins, Result, ToolDisc};
use nalgebra::{Isometry3, Matrix3, Matrix6, Rotation3, Translation3, Vector3, Vector6};
use wide::f64x2;

use std::f64::consts::TAU;

/// Steps of Newton's method after which there is no solution. Far from singularities five do; at an edge of reach each one halves what is missing.
const STEPS: usize = 64;
/// How far off its length a rod may be in a solution, in parts of its length.
const TOLERANCE: f64 = 32.0 * f64::EPSILON;
/// By how much the level pairs of the closed form may miss, in parts of a squared length: the true rods may reach.
const SLACK: f64 = 0.1;
/// Steps of the third order after which Newton's method decides.
const FAST_STEPS: usize = 4;
/// Rods that are less steep than this (vertical part, in parts of the length) are near an edge of reach.
const STEEP: f64 = 0.02;
/// A platform that a step turns by more than this, rad, is left to Newton's method. After all of the fast steps it is still upright.
const FAR: f64 = 0.2;
/// A step that turns by less than this, rad, needs no correction.
const SMALL: f64 = 3e-8;
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

/// The two rods of a carriage in a state.
#[derive(Clone, Copy, Debug)]
struct Pair {
    /// From the upper to the lower ends.
    s: Vector3<f64x2>,
    /// From the tip to the lower ends.
    r: Vector3<f64x2>,
}

/// The same vector for both rods of a pair.
#[inline(always)]
fn both(v: &Vector3<f64>) -> Vector3<f64x2> {
    Vector3::new(f64x2::splat(v.x), f64x2::splat(v.y), f64x2::splat(v.z))
}

/// A vector for each rod of a pair.
#[inline(always)]
fn each(first: &Vector3<f64>, second: &Vector3<f64>) -> Vector3<f64x2> {
    let of = |first, second| f64x2::from([first, second]);
    Vector3::new(of(first.x, second.x), of(first.y, second.y), of(first.z, second.z))
}

/// The sum of each over both rods.
#[inline(always)]
fn sums(first: f64x2, second: f64x2) -> [f64; 2] {
    let [a, b] = f64x2::transpose([first, second]);
    (a + b).to_array()
}

#[inline(always)]
fn dot(v: &Vector3<f64x2>, w: &Vector3<f64x2>) -> f64x2 {
    v.x * w.x + v.y * w.y + v.z * w.z
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

    #[inline(always)]
    fn rods_by_carriage(&self) -> [[&Rod; 2]; 3] {
        let [a, b, c, d, e, f] = &self.rods;
        [[a, b], [c, d], [e, f]]
    }

    /// Ends of a pair's rods: the lower ends seen from the tip with the platform level, and the upper ends with the carriage at height 0.
    #[inline(always)]
    fn ends(&self, [first, second]: [&Rod; 2]) -> (Vector3<f64x2>, Vector3<f64x2>) {
        let lower = each(&first.lower.coords, &second.lower.coords) - both(&self.tool);
        (lower, each(&first.upper.coords, &second.upper.coords))
    }

    #[inline(always)]
    fn spokes(&self, state: &State) -> [Pair; 3] {
        let columns = state.attitude.matrix();
        let column = |index| both(&columns.column(index).into_owned());
        let (x, y, z) = (column(0), column(1), column(2));
        let of = |rods, height: f64| {
            let (lower, mut upper) = self.ends(rods);
            let r = x * lower.x + y * lower.y + z * lower.z;
            upper.z += f64x2::splat(height);
            Pair { s: both(&state.tip) + r - upper, r }
        };
        let [a, b, c] = self.rods_by_carriage();
        let heights = &state.heights;
        [of(a, heights.x), of(b, heights.y), of(c, heights.z)]
    }

    /// For every pair: where its rod would hang from the carriage if the pair were one, seen from the platform; and
    /// its length.
    fn pairs(&self) -> ([Vector3<f64>; 3], [f64; 3]) {
        let middle = |[first, second]: [&Rod; 2]| {
            ((first.upper - first.lower) + (second.upper - second.lower)) * 0.5 + self.tool
        };
        let length = |[first, second]: [&Rod; 2]| f64::midpoint(first.length, second.length);
        let [a, b, c] = self.rods_by_carriage();
        ([middle(a), middle(b), middle(c)], [length(a), length(b), length(c)])
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
        matrix: impl Fn(&[Pair; 3]) -> Matrix6<f64>,
        apply: impl Fn(&mut State, &Vector3<f64>),
    ) -> Result<State, f64> {
        let size = self.rods.iter().map(|rod| rod.length).fold(0.0, f64::max);
        let (mut best, mut best_off) = (state, f64::INFINITY);
        let mut tries = 3;
        for _ in 0..STEPS {
            let spokes = self.spokes(&state);
            let mut rest = Vector6::zeros();
            let mut off: f64 = 0.0;
            for ((rest, (s, _)), rod) in rest.iter_mut().zip(single(&spokes)).zip(&self.rods) {
                let length = s.norm();
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
        let hanging = single(&self.spokes(&best)).all(|(s, _)| s.z <= 0.0);
        let upright = best.attitude.matrix().m33 > 0.0;
        if best_off <= TOLERANCE * size && hanging && upright { Ok(best) } else { Err(best_off) }
    }

    #[inline(always)]
    fn hung_at(&self, tip: &Vector3<f64>) -> Result<(Vector3<f64>, [Pair; 3])> {
        if let Some(found) = self.close_fast(tip) {
            return Ok(found);
        }
        let state = self.close_slowly(tip)?;
        Ok((state.heights, self.spokes(&state)))
    }

    #[cold]
    fn close_slowly(&self, tip: &Vector3<f64>) -> Result<State> {
        let start = self.level(tip).ok_or_else(|| self.unreachable(tip, f64::NAN))?;
        self.close(start, tip_given, |state, shift| state.heights += shift)
            .map_err(|off| self.unreachable(tip, off))
    }

    /// Steps of the third order for attitude and heights. `None` near an edge of reach and where they do not converge at once.
    #[inline(always)]
    fn close_fast(&self, tip: &Vector3<f64>) -> Option<(Vector3<f64>, [Pair; 3])> {
        let of = |rods| {
            let (r, upper) = self.ends(rods);
            Pair { s: both(tip) + r - upper, r }
        };
        let length = |[first, second]: [&Rod; 2]| f64x2::from([first.length, second.length]);
        let [a, b, c] = self.rods_by_carriage();
        let (mut pairs, lengths) = ([of(a), of(b), of(c)], [length(a), length(b), length(c)]);
        let (mut heights, zero) = (Vector3::zeros(), Vector3::zeros());
        for ((height, pair), length) in heights.iter_mut().zip(&mut pairs).zip(lengths) {
            let ([x, y], [z, length]) = (sums(pair.s.x, pair.s.y), sums(pair.s.z, length));
            let squared = length * length - (x * x + y * y);
            let steep = squared > STEEP * STEEP * length * length;
            if !steep {
                return None;
            }
            *height = 0.5 * (z + squared.sqrt());
            pair.s.z -= f64x2::splat(*height);
        }
        for _ in 0..FAST_STEPS {
            let mut rest = [f64x2::ZERO; 3];
            // Both hold for what is not a number, too.
            let (mut far, mut flat) = (f64x2::ZERO, f64x2::ZERO);
            for ((rest, pair), length) in rest.iter_mut().zip(&pairs).zip(lengths) {
                let squared = length * length;
                *rest = (dot(&pair.s, &pair.s) - squared) * 0.5;
                far |= !rest.abs().simd_le(squared * (0.25 * TOLERANCE));
                flat |= !pair.s.z.simd_lt(length * -STEEP);
            }
            if flat.any() {
                return None;
            }
            if !far.any() {
                return Some((heights, pairs));
            }
            let held = HeldByRods::new(&pairs);
            let first = held.balance(rest);
            let mut step = first;
            if first.turn.norm_squared() > SMALL * SMALL {
                let second = held.balance(held.known_second(&zero, &first, &zero));
                step.turn += second.turn * 0.5;
                step.heights += second.heights * 0.5;
            }
            let (turn, rise) = (step.turn, step.heights);
            // Written so that what is not a number is far, too.
            let near = turn.norm_squared() < FAR * FAR;
            if !near {
                return None;
            }
            heights += rise;
            let half = both(&(turn * 0.5));
            let by = both(&(turn / (1.0 + 0.25 * turn.norm_squared())));
            for (pair, rise) in pairs.iter_mut().zip(&rise) {
                let change = by.cross(&(pair.r + half.cross(&pair.r)));
                pair.r += change;
                pair.s += change;
                pair.s.z -= f64x2::splat(*rise);
            }
        }
        None
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
}

/// The rods one by one: s and r.
fn single(pairs: &[Pair; 3]) -> impl Iterator<Item = (Vector3<f64>, Vector3<f64>)> {
    pairs.iter().flat_map(|pair| {
        [0, 1].map(|rod| {
            (pair.s.map(|both| both.to_array()[rod]), pair.r.map(|both| both.to_array()[rod]))
        })
    })
}

/// Rows: how half the squared length of each rod changes with the attitude and with the heights.
fn tip_given(pairs: &[Pair; 3]) -> Matrix6<f64> {
    rows(pairs, |s, carriage| Vector3::from_fn(|row, _| if row == carriage { -s.z } else { 0.0 }))
}

/// Rows: how half the squared length of each rod changes with the attitude and with the tip.
fn axes_given(pairs: &[Pair; 3]) -> Matrix6<f64> {
    rows(pairs, |s, _| *s)
}

fn rows(pairs: &[Pair; 3], last: impl Fn(&Vector3<f64>, usize) -> Vector3<f64>) -> Matrix6<f64> {
    let mut matrix = Matrix6::zeros();
    for (rod, (mut row, (s, r))) in matrix.row_iter_mut().zip(single(pairs)).enumerate() {
        let turn = r.cross(&s);
        for (entry, value) in row.iter_mut().zip(turn.iter().chain(&last(&s, rod / 2))) {
            *entry = *value;
        }
    }
    matrix
}

/// From the tool to the axes of a calibrated tripod.
#[derive(Clone, Copy, Debug)]
pub struct HeldByRods {
    pairs: [Pair; 3],
    /// From the k across the pairs to the attitude.
    turn: Matrix3<f64>,
    /// From the k along the pairs to the heights: 1 by the sum of both sz².
    inverse: Vector3<f64>,
    /// From the attitude to the heights, row by row.
    lift: [Vector3<f64>; 3],
}

impl Pair {
    /// A value per rod, along and across the pair.
    #[inline(always)]
    fn combine(&self, known: f64x2) -> [f64; 2] {
        let [first, second] = f64x2::transpose([self.s.z, self.s.z]);
        let [swapped, _] = f64x2::transpose([second, first]);
        sums(known * self.s.z, known * (swapped * f64x2::new([1.0, -1.0])))
    }
}

/// A derivative of the platform's attitude (as a vector) and of the carriages' heights.
#[derive(Clone, Copy)]
struct Change {
    turn: Vector3<f64>,
    heights: Vector3<f64>,
}

impl HeldByRods {
    #[inline(always)]
    fn new(pairs: &[Pair; 3]) -> Self {
        let (mut rows, mut lift) = ([Vector3::zeros(); 3], [Vector3::zeros(); 3]);
        let mut inverse = Vector3::zeros();
        for (index, pair) in pairs.iter().enumerate() {
            inverse[index] = 1.0 / (pair.s.z * pair.s.z).reduce_add();
            let n = pair.r.cross(&pair.s);
            let [[a, d], [b, e], [c, f]] =
                [pair.combine(n.x), pair.combine(n.y), pair.combine(n.z)];
            lift[index] = Vector3::new(a, b, c) * inverse[index];
            rows[index] = Vector3::new(d, e, f);
        }
        let [a, b, c] = &rows;
        let (bc, ca, ab) = (b.cross(c), c.cross(a), a.cross(b));
        let turn = Matrix3::from_columns(&[bc, ca, ab]) * (-1.0 / a.dot(&bc));
        Self { pairs: *pairs, turn, inverse, lift }
    }

    /// The changes that make up for k = `known` per rod.
    #[inline(always)]
    fn balance(&self, known: [f64x2; 3]) -> Change {
        let (mut apart, mut heights) = (Vector3::zeros(), Vector3::zeros());
        for (carriage, pair) in self.pairs.iter().enumerate() {
            let [along, across] = pair.combine(known[carriage]);
            apart[carriage] = across;
            heights[carriage] = along * self.inverse[carriage];
        }
        let turn = self.turn * apart;
        for (height, lift) in heights.iter_mut().zip(&self.lift) {
            *height += lift.dot(&turn);
        }
        Change { turn, heights }
    }

    /// k per rod, of its pair and carriage.
    #[inline(always)]
    fn each(&self, of: impl Fn(&Pair, usize) -> f64x2) -> [f64x2; 3] {
        let [a, b, c] = &self.pairs;
        [of(a, 0), of(b, 1), of(c, 2)]
    }

    /// k of the velocity v.
    #[inline(always)]
    fn known_first(&self, v: &Vector3<f64>) -> [f64x2; 3] {
        let v = both(v);
        self.each(|pair, _| dot(&pair.s, &v))
    }

    /// k of the acceleration `a` at the velocity v.
    #[inline(always)]
    fn known_second(&self, v: &Vector3<f64>, first: &Change, a: &Vector3<f64>) -> [f64x2; 3] {
        let (omega, a) = (both(&first.turn), both(a));
        self.each(|pair, carriage| {
            let swing = omega.cross(&pair.r);
            let closing = both(&(v - Vector3::z() * first.heights[carriage])) + swing;
            dot(&pair.s, &(a + omega.cross(&swing))) + dot(&closing, &closing)
        })
    }

    /// k of the jerk j at the velocity v and the acceleration a.
    #[inline(always)]
    fn known_third(
        &self,
        [v, a, j]: &[Vector3<f64>; 3],
        first: &Change,
        second: &Change,
    ) -> [f64x2; 3] {
        let (omega, alpha, j) = (both(&first.turn), both(&second.turn), both(j));
        self.each(|pair, carriage| {
            let (swing, swerve) = (omega.cross(&pair.r), alpha.cross(&pair.r));
            let swerve = swerve + omega.cross(&swing);
            let closing = both(&(v - Vector3::z() * first.heights[carriage])) + swing;
            let closing_change = both(&(a - Vector3::z() * second.heights[carriage])) + swerve;
            let twice = alpha + alpha;
            let rest = twice.cross(&swing) + omega.cross(&swerve);
            dot(&closing, &closing_change) * 3.0 + dot(&pair.s, &(j + rest))
        })
    }
}

impl SmoothMap<3> for HeldByRods {
    #[inline(always)]
    fn is_singular(&self) -> bool {
        !self.turn.iter().chain(&self.inverse).all(|entry| entry.is_finite())
    }

    #[inline(always)]
    fn rate(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.balance(self.known_first(v)).heights
    }

    fn solve(&self, rate: &Vector3<f64>) -> Option<Vector3<f64>> {
        let mut right = Vector6::zeros();
        for (rod, (entry, (s, _))) in right.iter_mut().zip(single(&self.pairs)).enumerate() {
            *entry = s.z * rate[rod / 2];
        }
        let x = axes_given(&self.pairs).lu().solve(&right)?;
        let tip = x.fixed_rows::<3>(3).into_owned();
        tip.iter().all(|value| value.is_finite()).then_some(tip)
    }

    #[inline(always)]
    fn second(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.along(v, &Vector3::zeros())[1]
    }

    #[inline(always)]
    fn third(&self, v: &Vector3<f64>, a: &Vector3<f64>) -> Vector3<f64> {
        self.along_jerk(&[*v, *a, Vector3::zeros()])[2]
    }

    #[inline(always)]
    fn along(&self, v: &Vector3<f64>, a: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let first = self.balance(self.known_first(v));
        [first.heights, self.balance(self.known_second(v, &first, a)).heights]
    }

    #[inline(always)]
    fn along_jerk(&self, given: &[Vector3<f64>; 3]) -> [Vector3<f64>; 3] {
        let [v, a, _] = given;
        let first = self.balance(self.known_first(v));
        let second = self.balance(self.known_second(v, &first, a));
        let third = self.balance(self.known_third(given, &first, &second));
        [first.heights, second.heights, third.heights]
    }
}

#[cfg(test)]
impl CalibratedTripod {
    /// Axes and their derivatives by Newton's method and all six equations at once.
    pub(crate) fn by_newton(
        &self,
        tip: &Vector3<f64>,
        given: &[Vector3<f64>; 3],
    ) -> Result<[Vector3<f64>; 4]> {
        let state = self.close_slowly(tip)?;
        let held = HeldByRods::new(&self.spokes(&state));
        let lu = tip_given(&held.pairs).lu();
        let balance = |known: [f64x2; 3]| {
            let known = known.iter().flat_map(|both| both.to_array());
            let x = lu.solve(&-Vector6::from_iterator(known)).unwrap();
            Change { turn: x.fixed_rows::<3>(0).into(), heights: x.fixed_rows::<3>(3).into() }
        };
        let [v, a, _] = given;
        let first = balance(held.known_first(v));
        let second = balance(held.known_second(v, &first, a));
        let third = balance(held.known_third(given, &first, &second));
        Ok([state.heights + self.offsets, first.heights, second.heights, third.heights])
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
        Ok(self.hung_at(tool)?.0 + self.offsets)
    }

    fn at_axes(&self, axes: &Vector3<f64>) -> Result<(Vector3<f64>, Self::Differential)> {
        let state = self.hung_from(axes)?;
        Ok((state.tip, Parallel(HeldByRods::new(&self.spokes(&state)))))
    }

    #[inline(always)]
    fn at_tool(
        &self,
        tool: &Vector3<f64>,
        _near: &Vector3<f64>,
    ) -> Result<(Vector3<f64>, Self::Differential)> {
        let (heights, pairs) = self.hung_at(tool)?;
        Ok((heights + self.offsets, Parallel(HeldByRods::new(&pairs))))
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
        let Ok((heights, _)) = self.hung_at(tool) else {
            return Margins { boundary: level.min(0.0), branch: 0.0 };
        };
        for (center, height) in centers.iter_mut().zip(&heights) {
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
