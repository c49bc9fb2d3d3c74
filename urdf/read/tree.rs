//! Order of links and joints: parents before children, as a model has them.

use super::document::{At, Element};
use crate::{Part, UrdfError};
use std::collections::{HashMap, HashSet};

/// A joint of the text with the names of its links.
pub(super) struct TreeJoint<'a> {
    pub(super) joint: Element<'a>,
    pub(super) parent: &'a str,
    pub(super) child: Element<'a>,
}

/// The joints of a robot, parents before children, otherwise as in the file.
pub(super) struct Tree<'a> {
    pub(super) base: Element<'a>,
    pub(super) joints: Vec<TreeJoint<'a>>,
}

/// The link that a joint names in its element `end`.
fn end<'a>(joint: Element<'a>, end: &str) -> &'a str {
    joint.child(end).and_then(|end| end.text("link")).unwrap_or_default()
}

impl<'a> Tree<'a> {
    pub(super) fn new(robot: Element<'a>) -> At<Self> {
        let mut links = HashMap::new();
        for link in robot.children("link") {
            let name = link.name();
            if name.is_empty() {
                return Err((link.line(), UrdfError::NoName));
            }
            if links.insert(name, link).is_some() {
                return Err((link.line(), UrdfError::Twice(Part::Link(name.to_owned()))));
            }
        }
        let mut names = HashSet::new();
        let mut parent_joint: HashMap<&str, &str> = HashMap::new();
        let mut waiting = Vec::new();
        for joint in robot.children("joint") {
            let refuse = |error| Err((joint.line(), error));
            let name = joint.name();
            if name.is_empty() {
                return refuse(UrdfError::NoName);
            }
            if !names.insert(name) {
                return refuse(UrdfError::Twice(Part::Joint(name.to_owned())));
            }
            let [parent, child] = ["parent", "child"].map(|side| end(joint, side));
            let missing =
                |link: &str| UrdfError::NoLink { joint: name.to_owned(), link: link.to_owned() };
            if !links.contains_key(parent) {
                return refuse(missing(parent));
            }
            let Some(to) = links.get(child) else { return refuse(missing(child)) };
            if let Some(other) = parent_joint.insert(child, name) {
                let joints = [other, name].map(str::to_owned);
                return refuse(UrdfError::TwoParents { link: child.to_owned(), joints });
            }
            waiting.push(TreeJoint { joint, parent, child: *to });
        }
        let hangs = |link: &Element<'_>| parent_joint.contains_key(link.name());
        let mut bases = robot.children("link").filter(|link| !hangs(link));
        let base = bases.next().ok_or((robot.line(), UrdfError::NoBase))?;
        if let Some(other) = bases.next() {
            let names = [base, other].map(|link| link.name().to_owned());
            return Err((other.line(), UrdfError::TwoBases(names)));
        }

        let mut joints = Vec::with_capacity(waiting.len());
        let mut placed = HashSet::from([base.name()]);
        while !waiting.is_empty() {
            let before = waiting.len();
            let mut left = Vec::new();
            for joint in waiting {
                if placed.contains(joint.parent) {
                    placed.insert(joint.child.name());
                    joints.push(joint);
                } else {
                    left.push(joint);
                }
            }
            waiting = left;
            if let Some(TreeJoint { joint, .. }) = waiting.first()
                && waiting.len() == before
            {
                return Err((joint.line(), UrdfError::Loop(joint.name().to_owned())));
            }
        }
        Ok(Self { base, joints })
    }
}
