//! Notices: changes and deviations that preparation reports separately from the stream.

use super::Stage;
use crate::Place;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Notices kept until somebody takes them.
const CAPACITY: usize = 1024;

/// Something the path shows only to a close look: preparation has changed it in a way the program may not have meant,
/// or the tool cannot do what the program says. The path itself goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Notice {
    /// On its offset path the tool cuts into the programmed contour.
    Gouge {
        /// The block on whose offset the tool is.
        place: Place,
        /// The block whose contour it damages.
        damaged: Place,
        /// How much nearer than its radius the tool comes, m.
        depth: f64,
    },
    /// The tool is too large for an element: its offset vanishes (an arc of a smaller radius) or reverses (between two
    /// inner corners), and the tool does not touch it along its whole length.
    TooNarrow {
        /// The block.
        place: Place,
        /// Radius of the arc that vanishes, m; none if the element is of another kind.
        radius: Option<f64>,
        /// Radius of the tool, m.
        tool_radius: f64,
    },
    /// A loop of the path has been cut off.
    LoopCut {
        /// The block on which the path is cut.
        place: Place,
        /// The block on which it goes on.
        resumed: Place,
        /// Length of the path cut off, m.
        length: f64,
    },
    /// A stage has begun without a radius or distance (D), so that it leaves the path as it is.
    NoRadius {
        /// The block with which it begins.
        place: Place,
        /// The stage.
        stage: Stage,
    },
    /// A switch point lies on a piece of path that is gone, and there is no room for it on what is left.
    SwitchLost {
        /// The block it was programmed in.
        place: Place,
        /// Number of the switch.
        number: u8,
        /// True if it was to be switched on.
        on: bool,
    },
}

impl Notice {
    /// The block it is about.
    pub const fn place(&self) -> Place {
        match self {
            Self::Gouge { place, .. }
            | Self::TooNarrow { place, .. }
            | Self::LoopCut { place, .. }
            | Self::NoRadius { place, .. }
            | Self::SwitchLost { place, .. } => *place,
        }
    }

    /// The rule it belongs to, as reports spell it.
    pub const fn rule(&self) -> &'static str {
        match self {
            Self::Gouge { .. } | Self::TooNarrow { .. } => "compensation-gouge",
            Self::LoopCut { .. } => "loop-cut",
            Self::NoRadius { .. } => "syntax",
            Self::SwitchLost { .. } => "switch-lost",
        }
    }
}

impl std::fmt::Display for Notice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mm = |metres: &f64| metres * 1e3;
        match self {
            Self::Gouge { place, damaged, depth } => {
                write!(
                    f,
                    "{place}: the tool cuts {:.6} mm into the contour of {damaged}",
                    mm(depth)
                )
            }
            Self::TooNarrow { place, radius: Some(radius), tool_radius } => write!(
                f,
                "{place}: an arc of radius {:.6} mm is too narrow for a tool of radius {:.6} mm",
                mm(radius),
                mm(tool_radius)
            ),
            Self::TooNarrow { place, radius: None, tool_radius } => write!(
                f,
                "{place}: the path between the corners is too short for a tool of radius {:.6} mm",
                mm(tool_radius)
            ),
            Self::LoopCut { place, resumed, length } => write!(
                f,
                "{place}: a loop of {:.6} mm is cut off, the path goes on with {resumed}",
                mm(length)
            ),
            Self::NoRadius { place, stage } => {
                let (size, words) = match stage {
                    Stage::ToolRadius => ("radius", "G41 or G42"),
                    Stage::Smoothing => ("distance", "G51"),
                    Stage::Rounding => ("distance", "G52"),
                };
                write!(
                    f,
                    "{place}: {stage} has no effect, because D is 0 mm; put the {size} as D into the block of {words}"
                )
            }
            Self::SwitchLost { place, number, on } => write!(
                f,
                "{place}: switch {number} {} lies on a removed part of the path, and the remaining path is too short for it",
                if *on { "on" } else { "off" }
            ),
        }
    }
}

/// List of [`Notice`]s: adapters add to it, and the consumer empties it while it pulls elements.
///
/// It is a handle: its clones are the same list, so one list serves a whole chain of adapters, and the consumer keeps
/// a clone. Memory is bounded; what comes when the list is full is counted, not kept. A notice comes when its adapter
/// knows, which for a gouge may be after the element has left: it is damaged by a later one.
#[derive(Clone, Debug, Default)]
pub struct Notices(Arc<Mutex<List>>);

#[derive(Debug, Default)]
struct List {
    items: VecDeque<Notice>,
    lost: u64,
}

impl Notices {
    fn list(&self) -> MutexGuard<'_, List> {
        // Every change to the list is complete whenever the lock is free.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn add(&self, notice: Notice) {
        let mut list = self.list();
        if list.items.len() < CAPACITY {
            list.items.push_back(notice);
        } else {
            list.lost += 1;
        }
    }

    /// Takes the oldest notice off the list.
    pub fn take(&self) -> Option<Notice> {
        self.list().items.pop_front()
    }

    /// Number of notices lost while the list was full.
    pub fn lost(&self) -> u64 {
        self.list().lost
    }
}
