//! `[work_frame]`: pose of the program's frame in the machine frame.

use super::Machine;
use crate::section::Section;
use nalgebra::{Point3, Vector3};
use twin_kinematics::{Cuboid, UnitVectors, WorkFrame};

/// Reads the section: given outright, or as six points probed on a corner of the work.
pub(super) fn read(root: &Section<'_>) -> Option<WorkFrame> {
    let section = root.section("work_frame");
    let translation = section.numbers::<3>("translation_mm", -1e5..=1e5);
    let rotation = section.numbers::<3>("rotation_deg", -360.0..=360.0);
    let frame = if section.has("probed_mm") {
        for key in ["translation_mm", "rotation_deg"] {
            if section.has(key) {
                let message =
                    format!("`{key}` and [work_frame.probed_mm] say the same: one of them");
                section.complain_at(key, message);
            }
        }
        probed(&section)
    } else {
        let [roll, pitch, yaw] = rotation.unwrap_or_default().map(f64::to_radians);
        let translation = Vector3::from(translation.unwrap_or_default()) * 1e-3;
        Some(WorkFrame::new(translation, roll, pitch, yaw))
    };
    section.finish();
    frame
}

impl Machine {
    /// Origin of the work frame, m, and its roll, pitch and yaw, rad (`SMC_UnitVectorToRPY`).
    pub fn work_frame(&self) -> [[f64; 3]; 2] {
        let origin = self.frame.point_to_machine(&Point3::origin());
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let [x, y, z] = axes.map(|axis| self.frame.vector_to_machine(&axis));
        let turned = UnitVectors::new(x, y, z).map(|vectors| vectors.roll_pitch_yaw());
        [origin.coords.into(), turned.unwrap_or_default()]
    }
}

/// `SMC_DetermineCuboidBearing`.
fn probed(section: &Section<'_>) -> Option<WorkFrame> {
    let probed = section.section("probed_mm");
    let point = |key: &str| {
        let point = probed.required_numbers::<3>(key, -1e5..=1e5);
        point.map(|point| Point3::from(point.map(|value| value * 1e-3)))
    };
    let points = [point("a1"), point("a2"), point("a3"), point("b1"), point("b2"), point("c1")];
    let frame = match points {
        [Some(a1), Some(a2), Some(a3), Some(b1), Some(b2), Some(c1)] => {
            Cuboid::from_points([a1, a2, a3], [b1, b2], c1)
                .map(|cuboid| WorkFrame::from_cuboid(&cuboid))
                .map_err(|error| probed.complain(error.to_string()))
                .ok()
        }
        _ => None,
    };
    probed.finish();
    frame
}
