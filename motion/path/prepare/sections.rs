//! Sections of preparation: which stages are active from element to element, and whether two of them overlap.

use super::{Incompatible, Stage};
use crate::Marks;

/// Tracks the sections of a path (G41 or G42 to G40, G51 or G52 to G50) and finds stages that overlap.
///
/// Tool radius correction, smoothing and rounding share D and cannot be combined (manual 3.4). Each acts between its
/// own marks, so all of them may be in one path, one section after the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sections {
    active: Marks,
}

/// Stages that share D, with the marks that begin them.
const STAGES: [(Stage, Marks); 3] = [
    (Stage::ToolRadius, Marks::CORRECTION_LEFT.with(Marks::CORRECTION_RIGHT)),
    (Stage::Smoothing, Marks::SMOOTHING),
    (Stage::Rounding, Marks::ROUNDING),
];

const fn overlap(marks: Marks, other: Marks) -> bool {
    marks.0 & other.0 != 0
}

impl Sections {
    /// Takes the marks of the next element.
    ///
    /// # Errors
    /// If two stages are active at this element.
    pub fn pass(&mut self, marks: Marks) -> Result<(), Incompatible> {
        let active = self.active.with(marks);
        let mut stages = STAGES.iter().filter(|(_, starts)| overlap(active, *starts));
        let pair = stages.next().zip(stages.next());
        self.active = active.without(marks.begun());
        match pair {
            Some(((first, _), (second, _))) => Err(Incompatible { first: *first, second: *second }),
            None => Ok(()),
        }
    }

    /// True if `marks`, of all elements of a path together, name at most one stage, so that none can overlap.
    pub fn cannot_overlap(marks: Marks) -> bool {
        STAGES.iter().filter(|(_, starts)| overlap(marks, *starts)).count() < 2
    }
}
