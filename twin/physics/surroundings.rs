//! Surroundings of a machine: obstacles, loose bodies, grippers, and parts that may touch each other.

use nalgebra::{Isometry3, Point3, Unit, Vector3};
use twin_urdf::{Inertial, Model, Solid, SolidShape};

/// A part that can touch another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Part {
    /// A link, by its place in [`Model::links`], without the tool.
    Link(usize),
    /// The solid of the last link on which the tool tip lies.
    Tool,
    /// By its place in [`Surroundings::obstacles`].
    Obstacle(usize),
    /// By its place in [`Surroundings::bodies`].
    Body(usize),
}

impl Part {
    /// Its name.
    pub fn name<'a>(self, model: &'a Model, surroundings: &'a Surroundings) -> &'a str {
        let link = |index: usize| model.links.get(index).map(|link| link.name.as_str());
        let obstacle = |index: usize| surroundings.obstacles.get(index);
        match self {
            Self::Link(index) => link(index).unwrap_or("link"),
            Self::Tool => "tool",
            Self::Obstacle(index) => obstacle(index).map_or("obstacle", |one| one.name.as_str()),
            Self::Body(index) => {
                surroundings.bodies.get(index).map_or("body", |one| one.name.as_str())
            }
        }
    }
}

/// An obstacle that does not move.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Its name in messages.
    pub name: String,
    /// Its kind: fixture or stock.
    pub kind: ObstacleKind,
    /// Its solids, machine frame.
    pub solids: Vec<Solid>,
    /// Its surface.
    pub surface: Surface,
}

/// Surface of an obstacle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// Its material.
    pub material: Material,
    /// Velocity of a conveyor belt, machine frame, m/s.
    pub velocity: Vector3<f64>,
}

/// Number of a material; those that are not named have number 0.
pub type Material = usize;

/// A part that nothing but contact, a clamp or a gripper moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Its name in messages.
    pub name: String,
    /// Its solids, in its frame.
    pub solids: Vec<Solid>,
    /// Mass distribution, in its frame.
    pub inertial: Inertial,
    /// Pose at the start, machine frame.
    pub pose: Isometry3<f64>,
    /// Its material.
    pub material: Material,
    /// Part of the approach speed with which it bounces, 0 to 1.
    pub restitution: f64,
    /// Force at which the clamp that holds it gives way, N; `None` without a clamp.
    pub clamp: Option<f64>,
}

/// A gripper: it holds the body nearest to it when it closes, until a load is too large.
#[derive(Clone, Debug, PartialEq)]
pub struct Gripper {
    /// Its name in messages.
    pub name: String,
    /// The link that carries it, by its place in [`Model::links`].
    pub link: usize,
    /// Where it holds, in the frame of the link, m.
    pub point: Point3<f64>,
    /// From the gripper to what it holds, in the frame of the link. What it pushes in this direction it need not
    /// hold.
    pub direction: Unit<Vector3<f64>>,
    /// Largest distance of a body from that point, m.
    pub reach: f64,
    /// Largest force, N.
    pub force: f64,
    /// Largest moment about its point, Nm.
    pub moment: f64,
}

/// Kind of an obstacle for the tool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ObstacleKind {
    /// A fixture, a table, a wall: nothing may touch it.
    #[default]
    Fixture,
    /// The workpiece: the tool cuts it, and nothing else may touch it. Cutting takes no force here.
    Stock,
}

/// Parts without contact force against the tool, such as those that a touch probe has touched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum YieldingTool {
    /// Nothing.
    #[default]
    Never,
    /// Everything.
    Always,
    /// One part alone.
    To(Part),
}

impl YieldingTool {
    /// True if the contact of the two is without force.
    pub(super) fn gives_way(self, parts: [Option<Part>; 2]) -> bool {
        if !parts.contains(&Some(Part::Tool)) {
            return false;
        }
        match self {
            Self::Never => false,
            Self::Always => true,
            Self::To(part) => parts.contains(&Some(part)),
        }
    }
}

/// Obstacles around a machine, and the pairs that are checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Surroundings {
    /// Obstacles.
    pub obstacles: Vec<Obstacle>,
    /// True if links are checked against each other. Links that a joint joins never are.
    pub among_links: bool,
    /// True if the solid of the last link at the tip is a tool; otherwise it is part of that link.
    pub has_tool: bool,
    /// Excluded pairs.
    pub left_out: Vec<[Part; 2]>,
    /// Force per depth at each point of contact, N/m.
    pub stiffness: f64,
    /// Loose bodies.
    pub bodies: Vec<Body>,
    /// Grippers of the machine.
    pub grippers: Vec<Gripper>,
    /// Friction coefficients of pairs of materials.
    pub frictions: Vec<([Material; 2], f64)>,
    /// Material of links and tool.
    pub machine_material: Material,
}

impl Default for Surroundings {
    fn default() -> Self {
        Self {
            obstacles: Vec::new(),
            among_links: true,
            has_tool: true,
            left_out: Vec::new(),
            stiffness: Self::STIFFNESS,
            bodies: Vec::new(),
            grippers: Vec::new(),
            frictions: Vec::new(),
            machine_material: 0,
        }
    }
}

impl Surroundings {
    /// Default contact stiffness, N/m: steel on steel where a tool holder meets a vice, some square millimetres.
    pub const STIFFNESS: f64 = 1e8;

    /// Friction coefficient of loose bodies whose pair of materials has none of its own.
    pub const FRICTION: f64 = 0.3;

    /// A floor whose top is at z = `top` (m, machine frame), 10 m square.
    pub fn floor(top: f64) -> Self {
        let size = Vector3::new(10.0, 10.0, 1.0);
        let floor = Solid {
            shape: SolidShape::Box { size },
            origin: Isometry3::translation(0.0, 0.0, top - 0.5 * size.z),
            color: [0.5, 0.5, 0.5, 1.0],
        };
        let floor = Obstacle {
            name: "floor".into(),
            kind: ObstacleKind::Fixture,
            solids: vec![floor],
            surface: Surface::default(),
        };
        Self { obstacles: vec![floor], ..Self::default() }
    }

    /// Coefficient of friction between two parts. Between the machine and what is fixed there is none, unless the pair
    /// of their materials has one.
    pub(super) fn friction(&self, parts: [Part; 2]) -> f64 {
        let [one, other] = parts.map(|part| self.surface(part).material);
        let pair =
            self.frictions.iter().find(|(pair, _)| *pair == [one, other] || *pair == [other, one]);
        let loose = parts.iter().any(|part| matches!(part, Part::Body(_)));
        pair.map_or(if loose { Self::FRICTION } else { 0.0 }, |(_, coefficient)| *coefficient)
    }

    pub(super) fn surface(&self, part: Part) -> Surface {
        let of = |material| Surface { material, velocity: Vector3::zeros() };
        match part {
            Part::Link(_) | Part::Tool => of(self.machine_material),
            Part::Obstacle(index) => {
                self.obstacles.get(index).map_or_else(Surface::default, |one| one.surface)
            }
            Part::Body(index) => of(self.bodies.get(index).map_or(0, |body| body.material)),
        }
    }

    /// True if the file excludes this pair.
    pub(super) fn names(&self, [one, other]: [Part; 2]) -> bool {
        self.left_out.iter().any(|left| *left == [one, other] || *left == [other, one])
    }

    /// True if this pair is excluded, apart from pairs that joints exclude.
    pub(super) fn leaves_out(&self, pair: [Part; 2]) -> bool {
        let [one, other] = pair;
        let stock = |part| match part {
            Part::Obstacle(index) => {
                self.obstacles.get(index).is_some_and(|it| it.kind == ObstacleKind::Stock)
            }
            Part::Link(_) | Part::Tool | Part::Body(_) => false,
        };
        let cuts = |tool, work| tool == Part::Tool && stock(work);
        cuts(one, other) || cuts(other, one) || self.names(pair)
    }
}
