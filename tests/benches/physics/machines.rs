//! Benchmark machines, the same as the models next to `tests/peers/mujoco_machines.py`, and their task. The task is
//! circles in the plane with a tool that goes up and down, from rest, under a controller with a period of one
//! millisecond.

use nalgebra::{Isometry3, Matrix3, Point3, Unit, Vector2, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};
use twin_kinematics::scara::{Elbow, Scara2};
use twin_kinematics::transform::Motion;
use twin_kinematics::tripod::{Tripod, TripodDeviations, TripodDimensions as Rings};
use twin_kinematics::{AxisMotion, AxisVector, Kinematics, Pose, ToolMotion, Transform};
use twin_physics::{
    AxisDriveParameters, AxisLoad, ElasticTransmission, FrictionParameters, PathDynamics,
    PhysicsMachine, ServoParameters, Surroundings,
};
use twin_urdf::{
    Inertial, Joint, JointDrive, JointKind, Link, MachineJoint, Model, Solid, SolidShape, Tip,
    TripodDimensions,
};

/// Periods of the controller, of 1 ms.
const PERIODS: u32 = 2_000;
/// s.
pub const PERIOD: f64 = 1e-3;
const PERIOD_NS: i64 = 1_000_000;
/// Top of the ground, m.
const GROUND: f64 = -0.5;
const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);
/// Of the controller, rad/s.
const BANDWIDTH: f64 = TAU * 15.0;

/// Set-points of the controller at the start of a period.
#[derive(Clone, Copy)]
pub struct Set {
    pub position: [f64; 3],
    pub velocity: [f64; 3],
    /// Inverse dynamics half a period ahead, N or Nm.
    pub effort: [f64; 3],
}

/// The tip of the tool (m, machine frame) with the axes somewhere.
type TipOfTool = Box<dyn Fn(&AxisVector) -> Point3<f64>>;

/// A machine and what it does.
pub struct Task {
    pub name: &'static str,
    /// File of the peer's model, and its names of the axes.
    pub peer: &'static str,
    pub axes: [&'static str; 3],
    pub start: [f64; 3],
    pub tool: Point3<f64>,
    pub set: Vec<Set>,
    pub kp: [f64; 3],
    pub kd: [f64; 3],
    model: Model,
    tip: TipOfTool,
}

/// Every drive off; nothing of it has to run more often than the controller, so that a step is a period.
fn off() -> AxisDriveParameters {
    AxisDriveParameters::servo(ServoParameters {
        position_passes: 1,
        velocity_passes: 1,
        ..ServoParameters::SLACK
    })
}

/// No drive at all.
const FREE: AxisLoad = AxisLoad {
    effort_limit: f64::INFINITY,
    coulomb_friction: 0.0,
    viscous_friction: 0.0,
    armature: 0.0,
    headroom: 0.0,
};

impl Task {
    /// A controller that makes every axis, of which `inertias` (kg or kg·m²) are about what it moves, follow `motion` (time in s).
    fn new(
        (name, peer, axes): (&'static str, &'static str, [&'static str; 3]),
        model: Model,
        inertias: [f64; 3],
        motion: impl Fn(f64) -> AxisMotion,
        tip: impl Fn(&AxisVector) -> Point3<f64> + 'static,
    ) -> Self {
        let mut dynamics =
            PathDynamics::new(&model, &[FREE; 3], GRAVITY).expect("a machine that moves");
        let set = (0..PERIODS).map(|period| {
            let t = f64::from(period) * PERIOD;
            let (now, ahead) = (motion(t), motion(t + 0.5 * PERIOD));
            let AxisMotion { position, velocity, acceleration } = ahead;
            let efforts = dynamics.at(&position, &velocity, &acceleration).expect("within reach");
            let efforts =
                AxisVector::from_values(efforts.axes().iter().map(|axis| axis.effort(0.0, 1.0)));
            Set {
                position: three(&now.position),
                velocity: three(&now.velocity),
                effort: three(&efforts),
            }
        });
        let set: Vec<Set> = set.collect();
        let start = set[0].position;
        Self {
            name,
            peer,
            axes,
            start,
            tool: tip(&AxisVector::from_values(start)),
            set,
            kp: inertias.map(|inertia| inertia * BANDWIDTH * BANDWIDTH),
            kd: inertias.map(|inertia| 2.0 * inertia * BANDWIDTH),
            model,
            tip: Box::new(tip),
        }
    }

    /// The machine at rest, with collisions, with this number of cycles per period.
    pub fn machine(&self, cycles: i64) -> PhysicsMachine {
        let start = AxisVector::from_values(self.start);
        let cycle = PERIOD_NS / cycles;
        let machine =
            PhysicsMachine::new(&self.model, &[(); 3].map(|()| off()), GRAVITY, &start, cycle);
        let mut machine = machine.expect("a machine");
        machine
            .insert_surroundings(&Surroundings::floor(GROUND))
            .expect("nothing touches at the start");
        machine
    }

    /// The machine at rest, with collisions, its axes behind springs with play and friction on both sides, under drives of its own.
    pub fn elastic(&self, longest_step: f64) -> PhysicsMachine {
        let start = AxisVector::from_values(self.start);
        let drives = self.kd.map(|kd| {
            let inertia = kd / (2.0 * BANDWIDTH);
            // The motor is a third of it, and swings against the rest 60 times a second; friction is what slows down by 1 m/s².
            let (motor, axis) = (inertia / 3.0, inertia);
            let stiffness = (TAU * 60.0).powi(2) * motor * axis / (motor + axis);
            AxisDriveParameters {
                armature: motor,
                friction: FrictionParameters {
                    breakaway: 1.3 * inertia,
                    stribeck_velocity: 0.01,
                    ..FrictionParameters::new(inertia, inertia)
                },
                motor_friction: FrictionParameters::new(0.3 * inertia, 0.3 * inertia),
                transmission: Some(ElasticTransmission::damped(stiffness, 0.05, 2e-5, motor, axis)),
                ..AxisDriveParameters::servo(ServoParameters {
                    current_bandwidth: TAU * 800.0,
                    delay: 1,
                    ..ServoParameters::tuned(motor + axis, 10.0, f64::INFINITY)
                })
            }
        });
        let machine = PhysicsMachine::new(&self.model, &drives, GRAVITY, &start, PERIOD_NS);
        let mut machine = machine.expect("a machine").with_steps_of(longest_step);
        machine
            .insert_surroundings(&Surroundings::floor(GROUND))
            .expect("nothing touches at the start");
        machine
    }

    /// One period of a machine with drives of its own.
    pub fn follow(machine: &mut PhysicsMachine, set: &Set) {
        let motion = AxisMotion {
            position: AxisVector::from_values(set.position),
            velocity: AxisVector::from_values(set.velocity),
            acceleration: AxisVector::from_values([0.0; 3]),
        };
        machine.step(&motion).expect("a machine that moves");
    }

    /// Tool tip positions of the elastic machine after each period.
    pub fn elastic_tips(&self, longest_step: f64) -> Vec<Point3<f64>> {
        let mut machine = self.elastic(longest_step);
        let tips = self.set.iter().map(|set| {
            Self::follow(&mut machine, set);
            (self.tip)(&machine.axis_state().position)
        });
        tips.collect()
    }

    /// One period of `machine` under the controller.
    pub fn advance(&self, machine: &mut PhysicsMachine, set: &Set, cycles: i64) {
        let state = machine.axis_state();
        let efforts = [0, 1, 2].map(|axis| {
            set.effort[axis]
                + self.kp[axis] * (set.position[axis] - state.position[axis])
                + self.kd[axis] * (set.velocity[axis] - state.velocity[axis])
        });
        let efforts = AxisVector::from_values(efforts);
        for _ in 0..cycles {
            machine.step_with_efforts(&efforts).expect("a machine that moves");
        }
    }

    /// Tool tip positions after each period, with `cycles` simulation steps per period.
    pub fn tips(&self, cycles: i64) -> Vec<Point3<f64>> {
        let mut machine = self.machine(cycles);
        let tips = self.set.iter().map(|set| {
            self.advance(&mut machine, set, cycles);
            (self.tip)(&machine.axis_state().position)
        });
        tips.collect()
    }

    /// Largest following error of the tip after the first tenth, m.
    pub fn following_error(&self, tips: &[Point3<f64>]) -> f64 {
        let wanted =
            self.set.iter().skip(1).map(|set| (self.tip)(&AxisVector::from_values(set.position)));
        let errors = tips.iter().zip(wanted).map(|(tip, wanted)| (tip - wanted).norm());
        errors.skip(self.set.len() / 10).fold(0.0, f64::max)
    }
}

/// All of them.
pub fn all() -> [Task; 3] {
    [gantry(), scara(), tripod()]
}

fn three(values: &AxisVector) -> [f64; 3] {
    [values[0], values[1], values[2]]
}

fn solid(shape: SolidShape, center: [f64; 3]) -> Solid {
    let [x, y, z] = center;
    Solid { shape, origin: Isometry3::translation(x, y, z), color: [1.0; 4] }
}

/// A link that is a uniform box, moved by the axis of this number, and behind the link before.
fn boxed(
    axis: usize,
    (kind, direction, origin): (JointKind, Vector3<f64>, [f64; 3]),
    (mass, center, size): (f64, [f64; 3], [f64; 3]),
) -> (Joint, Link) {
    let [x, y, z] = size.map(|edge| edge * edge);
    let inertia = Matrix3::from_diagonal(&Vector3::new(y + z, x + z, x + y)) * (mass / 12.0);
    let shape = SolidShape::Box { size: Vector3::from(size) };
    let inertial = Inertial { mass, center: Point3::from(center), inertia };
    let link = Link::new(format!("link{axis}"), Some(inertial), vec![solid(shape, center)]);
    let [x, y, z] = origin;
    let joint = Joint::new(
        format!("joint{axis}"),
        kind,
        [axis, axis + 1],
        Isometry3::translation(x, y, z),
        Unit::new_unchecked(direction),
        JointDrive::Axis(axis),
    );
    (joint, link)
}

fn chain(name: &str, parts: [(Joint, Link); 3], tip: [f64; 3]) -> Model {
    let base = Link::new("base", None, Vec::new());
    let (joints, links): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
    Model {
        name: name.into(),
        links: std::iter::once(base).chain(links).collect(),
        joints,
        loops: Vec::new(),
        tip: Tip { link: 3, point: Point3::from(tip) },
    }
}

/// Position, velocity and acceleration on a circle of this radius at this angular velocity, beside a sine upwards.
fn circle(radius: f64, rate: f64, (height, frequency): (f64, f64), t: f64) -> [Vector3<f64>; 3] {
    let (sin, cos) = (rate * t).sin_cos();
    let (up, along) = (frequency * t).sin_cos();
    [
        Vector3::new(radius * cos, radius * sin, height * up),
        Vector3::new(-radius * sin, radius * cos, 0.0) * rate
            + Vector3::z() * (height * frequency * along),
        Vector3::new(-radius * cos, -radius * sin, 0.0) * (rate * rate)
            - Vector3::z() * (height * frequency * frequency * up),
    ]
}

fn of(values: Vector3<f64>) -> AxisVector {
    AxisVector::from_values(values.iter().copied())
}

fn gantry() -> Task {
    let slide = |direction| (JointKind::Prismatic, direction, [0.0; 3]);
    let parts = [
        boxed(0, slide(Vector3::x()), (12.0, [0.0, 0.0, 0.3], [0.1, 0.8, 0.1])),
        boxed(1, slide(Vector3::y()), (5.0, [0.1, 0.0, 0.3], [0.1, 0.12, 0.2])),
        boxed(2, slide(Vector3::z()), (3.0, [0.18, 0.0, 0.1], [0.06, 0.06, 0.4])),
    ];
    let tip = [0.18, 0.0, -0.1];
    Task::new(
        ("gantry, rigid", "mujoco_gantry.xml", ["X", "Y", "Z"]),
        chain("gantry", parts, tip),
        [20.0, 8.0, 3.0],
        |t| {
            let [position, velocity, acceleration] = circle(0.1, 5.0, (0.02, TAU), t).map(of);
            AxisMotion { position, velocity, acceleration }
        },
        move |axes| Point3::new(axes[0], axes[1], axes[2]) + Vector3::from(tip),
    )
}

fn scara() -> Task {
    let [l1, l2] = [0.4, 0.3];
    let arms = Scara2::new([l1, l2], [0.0; 2], Elbow::Low).expect("arms");
    let turn = |x| (JointKind::Revolute, Vector3::z(), [x, 0.0, 0.0]);
    let parts = [
        boxed(0, turn(0.0), (8.0, [0.2, 0.0, 0.0], [0.4, 0.1, 0.08])),
        boxed(1, turn(l1), (4.0, [0.15, 0.0, 0.0], [0.3, 0.08, 0.06])),
        boxed(
            2,
            (JointKind::Prismatic, Vector3::z(), [l2, 0.0, 0.0]),
            (2.0, [0.0, 0.0, -0.02], [0.04, 0.04, 0.2]),
        ),
    ];
    Task::new(
        ("SCARA, rigid", "mujoco_scara.xml", ["A1", "A2", "Z"]),
        chain("scara", parts, [0.0, 0.0, -0.12]),
        [2.0, 0.3, 2.0],
        move |t| {
            let [mut place, velocity, acceleration] = circle(0.1, 5.0, (0.02, TAU), t);
            place.x += 0.45;
            let tool = Motion {
                position: place.xy(),
                velocity: velocity.xy(),
                acceleration: acceleration.xy(),
            };
            let arms = arms.axis_motion(&tool, &Vector2::zeros()).expect("within reach");
            AxisMotion {
                position: of(arms.position.push(place.z)),
                velocity: of(arms.velocity.push(velocity.z)),
                acceleration: of(arms.acceleration.push(acceleration.z)),
            }
        },
        move |axes| {
            let tip = arms.to_tool(&Vector2::new(axes[0], axes[1])).expect("anywhere");
            Point3::from(tip.push(axes[2] - 0.12))
        },
    )
}

fn tripod() -> Task {
    let half = 0.03_f64;
    let rings = Rings {
        inner_radius: half.hypot(0.05),
        outer_radius: half.hypot(0.25),
        rod_length: 0.4,
        rod_distance: 2.0 * half,
        rotation: FRAC_PI_2,
    };
    let axes = ["A", "B", "C"];
    let joints = [0, 1, 2].map(|axis| MachineJoint::new(axes[axis], axis, [0.25, 0.45]));
    let rods = rings.rods(&TripodDeviations::default()).expect("rods");
    let dimensions = TripodDimensions {
        carriage_mass: Some(1.5),
        rod_mass: Some(0.1),
        platform_mass: Some(1.0),
        ..TripodDimensions::new("tripod", joints, rods)
    };
    let mut model = dimensions.model().expect("a tripod");
    let platform = model.tip.link;
    for (index, link) in model.links.iter_mut().enumerate() {
        let shape = match index {
            1..=3 => (SolidShape::Box { size: Vector3::repeat(0.08) }, [0.0; 3]),
            _ if index == platform => {
                (SolidShape::Cylinder { radius: 0.07, length: 0.01 }, [0.0; 3])
            }
            _ if link.inertial.is_some() => {
                let inertia =
                    Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0)) * (0.1 * 0.16 / 12.0);
                let center = Point3::new(0.0, 0.0, -0.2);
                link.inertial = Some(Inertial { mass: 0.1, center, inertia });
                (SolidShape::Cylinder { radius: 0.004, length: 0.4 }, [0.0, 0.0, -0.2])
            }
            _ => continue,
        };
        link.solids = vec![solid(shape.0, shape.1)];
    }
    let tripod = Tripod::new(rings, [0.0; 3]).expect("a tripod");
    let motion = move |t: f64| {
        let [place, velocity, acceleration] = circle(0.06, 5.0, (0.01, 2.0), t);
        let tool = ToolMotion {
            pose: Pose { position: Point3::from(place), direction: 0.0 },
            velocity,
            acceleration,
            direction_velocity: 0.0,
            direction_acceleration: 0.0,
        };
        Kinematics::inverse_motion(&tripod, &tool, &AxisVector::from_values([0.0; 3]))
            .expect("within reach")
    };
    Task::new(("tripod, rigid", "mujoco_tripod.xml", axes), model, [2.5; 3], motion, move |axes| {
        Kinematics::forward(&tripod, axes).expect("within reach").position
    })
}
