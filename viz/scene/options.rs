//! Options of a scene: destinations and playback.

use std::net::SocketAddr;
use std::path::PathBuf;

use crate::timeline::Playback;

/// Options of a scene.
#[derive(Clone, Debug, Default)]
pub struct SceneOptions {
    /// A file to record to (`.rrd`), overwritten if it exists.
    pub record: Option<PathBuf>,
    /// An address to serve the viewer at; [`crate::DEFAULT_ADDRESS`] is the customary one. Port 0 takes any free one.
    pub serve: Option<SocketAddr>,
    /// Playback mode of the viewer when it opens.
    pub playback: Playback,
    /// True if frames come in step with the clock: then a slow file costs data, and never time.
    pub is_paced: bool,
    /// Number of the recording, which gives its rows theirs: equal frames and numbers make equal files. `None` takes a
    /// random one.
    pub number: Option<u64>,
}
