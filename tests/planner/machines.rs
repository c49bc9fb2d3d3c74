//! Test machines: dimensions and axis limits of `machines/gantry3.toml`, `scara2.toml` and `tripod.toml`, without tool,
//! and of `gantry_cutter3.toml` with the edge of its knife, which turns with the path.

use nalgebra::Vector3;
use twin_kinematics::gantry::{Gantry3, GantryCutter3, Sense};
use twin_kinematics::scara::{Elbow, Scara2};
use twin_kinematics::tripod::{Tripod, TripodDimensions};
use twin_kinematics::{AxisSource, AxisVector, Coordinate, Kinematics, MachineAxes, Pose};
use twin_planner::time_optimal::{AxisLimits, KinematicPath};

/// Acceleration is built up in this time, s: the jerk limit is the acceleration limit divided by it.
pub const BUILD_UP: f64 = 0.02;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Machine {
    Gantry3,
    Scara2,
    Tripod,
    Cutter,
}

impl Machine {
    /// Those whose tool does not turn.
    pub const ALL: [Self; 3] = [Self::Gantry3, Self::Scara2, Self::Tripod];

    pub fn name(self) -> &'static str {
        match self {
            Self::Gantry3 => "gantry3",
            Self::Scara2 => "scara2",
            Self::Tripod => "tripod",
            Self::Cutter => "cutter",
        }
    }

    fn kinematics(self) -> MachineAxes {
        let (transform, sources): (Box<dyn Kinematics>, Vec<AxisSource>) = match self {
            Self::Gantry3 => (
                Box::new(Gantry3::new([0.0; 3]).unwrap()),
                [0, 1, 2].map(AxisSource::Transform).to_vec(),
            ),
            Self::Scara2 => (
                Box::new(Scara2::new([0.25, 0.2], [0.0; 2], Elbow::Low).unwrap()),
                vec![
                    AxisSource::Transform(0),
                    AxisSource::Transform(1),
                    AxisSource::Coordinate(Coordinate::Z),
                ],
            ),
            Self::Tripod => {
                let dimensions = TripodDimensions {
                    inner_radius: 0.06,
                    outer_radius: 0.26,
                    rod_length: 0.4,
                    rod_distance: 0.05,
                    rotation: 90_f64.to_radians(),
                };
                let tripod = Tripod::new(dimensions, [0.0; 3]).unwrap();
                (Box::new(tripod), [0, 1, 2].map(AxisSource::Transform).to_vec())
            }
            Self::Cutter => (
                Box::new(GantryCutter3::new([0.0; 4], Sense::CounterClockwise).unwrap()),
                [0, 1, 2, 3].map(AxisSource::Transform).to_vec(),
            ),
        };
        let edge = if self.turns() { Vector3::new(-0.002, 0.0, 0.0) } else { Vector3::zeros() };
        MachineAxes::new(transform, sources, edge).unwrap()
    }

    /// True if the tool turns with the path.
    pub fn turns(self) -> bool {
        self == Self::Cutter
    }

    /// Velocity and acceleration per axis, and the least and largest position, SI.
    fn axes(self) -> Vec<([f64; 2], [f64; 2])> {
        let turn = f64::to_radians;
        let three = match self {
            Self::Gantry3 | Self::Cutter => [
                ([0.4, 3.0], [-0.05, 0.65]),
                ([0.4, 3.0], [-0.25, 0.45]),
                ([0.2, 2.0], [-0.06, 0.12]),
            ],
            Self::Scara2 => [
                ([turn(240.0), turn(1500.0)], [turn(-150.0), turn(150.0)]),
                ([turn(300.0), turn(2500.0)], [turn(-150.0), turn(150.0)]),
                ([0.3, 3.0], [-0.06, 0.14]),
            ],
            Self::Tripod => [([0.5, 8.0], [0.24, 0.56]); 3],
        };
        let endless = [f64::NEG_INFINITY, f64::INFINITY];
        let fourth = self.turns().then_some(([turn(1080.0), turn(20000.0)], endless));
        three.into_iter().chain(fourth).collect()
    }

    pub fn limits(self, jerk: bool) -> Vec<AxisLimits> {
        let limits = self.axes().into_iter().map(|([velocity, acceleration], _)| AxisLimits {
            velocity,
            acceleration,
            deceleration: acceleration,
            jerk: jerk.then_some(acceleration / BUILD_UP),
        });
        limits.collect()
    }

    /// Axis path for the planner.
    pub fn path(self, jerk: bool) -> KinematicPath<MachineAxes> {
        self.path_within(self.limits(jerk))
    }

    /// The same with other limits.
    pub fn path_within(self, limits: Vec<AxisLimits>) -> KinematicPath<MachineAxes> {
        let home = AxisVector::zeros(self.axes().len());
        KinematicPath::new(self.kinematics(), limits, home)
    }

    /// A box within reach, m: least and largest corner.
    pub fn room(self) -> [Vector3<f64>; 2] {
        match self {
            Self::Gantry3 | Self::Cutter => {
                [Vector3::new(0.0, -0.2, -0.05), Vector3::new(0.6, 0.4, 0.1)]
            }
            Self::Scara2 => [Vector3::new(0.18, -0.12, -0.05), Vector3::new(0.38, 0.12, 0.1)],
            Self::Tripod => [Vector3::new(-0.12, -0.12, 0.0), Vector3::new(0.12, 0.12, 0.12)],
        }
    }

    /// True if every axis is within its range at a point, m.
    pub fn reaches(self, point: &Vector3<f64>) -> bool {
        let pose = Pose::at(point.x, point.y, point.z);
        let Ok(axes) = self.kinematics().inverse(&pose, &AxisVector::zeros(self.axes().len()))
        else {
            return false;
        };
        axes.iter().zip(self.axes()).all(|(at, (_, [min, max]))| (min..=max).contains(at))
    }
}
