//! `[drives.encoder]`: check that encoders are on axes that move something.

use crate::section::Section;
use twin_drives::family::Family;

/// Checks that the axes with an encoder are among those of the device: `names` as in `[[axes]]`.
pub(crate) fn check(of_device: &Section<'_>, family: Option<&dyn Family>, names: &[&str]) {
    // Others do not know the key.
    let knows = family.is_some_and(Family::has_encoders);
    if !knows || !of_device.has("encoder") {
        return;
    }
    let said = of_device.section("encoder");
    let nowhere = |key: &str, axis: &str| {
        let message = format!(
            "no entry of [[axes]] uses axis {axis} of this drive, so its encoder measures nothing"
        );
        said.complain_at(key, message);
    };
    if let Some(axis) = said.glance_at_text("axis").filter(|axis| !names.contains(axis)) {
        nowhere("axis", axis);
    }
    for number in said.glance_at_integers("axes") {
        let axis = number.to_string();
        if matches!(number, 1 | 2) && !names.contains(&axis.as_str()) {
            nowhere("axes", &axis);
        }
    }
}
