//! Where a scene goes, and how it is played.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use rerun::log::ChunkBatcherConfig;

/// Where a scene goes.
#[derive(Clone, Debug, Default)]
pub struct SceneOptions {
    /// A file to record to (`.rrd`), overwritten if it exists.
    pub record: Option<PathBuf>,
    /// An address to serve the viewer at; [`crate::DEFAULT_ADDRESS`] is the customary one. Port 0 takes any free one.
    pub serve: Option<SocketAddr>,
    /// What the viewer does with the time when it opens.
    pub playback: Playback,
}

/// What the viewer does with the time when it opens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Playback {
    /// Plays from the start of the program at the speed of the machine and waits at the end for more. Right for runs
    /// that are faster than the machine.
    #[default]
    FromStart,
    /// Shows the newest. Right for runs in step with the clock.
    Follow,
}

impl Playback {
    /// How much of the program is sent at once, poses and trails. Few large pieces load and replay faster; small ones
    /// show sooner, and more smoothly, what happens now.
    pub(super) fn rows_ns(self) -> i64 {
        match self {
            Self::FromStart => 2_000_000_000,
            Self::Follow => 100_000_000,
        }
    }

    /// How much of the program is sent at once, plots.
    pub(super) fn series_ns(self) -> i64 {
        match self {
            Self::FromStart => 2_000_000_000,
            Self::Follow => 1_000_000_000,
        }
    }

    /// rerun sends by itself only what has waited for long, as when the program holds.
    pub(super) fn batcher(self) -> ChunkBatcherConfig {
        let flush_tick = Duration::from_nanos(self.rows_ns().unsigned_abs());
        ChunkBatcherConfig { flush_tick, ..ChunkBatcherConfig::DEFAULT }
    }
}
