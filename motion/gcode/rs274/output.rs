//! Output queue of a line: elements, warnings and errors.

use super::error::{DecodeError, Diagnostic, Failure, Item, Problem};
use std::collections::VecDeque;
use std::ops::Range;
use twin_path::PathElement;
use twin_path::Place;

/// Items of a line, in order: few, except for canned cycles.
#[derive(Debug, Default)]
pub(super) struct Output {
    pub(super) items: VecDeque<Result<Item, Failure>>,
    /// The current block.
    pub(super) place: Place,
    remarks: Vec<Remark>,
}

/// What is reported once, with its count, at the end of the program.
#[derive(Debug)]
struct Remark {
    kind: DecodeError,
    refused: bool,
    /// The first of them.
    first: Diagnostic,
    more: usize,
    last: u32,
}

impl Output {
    pub(super) fn element(&mut self, element: PathElement) {
        self.items.push_back(Ok(Item::Element(element)));
    }

    pub(super) fn warning(&mut self, columns: Option<Range<usize>>, error: DecodeError) {
        let diagnostic = self.diagnostic(columns, error);
        self.items.push_back(Ok(Item::Warning(diagnostic)));
    }

    pub(super) fn error(&mut self, problem: impl Into<Problem>) {
        let Problem { columns, error } = problem.into();
        let diagnostic = self.diagnostic(columns, error);
        self.items.push_back(Err(diagnostic.into()));
    }

    /// Remembers a warning, or an error if it is `refused`, for the end of the program.
    pub(super) fn remark(
        &mut self,
        columns: Option<Range<usize>>,
        kind: DecodeError,
        refused: bool,
    ) {
        let line = self.place.line;
        if let Some(remark) = self.remarks.iter_mut().find(|remark| remark.kind == kind) {
            remark.more += 1;
            remark.last = remark.last.max(line);
            return;
        }
        let first = self.diagnostic(columns, kind.clone());
        self.remarks.push(Remark { kind, refused, first, more: 0, last: line });
    }

    /// Passes on what has been remembered.
    pub(super) fn end(&mut self) {
        for Remark { refused, mut first, more, last, .. } in self.remarks.drain(..) {
            if more > 0 {
                first.error = DecodeError::Repeated { error: Box::new(first.error), more, last };
            }
            self.items.push_back(if refused {
                Err(first.into())
            } else {
                Ok(Item::Warning(first))
            });
        }
    }

    fn diagnostic(&self, columns: Option<Range<usize>>, error: DecodeError) -> Diagnostic {
        Diagnostic { place: self.place, columns, error }
    }
}
