//! The tripod as the manual has it (`SMC_TRAFO_Tripod`, `SMC_TRAFOF_Tripod`; SoftMotion manual 8.2.6).
//!
//! The rods of a pair are parallel, so the platform stays level and each pair acts like one rod of length L from the
//! point at the overhang e·(cos φi, sin φi) on its carriage to the platform's reference point (the middle of the platform, in the plane of its rod ends):
//!
//! ```text
//!   e  = √(ro² − d²/4) − √(ri² − d²/4),   φi = ρ + i·120°
//!   si = p − (e·cos φi, e·sin φi, qi − oi),   |si| = L
//!   qi = z + √(L² − si,x² − si,y²) + oi
//! ```
//!
//! Zero pose: none of its own; axis positions less offsets are the heights of the upper rod ends in the machine frame,
//! positive up, and the platform is below them. Both ways are closed forms; the way from the axes to the tool is where
//! three spheres of radius L meet, the lower one of two points.
//!
//! # Derivatives
//!
//! The length of a rod does not change: s·ṡ = 0, so with ṡ = ṗ − q̇·ẑ
//!
//! ```text
//!   q̇ = s·ṗ/sz
//!   q̈ = (s·p̈ + ṡ·ṡ)/sz
//!   q⃛ = (s·p⃛ + 3·ṡ·s̈)/sz
//! ```
//!
//! # Reach and singularities
//!
//! A carriage reaches as far sideways as its rods are long. There they are horizontal (sz = 0) and the axes cannot follow.
//! Where the platform is in the plane of the three points on the carriages, the tool is not held: the two solutions of the way from the axes to the
//! tool meet there. The platform cannot get there but through that state, so the branch never changes.

use super::meet;
use super::rods::TripodDimensions;
use super::view::TripodView;
use crate::error::{DimensionError, ReachOf, all_finite};
use crate::smooth::SmoothMap;
use crate::transform::{Parallel, Transform};
use crate::{Branch, Coordinate, KinematicsError, Margins};
use nalgebra::{Vector2, Vector3};

/// What counts as rounding in L² − h², in parts of L².
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A tripod with equal rods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tripod {
    dimensions: TripodDimensions,
    offsets: Vector3<f64>,
    tool: Vector3<f64>,
    /// e·(cos φi, sin φi).
    towers: [Vector2<f64>; 3],
    /// L².
    squared: f64,
}

impl Tripod {
    /// A tripod whose axes are at `offsets` (m: `dOffsetA`, `dOffsetB`, `dOffsetC`) with the upper rod ends at z = 0.
    ///
    /// # Errors
    /// [`DimensionError`]; [`DimensionError::Loose`] if the rod ends of carriages and platform lie over each other.
    pub fn new(dimensions: TripodDimensions, offsets: [f64; 3]) -> Result<Self, DimensionError> {
        all_finite(&offsets)?;
        let overhang = dimensions.overhang()?;
        if overhang.abs() <= 1e-9 * dimensions.rod_length {
            return Err(DimensionError::Loose);
        }
        let towers = [0, 1, 2].map(|carriage| {
            let (sin, cos) = dimensions.angle(carriage).sin_cos();
            Vector2::new(cos, sin) * overhang
        });
        let squared = dimensions.rod_length * dimensions.rod_length;
        Ok(Self { dimensions, offsets: offsets.into(), tool: Vector3::zeros(), towers, squared })
    }

    /// Its dimensions.
    pub const fn dimensions(&self) -> &TripodDimensions {
        &self.dimensions
    }

    /// Axis positions with the upper rod ends at z = 0, m.
    pub fn offsets(&self) -> [f64; 3] {
        self.offsets.into()
    }

    /// The manual's normalised outputs with the axes at `axes` (m).
    ///
    /// # Errors
    /// As [`Transform::to_tool`].
    pub fn view(&self, axes: &Vector3<f64>) -> Result<TripodView, KinematicsError> {
        let tool = self.to_tool(axes)?;
        Ok(TripodView::new(&self.dimensions, &(tool - self.tool), &tool))
    }

    /// Horizontal part of the rods.
    #[inline]
    fn beside(&self, platform: &Vector3<f64>) -> [Vector2<f64>; 3] {
        let (x, y) = (platform.x, platform.y);
        self.towers.map(|tower| Vector2::new(x - tower.x, y - tower.y))
    }

    /// Vertical part of the rods: the sz, negative.
    #[inline]
    fn rods(&self, tool: &Vector3<f64>) -> Result<[Vector3<f64>; 3], KinematicsError> {
        let [first, second, third] = self.beside(&(tool - self.tool));
        let tolerance = ROUNDING * self.squared;
        let left = [
            self.squared - first.norm_squared(),
            self.squared - second.norm_squared(),
            self.squared - third.norm_squared(),
        ];
        // Written so that NaN is out of reach, too.
        if !(left[0] >= -tolerance && left[1] >= -tolerance && left[2] >= -tolerance) {
            return Err(self.unreachable(tool));
        }
        let [a, b, c] = left.map(|left| -left.max(0.0).sqrt());
        Ok([
            Vector3::new(first.x, first.y, a),
            Vector3::new(second.x, second.y, b),
            Vector3::new(third.x, third.y, c),
        ])
    }

    #[cold]
    fn unreachable(&self, tool: &Vector3<f64>) -> KinematicsError {
        let distances = self.beside(&(tool - self.tool)).map(|beside| beside.norm());
        let mut farthest = (0, 0.0);
        for (rod, distance) in distances.into_iter().enumerate() {
            // A distance that is not a number is farther than any.
            if distance > farthest.1 || distance.is_nan() {
                farthest = (rod, distance);
            }
        }
        KinematicsError::Unreachable {
            target: (*tool).into(),
            of: ReachOf::Rod(farthest.0),
            distance: farthest.1,
            reach: [0.0, self.dimensions.rod_length],
        }
    }

    #[inline]
    fn axes(&self, tool: &Vector3<f64>, rods: &[Vector3<f64>; 3]) -> Vector3<f64> {
        let z = tool.z - self.tool.z;
        Vector3::new(z - rods[0].z, z - rods[1].z, z - rods[2].z) + self.offsets
    }

    /// The points about which the rod pairs act.
    fn centers(&self, axes: &Vector3<f64>) -> [Vector3<f64>; 3] {
        let heights: [f64; 3] = (axes - self.offsets).into();
        let [a, b, c] = self.towers;
        [a.push(heights[0]), b.push(heights[1]), c.push(heights[2])]
    }
}

/// How high the plane through three points is above `point`, along its normal.
pub(super) fn plane_above(centers: &[Vector3<f64>; 3], point: &Vector3<f64>) -> f64 {
    let [first, ..] = centers;
    (first - point).dot(&plane_normal(centers))
}

/// The normal of the plane through three points, up.
pub(super) fn plane_normal(centers: &[Vector3<f64>; 3]) -> Vector3<f64> {
    let [first, second, third] = centers;
    let normal = (second - first).cross(&(third - first)).normalize();
    normal * normal.z.signum()
}

/// From the tool to the axes of a tripod.
#[derive(Clone, Copy, Debug)]
pub struct TripodRods([Vector3<f64>; 3]);

impl TripodRods {
    #[inline]
    fn each(&self, of: impl Fn(&Vector3<f64>) -> f64) -> Vector3<f64> {
        let [first, second, third] = &self.0;
        Vector3::new(of(first), of(second), of(third))
    }
}

/// The vertical rate at which the lower end of a rod moves against its upper one, from the horizontal rates.
#[inline]
fn closing(s: &Vector3<f64>, v: &Vector3<f64>) -> f64 {
    -(s.x * v.x + s.y * v.y) / s.z
}

/// Acceleration of the axis from the velocity alone.
#[inline]
fn bend(s: &Vector3<f64>, v: &Vector3<f64>) -> f64 {
    let down = closing(s, v);
    (v.x * v.x + v.y * v.y + down * down) / s.z
}

impl SmoothMap<3> for TripodRods {
    #[inline]
    fn rate(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.each(|s| v.z - closing(s, v))
    }

    fn solve(&self, rate: &Vector3<f64>) -> Option<Vector3<f64>> {
        let [a, b, c] = &self.0;
        meet::solve(&self.0, [a.z * rate.x, b.z * rate.y, c.z * rate.z])
    }

    #[inline]
    fn second(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.each(|s| bend(s, v))
    }

    /// As by default, with one division for each rod.
    #[inline]
    fn along(&self, v: &Vector3<f64>, a: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let inverse = self.each(|s| 1.0 / s.z);
        let level =
            |of: &Vector3<f64>| self.each(|s| s.x * of.x + s.y * of.y).component_mul(&inverse);
        let (first, second) = (level(v), level(a));
        let across = v.x * v.x + v.y * v.y;
        let bend = first.map(|rate| across + rate * rate).component_mul(&inverse);
        [first.add_scalar(v.z), second.add_scalar(a.z) + bend]
    }

    #[inline]
    fn third(&self, v: &Vector3<f64>, a: &Vector3<f64>) -> Vector3<f64> {
        self.each(|s| {
            // ṡ·s̈, whose vertical part is p̈z − q̈.
            let down = closing(s, v) * (closing(s, a) - bend(s, v));
            3.0 * (v.x * a.x + v.y * a.y + down) / s.z
        })
    }
}

impl Transform<3> for Tripod {
    type Differential = Parallel<TripodRods>;

    fn coordinates(&self) -> &'static [Coordinate] {
        &Coordinate::TRANSLATIONS
    }

    fn rotary(&self) -> [bool; 3] {
        [false; 3]
    }

    fn to_tool(&self, axes: &Vector3<f64>) -> Result<Vector3<f64>, KinematicsError> {
        let lengths = [self.dimensions.rod_length; 3];
        let platform = meet::below(&self.centers(axes), lengths);
        let platform = platform.ok_or(KinematicsError::Apart { carriages: (*axes).into() })?;
        Ok(platform + self.tool)
    }

    #[inline]
    fn to_axes(&self, tool: &Vector3<f64>) -> Result<Vector3<f64>, KinematicsError> {
        Ok(self.axes(tool, &self.rods(tool)?))
    }

    fn at_axes(
        &self,
        axes: &Vector3<f64>,
    ) -> Result<(Vector3<f64>, Self::Differential), KinematicsError> {
        let tool = self.to_tool(axes)?;
        let platform = tool - self.tool;
        let rods = self.centers(axes).map(|center| platform - center);
        Ok((tool, Parallel(TripodRods(rods))))
    }

    #[inline]
    fn at_tool(
        &self,
        tool: &Vector3<f64>,
        _near: &Vector3<f64>,
    ) -> Result<(Vector3<f64>, Self::Differential), KinematicsError> {
        let rods = self.rods(tool)?;
        Ok((self.axes(tool, &rods), Parallel(TripodRods(rods))))
    }

    fn branch(&self) -> Branch {
        Branch::PlatformBelow
    }

    fn margins(&self, tool: &Vector3<f64>) -> Margins {
        let length = self.dimensions.rod_length;
        let beside = self.beside(&(tool - self.tool)).map(|beside| beside.norm());
        let boundary =
            beside.iter().fold(f64::INFINITY, |least, beside| least.min(length - beside));
        let branch = self
            .to_axes(tool)
            .map_or(0.0, |axes| plane_above(&self.centers(&axes), &(tool - self.tool)));
        Margins { boundary, branch }
    }

    fn characteristic_length(&self) -> f64 {
        self.dimensions.rod_length
    }

    fn holding(self, tip: &Vector3<f64>) -> Self {
        Self { tool: *tip, ..self }
    }
}
