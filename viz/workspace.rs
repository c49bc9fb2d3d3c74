//! A section through the workspace of a machine, beside the machine itself.

use nalgebra::{Isometry3, Point3};
use rerun::sink::LogSink;
use rerun::{Color, RecordingStream, RecordingStreamBuilder, TextDocument};
use twin_urdf::Model;

use crate::blueprint;
use crate::bounds::Bounds;
use crate::error::VizError;
use crate::scene::destination::{self, Destination};
use crate::scene::machine::Machine;
use crate::scene::{APPLICATION, At, SceneOptions};
use crate::server::Viewer;
use crate::units::point_mm;
use std::sync::atomic::Ordering;

/// Radius of lines on the screen, in its points: the same from near and far.
const LINE: f32 = -1.6;
/// Radius of marks on the screen, in its points.
const MARK: f32 = -5.0;

/// A line of a section.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetLine {
    /// Machine frame, m.
    pub points: Vec<Point3<f64>>,
    /// Red, green, blue.
    pub color: [u8; 3],
}

/// A marked point.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Machine frame, m.
    pub point: Point3<f64>,
    /// What is written beside it.
    pub label: &'static str,
    /// Red, green, blue.
    pub color: [u8; 3],
}

/// A machine and a section through its workspace.
#[derive(Clone, Copy, Debug)]
pub struct WorkspaceView<'a> {
    /// The machine.
    pub machine: &'a Model,
    /// Poses of its links in the machine frame; as many as it has links.
    pub poses: &'a [Isometry3<f64>],
    /// Corners of the section's triangles, machine frame, m.
    pub corners: &'a [Point3<f64>],
    /// Red, green and blue of every corner.
    pub colors: &'a [[u8; 3]],
    /// The triangles, each by three places in `corners`.
    pub triangles: &'a [[u32; 3]],
    /// What bounds the section.
    pub lines: &'a [SheetLine],
    /// Points of interest.
    pub marks: &'a [Mark],
    /// What is shown, in words (Markdown).
    pub about: &'a str,
}

/// Records a workspace, or serves it, or both. The page goes on until the returned [`Viewer`] is dropped.
///
/// # Errors
///
/// [`VizError::NoDestination`] and its neighbours if the destinations cannot be had, [`VizError::LinkCount`] if the poses
/// do not fit the machine, [`VizError::Write`] if not everything could be written.
pub fn show_workspace(
    options: &SceneOptions,
    view: &WorkspaceView<'_>,
) -> Result<Option<Viewer>, VizError> {
    let (expected, found) = (view.machine.links.len(), view.poses.len());
    if expected != found {
        return Err(VizError::LinkCount { expected, found });
    }
    let title = format!("workspace of {}", view.machine.name);
    let Destination { path, sink, viewer, complete } = destination::open(options, &title)?;
    let stream = RecordingStreamBuilder::new(APPLICATION)
        .recording_name(title)
        .enabled(true)
        .set_sinks(vec![Box::new(sink) as Box<dyn LogSink>])?;
    stream.set_log_time_enabled(false);
    stream.set_log_tick_enabled(false);
    stream.log_static("/", &rerun::ViewCoordinates::RIGHT_HAND_Z_UP())?;

    let mut bounds = Bounds::default();
    let mut machine = Machine::log_solids(&stream, view.machine, view.poses, &mut bounds)?;
    At { time_ns: 0, line: 0 }.set(&stream);
    machine.log_poses(&stream, view.poses)?;
    log_section(&stream, view)?;
    view.corners.iter().for_each(|corner| bounds.add(corner));
    stream.log_static("about", &TextDocument::from_markdown(view.about))?;
    blueprint::send_workspace(&stream, APPLICATION, &bounds)?;

    stream.flush_blocking().map_err(|source| VizError::Write { path, source })?;
    stream.finalize_deferred_sinks();
    complete.store(true, Ordering::Release);
    Ok(viewer)
}

fn log_section(stream: &RecordingStream, view: &WorkspaceView<'_>) -> Result<(), VizError> {
    let color = |[red, green, blue]: [u8; 3]| Color::from_rgb(red, green, blue);
    if !view.triangles.is_empty() {
        let mesh = rerun::Mesh3D::new(view.corners.iter().map(point_mm))
            .with_vertex_colors(view.colors.iter().copied().map(color))
            .with_triangle_indices(view.triangles.iter().copied());
        stream.log_static("workspace/section", &mesh)?;
    }
    let strips = view.lines.iter().map(|line| line.points.iter().map(point_mm).collect::<Vec<_>>());
    let lines = rerun::LineStrips3D::new(strips)
        .with_colors(view.lines.iter().map(|line| color(line.color)))
        .with_radii([LINE]);
    stream.log_static("workspace/lines", &lines)?;
    let marks = rerun::Points3D::new(view.marks.iter().map(|mark| point_mm(&mark.point)))
        .with_colors(view.marks.iter().map(|mark| color(mark.color)))
        .with_labels(view.marks.iter().map(|mark| mark.label))
        .with_radii([MARK]);
    stream.log_static("workspace/marks", &marks)?;
    Ok(())
}
