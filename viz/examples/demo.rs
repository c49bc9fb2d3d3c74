//! Demo recording for work on the page: an invented two-arm machine draws a circle and a square, and its "twin" and
//! "drives" lag behind by invented amounts. Nothing here is simulated; the product's pictures come from `twin run`.
//!
//! ```text
//! cargo run --release -p twin-viz --example demo -- [--serve 127.0.0.1:9090] [--record demo.rrd] [--realtime] [--repeat N]
//! ```

use std::f64::consts::TAU;
use std::time::Duration;

use nalgebra::{Point3, Vector3};
use twin_urdf::{MachineJoint, ScaraDimensions, Solid, SolidShape};
use twin_viz::{
    Axis, AxisUnit, ClearanceFrame, Deviation, DrivesFrame, Frame, MoveKind, Obstacle, PathStrip,
    Playback, Program, Scene, SceneOptions, Setup,
};

const UPPER_ARM: f64 = 0.3;
const FOREARM: f64 = 0.25;
const FEED: f64 = 0.06;

const PROGRAM: &str = "% demo\n\
N10 G0 X300 Y200\n\
N20 G2 X300 Y200 I50 J0 F60\n\
N30 G0 X280 Y80\n\
N40 G1 X380 Y80 F60\n\
N50 G1 X380 Y-20\n\
N60 G1 X280 Y-20\n\
N70 G1 X280 Y80\n\
N80 G0 X300 Y200\n";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut options = SceneOptions::default();
    let (mut is_realtime, mut repeat) = (false, 1);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--record" => options.record = arguments.next().map(Into::into),
            "--serve" => {
                options.serve = arguments.next().map(|address| address.parse()).transpose()?;
            }
            "--repeat" => repeat = arguments.next().unwrap_or_default().parse()?,
            "--realtime" => (is_realtime, options.playback) = (true, Playback::Follow),
            other => return Err(format!("unknown argument {other}").into()),
        }
    }
    let axes = [("A1", AxisUnit::Rotary), ("A2", AxisUnit::Rotary), ("Z", AxisUnit::Linear)]
        .map(|(name, unit)| Axis { name: name.to_owned(), unit });
    let arms =
        [("A1", 0), ("A2", 1)].map(|(name, axis)| MachineJoint::new(name, axis, [-3.0, 3.0]));
    let quill = MachineJoint::new("Z", 2, [-0.1, 0.1]);
    let dimensions = ScaraDimensions::new("demo machine", arms, Some(quill), [UPPER_ARM, FOREARM]);
    let model = ScaraDimensions { quill_radius: Some(QUILL_RADIUS), ..dimensions }.model()?;
    let path = path();
    let start = axis_positions(&Point3::new(0.3, 0.2, 0.0));
    let mut scene = Scene::open(
        &options,
        &Setup {
            machine: &model,
            home: &model.link_poses(&start),
            surroundings: &[Obstacle { name: "ball", solids: &[ball()] }],
            bodies: &[],
            clearance: Some(0.002),
            axes: &axes,
            program: Program { name: "demo.cnc", text: PROGRAM },
            drives: Some("made up"),
        },
    )?;
    if let Some(viewer) = scene.viewer() {
        println!("{}", viewer.url());
    }
    scene.programmed_path(&path.iter().map(|(_, strip)| strip.clone()).collect::<Vec<_>>())?;

    let positions = travel(&path).repeat(repeat);
    let first = positions.first().map_or_else(Point3::origin, |(_, at)| *at);
    let mut followers = [first; 2];
    for (ms, (line, setpoint)) in positions.iter().enumerate() {
        // The "twin" follows with 4 ms and sags a little, the "drives" follow with 9 ms.
        for (follower, delay) in followers.iter_mut().zip([4.0, 9.0]) {
            *follower += (setpoint - *follower) / delay;
        }
        let [twin, drives] = [followers[0] - Vector3::z() * 1.5e-5, followers[1]];
        let wanted = axis_positions(setpoint);
        let errors = |tool| {
            let got = axis_positions(tool);
            [got[0] - wanted[0], got[1] - wanted[1], got[2] - wanted[2]]
        };
        let (twin_errors, drive_errors) = (errors(&twin), errors(&drives));
        let deviation = |tool: Point3<f64>, axis_errors| Deviation {
            tool,
            tool_error: (tool - setpoint).norm(),
            axis_errors,
        };
        let ahead = positions.get(ms + 1).map_or(*setpoint, |(_, at)| *at);
        scene.frame(&Frame {
            time_ns: i64::try_from(ms)? * 1_000_000,
            line: *line,
            setpoint: *setpoint,
            path_speed: (ahead - setpoint).norm() * 1000.0,
            programmed_speed: Some(FEED),
            link_poses: &model.link_poses(&axis_positions(&twin)),
            body_poses: &[],
            twin: deviation(twin, &twin_errors[..]),
            motors: &[],
            clearance: Some(to_ball(&twin)),
            drives: Some(DrivesFrame {
                deviation: deviation(drives, &drive_errors),
                tool_error_to_twin: (drives - twin).norm(),
            }),
        })?;
        if is_realtime {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
    // Served as long as it lives.
    let viewer = scene.finish()?;
    while viewer.is_some() {
        std::thread::sleep(Duration::from_secs(1));
    }
    Ok(())
}

/// A rapid, a circle, a rapid, a square and a rapid, each with its line of the program.
fn path() -> Vec<(u32, PathStrip)> {
    let circle = (0..=180_u32).map(|step| {
        let angle = TAU * f64::from(step) / 180.0;
        Point3::new(0.35 - 0.05 * angle.cos(), 0.2 + 0.05 * angle.sin(), 0.0)
    });
    let corners = [[0.28, 0.08], [0.38, 0.08], [0.38, -0.02], [0.28, -0.02], [0.28, 0.08]]
        .map(|[x, y]| Point3::new(x, y, 0.0));
    let sides = corners.windows(2).map(|side| (MoveKind::Cut, side.to_vec()));
    let (start, corner) = (Point3::new(0.3, 0.2, 0.0), corners[0]);
    let moves = [(MoveKind::Cut, circle.collect()), (MoveKind::Rapid, vec![start, corner])];
    let moves = moves.into_iter().chain(sides).chain([(MoveKind::Rapid, vec![corner, start])]);
    (3..).zip(moves.map(|(kind, points)| PathStrip { kind, points })).collect()
}

/// Positions each ms at constant feed, with the line of the program.
fn travel(path: &[(u32, PathStrip)]) -> Vec<(u32, Point3<f64>)> {
    let mut positions = Vec::new();
    let mut left = 0.0;
    for (line, strip) in path {
        for ends in strip.points.windows(2) {
            let [from, to] = ends else { continue };
            let length = (to - from).norm();
            let mut at = left;
            while at < length {
                positions.push((*line, from + (to - from) * (at / length)));
                at += FEED / 1000.0;
            }
            left = at - length;
        }
    }
    positions
}

/// Shoulder and elbow angles (elbow right) and tool height.
fn axis_positions(tool: &Point3<f64>) -> [f64; 3] {
    let reach_2 = tool.x * tool.x + tool.y * tool.y;
    let cos = (reach_2 - UPPER_ARM.powi(2) - FOREARM.powi(2)) / (2.0 * UPPER_ARM * FOREARM);
    let elbow = -cos.acos();
    let turned = (FOREARM * elbow.sin()).atan2(UPPER_ARM + FOREARM * cos);
    [tool.y.atan2(tool.x) - turned, elbow, tool.z]
}

/// Next to the square.
const BALL: [f64; 3] = [0.415, 0.03, 0.0];
const BALL_RADIUS: f64 = 0.02;
const QUILL_RADIUS: f64 = 0.006;

fn ball() -> Solid {
    let origin = Vector3::from(BALL).into();
    let shape = SolidShape::Sphere { radius: BALL_RADIUS };
    Solid { shape, origin, color: [0.72, 0.66, 0.5, 0.6] }
}

/// From the end of the quill to the ball, at the height of its middle.
fn to_ball(tool: &Point3<f64>) -> ClearanceFrame<'static> {
    let middle = Point3::from(BALL);
    let way = middle - tool;
    let towards = way.normalize();
    ClearanceFrame {
        distance: way.norm() - BALL_RADIUS - QUILL_RADIUS,
        parts: ["quill", "ball"],
        points: [tool + towards * QUILL_RADIUS, middle - towards * BALL_RADIUS],
    }
}
