//! A plane through the workspace, and what the machine can do on it.

use super::extent::Extent;
use super::grid::Grid;
use super::region::{self, Region};
use super::space::{Sample, Space, State};
use nalgebra::{Point2, Point3, Vector2, Vector3};
use std::fmt;
use twin_plot::short;

/// Cells along the longer side of a section.
const CELLS: u32 = 200;
/// Room around what is shown, as a part of its longer side.
const ROOM: f64 = 0.06;
/// Smallest side of a section, as a part of the longer one.
const NARROWEST: f64 = 0.1;
/// Smallest step of the search for the best place, relative to a cell.
const FINEST: f64 = 1e-7;

/// Orientation of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cut {
    /// Level, at this height of the tool tip above the origin of the machine frame, m.
    Horizontal {
        /// m.
        height: f64,
    },
    /// Upright through a point, in this direction from it.
    Vertical {
        /// In the plane; m, machine frame.
        through: Point2<f64>,
        /// rad, from +x, counter-clockwise seen from above.
        azimuth: f64,
    },
}

impl fmt::Display for Cut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Horizontal { height } => {
                write!(f, "horizontal section at z {} mm", short(height * 1e3))
            }
            Self::Vertical { through, azimuth } => write!(
                f,
                "vertical section through x {}, y {} mm at {}°",
                short(through.x * 1e3),
                short(through.y * 1e3),
                short(azimuth.to_degrees())
            ),
        }
    }
}

/// A plane with coordinates of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    origin: Point3<f64>,
    /// Unit vectors along the plane's two coordinates.
    directions: [Vector3<f64>; 2],
}

impl Plane {
    /// Plane of a section: x and y if level; distance along the ground and z if upright.
    pub fn new(cut: &Cut) -> Self {
        match *cut {
            Cut::Horizontal { height } => Self {
                origin: Point3::new(0.0, 0.0, height),
                directions: [Vector3::x(), Vector3::y()],
            },
            Cut::Vertical { through, azimuth } => {
                let (sin, cos) = azimuth.sin_cos();
                Self {
                    origin: Point3::new(through.x, through.y, 0.0),
                    directions: [Vector3::new(cos, sin, 0.0), Vector3::z()],
                }
            }
        }
    }

    /// A point of the plane in the machine frame, m.
    pub fn point(&self, at: &Point2<f64>) -> Point3<f64> {
        let [first, second] = &self.directions;
        self.origin + first * at.x + second * at.y
    }

    /// Where a point is seen on the plane, looking along its normal.
    pub fn project(&self, point: &Point3<f64>) -> Point2<f64> {
        let from = point - self.origin;
        Point2::from(self.directions.map(|direction| direction.dot(&from)))
    }

    /// The rectangle in which a box is seen on the plane.
    pub fn project_extent(&self, extent: &Extent) -> [Point2<f64>; 2] {
        let Extent { min, max } = extent;
        let corners = [[min, min], [min, max], [max, min], [max, max]];
        let corners = corners.into_iter().flat_map(|[one, other]| {
            [min.z, max.z].map(|z| self.project(&Point3::new(one.x, other.y, z)))
        });
        let none = Point2::new(f64::INFINITY, f64::INFINITY);
        corners.fold([none, -none], |[low, high], corner| [low.inf(&corner), high.sup(&corner)])
    }
}

/// A value of the singularity measure, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureAt {
    /// 0 to 1.
    pub measure: f64,
    /// m, machine frame.
    pub position: Point3<f64>,
}

/// A section through the workspace.
#[derive(Clone, Debug)]
pub struct Section<'m> {
    /// Space that was sampled.
    pub space: Space<'m>,
    /// Its orientation.
    pub cut: Cut,
    /// Its coordinates.
    pub plane: Plane,
    /// Sampling grid.
    pub grid: Grid,
    /// Samples, in the order of the grid's nodes.
    pub samples: Vec<Sample>,
    /// Where the tool can be within the software limits.
    pub within: Region,
    /// The place there at which the axes move the tool best; `None` if the tool cannot be here at all.
    pub best: Option<MeasureAt>,
    /// The place there at which they move it worst, boundary included.
    pub worst: Option<MeasureAt>,
}

impl<'m> Section<'m> {
    /// A section that shows `rectangle` (m, in the plane) with room around it.
    pub fn new(space: Space<'m>, cut: Cut, [min, max]: [Point2<f64>; 2]) -> Self {
        let plane = Plane::new(&cut);
        let sides = max - min;
        let longer = sides.max().max(1e-3);
        let room = sides.map(|side| ROOM * longer + ((NARROWEST * longer - side) / 2.0).max(0.0));
        let grid = Grid::over(min - room, max + room, CELLS);
        let samples: Vec<_> = grid
            .nodes()
            .map(|(column, row)| space.sample(plane.point(&grid.node(column, row))))
            .collect();
        let within = Region::default();
        let mut section =
            Self { space, cut, plane, grid, samples, within, best: None, worst: None };
        section.within = section.region_by_state(&|state| state == State::Within);
        section.best = section.find_best();
        section.worst = section.find_worst();
        section
    }

    /// What was found at a point of the plane.
    pub fn sample(&self, at: &Point2<f64>) -> Sample {
        self.space.sample(self.plane.point(at))
    }

    /// The part of the section of which `holds` is true.
    pub fn region(&self, holds: &dyn Fn(&Sample) -> bool) -> Region {
        let nodes: Vec<_> = self.samples.iter().map(holds).collect();
        Region::trace(&self.grid, &nodes, region::COARSE, &|at| holds(&self.sample(at)))
    }

    /// [`Self::region`] where the measure does not count.
    pub fn region_by_state(&self, holds: &dyn Fn(State) -> bool) -> Region {
        let nodes: Vec<_> = self.samples.iter().map(|sample| holds(sample.state)).collect();
        let state = |at: &Point2<f64>| self.space.state(self.plane.point(at));
        Region::trace(&self.grid, &nodes, region::EXACT, &|at| holds(state(at)))
    }

    fn find_best(&self) -> Option<MeasureAt> {
        let (mut at, mut measure) = self.nodes_within().fold(None, higher)?;
        let mut step = self.grid.cell / 2.0;
        while step > self.grid.cell * FINEST {
            let ways = [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step)];
            let neighbours = ways.into_iter().filter_map(|(x, y)| {
                let at = at + Vector2::new(x, y);
                let sample = self.sample(&at);
                sample.is_within().then_some((at, sample.measure))
            });
            match neighbours.fold(None, higher).filter(|(_, found)| *found > measure) {
                Some(better) => (at, measure) = better,
                None => step /= 2.0,
            }
        }
        Some(MeasureAt { measure, position: self.plane.point(&at) })
    }

    fn find_worst(&self) -> Option<MeasureAt> {
        let boundary =
            self.within.vertices().map(|vertex| (vertex.at, self.sample(&vertex.at).measure));
        let lower = |worst: Option<(Point2<f64>, f64)>, (at, measure)| match worst {
            Some((_, least)) if least <= measure => worst,
            _ => Some((at, measure)),
        };
        let (at, measure) = boundary.chain(self.nodes_within()).fold(None, lower)?;
        Some(MeasureAt { measure, position: self.plane.point(&at) })
    }

    fn nodes_within(&self) -> impl Iterator<Item = (Point2<f64>, f64)> {
        let nodes = self.grid.nodes().map(|(column, row)| self.grid.node(column, row));
        let nodes = nodes.zip(&self.samples).filter(|(_, sample)| sample.is_within());
        nodes.map(|(at, sample)| (at, sample.measure))
    }

    /// A point well inside: of the points farthest from the boundary, the one nearest to the centroid.
    pub fn middle(&self) -> Option<Point2<f64>> {
        const EVERY: u32 = 8;
        let nodes = self.grid.nodes().zip(&self.samples);
        let candidates: Vec<_> = nodes
            .filter(|((column, row), sample)| {
                column.is_multiple_of(EVERY) && row.is_multiple_of(EVERY) && sample.is_within()
            })
            .map(|((column, row), _)| self.grid.node(column, row))
            .map(|at| (at, self.within.distance(&at)))
            .collect();
        let deepest = candidates.iter().map(|(_, depth)| *depth).fold(0.0, f64::max);
        let centroid = self.within.centroid()?;
        let is_deep = |at: &Point2<f64>| {
            self.sample(at).is_within() && self.within.distance(at) >= 0.9 * deepest
        };
        if is_deep(&centroid) {
            return Some(centroid);
        }
        let aside = |(at, _): &&(Point2<f64>, f64)| (at - centroid).norm();
        let deep = candidates.iter().filter(|(_, depth)| *depth >= 0.9 * deepest);
        let found = deep.min_by(|one, other| aside(one).total_cmp(&aside(other)));
        found.map(|(at, _)| *at).or_else(|| self.nodes_within().next().map(|(at, _)| at))
    }
}

fn higher(
    best: Option<(Point2<f64>, f64)>,
    (at, measure): (Point2<f64>, f64),
) -> Option<(Point2<f64>, f64)> {
    match best {
        Some((_, most)) if most >= measure => best,
        _ => Some((at, measure)),
    }
}
