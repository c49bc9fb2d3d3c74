//! The recording being written.

mod machine;
mod program;
mod series;
mod trail;

#[cfg(test)]
pub(crate) mod tests;

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use nalgebra::{Isometry3, Point3};
use rerun::sink::{FileSink, LogSink};
use rerun::{RecordingStream, RecordingStreamBuilder, TimeCell};
use twin_urdf::Model;

use crate::blueprint::{self, Layout};
use crate::bounds::Bounds;
use crate::error::VizError;
use crate::frame::{Axis, Deviation, Frame, PathStrip, Program};
use crate::palette;
use crate::server::{Source, Viewer};
use crate::units::point_mm;
use program::Excerpt;
use series::{AxisSeries, Series};
use trail::Trail;

/// Name under which the viewer groups our recordings.
const APPLICATION: &str = "twin";
/// Timeline: since the start of the program.
pub(crate) const TIME: &str = "time";
/// Timeline: line of the program file.
pub(crate) const LINE: &str = "line";
/// Poses are shown 50 times a second of program time; a screen does not show more.
const POSE_INTERVAL_NS: i64 = 20_000_000;
/// Height of what the close-up of the tool shows, m.
const CLOSE_UP: f64 = 0.002;

/// Where a scene goes.
#[derive(Clone, Debug, Default)]
pub struct SceneOptions {
    /// A file to record to (`.rrd`), overwritten if it exists.
    pub record: Option<PathBuf>,
    /// An address to serve the viewer at; [`crate::DEFAULT_ADDRESS`] is the customary one. Port 0 takes any free one.
    pub serve: Option<SocketAddr>,
    /// What the viewer does with the time when it opens.
    pub playback: Playback,
}

/// What the viewer does with the time when it opens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Playback {
    /// Plays from the start of the program at the speed of the machine and waits at the end for more. Right for runs
    /// that are faster than the machine.
    #[default]
    FromStart,
    /// Shows the newest. Right for runs in step with the clock.
    Follow,
}

impl Playback {
    /// How much of the program is sent at once. Few large pieces load and replay faster; small ones show sooner what
    /// happens now.
    fn batch_ns(self) -> i64 {
        match self {
            Self::FromStart => 2_000_000_000,
            Self::Follow => 200_000_000,
        }
    }
}

/// What the scene is about.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// The machine.
    pub machine: &'a Model,
    /// Poses of its links before the first frame, in the machine frame; as many as it has links.
    pub home: &'a [Isometry3<f64>],
    /// Its axes.
    pub axes: &'a [Axis],
    /// The program.
    pub program: Program<'a>,
    /// What the drives are ("`InterpCNC`, emulated"); `None` if there are none.
    pub drives: Option<&'a str>,
}

/// A recording being written, and the page that shows it.
#[derive(Debug)]
pub struct Scene {
    stream: RecordingStream,
    path: PathBuf,
    /// Tells the page that nothing more comes.
    complete: Arc<AtomicBool>,
    viewer: Option<Viewer>,
    bounds: Bounds,
    playback: Playback,
    has_layout: bool,
    strips_logged: usize,
    links: Vec<String>,
    axes: Vec<AxisSeries>,
    excerpt: Excerpt,
    pose_due: Due,
    batch_begun_ns: Option<i64>,
    setpoint: ToolTrack,
    twin: ToolTrack,
    drives: ToolTrack,
    drives_to_twin: Series,
    path_speed: Series,
    programmed_speed: Series,
    layout: Layout,
}

/// Marker, trail and error of one of the three tools.
#[derive(Debug)]
struct ToolTrack {
    entity: String,
    color: rerun::Color,
    has_marker: bool,
    pose_due: Due,
    trail: Trail,
    /// Distance to the set-point; the set-point itself has none.
    error: Option<Series>,
}

/// Thins poses to those that a screen can show.
#[derive(Clone, Copy, Debug, Default)]
struct Due {
    next_ns: Option<i64>,
}

impl Due {
    /// Whether a pose is due at this time; the next one then is an interval later.
    fn take(&mut self, time_ns: i64) -> bool {
        let is_due = self.next_ns.is_none_or(|next| time_ns >= next);
        if is_due {
            self.next_ns = Some(time_ns.saturating_add(POSE_INTERVAL_NS));
        }
        is_due
    }
}

impl ToolTrack {
    fn new(name: &str, color: rerun::Color, error: Option<Series>) -> Self {
        let trail = Trail::new(name, color);
        Self {
            entity: format!("tool/{name}"),
            color,
            has_marker: false,
            pose_due: Due::default(),
            trail,
            error,
        }
    }

    /// Places the marker, at the stream's time, and brings the trail up to it. The close-up looks from the frame of the
    /// set-point, so the marker itself is at the origin of its frame.
    fn log_position(
        &mut self,
        stream: &RecordingStream,
        tool: &Point3<f64>,
    ) -> Result<(), VizError> {
        if !self.has_marker {
            self.has_marker = true;
            trail::log_marker(stream, &self.entity, self.color)?;
        }
        let position = rerun::Transform3D::update_fields().with_translation(point_mm(tool));
        stream.log(self.entity.as_str(), &position)?;
        self.trail.log_newest(stream, tool)
    }
}

impl Scene {
    /// Creates the recording, starts the page if one is asked for, and shows the machine at its home pose.
    ///
    /// # Errors
    ///
    /// [`VizError::NoDestination`], [`VizError::Create`], [`VizError::Temporary`], [`VizError::Bind`] and its
    /// neighbours if the destinations cannot be had; [`VizError::LinkCount`] if `home` does not fit the machine.
    pub fn open(options: &SceneOptions, setup: &Setup<'_>) -> Result<Self, VizError> {
        if setup.home.len() != setup.machine.links.len() {
            return Err(VizError::LinkCount {
                expected: setup.machine.links.len(),
                found: setup.home.len(),
            });
        }
        let complete = Arc::new(AtomicBool::new(false));
        let (path, viewer, sink) = destinations(options, setup.program.name, &complete)?;
        let stream = RecordingStreamBuilder::new(APPLICATION)
            .recording_name(setup.program.name)
            .enabled(true)
            .set_sinks(vec![Box::new(sink) as Box<dyn LogSink>])?;
        // Only the time of the program counts; when a value happened to be logged does not.
        stream.set_log_time_enabled(false);
        stream.set_log_tick_enabled(false);

        let mut bounds = Bounds::default();
        stream.log_static("/", &rerun::ViewCoordinates::RIGHT_HAND_Z_UP())?;
        let links = machine::log_solids(&stream, setup.machine, setup.home, &mut bounds)?;
        At { time_ns: 0, line: 0 }.set(&stream);
        machine::log_poses(&stream, &links, setup.home)?;
        program::log_about(&stream, setup)?;

        let error = |name, label, color| Series::new(format!("error/tool/{name}"), label, color);
        let twin = error("twin", "twin to set-point", palette::twin());
        let drives = error("drives", "drives to set-point", palette::drives());
        // The page must know the machine and the names before the first values.
        stream.flush_async().map_err(|source| VizError::Write { path: path.clone(), source })?;
        let layout = Layout { axes: setup.axes.to_vec(), close_up: CLOSE_UP };
        Ok(Self {
            stream,
            path,
            complete,
            viewer,
            bounds,
            playback: options.playback,
            has_layout: false,
            strips_logged: 0,
            links,
            axes: AxisSeries::all(setup.axes),
            excerpt: Excerpt::new(setup.program.text),
            pose_due: Due::default(),
            batch_begun_ns: None,
            setpoint: ToolTrack::new("set-point", palette::setpoint(), None),
            twin: ToolTrack::new("twin", palette::twin(), Some(twin)),
            drives: ToolTrack::new("drives", palette::drives(), Some(drives)),
            drives_to_twin: error("drives_to_twin", "drives to twin", palette::drives_to_twin()),
            path_speed: Series::new("speed/set-point".to_owned(), "set-point", palette::setpoint()),
            programmed_speed: Series::new(
                "speed/programmed".to_owned(),
                "programmed",
                palette::cut(),
            ),
            layout,
        })
    }

    /// The page, if one was asked for.
    pub fn viewer(&self) -> Option<&Viewer> {
        self.viewer.as_ref()
    }

    /// Shows a piece of the programmed path. May be called often; call it before the first frame for the camera to
    /// take the path in.
    ///
    /// # Errors
    ///
    /// [`VizError::Log`] if rerun refuses the path.
    pub fn programmed_path(&mut self, strips: &[PathStrip]) -> Result<(), VizError> {
        strips.iter().flat_map(|strip| &strip.points).for_each(|point| self.bounds.add(point));
        self.strips_logged += 1;
        trail::log_programmed(&self.stream, self.strips_logged, strips)
    }

    /// Shows one instant. Poses are thinned to what a screen shows, errors and speeds are kept as they come.
    ///
    /// # Errors
    ///
    /// [`VizError::LinkCount`] and [`VizError::AxisCount`] if the frame does not fit the machine; [`VizError::Log`]
    /// and [`VizError::Encode`] if rerun refuses it.
    pub fn frame(&mut self, frame: &Frame<'_>) -> Result<(), VizError> {
        self.fits(frame)?;
        self.lay_out()?;
        let at = At { time_ns: frame.time_ns, line: frame.line };
        at.set(&self.stream);

        let tracks = [
            (&mut self.setpoint, Some(&frame.setpoint), None),
            (&mut self.twin, Some(&frame.twin.tool), Some(frame.twin.tool_error)),
            (
                &mut self.drives,
                frame.drives.as_ref().map(|drives| &drives.deviation.tool),
                frame.drives.as_ref().map(|drives| drives.deviation.tool_error),
            ),
        ];
        for (track, tool, error) in tracks {
            let Some(tool) = tool else { continue };
            track.trail.add(&self.stream, at, tool)?;
            if let (Some(series), Some(error)) = (&mut track.error, error) {
                series.add_length(at, error);
            }
            if track.pose_due.take(frame.time_ns) {
                track.log_position(&self.stream, tool)?;
            }
        }
        if self.pose_due.take(frame.time_ns) {
            machine::log_poses(&self.stream, &self.links, frame.link_poses)?;
        }
        if let Some(drives) = &frame.drives {
            self.drives_to_twin.add_length(at, drives.tool_error_to_twin);
        }
        self.path_speed.add_length(at, frame.path_speed);
        if let Some(speed) = frame.programmed_speed {
            self.programmed_speed.add_length(at, speed);
        }
        for (index, axis) in self.axes.iter_mut().enumerate() {
            let of = |deviation: &Deviation<'_>| deviation.axis_errors.get(index).copied();
            let drives = frame.drives.as_ref().and_then(|drives| of(&drives.deviation));
            axis.add(at, of(&frame.twin), drives);
        }
        self.excerpt.log(&self.stream, frame.line)?;
        let waited =
            frame.time_ns.saturating_sub(*self.batch_begun_ns.get_or_insert(frame.time_ns));
        if waited >= self.playback.batch_ns() {
            self.batch_begun_ns = None;
            self.send_batch()?;
        }
        Ok(())
    }

    /// Writes what is still held back and closes the recording. The page, if there is one, goes on until the returned
    /// [`Viewer`] is dropped.
    ///
    /// # Errors
    ///
    /// [`VizError::Write`] if not everything could be written.
    pub fn finish(mut self) -> Result<Option<Viewer>, VizError> {
        self.lay_out()?;
        for track in [&mut self.setpoint, &mut self.twin, &mut self.drives] {
            track.trail.flush(&self.stream)?;
        }
        self.send_batch()?;
        self.stream
            .flush_blocking()
            .map_err(|source| VizError::Write { path: self.path.clone(), source })?;
        self.stream.finalize_deferred_sinks();
        self.complete.store(true, Ordering::Release);
        Ok(self.viewer.take())
    }

    /// Sends what the series hold back, and what rerun holds back after it, so that the page gets everything about a
    /// time at about the same time.
    fn send_batch(&mut self) -> Result<(), VizError> {
        for track in [&mut self.setpoint, &mut self.twin, &mut self.drives] {
            if let Some(error) = &mut track.error {
                error.flush(&self.stream)?;
            }
        }
        for series in [&mut self.drives_to_twin, &mut self.path_speed, &mut self.programmed_speed] {
            series.flush(&self.stream)?;
        }
        for axis in &mut self.axes {
            axis.flush(&self.stream)?;
        }
        self.stream
            .flush_async()
            .map_err(|source| VizError::Write { path: self.path.clone(), source })
    }

    fn fits(&self, frame: &Frame<'_>) -> Result<(), VizError> {
        if frame.link_poses.len() != self.links.len() {
            return Err(VizError::LinkCount {
                expected: self.links.len(),
                found: frame.link_poses.len(),
            });
        }
        let deviations = [Some(&frame.twin), frame.drives.as_ref().map(|drives| &drives.deviation)];
        match deviations
            .into_iter()
            .flatten()
            .find(|deviation| deviation.axis_errors.len() != self.axes.len())
        {
            Some(deviation) => Err(VizError::AxisCount {
                expected: self.axes.len(),
                found: deviation.axis_errors.len(),
            }),
            None => Ok(()),
        }
    }

    /// Sends the layout, once, when the extent of machine and path is known.
    fn lay_out(&mut self) -> Result<(), VizError> {
        if !self.has_layout {
            self.has_layout = true;
            blueprint::send(&self.stream, APPLICATION, &self.layout, &self.bounds, self.playback)?;
        }
        Ok(())
    }
}

impl Drop for Scene {
    /// A scene that is given up half-way still ends its recording properly, and tells the page.
    fn drop(&mut self) {
        self.stream.finalize_deferred_sinks();
        self.complete.store(true, Ordering::Release);
    }
}

/// A place on both timelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct At {
    pub(crate) time_ns: i64,
    pub(crate) line: u32,
}

impl At {
    /// Everything logged from here on is at this place.
    pub(crate) fn set(self, stream: &RecordingStream) {
        stream.set_time(TIME, TimeCell::from_duration_nanos(self.time_ns));
        stream.set_time(LINE, TimeCell::from_sequence(i64::from(self.line)));
    }
}

/// Opens the file and the page. The page reads the recording from the file; without one asked for, from a temporary
/// one that goes away with the page.
fn destinations(
    options: &SceneOptions,
    title: &str,
    complete: &Arc<AtomicBool>,
) -> Result<(PathBuf, Option<Viewer>, FileSink), VizError> {
    let (source, path) = match (&options.record, options.serve) {
        (None, None) => return Err(VizError::NoDestination),
        (Some(path), _) => (Source::file(path.clone(), complete.clone()), path.clone()),
        (None, Some(_)) => {
            let temporary = tempfile::Builder::new()
                .prefix("twin-")
                .suffix(".rrd")
                .tempfile()
                .map_err(|source| VizError::Temporary { folder: std::env::temp_dir(), source })?
                .into_temp_path();
            let path = temporary.to_path_buf();
            (Source::temporary(temporary, complete.clone()), path)
        }
    };
    // The address first: an address that is taken must not cost the user an existing recording.
    let listener = options.serve.map(crate::server::bind).transpose()?;
    let sink =
        FileSink::new(&path).map_err(|source| VizError::Create { path: path.clone(), source })?;
    let viewer = listener.map(|listener| Viewer::start(listener, title, source)).transpose()?;
    Ok((path, viewer, sink))
}
