//! Destination of a recording: a file, and the page that reads it.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::SceneOptions;
use crate::error::{Result, VizError};
use crate::recorder::Recorder;
use crate::server::{Source, Viewer};

/// An open recording.
pub(crate) struct Destination {
    pub(crate) stream: Recorder,
    pub(crate) viewer: Option<Viewer>,
    /// To be set when nothing more comes.
    pub(crate) complete: Arc<AtomicBool>,
}

/// Opens the file and the page, which reads the file; without one, a temporary file of the page.
pub(crate) fn open(options: &SceneOptions, title: &str) -> Result<Destination> {
    let complete = Arc::new(AtomicBool::new(false));
    // The address first: an address that is taken must not cost the user an existing recording.
    let address = options.serve.map(crate::server::bind).transpose()?;
    let (source, path) = match (&options.record, &address) {
        (None, None) => return Err(VizError::NoDestination),
        (Some(path), _) => (Source::file(path.clone(), complete.clone()), path.clone()),
        (None, Some(_)) => {
            let temporary = tempfile::Builder::new()
                .prefix("twin-")
                .suffix(".rrd")
                .tempfile()
                .map_err(|source| VizError::Temporary { folder: std::env::temp_dir(), source })?
                .into_temp_path();
            let path = temporary.to_path_buf();
            (Source::temporary(temporary, complete.clone()), path)
        }
    };
    let stream = Recorder::create(&path, title, options.number)?;
    let viewer = address.map(|address| Viewer::start(address, title, source)).transpose()?;
    Ok(Destination { stream, viewer, complete })
}
