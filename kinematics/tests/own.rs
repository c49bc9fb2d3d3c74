//! A transform of one's own beside those of SM_Trafo (manual 11.8): an arm that turns and grows.

use super::differences;
use crate::transform::{Motion, Serial};
use crate::{Coordinate, KinematicsError, SmoothMap, Transform};
use nalgebra::{SVector, Vector2, Vector3};

/// x = r·cos φ, y = r·sin φ.
#[derive(Clone, Copy, Debug)]
struct Polar;

/// Where its axes are.
#[derive(Clone, Copy, Debug)]
struct At {
    r: f64,
    sin: f64,
    cos: f64,
}

impl At {
    fn new(axes: &Vector2<f64>) -> Self {
        let (sin, cos) = axes.y.sin_cos();
        Self { r: axes.x, sin, cos }
    }

    /// Along and across the arm.
    fn turned(&self, along: f64, across: f64) -> Vector2<f64> {
        Vector2::new(along * self.cos - across * self.sin, along * self.sin + across * self.cos)
    }
}

impl SmoothMap<2> for At {
    fn is_singular(&self) -> bool {
        self.r == 0.0
    }

    fn rate(&self, v: &Vector2<f64>) -> Vector2<f64> {
        self.turned(v.x, self.r * v.y)
    }

    fn solve(&self, rate: &Vector2<f64>) -> Option<Vector2<f64>> {
        let along = rate.x * self.cos + rate.y * self.sin;
        let across = rate.y * self.cos - rate.x * self.sin;
        (self.r != 0.0).then(|| Vector2::new(along, across / self.r))
    }

    fn second(&self, v: &Vector2<f64>) -> Vector2<f64> {
        self.turned(-self.r * v.y * v.y, 2.0 * v.x * v.y)
    }

    fn third(&self, v: &Vector2<f64>, a: &Vector2<f64>) -> Vector2<f64> {
        let along = -3.0 * v.x * v.y * v.y - 3.0 * self.r * v.y * a.y;
        let across = 3.0 * a.x * v.y + 3.0 * v.x * a.y - self.r * v.y.powi(3);
        self.turned(along, across)
    }
}

impl Transform<2> for Polar {
    type Differential = Serial<At>;

    fn coordinates(&self) -> &'static [Coordinate] {
        &[Coordinate::X, Coordinate::Y]
    }

    fn rotary(&self) -> [bool; 2] {
        [false, true]
    }

    fn to_tool(&self, axes: &Vector2<f64>) -> Result<Vector2<f64>, KinematicsError> {
        Ok(At::new(axes).turned(axes.x, 0.0))
    }

    fn to_axes(&self, tool: &Vector2<f64>) -> Result<Vector2<f64>, KinematicsError> {
        Ok(Vector2::new(tool.norm(), tool.y.atan2(tool.x)))
    }

    fn at_axes(&self, axes: &Vector2<f64>) -> Result<(Vector2<f64>, Serial<At>), KinematicsError> {
        Ok((self.to_tool(axes)?, Serial(At::new(axes))))
    }

    fn at_tool(
        &self,
        tool: &Vector2<f64>,
        near: &Vector2<f64>,
    ) -> Result<(Vector2<f64>, Serial<At>), KinematicsError> {
        let axes = self.to_axes_near(tool, near)?;
        Ok((axes, Serial(At::new(&axes))))
    }

    fn characteristic_length(&self) -> f64 {
        0.3
    }

    fn holding(self, _tip: &Vector3<f64>) -> Self {
        self
    }
}

/// The tool goes round a circle of 50 mm beside the pole; what the axes do is held against differences of where they are.
#[test]
fn an_own_transform_gives_what_the_others_give() {
    let tool = |t: f64| [0.3 + 0.05 * t.cos(), 0.1 + 0.05 * t.sin()];
    for start in [0.0, 1.0, 2.5, 4.0, 5.5_f64] {
        let (sin, cos) = start.sin_cos();
        let motion = Motion {
            position: SVector::from(tool(start)),
            velocity: Vector2::new(-sin, cos) * 0.05,
            acceleration: Vector2::new(-cos, -sin) * 0.05,
        };
        // A turn further, as axes that have gone round are.
        let near = Vector2::new(0.3, 6.5);
        let axes = Polar.axis_motion(&motion, &near).unwrap();
        let at = |t: f64| Polar.to_axes_near(&tool(start + t).into(), &near).unwrap().into();
        let (velocity, acceleration): ([f64; 2], [f64; 2]) = differences(at, 0.01);
        assert!((axes.position - SVector::from(at(0.0))).norm() < 1e-12);
        assert!((axes.position.y - 6.5).abs() < 0.5, "{}", axes.position);
        assert!((axes.velocity - SVector::from(velocity)).norm() < 1e-9, "{start}");
        assert!((axes.acceleration - SVector::from(acceleration)).norm() < 1e-8, "{start}");
        let back = Polar.tool_motion(&axes).unwrap();
        assert!((back.position - motion.position).norm() < 1e-12);
        assert!((back.velocity - motion.velocity).norm() < 1e-12);
        assert!((back.acceleration - motion.acceleration).norm() < 1e-12);
    }
    // At the pole the axes cannot follow.
    let through = Motion {
        position: Vector2::zeros(),
        velocity: Vector2::new(0.0, 1.0),
        acceleration: Vector2::zeros(),
    };
    let error = Polar.axis_motion(&through, &Vector2::zeros()).unwrap_err();
    assert!(matches!(error, KinematicsError::Singular { target: [0.0, 0.0, 0.0] }), "{error}");
}
