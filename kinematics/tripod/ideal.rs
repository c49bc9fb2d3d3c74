//! Ideal tripod in closed form (`SMC_TRAFO_Tripod`, `SMC_TRAFOF_Tripod`; SoftMotion manual 8.2.6).
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
//! positive up, and the platform is below them. Both directions are closed forms; the forward one intersects three
//! spheres of radius L and takes the lower of two points.
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
//! The sideways reach of a carriage is the length of its rods. At that edge they are horizontal (sz = 0) and the axes
//! cannot follow. When the platform is in the plane of the three points on the carriages, the rods do not hold the
//! tool: the two forward solutions meet. The platform reaches the other branch only through that state, so the branch
//! never changes.

#![expect(
    clippy::inline_always,
    reason = "what is computed for a position and for its derivatives only overlaps if all of it is in one place: a third of the time"
)]

use super::meet;
use super::rods::TripodDimensions;
use crate::disc::Square;
use crate::error::{DimensionError, ReachOf, all_finite};
use crate::smooth::SmoothMap;
use crate::transform::{Parallel, Transform};
use crate::{AxisDisc, AxisVector, Branch, Coordinate, KinematicsError, Margins, Result, ToolDisc};
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

    /// Horizontal part of the rods.
    #[inline(always)]
    fn beside(&self, platform: &Vector3<f64>) -> [Vector2<f64>; 3] {
        let (x, y) = (platform.x, platform.y);
        self.towers.map(|tower| Vector2::new(x - tower.x, y - tower.y))
    }

    /// Vertical part of the rods: the sz, negative.
    #[inline(always)]
    fn rods(&self, tool: &Vector3<f64>) -> Result<TripodRods> {
        let [first, second, third] = self.beside(&(tool - self.tool));
        let left = [
            self.squared - first.norm_squared(),
            self.squared - second.norm_squared(),
            self.squared - third.norm_squared(),
        ];
        let tolerance = ROUNDING * self.squared;
        // Written so that NaN is out of reach, too; what is nearer to an edge than rounding is looked at apart.
        if !(left[0] > tolerance && left[1] > tolerance && left[2] > tolerance) {
            return self.rods_at_edge(tool, left);
        }
        let [a, b, c] = left.map(|left| -left.sqrt());
        // 1/sz from the square, so that the division need not wait for the root.
        let inverse = Vector3::new((1.0 / left[0]) * a, (1.0 / left[1]) * b, (1.0 / left[2]) * c);
        let rods = [first.push(a), second.push(b), third.push(c)];
        Ok(TripodRods { rods, inverse, level: false })
    }

    /// [`Self::rods`] where one of them is level, give or take rounding, or does not reach.
    #[cold]
    fn rods_at_edge(&self, tool: &Vector3<f64>, left: [f64; 3]) -> Result<TripodRods> {
        let tolerance = ROUNDING * self.squared;
        if !left.iter().all(|left| *left >= -tolerance) {
            return Err(self.unreachable(tool));
        }
        let [first, second, third] = self.beside(&(tool - self.tool));
        let [a, b, c] = left.map(|left| -left.max(0.0).sqrt());
        let rods = [first.push(a), second.push(b), third.push(c)];
        let inverse = Vector3::new(1.0 / a, 1.0 / b, 1.0 / c);
        Ok(TripodRods { rods, inverse, level: true })
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

    #[inline(always)]
    fn axes(&self, tool: &Vector3<f64>, rods: &TripodRods) -> Vector3<f64> {
        let z = tool.z - self.tool.z;
        let rods = &rods.rods;
        Vector3::new(z - rods[0].z, z - rods[1].z, z - rods[2].z) + self.offsets
    }

    /// The points about which the rod pairs act.
    fn centers(&self, axes: &Vector3<f64>) -> [Vector3<f64>; 3] {
        let heights: [f64; 3] = (axes - self.offsets).into();
        let [a, b, c] = self.towers;
        [a.push(heights[0]), b.push(heights[1]), c.push(heights[2])]
    }
}

/// Part of the square of a rod's height that a disc takes.
const DISC: f64 = 0.6;

/// A disc for three rods with these horizontal parts and lengths: the height of each is √(L² − ρ²).
pub(super) fn rods_disc(path: &ToolDisc, rods: [(Vector2<f64>, f64); 3]) -> AxisDisc {
    let rate = path.rate.xy();
    let squares = rods.map(|(beside, length)| {
        let square = Square {
            size: beside.norm(),
            along: beside.dot(&rate).abs(),
            rate: rate.norm(),
            bend: path.bend.xy().norm(),
        };
        (square, length * length - beside.norm_squared())
    });
    let smallest = |radius: f64, (square, left): &(Square, f64)| square.radius(DISC * left, radius);
    let radius = squares.iter().fold(path.radius, smallest);
    let change = squares.map(|(square, left)| {
        let height = left.max(0.0).sqrt();
        path.way(radius).z + height - (left - square.change(radius)).max(0.0).sqrt()
    });
    AxisDisc { radius, change: AxisVector::from_values(change), is_even: path.is_upright() }
}

/// Distance of the plane through three points above `point`, along its normal.
pub(super) fn plane_above(centers: &[Vector3<f64>; 3], point: &Vector3<f64>) -> f64 {
    let [first, second, third] = centers;
    let normal = (second - first).cross(&(third - first)).normalize();
    (first - point).dot(&normal) * normal.z.signum()
}

/// From the tool to the axes of a tripod: its rods as vectors, down.
#[derive(Clone, Copy, Debug)]
pub struct TripodRods {
    rods: [Vector3<f64>; 3],
    /// 1/sz.
    inverse: Vector3<f64>,
    /// A rod is horizontal.
    level: bool,
}

impl TripodRods {
    /// The horizontal part of s·v, by sz: minus the vertical rate at which the lower ends move against the upper ones.
    #[inline(always)]
    fn level(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let [first, second, third] = &self.rods;
        let of = |s: &Vector3<f64>| s.x * v.x + s.y * v.y;
        Vector3::new(of(first), of(second), of(third)).component_mul(&self.inverse)
    }

    /// ṡ·ṡ/sz.
    #[inline(always)]
    fn bend(&self, v: &Vector3<f64>, level: &Vector3<f64>) -> Vector3<f64> {
        let across = v.x * v.x + v.y * v.y;
        level.component_mul(level).add_scalar(across).component_mul(&self.inverse)
    }
}

impl SmoothMap<3> for TripodRods {
    #[inline(always)]
    fn is_singular(&self) -> bool {
        self.level
    }

    #[inline]
    fn rate(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.level(v).add_scalar(v.z)
    }

    fn solve(&self, rate: &Vector3<f64>) -> Option<Vector3<f64>> {
        let [a, b, c] = &self.rods;
        meet::solve(&self.rods, [a.z * rate.x, b.z * rate.y, c.z * rate.z])
    }

    #[inline]
    fn second(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.bend(v, &self.level(v))
    }

    /// As by default, with what both have in common once.
    #[inline(always)]
    fn along(&self, v: &Vector3<f64>, a: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let across = v.x * v.x + v.y * v.y;
        let mut along = [Vector3::repeat(v.z), Vector3::repeat(a.z)];
        let [first, second] = &mut along;
        for (((first, second), s), inverse) in
            first.iter_mut().zip(second.iter_mut()).zip(&self.rods).zip(&self.inverse)
        {
            let level = (s.x * v.x + s.y * v.y) * inverse;
            *first += level;
            *second += (s.x * a.x + s.y * a.y + across + level * level) * inverse;
        }
        along
    }

    #[inline]
    fn third(&self, v: &Vector3<f64>, a: &Vector3<f64>) -> Vector3<f64> {
        let level = self.level(v);
        // The vertical part of s̈ is p̈z − q̈.
        let down = self.level(a) + self.bend(v, &level);
        let product = level.component_mul(&down).add_scalar(v.x * a.x + v.y * a.y);
        product.component_mul(&self.inverse) * 3.0
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

    fn to_tool(&self, axes: &Vector3<f64>) -> Result<Vector3<f64>> {
        let (centers, length) = (self.centers(axes), self.dimensions.rod_length);
        // Rods that point up belong to another way of assembly. What is nearer to level than rounding is level.
        let rounding = 1e-9 * length;
        let platform = meet::below(&centers, [length; 3])
            .filter(|platform| centers.iter().all(|center| platform.z <= center.z + rounding))
            .ok_or(KinematicsError::Apart((*axes).into()))?;
        Ok(platform + self.tool)
    }

    #[inline]
    fn to_axes(&self, tool: &Vector3<f64>) -> Result<Vector3<f64>> {
        Ok(self.axes(tool, &self.rods(tool)?))
    }

    fn at_axes(&self, axes: &Vector3<f64>) -> Result<(Vector3<f64>, Self::Differential)> {
        let tool = self.to_tool(axes)?;
        let platform = tool - self.tool;
        let rods = self.centers(axes).map(|center| platform - center);
        let inverse = Vector3::new(1.0 / rods[0].z, 1.0 / rods[1].z, 1.0 / rods[2].z);
        let level = rods.iter().any(|rod| rod.z >= 0.0);
        Ok((tool, Parallel(TripodRods { rods, inverse, level })))
    }

    #[inline(always)]
    fn at_tool(
        &self,
        tool: &Vector3<f64>,
        _near: &Vector3<f64>,
    ) -> Result<(Vector3<f64>, Self::Differential)> {
        let rods = self.rods(tool)?;
        Ok((self.axes(tool, &rods), Parallel(rods)))
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

    fn disc(&self, path: &ToolDisc) -> Option<AxisDisc> {
        let beside = self.beside(&(path.pose.position.coords - self.tool));
        Some(rods_disc(path, beside.map(|beside| (beside, self.dimensions.rod_length))))
    }

    fn characteristic_length(&self) -> f64 {
        self.dimensions.rod_length
    }

    fn holding(self, tip: &Vector3<f64>) -> Self {
        Self { tool: *tip, ..self }
    }
}
