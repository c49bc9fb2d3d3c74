//! Error memory of an axis: the latest errors of its blocks (manual 9.1).

use super::Axis;
use crate::SmcError;
use std::collections::VecDeque;

/// Number of errors kept; the manual names none.
const KEPT: usize = 16;

/// Errors that blocks have shown, the oldest first.
#[derive(Clone, Debug, Default)]
pub(crate) struct BlockErrors(VecDeque<SmcError>);

impl Axis {
    /// Keeps what a block shows as its error; the oldest is dropped where there are too many.
    pub(crate) fn report(&mut self, error: SmcError) {
        let kept = &mut self.errors.0;
        if kept.len() == KEPT {
            kept.pop_front();
        }
        kept.push_back(error);
        self.values.fb_error_id = error.number().into();
    }

    /// True if blocks of this axis have shown errors that nobody has cleared (`FBErrorOccured` of `MC_ReadStatus`).
    #[doc(alias = "FBErrorOccured")]
    #[must_use]
    pub fn fb_error_occurred(&self) -> bool {
        !self.errors.0.is_empty()
    }

    /// The latest block error (`SMC_ReadFBError`, manual 9.1).
    #[doc(alias = "SMC_ReadFBError")]
    #[must_use]
    pub fn read_fb_error(&self) -> Option<SmcError> {
        self.errors.0.back().copied()
    }

    /// Clears the oldest block error and says which (`SMC_ClearFBError`, manual 9.1).
    #[doc(alias = "SMC_ClearFBError")]
    pub fn clear_fb_error(&mut self) -> Option<SmcError> {
        let oldest = self.errors.0.pop_front();
        self.values.fb_error_id = self.read_fb_error().map_or(0, |error| error.number().into());
        oldest
    }
}
