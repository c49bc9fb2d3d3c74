//! Order of links and joints: parents before children, as a model has them.

use super::document::{At, Places};
use crate::{Part, UrdfError};
use std::collections::{HashMap, HashSet};

/// The joints of a robot, parents before children, otherwise as in the file. All are named by their places in the file.
pub(super) struct Tree {
    pub(super) base: usize,
    /// Joint, parent link, child link.
    pub(super) joints: Vec<(usize, usize, usize)>,
}

impl Tree {
    pub(super) fn new(robot: &urdf_rs::Robot, places: &Places) -> At<Self> {
        let mut links = HashMap::new();
        for (index, link) in robot.links.iter().enumerate() {
            let refuse = |error| Err((places.link(index), error));
            if link.name.is_empty() {
                return refuse(UrdfError::NoName);
            }
            if links.insert(link.name.as_str(), index).is_some() {
                return refuse(UrdfError::Twice(Part::Link(link.name.clone())));
            }
        }
        let mut names = HashSet::new();
        let mut parent_joint: HashMap<usize, &str> = HashMap::new();
        let mut waiting = Vec::with_capacity(robot.joints.len());
        for (index, joint) in robot.joints.iter().enumerate() {
            let refuse = |error| Err((places.joint(index), error));
            if joint.name.is_empty() {
                return refuse(UrdfError::NoName);
            }
            if !names.insert(joint.name.as_str()) {
                return refuse(UrdfError::Twice(Part::Joint(joint.name.clone())));
            }
            let end = |name: &String| links.get(name.as_str()).copied();
            let missing =
                |link: &String| UrdfError::NoLink { joint: joint.name.clone(), link: link.clone() };
            let (parent, child) = (&joint.parent.link, &joint.child.link);
            let Some(from) = end(parent) else { return refuse(missing(parent)) };
            let Some(to) = end(child) else { return refuse(missing(child)) };
            if let Some(other) = parent_joint.insert(to, &joint.name) {
                let joints = [other.to_owned(), joint.name.clone()];
                return refuse(UrdfError::TwoParents { link: child.clone(), joints });
            }
            waiting.push((index, from, to));
        }
        let mut bases = (0..robot.links.len()).filter(|link| !parent_joint.contains_key(link));
        let base = bases.next().ok_or((places.robot, UrdfError::NoBase))?;
        if let Some(other) = bases.next() {
            let name = |link: usize| {
                robot.links.get(link).map(|link| link.name.clone()).unwrap_or_default()
            };
            let error = UrdfError::TwoBases([name(base), name(other)]);
            return Err((places.link(other), error));
        }

        let mut joints = Vec::with_capacity(waiting.len());
        let mut placed = HashSet::from([base]);
        while !waiting.is_empty() {
            let before = waiting.len();
            waiting.retain(|&(joint, parent, child)| {
                let hangs = placed.contains(&parent);
                if hangs {
                    placed.insert(child);
                    joints.push((joint, parent, child));
                }
                !hangs
            });
            if let Some((joint, ..)) = waiting.first()
                && waiting.len() == before
            {
                let name = robot.joints.get(*joint).map(|joint| joint.name.clone());
                let error = UrdfError::Loop(name.unwrap_or_default());
                return Err((places.joint(*joint), error));
            }
        }
        Ok(Self { base, joints })
    }
}
