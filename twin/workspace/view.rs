//! A section in space, next to the machine.

use super::{Example, Scale, Section, State, Workspace};
use crate::live_view::obstacles;
use nalgebra::Point2;
use twin_viz::{Mark, SceneOptions, SheetLine, Viewer, VizError, WorkspaceView, show_workspace};

const EDGE: [u8; 3] = [235, 238, 242];
const REACH: [u8; 3] = [130, 138, 150];
const MARKS: [u8; 3] = [240, 70, 60];

/// Records machine and section, or serves them, or both; the page goes on until the [`Viewer`] is dropped.
///
/// # Errors
/// What the view says.
pub fn show(
    options: &SceneOptions,
    workspace: &Workspace<'_>,
    section: &Section<'_>,
    example: Option<&Example>,
) -> Result<Option<Viewer>, VizError> {
    let machine = workspace.space.machine();
    let region = &section.within;
    let in_space = |at: &Point2<f64>| section.plane.point(at);
    let scale = Scale::up_to(section.best.map_or(0.0, |best| best.measure));
    let colors: Vec<_> = region
        .corners
        .iter()
        .map(|at| scale.shade(section.sample(at).measure).channels())
        .collect();
    let corners: Vec<_> = region.corners.iter().map(in_space).collect();

    let reach = section.region_by_state(&|state| state != State::OutOfReach);
    let line = |color: [u8; 3]| {
        move |line: Vec<Point2<f64>>| SheetLine {
            points: line.iter().map(in_space).collect(),
            color,
        }
    };
    let lines: Vec<_> = reach
        .lines()
        .into_iter()
        .map(line(REACH))
        .chain(region.lines().into_iter().map(line(EDGE)))
        .collect();

    let mark = |label, point| Mark { point, label, color: MARKS };
    let marks: Vec<_> = workspace
        .start
        .map(|start| mark("start of programs", start))
        .into_iter()
        .chain(example.map(|example| mark("worked example", example.position)))
        .collect();
    show_workspace(
        options,
        &WorkspaceView {
            machine: &machine.model,
            poses: &machine.model.link_poses(&workspace.stance()),
            surroundings: &obstacles(machine),
            corners: &corners,
            colors: &colors,
            triangles: &region.triangles,
            lines: &lines,
            marks: &marks,
            about: &about(section, &machine.name, scale),
        },
    )
}

/// Description of the picture.
fn about(section: &Section<'_>, machine: &str, scale: Scale) -> String {
    let measure = match (section.worst, section.best) {
        (Some(worst), Some(best)) => format!("{:.3} to {:.3}", worst.measure, best.measure),
        _ => "–".to_owned(),
    };
    format!(
        "**Machine** {machine}  \n**Section** {}  \n**Area** {:.0} cm² within the software limits  \n\
         **White** edge of the workspace, **grey** edge of the reach  \n\
         **Colours** singularity measure, from dark (0) to bright ({:.2})  \n**Measure** {measure}",
        section.cut,
        section.within.area() * 1e4,
        scale.least(scale.bands())
    )
}
