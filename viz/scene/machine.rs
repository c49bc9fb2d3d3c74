//! Machine and obstacles in the recording: solids once, link poses as the machine moves.

use nalgebra::Isometry3;
use twin_urdf::Model;

use super::solids;
use crate::bounds::Bounds;
use crate::error::Result;
use crate::frame::Obstacle;
use crate::recorder::Recorder;
use crate::units;

/// The links of the machine in the recording.
#[derive(Debug)]
pub(crate) struct Machine {
    links: Vec<Link>,
}

#[derive(Debug)]
struct Link {
    entity: String,
    /// As logged last.
    pose: Option<Isometry3<f64>>,
}

impl Machine {
    /// Logs the solids of every link below an entity of its own, and takes them into the bounds at their home poses.
    pub(crate) fn log_solids(
        stream: &mut Recorder,
        model: &Model,
        home: &[Isometry3<f64>],
        bounds: &mut Bounds,
    ) -> Result<Self> {
        let mut links = Vec::with_capacity(model.links.len());
        for (link, pose) in model.links.iter().zip(home) {
            link.solids.iter().for_each(|solid| bounds.add_solid(pose, solid));
            let entity = entity("machine", &link.name);
            solids::log(stream, &entity, &link.solids)?;
            links.push(Link { entity, pose: None });
        }
        Ok(Self { links })
    }

    /// Number of links.
    pub(crate) fn link_count(&self) -> usize {
        self.links.len()
    }

    /// Logs where the links are that have moved, at the stream's time.
    pub(crate) fn log_poses(
        &mut self,
        stream: &mut Recorder,
        poses: &[Isometry3<f64>],
    ) -> Result<()> {
        for (link, pose) in self.links.iter_mut().zip(poses) {
            if link.pose.as_ref() != Some(pose) {
                link.pose = Some(*pose);
                let transform = rerun::Transform3D::update_fields()
                    .with_translation(units::vector_mm(&pose.translation.vector))
                    .with_quaternion(units::quaternion(pose));
                stream.log(link.entity.as_str(), &transform)?;
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
