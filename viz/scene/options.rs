//! Where a scene goes, and how it is played.

use std::net::SocketAddr;
use std::path::PathBuf;

use crate::timeline::Playback;

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
