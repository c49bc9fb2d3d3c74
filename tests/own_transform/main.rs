//! Custom transform next to those of `SM_Trafo` (SoftMotion manual 11.8), written outside the crates: a turntable that
//! carries the workpiece under a slide. A program runs through decoder, preparation and interpolator to its axes.
//!
//! ```text
//!            y ▲    ● tool at (x, y) of the workpiece
//!              │   ╱        axis 0: angle φ of the table, rad
//!              │  ╱ R       axis 1: slide r, R = r + arm, m
//!              │ ╱ φ
//!              └──────▶ x
//! ```
//!
//! With z = R·e^(iφ), in the frame that turns with φ: ż = (Ṙ, Rφ̇), z̈ = (R̈ − Rφ̇², Rφ̈ + 2Ṙφ̇) and
//! z⃛ = (R⃛ − 3Ṙφ̇² − 3Rφ̇φ̈, Rφ⃛ + 3R̈φ̇ + 3Ṙφ̈ − Rφ̇³). At R = 0 the table cannot follow.

#![allow(
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "a test that cannot be set up has failed"
)]

use nalgebra::Vector3;
use std::error::Error;
use std::io::Cursor;
use twin_gcode::din66025::{Decoder, DecoderOptions, Item};
use twin_kinematics::turn::nearest_turn;
use twin_kinematics::{
    AxisMotion, AxisSource, AxisVector, Branch, Coordinate, Jacobian, Kinematics, KinematicsError,
    MachineAxes, Margins, Pose, Result, ToolJerk, ToolMotion,
};
use twin_path::Marks;
use twin_path::prepare::{Notices, Preparation};
use twin_planner::controller::{DEFAULT_CYCLE_NS, Interpolator, LookAhead, ToolSetpoint};

type Fault = Box<dyn Error>;

/// The tool is on the line of the slide; the x of its tip makes that longer.
#[derive(Clone, Copy, Debug)]
struct Turntable {
    /// m.
    arm: f64,
}

fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

fn plane(vector: &Vector3<f64>) -> [f64; 2] {
    [vector.x, vector.y]
}

fn level([x, y]: [f64; 2]) -> Vector3<f64> {
    Vector3::new(x, y, 0.0)
}

impl Turntable {
    /// φ and R.
    fn polar(self, axes: &AxisVector) -> Result<[f64; 2]> {
        match **axes {
            _ if !axes.is_finite() => Err(KinematicsError::NotFinite),
            [angle, slide] => Ok([angle, slide + self.arm]),
            _ => Err(KinematicsError::AxisCount { given: axes.len(), expected: 2 }),
        }
    }

    fn pair(axes: &AxisVector) -> Result<[f64; 2]> {
        Self { arm: 0.0 }.polar(axes)
    }

    fn place(pose: &Pose, near: &AxisVector) -> Result<[f64; 2]> {
        let ([near, _], z) = (Self::pair(near)?, pose.position.z);
        if !pose.is_finite() {
            return Err(KinematicsError::NotFinite);
        }
        if z.abs() > 1e-9 {
            return Err(KinematicsError::NoAxis { coordinate: Coordinate::Z, value: z });
        }
        let angle = pose.position.y.atan2(pose.position.x);
        let angle = nearest_turn(angle, near, std::f64::consts::TAU);
        Ok([angle, pose.position.x.hypot(pose.position.y)])
    }

    /// Motion and jerk of the tool for those of the axes.
    fn forward_jerk(self, axes: &AxisMotion, jerk: &AxisVector) -> Result<(ToolMotion, ToolJerk)> {
        let [angle, r] = self.polar(&axes.position)?;
        let ([w, v], [dw, a]) = (Self::pair(&axes.velocity)?, Self::pair(&axes.acceleration)?);
        let [ddw, j] = Self::pair(jerk)?;
        let back = |vector| level(turned(vector, angle));
        let tool = ToolMotion {
            velocity: back([v, r * w]),
            acceleration: back([a - r * w * w, r * dw + 2.0 * v * w]),
            ..ToolMotion::at_rest(self.forward(&axes.position)?)
        };
        let radial = j - 3.0 * v * w * w - 3.0 * r * w * dw;
        let across = r * ddw + 3.0 * a * w + 3.0 * v * dw - r * w * w * w;
        Ok((tool, ToolJerk { linear: back([radial, across]), direction: 0.0 }))
    }
}

impl Kinematics for Turntable {
    fn axis_count(&self) -> usize {
        2
    }

    fn coordinates(&self) -> &[Coordinate] {
        &[Coordinate::X, Coordinate::Y]
    }

    fn is_rotary(&self, axis: usize) -> bool {
        axis == 0
    }

    fn forward(&self, axes: &AxisVector) -> Result<Pose> {
        let [angle, radius] = self.polar(axes)?;
        let [x, y] = turned([radius, 0.0], angle);
        Ok(Pose::at(x, y, 0.0))
    }

    fn inverse(&self, pose: &Pose, near: &AxisVector) -> Result<AxisVector> {
        let [angle, radius] = Self::place(pose, near)?;
        Ok(AxisVector::from_values([angle, radius - self.arm]))
    }

    fn forward_motion(&self, axes: &AxisMotion) -> Result<ToolMotion> {
        Ok(self.forward_jerk(axes, &AxisVector::zeros(2))?.0)
    }

    fn inverse_motion(&self, tool: &ToolMotion, near: &AxisVector) -> Result<AxisMotion> {
        let jerk = ToolJerk { linear: Vector3::zeros(), direction: 0.0 };
        Ok(self.inverse_jerk(tool, &jerk, near)?.0)
    }

    fn inverse_jerk(
        &self,
        tool: &ToolMotion,
        jerk: &ToolJerk,
        near: &AxisVector,
    ) -> Result<(AxisMotion, AxisVector)> {
        let [angle, r] = Self::place(&tool.pose, near)?;
        if r == 0.0 {
            let target = tool.pose.position.coords.into();
            return Err(KinematicsError::Singular(target));
        }
        let along = |vector: &Vector3<f64>| turned(plane(vector), -angle);
        let [v, across] = along(&tool.velocity);
        let w = across / r;
        let [radial, across] = along(&tool.acceleration);
        let (a, dw) = (radial + r * w * w, (across - 2.0 * v * w) / r);
        let [radial, across] = along(&jerk.linear);
        let j = radial + 3.0 * v * w * w + 3.0 * r * w * dw;
        let ddw = (across - 3.0 * a * w - 3.0 * v * dw + r * w * w * w) / r;
        let both = |one, other| AxisVector::from_values([one, other]);
        let (position, velocity) = (both(angle, r - self.arm), both(w, v));
        Ok((AxisMotion { position, velocity, acceleration: both(dw, a) }, both(ddw, j)))
    }

    fn jacobian(&self, axes: &AxisVector) -> Result<Jacobian> {
        let [angle, radius] = self.polar(axes)?;
        let columns = [turned([0.0, radius], angle), turned([1.0, 0.0], angle)];
        Ok(filled(columns))
    }

    fn branch(&self) -> Branch {
        Branch::Only
    }

    fn branch_at(&self, axes: &AxisVector) -> Result<Branch> {
        self.polar(axes).map(|_| Branch::Only)
    }

    fn margins(&self, pose: &Pose) -> Result<Margins> {
        Self::place(pose, &AxisVector::zeros(2)).map(|_| Margins::UNBOUNDED)
    }

    fn characteristic_length(&self) -> f64 {
        0.1
    }

    fn holding(self: Box<Self>, tip: &Vector3<f64>) -> Box<dyn Kinematics> {
        Box::new(Self { arm: tip.x })
    }
}

fn filled(columns: [[f64; 2]; 2]) -> Jacobian {
    let mut jacobian = Jacobian::zeros(2);
    for (axis, [x, y]) in columns.into_iter().enumerate() {
        jacobian.set(Coordinate::X, axis, x);
        jacobian.set(Coordinate::Y, axis, y);
    }
    jacobian
}

/// Along the slide to 50 mm, once round the middle, and off along x = 50 mm.
const PROGRAM: &str = "% round\nN10 G1 X50 Y0 F50 E500 E-500\nN20 G3 X-50 Y0 I-50 J0\nN30 G3 X50 Y0 I50 J0\n\
                       N40 G1 X50 Y60\n";

fn setpoints() -> Vec<ToolSetpoint> {
    let mut options = DecoderOptions::default();
    options.start[0] = 0.02;
    let items = Decoder::with_jumps(Cursor::new(PROGRAM), options);
    let elements = items.map(|item| match item.expect("a program") {
        Item::Element(element) => Ok::<_, Fault>(element),
        Item::Warning(warning) => panic!("{warning}"),
    });
    let stages = Preparation::for_marks(Marks::default());
    let path = stages.check(elements, 0.1, &Notices::default());
    let setpoints = Interpolator::new(LookAhead::new(path), DEFAULT_CYCLE_NS);
    setpoints.map(|setpoint| setpoint.expect("a path")).collect()
}

/// The table, its slide and an axis of its own for z, with a tool of 40 mm straight down.
fn machine() -> MachineAxes {
    let sources = vec![
        AxisSource::Transform(0),
        AxisSource::Transform(1),
        AxisSource::Coordinate(Coordinate::Z),
    ];
    MachineAxes::new(Box::new(Turntable { arm: 0.0 }), sources, Vector3::new(0.0, 0.0, -0.04))
        .expect("a machine")
}

fn near(actual: f64, expected: f64, tolerance: f64) {
    assert!((actual - expected).abs() <= tolerance, "{actual} is not {expected}");
}

#[test]
fn a_program_runs_on_a_transform_of_ones_own() {
    let machine = machine();
    let mut last: Option<AxisMotion> = None;
    let mut blocks = [0; 4];
    for setpoint in setpoints() {
        let tool = ToolMotion {
            velocity: setpoint.velocity,
            acceleration: setpoint.acceleration,
            ..ToolMotion::at_rest(Pose { position: setpoint.position, direction: 0.0 })
        };
        let from = last.map_or(AxisVector::zeros(3), |last| last.position);
        let axes = machine.inverse_motion(&tool, &from).expect("within reach");
        let [angle, slide, height] = *axes.position else { panic!("{axes:?}") };
        near(height, 0.04, 1e-12);
        // The way back.
        let back = machine.forward_motion(&axes).expect("a tool");
        assert!((back.pose.position - setpoint.position).norm() < 1e-12);
        assert!((back.velocity - setpoint.velocity).norm() < 1e-12);
        assert!((back.acceleration - setpoint.acceleration).norm() < 1e-9);
        let by_jacobian =
            machine.jacobian(&axes.position).expect("one").tool_velocity(&axes.velocity);
        near(by_jacobian[0], setpoint.velocity.x, 1e-12);
        near(by_jacobian[1], setpoint.velocity.y, 1e-12);
        // What closed forms say.
        let number = setpoint.place.block.expect("a block");
        blocks[usize::try_from(number).expect("small") / 10 - 1] += 1;
        let [x, y] = [setpoint.position.x, setpoint.position.y];
        match number {
            10 => {
                near(angle, 0.0, 1e-12);
                near(slide, x, 1e-12);
                near(axes.velocity[1], setpoint.path_velocity, 1e-12);
            }
            20 | 30 => {
                near(slide, 0.05, 1e-9);
                near(axes.velocity[0], setpoint.path_velocity / 0.05, 1e-6);
            }
            _ => {
                // Once round: it does not go back to 0.
                near(angle, std::f64::consts::TAU + (y / 0.05).atan(), 1e-9);
                near(slide, 0.05_f64.hypot(y), 1e-9);
            }
        }
        // Velocities are what positions do, accelerations what velocities do; where an acceleration steps, half of it.
        if let Some(last) = last {
            let cycle = 1e-3;
            for axis in 0..2 {
                let way = axes.position[axis] - last.position[axis];
                let mean = f64::midpoint(axes.velocity[axis], last.velocity[axis]);
                near(way / cycle, mean, 0.5 * cycle * (0.5 / 0.02) + 1e-9);
            }
        }
        last = Some(axes);
    }
    assert!(blocks.iter().all(|count| *count > 100), "{blocks:?}");
    let end = last.expect("set-points");
    near(end.position[0], std::f64::consts::TAU + 1.2_f64.atan(), 1e-9);
    near(end.position[1], 0.05 * (1.0_f64 + 1.44).sqrt(), 1e-9);
}

/// Jerks, by differences of accelerations along a motion that is known in closed form: R = 0.1 + 0.02·t, φ = t².
#[test]
fn jerks_are_the_derivatives_of_accelerations() {
    let table = Turntable { arm: 0.03 };
    let at = |t: f64| AxisMotion {
        position: AxisVector::from_values([t * t, 0.07 + 0.02 * t]),
        velocity: AxisVector::from_values([2.0 * t, 0.02]),
        acceleration: AxisVector::from_values([2.0, 0.0]),
    };
    for t in [0.1, 0.7, 1.9] {
        let (motion, jerk) = table.forward_jerk(&at(t), &AxisVector::zeros(2)).expect("a tool");
        let step = 1e-5;
        let acceleration = |t| table.forward_motion(&at(t)).expect("a tool").acceleration;
        let slope = (acceleration(t + step) - acceleration(t - step)) / (2.0 * step);
        assert!((slope - jerk.linear).norm() < 1e-6, "{slope} {}", jerk.linear);
        let (axes, back) = table.inverse_jerk(&motion, &jerk, &at(t).position).expect("axes");
        for axis in 0..2 {
            near(axes.position[axis], at(t).position[axis], 1e-12);
            near(axes.acceleration[axis], at(t).acceleration[axis], 1e-9);
            near(back[axis], 0.0, 1e-8);
        }
    }
}

/// What such a machine cannot do is reported as for any other.
#[test]
fn what_it_cannot_do_is_reported() {
    let machine = machine();
    let through =
        ToolMotion { velocity: Vector3::x(), ..ToolMotion::at_rest(Pose::at(0.0, 0.0, 0.0)) };
    let error = machine.inverse_motion(&through, &AxisVector::zeros(3));
    assert!(matches!(error, Err(KinematicsError::Singular(_))), "{error:?}");
    let error = Turntable { arm: 0.0 }.inverse(&Pose::at(0.1, 0.0, 0.2), &AxisVector::zeros(2));
    assert!(matches!(error, Err(KinematicsError::NoAxis { .. })), "{error:?}");
    let error = machine.forward(&AxisVector::zeros(2));
    assert!(matches!(error, Err(KinematicsError::AxisCount { .. })), "{error:?}");
}
