//! Gantries: linear axes at right angles to each other (SoftMotion manual 8.2.1 to 8.2.3).

mod cartesian;
mod cutter;
mod h_belt;
mod tool_offset;

pub use cartesian::{Gantry, Gantry2, Gantry3};
pub use cutter::{GantryCutter, GantryCutter2, GantryCutter3, Sense, Swinging};
pub use h_belt::{BeltLayout, GantryH2};
pub use tool_offset::ToolBeside;

/// A gantry has no size of its own; this is that of a machine on a bench, m.
const CHARACTERISTIC_LENGTH: f64 = 0.5;
