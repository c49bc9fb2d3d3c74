//! `[drives.encoder]`: encoder parameters of a device for its check of counters against encoders.

use super::Kind;
use crate::section::Section;
use twin_bim2ax::{DriveMode, ModuleAxis};
use twin_interpcnc::{BoardAxis, EncoderOptions};

/// Encoder and counter may be no farther apart than this, whatever the file says.
const MOST_TOLERANCE: i64 = 1_000_000;
/// Full steps of a turn of most motors, from which a module's µsteps per turn follow where the file does not say them.
const FULL_STEPS: u16 = 200;

/// The encoders of a module, which are alike.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModuleEncoder {
    /// The axes that have one.
    pub axes: Vec<ModuleAxis>,
    /// Points of a turn, parameters $2E and $2F.
    pub points_per_turn: u16,
    /// µsteps of a turn, parameters $2C and $2D.
    pub increments_per_turn: u16,
    /// So far encoder and counter may be apart, µsteps; three full steps where the file does not say.
    pub tolerance: Option<u32>,
}

/// The section, if there is one.
fn section<'a>(of_device: &Section<'a>) -> Option<Section<'a>> {
    of_device.has("encoder").then(|| of_device.section("encoder"))
}

/// The encoder of a board; `[[axes]]` gives its axis.
pub(super) fn of_board(of_device: &Section<'_>) -> Option<EncoderOptions> {
    let said = section(of_device)?;
    let letters = ["X", "Y", "Z", "A", "B"];
    let axes: Vec<_> = letters.into_iter().zip(BoardAxis::ALL).collect();
    let axis = said.required_choice("axis", &axes);
    let points = said.required_integer("points", -1_000_000_000..=1_000_000_000);
    if points == Some(0) {
        let message = "`points` is 0; an encoder that never counts shows nothing".to_owned();
        said.complain_at("points", message);
    }
    let increments = said.required_integer("per_increments", 1..=1_000_000_000);
    let tolerance = said.required_integer("tolerance_increments", 0..=MOST_TOLERANCE);
    said.finish();
    Some(EncoderOptions {
        axis: axis?,
        points: i32::try_from(points?).ok().filter(|points| *points != 0)?,
        increments: u32::try_from(increments?).ok()?,
        tolerance: u32::try_from(tolerance?).ok()?,
    })
}

/// The encoders of a module.
pub(super) fn of_module(of_device: &Section<'_>, mode: DriveMode) -> Option<ModuleEncoder> {
    let said = section(of_device)?;
    let numbers = said.integers("axes", &(1..=2), 2);
    if numbers.is_empty() {
        said.complain_at(
            "axes",
            "`axes` names none; [1], [2] or [1, 2] have an encoder".to_owned(),
        );
    }
    let has = |axis: &ModuleAxis| numbers.contains(&i64::from(axis.number()));
    let axes: Vec<_> = ModuleAxis::ALL.into_iter().filter(has).collect();
    let points = said.required_integer("points_per_turn", 1..=65_535);
    let usual = FULL_STEPS.saturating_mul(mode.microsteps());
    let increments = said.integer("increments_per_turn", 1..=65_535).unwrap_or(usual.into());
    let tolerance = said.integer("tolerance_increments", 0..=MOST_TOLERANCE);
    said.finish();
    Some(ModuleEncoder {
        axes,
        points_per_turn: u16::try_from(points?).ok()?,
        increments_per_turn: u16::try_from(increments).ok()?,
        tolerance: tolerance.and_then(|tolerance| u32::try_from(tolerance).ok()),
    })
}

/// Checks that the axes with an encoder are among those of the device: `names` as in `[[axes]]`.
pub(crate) fn check(of_device: &Section<'_>, kind: Option<Kind>, names: &[&str]) {
    // Others do not know the key.
    if !matches!(kind, Some(Kind::InterpCnc | Kind::Bim2Ax)) {
        return;
    }
    let Some(said) = section(of_device) else { return };
    let nowhere = |key: &str, axis: &str| {
        let message = format!(
            "no [[axes]] hang on axis {axis} of this drive; its encoder shows nothing that moves"
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
