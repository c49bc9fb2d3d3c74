//! Surroundings of a machine: obstacles, and parts that may touch each other.

use nalgebra::{Isometry3, Vector3};
use twin_urdf::{Model, Solid, SolidShape};

/// A part that can touch another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Part {
    /// A link, by its place in [`Model::links`], without the tool.
    Link(usize),
    /// The solid of the last link on which the tool tip lies.
    Tool,
    /// By its place in [`Surroundings::obstacles`].
    Obstacle(usize),
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
}

impl Default for Surroundings {
    fn default() -> Self {
        Self {
            obstacles: Vec::new(),
            among_links: true,
            has_tool: true,
            left_out: Vec::new(),
            stiffness: Self::STIFFNESS,
        }
    }
}

impl Surroundings {
    /// Default contact stiffness, N/m: steel on steel where a tool holder meets a vice, some square millimetres.
    pub const STIFFNESS: f64 = 1e8;

    /// A floor whose top is at z = `top` (m, machine frame), 10 m square.
    pub fn floor(top: f64) -> Self {
        let size = Vector3::new(10.0, 10.0, 1.0);
        let floor = Solid {
            shape: SolidShape::Box { size },
            origin: Isometry3::translation(0.0, 0.0, top - 0.5 * size.z),
            color: [0.5, 0.5, 0.5, 1.0],
        };
        let floor =
            Obstacle { name: "floor".into(), kind: ObstacleKind::Fixture, solids: vec![floor] };
        Self { obstacles: vec![floor], ..Self::default() }
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
            Part::Link(_) | Part::Tool => false,
        };
        let cuts = |tool, work| tool == Part::Tool && stock(work);
        cuts(one, other) || cuts(other, one) || self.names(pair)
    }
}
