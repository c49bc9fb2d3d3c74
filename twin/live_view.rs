//! Live view of a run: sends the programmed path and the motion of twin and drives to the view.

use crate::compare::Measured;
use crate::job::JobSetpoints;
use crate::program::{Dialect, ElementItem, Elements, ProgramFile};
use crate::session::{DriveSample, TwinCycle};
use crate::setpoint::Transformer;
use crate::setpoint_source::PlanItem;
use crate::spindle::Spindle;
use nalgebra::{Isometry3, Point3};
use std::collections::{BTreeSet, VecDeque};
use twin_kinematics::AxisVector;
use twin_machine::axis_kind::AxisKind;
use twin_machine::limited_read;
use twin_machine::switch_points::changed;
use twin_machine::tappets::TappetBits;
use twin_machine::{Machine, SimulationError};
use twin_path::{ElementKind, PathElement, Shape};
use twin_physics::{ClearanceScan, MotorState};
use twin_viz::{
    Axis, AxisUnit, Body, ClearanceFrame, Deviation, DrivesFrame, Frame, MotorFrame, MoveKind,
    Obstacle, PathStrip, Program, Scene, SceneOptions, Setup, Viewer, VizError,
};

/// Cycles of the twin shown between samples of the drives, ns.
const INTERVAL_NS: i64 = 4_000_000;

/// How long cycles of the twin wait for a sample of the drives to be shown in order, ns.
const PATIENCE_NS: i64 = 300_000_000;

/// Chords of arcs in the picture are this short, m, and at most this many.
const CHORD: f64 = 0.5e-3;
const MAX_CHORDS: f64 = 200.0;

/// Path elements logged at once.
const BATCH: usize = 2000;

/// More of a program's text than this is not shown next to the machine, bytes.
const MAX_TEXT: u64 = 8 << 20;

/// The live view of a run; does nothing if none was requested.
#[derive(Debug)]
pub struct Picture<'m> {
    machine: &'m Machine,
    scene: Option<Scene>,
    /// Measures how near the twin is to what it must not touch.
    scan: Option<ClearanceScan>,
    spindle: Spindle,
    /// Cycles that wait for a sample of the drives.
    waiting: VecDeque<Instant>,
    has_drives: bool,
    next_ns: i64,
    /// Along the path, and programmed, at the last cycle taken.
    speed: (f64, Option<f64>),
    /// What tappets had switched on in the last cycle taken, and in the last shown.
    tappets: [TappetBits; 2],
    /// Switches of the path that were on then.
    switches: [u32; 2],
    /// Number of tappet signals in the view; behind them come the switches of the path, by their numbers.
    tappet_signals: usize,
    path_switches: Vec<u8>,
    failure: Option<VizError>,
    poses: Vec<Isometry3<f64>>,
}

/// One cycle of the twin as it is shown.
#[derive(Clone, Debug)]
struct Instant {
    time_ns: i64,
    line: u32,
    path_speed: f64,
    feed: Option<f64>,
    wanted: Measured,
    twin: Measured,
    /// What the motors of the twin do.
    motors: Vec<MotorFrame>,
    tappets: TappetBits,
    /// Switches of the path that are on.
    switches: u32,
    /// Loose bodies.
    bodies: Vec<Isometry3<f64>>,
}

impl<'m> Picture<'m> {
    /// Starts recording and page and shows the machine at `start` and the programmed path.
    ///
    /// # Errors
    /// If file or page cannot be had, the program cannot be read, or the machine cannot be measured.
    pub fn open(
        options: &SceneOptions,
        machine: &'m Machine,
        program: &ProgramFile,
        start: &AxisVector,
        drives: Option<&str>,
    ) -> Result<Self, PictureError> {
        let mut picture = Self {
            machine,
            scene: None,
            scan: None,
            spindle: program.spindle(machine),
            waiting: VecDeque::new(),
            has_drives: drives.is_some(),
            next_ns: 0,
            speed: (0.0, None),
            tappets: [TappetBits::default(); 2],
            switches: [0; 2],
            tappet_signals: 0,
            path_switches: Vec::new(),
            failure: None,
            poses: machine.model.link_poses(start),
        };
        if options.record.is_none() && options.serve.is_none() {
            return Ok(picture);
        }
        let tool = picture.spindle.tool();
        let scan = machine.clearance_scan_with(tool);
        picture.scan = scan.map_err(|error| SimulationError::of(machine, error))?;
        let text = if program.size()? <= MAX_TEXT {
            String::from_utf8_lossy(&limited_read::read(program.path())?).into_owned()
        } else {
            String::new()
        };
        let axes: Vec<_> = machine
            .axes
            .iter()
            .map(|axis| Axis {
                name: axis.name.clone(),
                unit: match axis.kind {
                    AxisKind::Rotary => AxisUnit::Rotary,
                    AxisKind::Linear => AxisUnit::Linear,
                },
            })
            .collect();
        let name = program.path().file_name().unwrap_or_default().to_string_lossy();
        let bodies = machine.spindle_bodies();
        let shown = bodies.as_ref().map(|bodies| bodies.with(tool).0);
        let setup = Setup {
            machine: shown.as_deref().unwrap_or(&machine.model),
            home: &picture.poses,
            surroundings: &obstacles(machine),
            bodies: &loose_bodies(machine),
            clearance: picture.scan.as_ref().and(machine.collision.as_ref()).map(|it| it.clearance),
            axes: &axes,
            program: Program { name: &name, text: &text },
            drives,
        };
        let mut scene = Scene::open(options, &setup)?;
        let mut signals = Transformer::new(machine).signals().to_vec();
        if program.dialect() == Dialect::Job {
            signals = JobSetpoints::open(machine, program)?.signals().to_vec();
            show_job(machine, &mut scene, program)?;
        }
        picture.tappet_signals = signals.len();
        picture.path_switches = path_switches(program.elements(&machine.conditions)?);
        let switches = picture.path_switches.iter().map(|number| format!("H{number}"));
        scene.signals(&signals.iter().map(ToString::to_string).chain(switches).collect::<Vec<_>>());
        show_path(machine, &mut scene, program.elements(&machine.conditions)?, |kind| kind)?;
        if program.is_changed_by_preparation(&machine.conditions)? {
            let prepared = program.prepared(&machine.conditions)?;
            show_path(machine, &mut scene, prepared, |_| MoveKind::Prepared)?;
        }
        picture.scene = Some(scene);
        Ok(picture)
    }

    /// Address of the live page.
    pub fn url(&self) -> Option<String> {
        self.scene.as_ref()?.viewer().map(Viewer::url)
    }

    /// One cycle of the twin.
    pub fn twin(&mut self, cycle: &TwinCycle<'_>) {
        let time_ns = cycle.setpoint.time_ns;
        let (tappets, switches) = (cycle.setpoint.tappets, cycle.setpoint.switches);
        // Nothing that is switched is left out.
        let is_new = std::mem::replace(&mut self.tappets[0], tappets) != tappets
            || self.switches[0] != switches;
        self.switches[0] = switches;
        if cycle.setpoint.m_call.is_some_and(|call| self.spindle.observe(&call)) {
            // Clearances before are those of the tool before.
            self.show_before(time_ns);
            self.scan = self.machine.clearance_scan_with(self.spindle.tool()).ok().flatten();
        }
        if self.scene.is_none() || (time_ns < self.next_ns && !is_new) {
            return;
        }
        self.next_ns = time_ns + INTERVAL_NS;
        self.speed = (cycle.setpoint.path_velocity, cycle.setpoint.feed);
        self.waiting.push_back(Instant {
            time_ns,
            line: cycle.setpoint.place.line,
            path_speed: cycle.setpoint.path_velocity,
            feed: cycle.setpoint.feed,
            wanted: *cycle.wanted,
            twin: *cycle.twin,
            motors: cycle.motors.iter().map(motor_frame).collect(),
            tappets,
            switches,
            bodies: cycle.bodies.to_vec(),
        });
        self.show_before(if self.has_drives { time_ns - PATIENCE_NS } else { i64::MAX });
    }

    /// Something has happened to the twin.
    pub fn happened(&mut self, time_ns: i64, line: u32, what: &str) {
        if let Some(scene) = &mut self.scene
            && let Err(error) = scene.news(time_ns, line, what)
        {
            self.failure.get_or_insert(error);
        }
    }

    /// One sample of the drives.
    pub fn drives(&mut self, sample: &DriveSample<'_>) {
        if self.scene.is_none() {
            return;
        }
        self.show_before(sample.time_ns);
        // The next cycle of the twin, or the last one if the drives are ahead of it.
        let (path_speed, feed) =
            self.waiting.front().map_or(self.speed, |next| (next.path_speed, next.feed));
        let instant = Instant {
            time_ns: sample.time_ns,
            line: sample.place.line,
            path_speed,
            feed,
            wanted: *sample.wanted,
            twin: *sample.twin,
            // Known of cycles only; those between the samples are shown.
            motors: Vec::new(),
            tappets: self.tappets[1],
            switches: self.switches[1],
            bodies: Vec::new(),
        };
        self.show(&instant, Some(sample.drives));
    }

    /// Writes everything, within a second; the page stays until the picture is dropped.
    ///
    /// # Errors
    /// The first thing that could not be shown or written, since the beginning.
    pub fn finish(&mut self) -> Result<(), VizError> {
        self.show_before(i64::MAX);
        let closed = self.scene.as_mut().map_or(Ok(()), Scene::close);
        self.failure.take().map_or(closed, Err)
    }

    /// Shows the waiting cycles before `time_ns`.
    fn show_before(&mut self, time_ns: i64) {
        while let Some(next) = self.waiting.pop_front_if(|next| next.time_ns < time_ns) {
            self.show(&next, None);
        }
    }

    fn show(&mut self, instant: &Instant, drives: Option<&Measured>) {
        let Some(scene) = &mut self.scene else { return };
        let before = std::mem::replace(&mut self.tappets[1], instant.tappets);
        let path_before = std::mem::replace(&mut self.switches[1], instant.switches);
        let numbers = &self.path_switches;
        let by_path = changed(path_before, instant.switches).filter_map(|(number, on)| {
            let place = numbers.iter().position(|one| *one == number)?;
            Some((self.tappet_signals + place, on))
        });
        for (signal, on) in instant.tappets.changed(before).chain(by_path) {
            let at = (instant.time_ns, instant.line);
            if let Err(error) = scene.switched(at, &instant.wanted.tool, signal, on) {
                self.failure.get_or_insert(error);
            }
        }
        self.machine.model.link_poses_into(&instant.twin.axes, &mut self.poses);
        let Instant { wanted, twin, .. } = instant;
        let twin_errors = differences(&twin.axes, &wanted.axes);
        let drive_errors =
            drives.map_or(twin_errors, |drives| differences(&drives.axes, &wanted.axes));
        // Where no links can be nothing is measured.
        let nearest = self.scan.as_mut().and_then(|scan| scan.nearest(&twin.axes).ok()?);
        let parts = nearest.map(|nearest| {
            nearest.parts.map(|part| self.machine.part_name_with(part, self.spindle.number()))
        });
        let frame = Frame {
            time_ns: instant.time_ns,
            line: instant.line,
            setpoint: wanted.tool,
            path_speed: instant.path_speed,
            programmed_speed: instant.feed,
            link_poses: &self.poses,
            body_poses: &instant.bodies,
            twin: Deviation {
                tool: twin.tool,
                tool_error: (twin.tool - wanted.tool).norm(),
                axis_errors: &twin_errors,
            },
            motors: &instant.motors,
            clearance: nearest.zip(parts.as_ref()).map(|(nearest, [one, other])| ClearanceFrame {
                distance: nearest.distance,
                parts: [one, other],
                points: nearest.points,
            }),
            drives: drives.map(|drives| DrivesFrame {
                deviation: Deviation {
                    tool: drives.tool,
                    tool_error: (drives.tool - wanted.tool).norm(),
                    axis_errors: &drive_errors,
                },
                tool_error_to_twin: (drives.tool - twin.tool).norm(),
            }),
        };
        if let Err(error) = scene.frame(&frame) {
            // The run goes on without a view; the first failure is reported at its end.
            self.failure.get_or_insert(error);
        }
    }
}

/// Errors that leave a run without a view.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The recording or the page.
    #[error(transparent)]
    View(#[from] VizError),
    /// The machine and what is around it.
    #[error(transparent)]
    Measure(#[from] SimulationError),
    /// The program.
    #[error("the program cannot be read: {0}")]
    Read(#[from] std::io::Error),
}

/// Obstacles around a machine, for the view.
pub(crate) fn obstacles(machine: &Machine) -> Vec<Obstacle<'_>> {
    let collision = machine.collision.iter();
    let obstacles = collision.flat_map(|collision| &collision.surroundings.obstacles);
    obstacles.map(|one| Obstacle { name: &one.name, solids: &one.solids }).collect()
}

/// Loose bodies of a machine, for the view.
fn loose_bodies(machine: &Machine) -> Vec<Body<'_>> {
    let collision = machine.collision.iter();
    let bodies = collision.flat_map(|collision| &collision.surroundings.bodies);
    bodies.map(|one| Body { name: &one.name, solids: &one.solids, pose: one.pose }).collect()
}

/// Numbers of the switches that a path has switch points for.
fn path_switches(path: Elements) -> Vec<u8> {
    let mut numbers = BTreeSet::new();
    for item in path {
        let ElementItem::Element(element) = item else { continue };
        numbers.extend(element.switches().iter().map(|switch| switch.number));
    }
    numbers.into_iter().collect()
}

/// Shows a path, each move as what `kind` makes of it.
fn show_path(
    machine: &Machine,
    scene: &mut Scene,
    path: Elements,
    kind: impl Fn(MoveKind) -> MoveKind,
) -> Result<(), PictureError> {
    let mut strips = Vec::new();
    for item in path {
        let ElementItem::Element(element) = item else { continue };
        let strip = strip(machine, &element);
        strips.extend(strip.map(|strip| PathStrip { kind: kind(strip.kind), ..strip }));
        if strips.len() >= BATCH {
            scene.programmed_path(&joined(std::mem::take(&mut strips)))?;
        }
    }
    scene.programmed_path(&joined(strips))?;
    Ok(())
}

/// Shows the way of the tool in a job, which has no path.
fn show_job(
    machine: &Machine,
    scene: &mut Scene,
    program: &ProgramFile,
) -> Result<(), PictureError> {
    let mut points: Vec<Point3<f64>> = Vec::new();
    for item in JobSetpoints::open(machine, program)? {
        let PlanItem::Axes(setpoint) = item else { continue };
        let point = setpoint.tool.pose.position;
        if points.last().is_none_or(|last| (point - last).norm() >= CHORD) {
            points.push(point);
        }
        if points.len() >= BATCH {
            let last = points.last().copied();
            let strip = PathStrip { kind: MoveKind::Cut, points: std::mem::take(&mut points) };
            scene.programmed_path(&[strip])?;
            points.extend(last);
        }
    }
    scene.programmed_path(&[PathStrip { kind: MoveKind::Cut, points }])?;
    Ok(())
}

/// What a motor does, for the view.
fn motor_frame(motor: &MotorState) -> MotorFrame {
    let MotorState { effort, effort_limit, power, warmth, load_angle } = *motor;
    MotorFrame { effort, effort_limit, power, utilisation: motor.utilisation(), warmth, load_angle }
}

fn differences(actual: &AxisVector, wanted: &AxisVector) -> AxisVector {
    AxisVector::from_values(
        actual.iter().zip(wanted.iter()).map(|(actual, wanted)| actual - wanted),
    )
}

/// An element as a polyline in the machine frame; jumps have none.
fn strip(machine: &Machine, element: &PathElement) -> Option<PathStrip> {
    let kind = match element.kind {
        ElementKind::Rapid => MoveKind::Rapid,
        ElementKind::Cut => MoveKind::Cut,
        ElementKind::Probe { .. } => MoveKind::Probe,
        ElementKind::Jump | ElementKind::MFunction { .. } | ElementKind::Dwell { .. } => {
            return None;
        }
    };
    let shape = &element.shape;
    let length = shape.length();
    let chords = match shape {
        Shape::Line { .. } => 1.0,
        Shape::Arc(_) | Shape::Ellipse(_) | Shape::Cubic(_) => {
            (length / CHORD).ceil().clamp(8.0, MAX_CHORDS)
        }
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 200")]
    let count = chords as u32;
    let point = |chord| shape.at(length * f64::from(chord) / chords).position;
    let points = (0..=count).map(|chord| machine.frame.point_to_machine(&point(chord))).collect();
    Some(PathStrip { kind, points })
}

/// Joins strips of one kind that follow each other: a strip costs more than its points.
fn joined(strips: Vec<PathStrip>) -> Vec<PathStrip> {
    let mut joined: Vec<PathStrip> = Vec::new();
    for strip in strips {
        let meets = |last: &PathStrip| {
            let ends: (Option<&Point3<f64>>, Option<&Point3<f64>>) =
                (last.points.last(), strip.points.first());
            last.kind == strip.kind && ends.0 == ends.1
        };
        match joined.last_mut().filter(|last| meets(last)) {
            Some(last) => last.points.extend(strip.points.into_iter().skip(1)),
            None => joined.push(strip),
        }
    }
    joined
}
