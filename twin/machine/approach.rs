//! `[program]`, `approach` and `safe_z_mm`: order of the axes on the way to the start of a program.

use crate::section::Section;

/// Order in which the axes go to the start of a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ApproachOrder {
    /// The tool goes up along its axis, then across at that height, then down.
    #[default]
    RetractFirst,
    /// One axis after the other, in the order of the machine file.
    AxisByAxis,
    /// All axes at once.
    Together,
}

/// The way to the start of a program, as the machine file wants it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ApproachRule {
    /// Order of the axes.
    pub order: ApproachOrder,
    /// Least height of the tool tip on its way across, m, machine frame; `None`: the lowest one that is clear.
    pub safe_z: Option<f64>,
}

/// Reads both keys of `[program]`.
pub(super) fn read(program: &Section<'_>) -> ApproachRule {
    let orders = [
        ("retract-first", ApproachOrder::RetractFirst),
        ("axis-by-axis", ApproachOrder::AxisByAxis),
        ("together", ApproachOrder::Together),
    ];
    let order = program.choice("approach", &orders).unwrap_or_default();
    let safe_z = program.number("safe_z_mm", -1e5..=1e5).map(|value| value * 1e-3);
    if safe_z.is_some() && order != ApproachOrder::RetractFirst {
        program.complain_at(
            "safe_z_mm",
            "only `approach = \"retract-first\"` has a height; remove one of the two keys",
        );
    }
    ApproachRule { order, safe_z }
}
