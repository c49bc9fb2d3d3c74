//! Loose bodies in the report.

use crate::plant::BodyRecord;
use twin_machine::Machine;
use twin_number::rounded;

/// A loose body at the end of the program.
#[derive(Clone, Debug, serde::Serialize)]
pub struct BodyReport {
    name: String,
    pose: PoseReport,
    /// The gripper that holds it.
    held_by: Option<String>,
}

/// A pose in the machine frame.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct PoseReport {
    position_mm: [f64; 3],
    /// Roll, pitch, yaw.
    rotation_deg: [f64; 3],
}

impl BodyReport {
    /// All bodies of `machine`.
    pub(super) fn all(machine: &Machine, bodies: &[BodyRecord]) -> Vec<Self> {
        let surroundings = machine.collision.iter().map(|collision| &collision.surroundings);
        let known =
            surroundings.flat_map(|around| around.bodies.iter().map(move |one| (around, one)));
        let reports = known.zip(bodies).map(|((around, body), record)| {
            let position = record.pose.translation.vector;
            let (roll, pitch, yaw) = record.pose.rotation.euler_angles();
            let gripper = record.held_by.and_then(|gripper| around.grippers.get(gripper));
            // Zero is not below zero.
            let value = |value: f64| rounded(value) + 0.0;
            Self {
                name: body.name.clone(),
                pose: PoseReport {
                    position_mm: [position.x, position.y, position.z].map(|one| value(one * 1e3)),
                    rotation_deg: [roll, pitch, yaw].map(|one| value(one.to_degrees())),
                },
                held_by: gripper.map(|gripper| gripper.name.clone()),
            }
        });
        reports.collect()
    }
}
