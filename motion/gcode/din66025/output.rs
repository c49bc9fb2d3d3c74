//! Output queue of a line: elements, warnings and errors, each reported once.

use super::error::{DecodeError, Diagnostic, Failure, Item};
use std::collections::{HashSet, VecDeque};
use std::mem::{Discriminant, discriminant};
use std::ops::Range;
use twin_path::PathElement;
use twin_path::Place;

/// Diagnostics that are remembered so that loops do not repeat them.
const REMEMBERED_DIAGNOSTICS: usize = 4096;

/// Items of a line, in order.
#[derive(Debug, Default)]
pub(super) struct Output {
    pub(super) items: VecDeque<Result<Item, Failure>>,
    /// The current block.
    pub(super) place: Place,
    /// Line, column and kind of every diagnostic so far.
    reported: HashSet<(u32, usize, Discriminant<DecodeError>)>,
    /// The program has jumped, so diagnostics may have been reported before.
    pub(super) repeats: bool,
}

impl Output {
    #[inline]
    pub(super) fn element(&mut self, element: PathElement) {
        self.items.push_back(Ok(Item::Element(element)));
    }

    pub(super) fn warning(&mut self, columns: Range<usize>, error: DecodeError) {
        if let Some(diagnostic) = self.diagnostic(self.place, Some(columns), error) {
            self.items.push_back(Ok(Item::Warning(diagnostic)));
        }
    }

    /// Of a block before the present one.
    pub(super) fn error_at(&mut self, place: Place, columns: Range<usize>, error: DecodeError) {
        let diagnostic = self.diagnostic(place, Some(columns), error);
        self.items.extend(diagnostic.map(|diagnostic| Err(diagnostic.into())));
    }

    pub(super) fn error(&mut self, columns: Range<usize>, error: DecodeError) {
        self.push_error(Some(columns), error);
    }

    pub(super) fn push_error(&mut self, columns: Option<Range<usize>>, error: DecodeError) {
        let diagnostic = self.diagnostic(self.place, columns, error);
        self.items.extend(diagnostic.map(|diagnostic| Err(diagnostic.into())));
    }

    /// None if the same words were reported on an earlier pass.
    fn diagnostic(
        &mut self,
        place: Place,
        columns: Option<Range<usize>>,
        error: DecodeError,
    ) -> Option<Diagnostic> {
        let column = columns.as_ref().map_or(usize::MAX, |columns| columns.start);
        let key = (place.line, column, discriminant(&error));
        let is_new = if self.reported.len() < REMEMBERED_DIAGNOSTICS {
            self.reported.insert(key)
        } else {
            !self.repeats || !self.reported.contains(&key)
        };
        (is_new || !self.repeats).then_some(Diagnostic { place, columns, error })
    }
}
