//! Timelines of a recording and their playback in the viewer.

/// Timeline: since the start of the program.
pub(crate) const TIME: &str = "time";
/// Timeline: line of the program file.
pub(crate) const LINE: &str = "line";

/// Playback mode of the viewer when it opens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Playback {
    /// Plays from the start at the speed of the machine: for runs faster than the machine.
    #[default]
    FromStart,
    /// Shows the newest. Right for runs in step with the clock.
    Follow,
}

impl Playback {
    /// Program time per batch of poses and trails, ns. Large batches load faster; small ones show sooner.
    pub(crate) fn rows_ns(self) -> i64 {
        match self {
            Self::FromStart => 2_000_000_000,
            Self::Follow => 100_000_000,
        }
    }

    /// Program time per batch of plot values, ns.
    pub(crate) fn series_ns(self) -> i64 {
        match self {
            Self::FromStart => 2_000_000_000,
            Self::Follow => 1_000_000_000,
        }
    }
}
