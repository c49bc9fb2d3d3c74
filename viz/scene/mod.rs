//! [`Scene`]: the recording while it is written.

mod clearance;
pub(crate) mod destination;
mod due;
pub(crate) mod machine;
pub(crate) mod motors;
mod options;
mod program;
mod series;
mod signals;
mod solids;
mod track;
mod trail;

#[cfg(test)]
pub(crate) mod tests;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use nalgebra::{Isometry3, Point3};
use twin_urdf::Model;

use crate::blueprint::{self, Layout};
use crate::bounds::Bounds;
use crate::error::{Result, VizError};
use crate::frame::{Axis, Body, Deviation, DrivesFrame, Frame, Obstacle, PathStrip, Program};
use crate::motor_plot::MotorPlot;
use crate::palette;
use crate::recorder::Recorder;
use crate::server::Viewer;
use crate::timeline::Playback;
use clearance::ClearanceTrack;
use destination::Destination;
use due::Due;
use machine::Moving;
use motors::MotorSeries;
pub use options::SceneOptions;
use program::Excerpt;
use series::{AxisSeries, Series};
use signals::Signals;
use track::ToolTrack;

/// Poses are shown 50 times a second of program time; a screen does not show more.
const POSE_INTERVAL_NS: i64 = 20_000_000;
/// Height of what the close-up of the tool shows, m.
const CLOSE_UP: f64 = 0.002;

/// Setup of a scene: machine, surroundings, axes, program and drives.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// The machine.
    pub machine: &'a Model,
    /// Poses of its links before the first frame, in the machine frame; as many as it has links.
    pub home: &'a [Isometry3<f64>],
    /// Obstacles around it.
    pub surroundings: &'a [Obstacle<'a>],
    /// Loose bodies.
    pub bodies: &'a [Body<'a>],
    /// Smallest permitted clearance, m; 0 if only contact counts. `None` if that is not measured.
    pub clearance: Option<f64>,
    /// Its axes.
    pub axes: &'a [Axis],
    /// The program.
    pub program: Program<'a>,
    /// Name of the drives ("`InterpCNC`, emulated"); `None` if there are none.
    pub drives: Option<&'a str>,
}

/// A recording being written, and the page that shows it.
#[derive(Debug)]
pub struct Scene {
    stream: Recorder,
    is_paced: bool,
    /// True when the recording is complete; the page reads it.
    complete: Arc<AtomicBool>,
    viewer: Option<Viewer>,
    bounds: Bounds,
    playback: Playback,
    has_layout: bool,
    strips_logged: usize,
    machine: Moving,
    bodies: Moving,
    axes: Vec<AxisSeries>,
    motors: Vec<MotorSeries>,
    excerpt: Excerpt,
    pose_due: Due,
    series_due: Due,
    rows_due: Due,
    setpoint: ToolTrack,
    twin: ToolTrack,
    drives: ToolTrack,
    /// Between drives and twin.
    between: Series,
    clearance: Option<ClearanceTrack>,
    path_speed: Series,
    programmed_speed: Series,
    signals: Signals,
    layout: Layout,
}

impl Scene {
    /// Creates the recording, starts the page if one is asked for, and shows the machine at its home pose.
    ///
    /// # Errors
    /// [`VizError::NoDestination`], [`VizError::Create`], [`VizError::Temporary`], [`VizError::Bind`] and its
    /// neighbours if the destinations cannot be had; [`VizError::Count`] if `home` does not fit the machine.
    pub fn open(options: &SceneOptions, setup: &Setup<'_>) -> Result<Self> {
        VizError::check_links(setup.machine.links.len(), setup.home.len())?;
        let Destination { mut stream, viewer, complete } =
            destination::open(options, setup.program.name)?;
        let mut bounds = Bounds::default();
        stream.log_static("/", &rerun::ViewCoordinates::RIGHT_HAND_Z_UP())?;
        let mut machine = Moving::links(&mut stream, setup.machine, setup.home, &mut bounds)?;
        machine::log_obstacles(&mut stream, setup.surroundings, &mut bounds)?;
        let mut bodies = Moving::bodies(&mut stream, setup.bodies, &mut bounds)?;
        stream.set_time(0, 0);
        machine.log_poses(&mut stream, setup.home)?;
        let poses: Vec<_> = setup.bodies.iter().map(|body| body.pose).collect();
        bodies.log_poses(&mut stream, &poses)?;
        program::log_about(&mut stream, setup)?;

        let error = |name, label, color| Series::new(format!("error/tool/{name}"), label, color);
        let speed = |name, color| Series::new(format!("speed/{name}"), name, color);
        let twin = error("twin", "twin to set-point", palette::twin());
        let drives = error("drives", "drives to set-point", palette::drives());
        // The page must know the machine and the names before the first values.
        stream.flush()?;
        let layout = Layout {
            axes: setup.axes.to_vec(),
            motors: Vec::new(),
            has_clearance: setup.clearance.is_some(),
            has_signals: false,
            close_up: CLOSE_UP,
        };
        Ok(Self {
            stream,
            is_paced: options.is_paced,
            complete,
            viewer,
            bounds,
            playback: options.playback,
            has_layout: false,
            strips_logged: 0,
            machine,
            bodies,
            axes: AxisSeries::all(setup.axes),
            motors: MotorSeries::all(setup.axes),
            excerpt: Excerpt::new(setup.program.text),
            pose_due: Due::every(POSE_INTERVAL_NS),
            series_due: Due::every(options.playback.series_ns()),
            rows_due: Due::every(options.playback.rows_ns()),
            setpoint: ToolTrack::new("set-point", palette::setpoint(), None),
            twin: ToolTrack::new("twin", palette::twin(), Some(twin)),
            drives: ToolTrack::new("drives", palette::drives(), Some(drives)),
            between: error("between", "drives to twin", palette::between()),
            clearance: setup.clearance.map(ClearanceTrack::new),
            path_speed: speed("set-point", palette::setpoint()),
            programmed_speed: speed("programmed", palette::cut()),
            signals: Signals::default(),
            layout,
        })
    }

    /// The page, if one was asked for.
    pub fn viewer(&self) -> Option<&Viewer> {
        self.viewer.as_ref()
    }

    /// Shows a piece of the programmed path; pieces before the first frame are in the camera's view.
    ///
    /// # Errors
    /// [`VizError::Log`] if rerun refuses the path.
    pub fn programmed_path(&mut self, strips: &[PathStrip]) -> Result<()> {
        strips.iter().flat_map(|strip| &strip.points).for_each(|point| self.bounds.add(point));
        self.strips_logged += 1;
        trail::log_programmed(&mut self.stream, self.strips_logged, strips)
    }

    /// Declares the signals by name, all off; call it before the first frame.
    pub fn signals(&mut self, names: &[String]) {
        self.signals = Signals::new(names);
        self.layout.has_signals = self.signals.are_there();
    }

    /// Shows that a signal switches at a time (ns) and line with the tool at `tool` (m): mark, plot and text.
    ///
    /// # Errors
    /// [`VizError::Log`] if rerun refuses it.
    pub fn switched(
        &mut self,
        (time_ns, line): (i64, u32),
        tool: &Point3<f64>,
        signal: usize,
        on: bool,
    ) -> Result<()> {
        self.lay_out()?;
        self.stream.set_time(time_ns, line);
        match self.signals.switch(&mut self.stream, tool, signal, on)? {
            Some(words) => self.news(time_ns, line, &words),
            None => Ok(()),
        }
    }

    /// Shows one instant. Poses are thinned to what a screen shows, errors and speeds are kept as they come.
    ///
    /// # Errors
    /// [`VizError::Count`] if the frame does not fit the
    /// machine; [`VizError::Log`] and [`VizError::Encode`] if rerun refuses it.
    pub fn frame(&mut self, frame: &Frame<'_>) -> Result<()> {
        self.fits(frame)?;
        if self.layout.motors.is_empty() && !frame.motors.is_empty() {
            // The first frame need not know of them: then the page gets room for them now.
            self.layout.motors = MotorPlot::of(&self.layout.axes, frame.motors);
            self.has_layout = false;
        }
        self.lay_out()?;
        let at = At { time_ns: frame.time_ns, line: frame.line };
        self.stream.set_time(at.time_ns, at.line);

        self.setpoint.add(&mut self.stream, at, &frame.setpoint, 0.0)?;
        self.twin.add(&mut self.stream, at, &frame.twin.tool, frame.twin.tool_error)?;
        if let Some(DrivesFrame { deviation, tool_error_to_twin }) = &frame.drives {
            self.drives.add(&mut self.stream, at, &deviation.tool, deviation.tool_error)?;
            self.between.add_length(at, *tool_error_to_twin);
        }
        if self.pose_due.take(frame.time_ns) {
            self.machine.log_poses(&mut self.stream, frame.link_poses)?;
            self.bodies.log_poses(&mut self.stream, frame.body_poses)?;
            let newest = [&self.setpoint, &self.twin, &self.drives]
                .into_iter()
                .filter_map(ToolTrack::newest);
            trail::log_newest(&mut self.stream, newest)?;
            if let Some(track) = &mut self.clearance {
                track.join(&mut self.stream, frame.clearance.as_ref())?;
            }
        }
        if let Some((track, clearance)) = self.clearance.as_mut().zip(frame.clearance.as_ref()) {
            track.add(at, clearance);
        }
        self.signals.add(at);
        self.path_speed.add_length(at, frame.path_speed);
        if let Some(speed) = frame.programmed_speed {
            self.programmed_speed.add_length(at, speed);
        }
        for (index, axis) in self.axes.iter_mut().enumerate() {
            let of = |deviation: &Deviation<'_>| deviation.axis_errors.get(index).copied();
            let drives = frame.drives.as_ref().and_then(|drives| of(&drives.deviation));
            axis.add(at, of(&frame.twin), drives);
        }
        for (series, motor) in self.motors.iter_mut().zip(frame.motors) {
            series.add(at, motor);
        }
        self.excerpt.log(&mut self.stream, frame.line)?;
        if self.series_due.take(frame.time_ns) {
            self.send_series()?;
        }
        if self.rows_due.take(frame.time_ns) {
            self.stream.flush()?;
        }
        Ok(())
    }

    /// Shows an event of the twin at `time_ns`, in a line of the program, next to its text.
    ///
    /// # Errors
    /// [`VizError::Log`] if rerun refuses it.
    pub fn news(&mut self, time_ns: i64, line: u32, what: &str) -> Result<()> {
        self.lay_out()?;
        self.stream.set_time(time_ns, line);
        let seconds = std::time::Duration::from_nanos(u64::try_from(time_ns).unwrap_or(0));
        self.excerpt.log_news(&mut self.stream, (seconds.as_secs_f64(), line), what)
    }

    /// Closes the recording, as [`Self::close`] does. The page, if there is one, goes on until the returned [`Viewer`]
    /// is dropped.
    ///
    /// # Errors
    /// [`VizError::Write`] if not everything could be written.
    pub fn finish(mut self) -> Result<Option<Viewer>> {
        self.close()?;
        Ok(self.viewer.take())
    }

    /// Writes all data still held back and closes the recording, within a second. The page, if there is one, goes on
    /// until the scene is dropped.
    ///
    /// # Errors
    /// [`VizError::Write`] if not everything could be written.
    pub fn close(&mut self) -> Result<()> {
        self.lay_out()?;
        for track in [&mut self.setpoint, &mut self.twin, &mut self.drives] {
            track.flush_trail(&mut self.stream)?;
        }
        self.send_series()?;
        let finished = self.stream.finish();
        self.complete.store(true, Ordering::Release);
        finished
    }

    /// Sends what the plots hold back.
    fn send_series(&mut self) -> Result<()> {
        for track in [&mut self.twin, &mut self.drives] {
            track.flush_error(&mut self.stream)?;
        }
        for series in [&mut self.between, &mut self.path_speed, &mut self.programmed_speed] {
            series.flush(&mut self.stream)?;
        }
        self.clearance.iter_mut().try_for_each(|track| track.flush(&mut self.stream))?;
        self.signals.flush(&mut self.stream)?;
        self.axes.iter_mut().try_for_each(|axis| axis.flush(&mut self.stream))?;
        self.motors.iter_mut().try_for_each(|motor| motor.flush(&mut self.stream))
    }

    fn fits(&self, frame: &Frame<'_>) -> Result<()> {
        VizError::check_links(self.machine.count(), frame.link_poses.len())?;
        let drives = frame.drives.as_ref().map(|drives| drives.deviation.axis_errors.len());
        let counts = [
            ("motors", Some(frame.motors.len()).filter(|count| *count > 0)),
            ("axis errors", Some(frame.twin.axis_errors.len())),
            ("axis errors", drives),
        ];
        let expected = self.axes.len();
        for (what, found) in counts {
            if let Some(found) = found.filter(|found| *found != expected) {
                return Err(VizError::Count { of: "axes", what, expected, found });
            }
        }
        Ok(())
    }

    /// Sends the layout, where it has not been sent as it is, when the extent of machine and path is known.
    fn lay_out(&mut self) -> Result<()> {
        if !self.has_layout {
            self.has_layout = true;
            blueprint::send(&mut self.stream, &self.layout, &self.bounds, self.playback)?;
            if self.is_paced {
                self.stream.hurry();
            }
        }
        Ok(())
    }
}

impl Drop for Scene {
    /// An abandoned scene also ends its recording properly and informs the page.
    fn drop(&mut self) {
        if !self.complete.load(Ordering::Acquire) {
            self.stream.finish().ok();
            self.complete.store(true, Ordering::Release);
        }
    }
}

/// A place on both timelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct At {
    pub(crate) time_ns: i64,
    pub(crate) line: u32,
}
