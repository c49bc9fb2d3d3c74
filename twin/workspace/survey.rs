//! Everything about a workspace at once.

use super::example::Example;
use super::extent::{Extent, Sweep};
use super::section::{Cut, Plane, Section};
use super::silhouette::{silhouette, surroundings};
use super::space::Space;
use nalgebra::{Point2, Point3, Vector2};
use twin_kinematics::{AxisVector, Coordinate, Kinematics, KinematicsError, ReachOf};
use twin_machine::Machine;

/// Farther than any machine reaches, m.
const FAR: f64 = 1e7;
/// Room for the machine around the workspace, relative to its longer side.
const MACHINE: f64 = 0.2;
/// Lower than this a workspace has no height, m.
const FLAT: f64 = 1e-9;
/// Examples are given in whole multiples of this, m, where the workspace is large enough.
const ROUND: [f64; 2] = [0.01, 0.001];

/// Sections and tool direction of a survey.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct View {
    /// Height of the horizontal section, m; default: that of the start of programs, or the middle.
    pub height: Option<f64>,
    /// Direction of the vertical section, rad about +z from +x.
    pub azimuth: f64,
    /// Direction of the tool, rad about +z from +x, if the machine turns it; default: that at the start of
    /// programs.
    pub direction: Option<f64>,
}

/// Errors of a survey.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum WorkspaceError {
    /// The tool of a machine that does not turn it was to have a direction.
    #[error("no axis of the machine turns the tool: it cannot be given a direction")]
    Direction,
    /// Software limits that leave nothing.
    #[error("the tool is nowhere within the software limits of all axes")]
    Nowhere,
    /// A height without workspace.
    #[error("at a height of {:.3} mm the tool is nowhere within the software limits; they let it be {:.3} to {:.3} mm high",
        height * 1e3, limits[0] * 1e3, limits[1] * 1e3)]
    Height {
        /// Requested height, m.
        height: f64,
        /// Lowest and highest place of the tool, m.
        limits: [f64; 2],
    },
    /// A vertical section of a workspace without height.
    #[error("no axis moves the tool up and down: there is no vertical section")]
    Flat,
}

/// Reach of the arms of a machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Part that reaches: the tool tip, or the wrist.
    pub of: ReachOf,
    /// Smallest and largest distance, m.
    pub distances: [f64; 2],
}

/// The workspace of a machine.
#[derive(Clone, Debug)]
pub struct Workspace<'m> {
    /// The space around the machine.
    pub space: Space<'m>,
    /// True if an axis turns the tool about the vertical.
    pub turns_tool: bool,
    /// The box around every place of the tool within the software limits.
    pub extent: Extent,
    /// How far the arms reach without limits; `None` for machines without arms.
    pub reach: Option<Reach>,
    /// Where programs start that do not say where, m, machine frame; `None` if that is out of reach.
    pub start: Option<Point3<f64>>,
    /// Where the vertical section goes.
    vertical: Cut,
    /// The horizontal one.
    horizontal: Cut,
    /// The box around everything that a picture shows.
    shown: Extent,
}

impl<'m> Workspace<'m> {
    /// Goes through the positions of the axes.
    ///
    /// # Errors
    /// [`WorkspaceError::Direction`], [`WorkspaceError::Nowhere`], [`WorkspaceError::Height`].
    pub fn survey(machine: &'m Machine, view: &View) -> Result<Self, WorkspaceError> {
        let direction = view.direction.unwrap_or_else(|| machine.start_pose().direction);
        let space = Space::new(machine, direction);
        let turns_tool = machine.kinematics.coordinates().contains(&Coordinate::Direction);
        if view.direction.is_some() && !turns_tool {
            return Err(WorkspaceError::Direction);
        }
        let extent = Sweep::within_limits(&space).extent().ok_or(WorkspaceError::Nowhere)?;
        let reachable = Sweep::whole_turns(&space).extent().unwrap_or(extent);
        let start = machine.start_axes().map(|_| machine.start_pose().position);
        let reach = reach(&space, &extent);

        let [lowest, highest] = [extent.min.z, extent.max.z];
        let is_there = |height: &f64| (lowest - FLAT..=highest + FLAT).contains(height);
        let height = match view.height {
            Some(height) if !is_there(&height) => {
                return Err(WorkspaceError::Height { height, limits: [lowest, highest] });
            }
            Some(height) => height,
            None => start
                .map(|start| start.z)
                .filter(is_there)
                .unwrap_or_else(|| lowest.midpoint(highest)),
        };
        let through = match (reach, start) {
            (Some(_), _) => Point2::origin(),
            (None, Some(start)) => start.xy(),
            (None, None) => extent.center().xy(),
        };
        Ok(Self {
            space,
            turns_tool,
            extent,
            reach,
            start,
            vertical: Cut::Vertical { through, azimuth: view.azimuth },
            horizontal: Cut::Horizontal { height },
            shown: extent.union(&reachable),
        })
    }

    /// The horizontal section.
    pub fn horizontal(&self) -> Section<'m> {
        self.section(self.horizontal)
    }

    /// The vertical section.
    ///
    /// # Errors
    /// [`WorkspaceError::Flat`].
    pub fn vertical(&self) -> Result<Section<'m>, WorkspaceError> {
        if self.extent.sides().z <= FLAT {
            return Err(WorkspaceError::Flat);
        }
        Ok(self.section(self.vertical))
    }

    fn section(&self, cut: Cut) -> Section<'m> {
        let plane = Plane::new(&cut);
        let [low, high] = plane.project_extent(&self.shown);
        // The machine and what is around it, too, but not so much of them that the workspace gets small.
        let room = Vector2::repeat((high - low).max() * MACHINE);
        let machine = self.space.machine();
        let mut outlines = silhouette(&machine.model, &self.stance(), &plane);
        let around = machine.collision.iter().flat_map(|around| surroundings(around, &plane));
        outlines.extend(around.map(|(_, _, outline)| outline));
        let rectangle = outlines.iter().flatten().fold([low, high], |[min, max], point| {
            let point = point.sup(&(low - room)).inf(&(high + room));
            [min.inf(&point), max.sup(&point)]
        });
        Section::new(self.space, cut, rectangle)
    }

    /// Axis positions in which the machine is shown: where programs start, or the middle.
    pub fn stance(&self) -> AxisVector {
        let machine = self.space.machine();
        machine.start_axes().unwrap_or_else(|| machine.middle())
    }

    /// A pose in the middle of a section, worked out, at round coordinates where possible.
    ///
    /// # Errors
    /// [`KinematicsError::Singular`] and its neighbours if the section has no such pose.
    pub fn example(&self, section: &Section<'m>) -> Option<Result<Example, KinematicsError>> {
        let middle = section.middle()?;
        let rounded =
            ROUND.into_iter().map(|unit| middle.map(|value| (value / unit).round() * unit));
        let is_inside =
            |at: &Point2<f64>| section.sample(at).is_within() && section.within.distance(at) > 0.0;
        let at = rounded.into_iter().find(is_inside).unwrap_or(middle);
        Some(Example::new(&self.space, section.plane.point(&at), self.turns_tool))
    }
}

/// Reach of the arms, from the error of the transform at an unreachable place.
fn reach(space: &Space<'_>, extent: &Extent) -> Option<Reach> {
    let far = space.pose(Point3::new(FAR, FAR, extent.center().z));
    match space.machine().kinematics.inverse(&far, &space.machine().middle()) {
        Err(KinematicsError::Unreachable {
            of: of @ (ReachOf::Arms | ReachOf::Wrist),
            reach,
            ..
        }) => Some(Reach { of, distances: reach }),
        _ => None,
    }
}
