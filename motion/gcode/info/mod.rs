//! Program overview: key figures ([`ProgramInfo`], manual 3.3), blocks as a viewer shows them ([`shown_block`], 6.2.2), and
//! the first lines and objects as text ([`first_lines`], [`QueueRow`], manual 7).

mod listing;
mod program;
#[cfg(test)]
mod tests;
mod viewer;

pub use listing::{MoveType, QUEUE_HEADING, QueueRow, SHOWN, first_lines};
pub use program::{Counts, ProgramInfo, RuleCount};
pub use viewer::shown_block;
