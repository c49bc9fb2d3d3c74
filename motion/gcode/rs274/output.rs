//! Output queue of a line: elements, warnings and errors.

use super::error::{DecodeError, Diagnostic, Failure, Item};
use std::collections::VecDeque;
use std::ops::Range;
use twin_path::PathElement;
use twin_path::Place;

/// Items of a line, in order: few, except for canned cycles.
#[derive(Debug, Default)]
pub(super) struct Output {
    pub(super) items: VecDeque<Result<Item, Failure>>,
    pub(super) place: Place,
}

impl Output {
    /// The block at hand.
    pub(super) fn place(&self) -> Place {
        self.place
    }

    pub(super) fn element(&mut self, element: PathElement) {
        self.items.push_back(Ok(Item::Element(element)));
    }

    pub(super) fn warning(&mut self, columns: Option<Range<usize>>, error: DecodeError) {
        let diagnostic = Diagnostic { place: self.place, columns, error };
        self.items.push_back(Ok(Item::Warning(diagnostic)));
    }

    pub(super) fn error(&mut self, columns: Option<Range<usize>>, error: DecodeError) {
        let diagnostic = Diagnostic { place: self.place, columns, error };
        self.items.push_back(Err(diagnostic.into()));
    }
}
