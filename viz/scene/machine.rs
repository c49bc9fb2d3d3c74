//! Machine, obstacles and loose bodies in the recording: solids once, poses of what moves as it moves.

use nalgebra::Isometry3;
use twin_urdf::{Model, Solid};

use super::solids;
use crate::bounds::Bounds;
use crate::error::Result;
use crate::frame::{Body, Obstacle};
use crate::recorder::Recorder;
use crate::units;

/// Moving parts in the recording: the links of the machine, or loose bodies.
#[derive(Debug)]
pub(crate) struct Moving {
    parts: Vec<Part>,
}

#[derive(Debug)]
struct Part {
    entity: String,
    /// As logged last.
    pose: Option<Isometry3<f64>>,
}

impl Moving {
    /// Logs the solids of every link of `model` below an entity of its own, and adds them to the bounds at their home
    /// poses.
    pub(crate) fn links(
        stream: &mut Recorder,
        model: &Model,
        home: &[Isometry3<f64>],
        bounds: &mut Bounds,
    ) -> Result<Self> {
        let links = model.links.iter().zip(home);
        let links = links.map(|(link, pose)| (link.name.as_str(), link.solids.as_slice(), *pose));
        Self::log(stream, "machine", links, bounds)
    }

    /// The same of loose bodies.
    pub(crate) fn bodies(
        stream: &mut Recorder,
        bodies: &[Body<'_>],
        bounds: &mut Bounds,
    ) -> Result<Self> {
        let bodies = bodies.iter().map(|body| (body.name, body.solids, body.pose));
        Self::log(stream, "bodies", bodies, bounds)
    }

    fn log<'a>(
        stream: &mut Recorder,
        folder: &str,
        all: impl Iterator<Item = (&'a str, &'a [Solid], Isometry3<f64>)>,
        bounds: &mut Bounds,
    ) -> Result<Self> {
        let mut parts = Vec::new();
        for (name, solids, pose) in all {
            for solid in solids {
                bounds.add_solid(&pose, solid);
            }
            let entity = entity(folder, name);
            solids::log(stream, &entity, solids)?;
            parts.push(Part { entity, pose: None });
        }
        Ok(Self { parts })
    }

    /// Number of parts.
    pub(crate) fn count(&self) -> usize {
        self.parts.len()
    }

    /// Logs where the parts are that have moved, at the stream's time.
    pub(crate) fn log_poses(
        &mut self,
        stream: &mut Recorder,
        poses: &[Isometry3<f64>],
    ) -> Result<()> {
        for (part, pose) in self.parts.iter_mut().zip(poses) {
            if part.pose.as_ref() != Some(pose) {
                part.pose = Some(*pose);
                let transform = rerun::Transform3D::update_fields()
                    .with_translation(units::vector_mm(&pose.translation.vector))
                    .with_quaternion(units::quaternion(pose));
                stream.log(part.entity.as_str(), &transform)?;
            }
        }
        Ok(())
    }
}

/// Logs the obstacles, each below an entity of its own, and adds them to the bounds.
pub(crate) fn log_obstacles(
    stream: &mut Recorder,
    obstacles: &[Obstacle<'_>],
    bounds: &mut Bounds,
) -> Result<()> {
    for obstacle in obstacles {
        obstacle.solids.iter().for_each(|solid| bounds.add_solid(&Isometry3::identity(), solid));
        solids::log(stream, &entity("surroundings", obstacle.name), obstacle.solids)?;
    }
    Ok(())
}

/// Entity path of `name`, which may have any characters.
fn entity(folder: &str, name: &str) -> String {
    format!("{folder}{}", rerun::EntityPath::from_single_string(name.to_owned()))
}
