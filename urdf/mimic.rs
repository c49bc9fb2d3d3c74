//! Mimic joints: the joint that each finally follows, with multiplier and offset.

use crate::{JointDrive, Model};

/// A joint whose position is `multiplier` times that of the joint `leader`, which mimics none, and `offset` more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Following {
    /// Index into [`Model::joints`]; the joint itself, if it mimics none.
    pub leader: usize,
    /// m or rad per m or rad of the leader.
    pub multiplier: f64,
    /// m or rad.
    pub offset: f64,
}

impl Following {
    /// The position with the leader at `position`.
    pub(crate) fn position(&self, position: f64) -> f64 {
        self.multiplier * position + self.offset
    }
}

impl Model {
    /// The joint that `index` finally follows, through chains of mimic joints. `None` if there is no such joint, or if
    /// they go round in a circle.
    pub fn following(&self, index: usize) -> Option<Following> {
        let mut found = Following { leader: index, multiplier: 1.0, offset: 0.0 };
        for _ in 0..=self.joints.len() {
            let JointDrive::Mimic { joint, multiplier, offset } =
                self.joints.get(found.leader)?.drive
            else {
                return Some(found);
            };
            found.offset += found.multiplier * offset;
            found.multiplier *= multiplier;
            found.leader = joint;
        }
        None
    }
}
