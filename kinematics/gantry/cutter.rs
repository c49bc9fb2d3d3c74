//! Gantries whose tool turns about the vertical: knives, wheels, nozzles (`SMC_TRAFO_GantryCutter2`, `_GantryCutter3`,
//! their `TRAFOF` and `TRAFOV`; SoftMotion manual 8.2.1).
//!
//! ```text
//!   y ▲      ╱ knife, direction d
//!     │     ╱
//!     │    ● ─ ─ ─    axis R = i·d + offset R,   i = 1 or −1 (iDirectionR)
//!     └────────────▶ x
//! ```
//!
//! X, Y (and Z) as in [`Gantry`](super::Gantry). Zero pose: with offset R = 0 and R at 0 the tool points along +x. The
//! direction of the tool is a coordinate of its own here; [`ToPath`](crate::ToPath) derives it from the path, as
//! `SMC_CalcDirectionFromVector` does. The flange turns with R: a tool tip next to the axis of R swings about it, and
//! the axes X and Y compensate for that.
//!
//! # Derivation
//!
//! With t the tip in the frame of the flange, D(d) the rotation by d, o the offsets, p the tip:
//!
//! ```text
//!   a = p − D(d)·t + o,   R = i·d + oR          E = D(90°)
//!   ȧ = ṗ − ḋ·E·D·t
//!   ä = p̈ − (d̈·E − ḋ²)·D·t
//!   a⃛ = p⃛ − ((d⃛ − ḋ³)·E − 3·ḋ·d̈)·D·t
//! ```

use crate::error::{DimensionError, all_finite};
use crate::smooth::SmoothMap;
use crate::transform::Values;
use crate::transform::{Parallel, Transform};
use crate::{AxisDisc, AxisVector, Coordinate, Result, ToolDisc};
use nalgebra::{SVector, Vector2, Vector3};
use std::f64::consts::TAU;

/// Counting direction of the axis R (`iDirectionR`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sense {
    /// As the direction of the tool: counter-clockwise about +z.
    #[default]
    CounterClockwise,
    /// The other way.
    Clockwise,
}

impl Sense {
    /// 1 or −1.
    pub const fn sign(self) -> f64 {
        match self {
            Self::CounterClockwise => 1.0,
            Self::Clockwise => -1.0,
        }
    }
}

/// A gantry with N axes, 3 or 4: x, y and R, or x, y, z and R.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GantryCutter<const N: usize> {
    offsets: Values<N>,
    sense: Sense,
    tool: Vector3<f64>,
}

/// A gantry with axes along x and y and a tool that turns about the vertical.
pub type GantryCutter2 = GantryCutter<3>;
/// A gantry with axes along x, y and z and a tool that turns about the vertical.
pub type GantryCutter3 = GantryCutter<4>;

impl<const N: usize> GantryCutter<N> {
    /// A gantry whose axes are at `offsets` (m, the last in rad: `dOffsetX`, `dOffsetY`, (`dOffsetZ`,) `dOffsetR`) when the tool
    /// tip is at the origin and points along +x.
    ///
    /// # Errors
    /// [`DimensionError::NotFinite`].
    pub fn new(offsets: [f64; N], sense: Sense) -> Result<Self, DimensionError> {
        const { assert!(N == 3 || N == 4, "a gantry with a cutter has three or four axes") };
        all_finite(&offsets)?;
        Ok(Self { offsets: SVector::from(offsets), sense, tool: Vector3::zeros() })
    }

    /// Axis positions with the tool tip at the origin and pointing along +x, m and rad.
    pub fn offsets(&self) -> [f64; N] {
        self.offsets.into()
    }

    /// Counting direction of the axis R.
    pub const fn sense(&self) -> Sense {
        self.sense
    }

    /// Axis R for a tool direction (rad), in [0, 2π): the manual's `dr`.
    pub fn turned(&self, direction: f64) -> f64 {
        crate::turn::fold(self.sense.sign() * direction + last(&self.offsets), TAU)
    }

    /// The flange, seen from the tip, for a direction given by its cosine and sine: −D·t.
    #[inline]
    fn flange_from_tip(&self, direction: f64) -> Vector2<f64> {
        let (sin, cos) = direction.sin_cos();
        let t = self.tool;
        Vector2::new(sin * t.y - cos * t.x, -sin * t.x - cos * t.y)
    }

    /// Adds to x, y (and z) of `values` and replaces the last of them.
    #[inline]
    fn moved(values: &Values<N>, by: Vector2<f64>, z: f64, last: f64) -> Values<N> {
        SVector::from_fn(|row, _| {
            let value = values[row];
            match row {
                0 => value + by.x,
                1 => value + by.y,
                _ if row + 1 == N => last,
                _ => value + z,
            }
        })
    }

    #[inline]
    fn axes_at(&self, tool: &Values<N>) -> (Values<N>, Vector2<f64>) {
        let direction = last(tool);
        let flange = self.flange_from_tip(direction);
        let r = self.sense.sign() * direction;
        (Self::moved(tool, flange, -self.tool.z, r) + self.offsets, flange)
    }

    #[inline]
    fn tool_at(&self, axes: &Values<N>) -> (Values<N>, Vector2<f64>) {
        let axes = axes - self.offsets;
        let direction = self.sense.sign() * last(&axes);
        let flange = self.flange_from_tip(direction);
        (Self::moved(&axes, -flange, self.tool.z, direction), flange)
    }
}

/// From the tool to the axes of a gantry with a cutter.
#[derive(Clone, Copy, Debug)]
pub struct Swinging<const N: usize> {
    /// The flange, seen from the tip.
    flange: Vector2<f64>,
    sign: f64,
}

impl<const N: usize> Swinging<N> {
    /// `values` with `factor` times the flange, and `quarter` times the flange turned by 90°, added to x and y, and with the last
    /// value in the sense of R.
    #[inline]
    fn map(&self, values: &Values<N>, factor: f64, quarter: f64) -> Values<N> {
        let (x, y) = (self.flange.x, self.flange.y);
        let mut result = *values;
        for (row, value) in result.iter_mut().enumerate() {
            match row {
                0 => *value += factor * x - quarter * y,
                1 => *value += factor * y + quarter * x,
                _ if row + 1 == N => *value *= self.sign,
                _ => {}
            }
        }
        result
    }
}

#[inline]
fn last<const N: usize>(values: &Values<N>) -> f64 {
    values[N - 1]
}

impl<const N: usize> SmoothMap<N> for Swinging<N> {
    #[inline]
    fn rate(&self, v: &Values<N>) -> Values<N> {
        self.map(v, 0.0, last(v))
    }

    #[inline]
    fn solve(&self, rate: &Values<N>) -> Option<Values<N>> {
        Some(self.map(rate, 0.0, -self.sign * last(rate)))
    }

    #[inline]
    fn second(&self, v: &Values<N>) -> Values<N> {
        let turning = last(v);
        self.map(&SVector::zeros(), -turning * turning, 0.0)
    }

    #[inline]
    fn third(&self, v: &Values<N>, a: &Values<N>) -> Values<N> {
        let (turning, change) = (last(v), last(a));
        self.map(&SVector::zeros(), -3.0 * turning * change, -turning * turning * turning)
    }
}

impl<const N: usize> Transform<N> for GantryCutter<N> {
    type Differential = Parallel<Swinging<N>>;

    fn coordinates(&self) -> &'static [Coordinate] {
        const TWO: &[Coordinate] = &[Coordinate::X, Coordinate::Y, Coordinate::Direction];
        if N == 3 { TWO } else { &Coordinate::ALL }
    }

    fn rotary(&self) -> [bool; N] {
        std::array::from_fn(|axis| axis + 1 == N)
    }

    #[inline]
    fn to_tool(&self, axes: &Values<N>) -> Result<Values<N>> {
        Ok(self.tool_at(axes).0)
    }

    #[inline]
    fn to_axes(&self, tool: &Values<N>) -> Result<Values<N>> {
        Ok(self.axes_at(tool).0)
    }

    #[inline]
    fn at_axes(&self, axes: &Values<N>) -> Result<(Values<N>, Self::Differential)> {
        let (tool, flange) = self.tool_at(axes);
        Ok((tool, Parallel(Swinging { flange, sign: self.sense.sign() })))
    }

    #[inline]
    fn at_tool(
        &self,
        tool: &Values<N>,
        near: &Values<N>,
    ) -> Result<(Values<N>, Self::Differential)> {
        let (mut axes, flange) = self.axes_at(tool);
        self.turn_to(&mut axes, near);
        Ok((axes, Parallel(Swinging { flange, sign: self.sense.sign() })))
    }

    fn disc(&self, path: &ToolDisc) -> Option<AxisDisc> {
        let radius = path.little_turn();
        let turn = path.turn(radius);
        let way = path.way(radius);
        let swing = self.tool.xy().norm() * turn.exp_m1();
        let change = [way.x + swing, way.y + swing].into_iter();
        let change = change.chain((N == 4).then_some(way.z)).chain([turn]);
        let is_even = path.is_even() && path.turn_rate == 0.0;
        Some(AxisDisc { radius, change: AxisVector::from_values(change), is_even })
    }

    fn characteristic_length(&self) -> f64 {
        super::CHARACTERISTIC_LENGTH
    }

    fn holding(self, tip: &Vector3<f64>) -> Self {
        let z = if N == 4 { tip.z } else { 0.0 };
        Self { tool: Vector3::new(tip.x, tip.y, z), ..self }
    }
}
