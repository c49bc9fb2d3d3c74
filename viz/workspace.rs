//! Recording of a section through the workspace of a machine, together with the machine.

use nalgebra::{Isometry3, Point3};
use rerun::{Color, TextDocument};
use twin_urdf::Model;

use crate::blueprint;
use crate::bounds::Bounds;
use crate::error::{Result, VizError};
use crate::frame::Obstacle;
use crate::recorder::Recorder;
use crate::scene::SceneOptions;
use crate::scene::destination::{self, Destination};
use crate::scene::machine::{self, Moving};
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
    /// Text next to it.
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
    /// Obstacles around it.
    pub surroundings: &'a [Obstacle<'a>],
    /// Corners of the section's triangles, machine frame, m.
    pub corners: &'a [Point3<f64>],
    /// Red, green and blue of every corner.
    pub colors: &'a [[u8; 3]],
    /// The triangles, each by three places in `corners`.
    pub triangles: &'a [[u32; 3]],
    /// Outlines of the section.
    pub lines: &'a [SheetLine],
    /// Points of interest.
    pub marks: &'a [Mark],
    /// Description of the view (Markdown).
    pub about: &'a str,
}

/// Records a workspace, or serves it, or both. The page goes on until the returned [`Viewer`] is dropped.
///
/// # Errors
/// [`VizError::NoDestination`] and its neighbours if the destinations cannot be had, [`VizError::Count`] if the poses
/// do not fit the machine, [`VizError::Write`] if not everything could be written.
pub fn show_workspace(options: &SceneOptions, view: &WorkspaceView<'_>) -> Result<Option<Viewer>> {
    VizError::check_links(view.machine.links.len(), view.poses.len())?;
    let title = format!("workspace of {}", view.machine.name);
    let Destination { mut stream, viewer, complete } = destination::open(options, &title)?;
    stream.log_static("/", &rerun::ViewCoordinates::RIGHT_HAND_Z_UP())?;

    let mut bounds = Bounds::default();
    let mut machine = Moving::links(&mut stream, view.machine, view.poses, &mut bounds)?;
    machine::log_obstacles(&mut stream, view.surroundings, &mut bounds)?;
    stream.set_time(0, 0);
    machine.log_poses(&mut stream, view.poses)?;
    log_section(&mut stream, view)?;
    view.corners.iter().for_each(|corner| bounds.add(corner));
    stream.log_static("about", &TextDocument::from_markdown(view.about))?;
    blueprint::send_workspace(&mut stream, &bounds)?;
    stream.finish()?;
    complete.store(true, Ordering::Release);
    Ok(viewer)
}

fn log_section(stream: &mut Recorder, view: &WorkspaceView<'_>) -> Result<()> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tests::{fixed_jaw, machine, read::Read};
    use rerun::components;

    const TRIANGLE: [[f64; 3]; 3] = [[0.1, 0.0, 0.02], [0.3, 0.0, 0.02], [0.1, 0.4, 0.02]];
    const COLORS: [[u8; 3]; 3] = [[1, 2, 3], [4, 5, 6], [7, 8, 9]];

    fn record(poses: usize) -> Result<Read> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("workspace.rrd");
        let corners = TRIANGLE.map(Point3::from);
        let viewer = show_workspace(
            &SceneOptions { record: Some(path.clone()), ..SceneOptions::default() },
            &WorkspaceView {
                machine: &machine(),
                poses: &vec![Isometry3::identity(); poses],
                surroundings: &[Obstacle { name: "fixed jaw", solids: &fixed_jaw() }],
                corners: &corners,
                colors: &COLORS,
                triangles: &[[0, 1, 2]],
                lines: &[SheetLine { points: corners.to_vec(), color: [255, 0, 0] }],
                marks: &[Mark { point: corners[1], label: "start", color: [0, 255, 0] }],
                about: "a triangle",
            },
        )?;
        assert!(viewer.is_none());
        Ok(Read::new(&path))
    }

    #[test]
    fn a_section_is_recorded_in_mm_beside_its_machine() {
        let read = record(2).unwrap();
        let mesh = rerun::Mesh3D::descriptor_vertex_positions();
        let corners = read.statics::<components::Position3D>("workspace/section", &mesh);
        let corners: Vec<_> = corners.iter().map(|corner| corner.0.0).collect();
        assert_eq!(corners, [[100.0, 0.0, 20.0], [300.0, 0.0, 20.0], [100.0, 400.0, 20.0]]);
        let colors = rerun::Mesh3D::descriptor_vertex_colors();
        let colors = read.statics::<components::Color>("workspace/section", &colors);
        assert_eq!(colors, COLORS.map(|[r, g, b]| Color::from_rgb(r, g, b)));
        let lines = rerun::LineStrips3D::descriptor_strips();
        let lines = read.statics::<components::LineStrip3D>("workspace/lines", &lines);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].0.len(), 3);
        let labels = rerun::Points3D::descriptor_labels();
        let labels = read.statics::<components::Text>("workspace/marks", &labels);
        assert_eq!(labels, ["start".into()]);
        assert!(read.of("machine/arm\\ 1/cylinders").next().is_some());
        assert!(read.of("surroundings/fixed\\ jaw/boxes").next().is_some());
        assert!(!read.blueprint.is_empty());
        assert_eq!(read.activations, 1);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let error = record(1).err().unwrap();
        assert!(
            matches!(error, VizError::Count { what: "link poses", expected: 2, found: 1, .. }),
            "{error}"
        );
        let view = WorkspaceView {
            machine: &machine(),
            poses: &[Isometry3::identity(); 2],
            surroundings: &[],
            corners: &[],
            colors: &[],
            triangles: &[],
            lines: &[],
            marks: &[],
            about: "",
        };
        let error = show_workspace(&SceneOptions::default(), &view).err().unwrap();
        assert!(matches!(error, VizError::NoDestination), "{error}");
    }
}
