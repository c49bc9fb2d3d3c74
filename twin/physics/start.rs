//! Loose bodies where the machine starts: none may be in another part.

use nalgebra::{Isometry3, Point3, Vector3};
use twin_kinematics::AxisVector;
use twin_urdf::{Model, Solid};

use crate::checked;
use crate::distances::Distances;
use crate::equation::Equation;
use crate::error::{PhysicsError, Result};
use crate::joint::JointVector;
use crate::maths;
use crate::pairs::Pairs;
use crate::posed::Posed;
use crate::solids;
use crate::surroundings::{Body, Obstacle, ObstacleKind, Part, Surface, Surroundings};
use crate::world::TOUCHING;

/// Checks that with the axes at `start` (m or rad) no loose body of `surroundings` is in another body, in an obstacle or
/// in a part of the machine. Bodies may touch, and be in what they are excluded from.
///
/// # Errors
/// [`PhysicsError::Overlap`] with the deepest, and those of [`crate::ClearanceScan::new`].
pub fn check_bodies(model: &Model, surroundings: &Surroundings, start: &AxisVector) -> Result<()> {
    if surroundings.bodies.is_empty() {
        return Ok(());
    }
    let equation = Equation::new(model, start.len(), Vector3::zeros(), JointVector::zeros())?;
    let position = checked(start, start.len(), 0)?;
    let mut poses = vec![Isometry3::identity(); model.links.len()];
    Posed::of(model, &equation).poses(model, &position, &mut poses)?;

    let first = surroundings.obstacles.len();
    let mut around = Surroundings { bodies: Vec::new(), ..surroundings.clone() };
    around.obstacles.extend(surroundings.bodies.iter().map(standing));
    let part = |part| match part {
        Part::Obstacle(index) if index >= first => Part::Body(index - first),
        part => part,
    };
    let pairs = Pairs::new(model, &around, solids::tool(model, &around).is_some());
    let wanted = |numbers: [usize; 2]| {
        let [Some(one), Some(other)] = numbers.map(|number| pairs.part(number).map(part)) else {
            return false;
        };
        let is_body = |part| matches!(part, Part::Body(_));
        (is_body(one) || is_body(other)) && !surroundings.names([one, other])
    };
    let distances = Distances::new(model, &around, &pairs, wanted);
    let mut distances = distances.map_err(|error| match error {
        PhysicsError::FlatMesh { part: flat, solid } => {
            PhysicsError::FlatMesh { part: part(flat), solid }
        }
        error => error,
    })?;
    let deepest = distances.nearest(&poses);
    match deepest.filter(|deepest| deepest.distance < -TOUCHING) {
        Some(deepest) => {
            Err(PhysicsError::Overlap { parts: deepest.parts.map(part), depth: -deepest.distance })
        }
        None => Ok(()),
    }
}

/// Distance of `point` (machine frame) from the nearest of `bodies`, which are at `poses`, m; `None` without one.
pub fn distance_to_bodies(
    bodies: &[Body],
    poses: &[Isometry3<f64>],
    point: &Point3<f64>,
) -> Option<f64> {
    let bodies = bodies.iter().zip(poses);
    let distances = bodies.flat_map(|(body, pose)| {
        body.solids.iter().filter_map(move |solid| {
            let solids::Placed { shape, pose: within } = solids::placed(solid)?;
            let pose = maths::pose_to_rapier(&(pose * within));
            let point = maths::point_to_rapier(point);
            Some((shape.project_point(&pose, point, true).point - point).length())
        })
    });
    distances.reduce(f64::min)
}

/// A body as an obstacle at its start.
fn standing(body: &Body) -> Obstacle {
    let placed = |solid: &Solid| Solid { origin: body.pose * solid.origin, ..solid.clone() };
    Obstacle {
        name: body.name.clone(),
        kind: ObstacleKind::Fixture,
        solids: body.solids.iter().map(placed).collect(),
        surface: Surface::default(),
    }
}
