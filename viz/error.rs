//! Errors of writing and showing a recording.

use std::net::SocketAddr;
use std::path::PathBuf;

/// What writing or showing a recording gives.
pub type Result<T, E = VizError> = std::result::Result<T, E>;

/// Error of writing or showing a recording.
#[derive(Debug, thiserror::Error)]
pub enum VizError {
    /// Neither a file nor an address was given.
    #[error("neither a recording file nor an address to serve at was given")]
    NoDestination,

    /// The recording cannot be created.
    #[error("cannot create the recording {}: {source}", .path.display())]
    Create {
        /// The file asked for.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },

    /// A page without a recording of its own needs a temporary file, which cannot be created.
    #[error("cannot create a temporary recording in {}: {source}", .folder.display())]
    Temporary {
        /// The folder for temporary files.
        folder: PathBuf,
        /// The cause.
        source: std::io::Error,
    },

    /// The recording has ended before its time; the disk may be full.
    #[error("cannot write the recording {}: {}", .path.display(), .ended.cause)]
    Write {
        /// The recording.
        path: PathBuf,
        /// Time and cause.
        ended: crate::Ended,
    },

    /// A frame was refused by rerun.
    #[error("cannot log to the recording: {0}")]
    Log(#[from] rerun::log::ChunkError),

    /// A value cannot be expressed in rerun's format.
    #[error("cannot encode a value for the recording: {0}")]
    Encode(#[from] rerun::SerializationError),

    /// A frame does not fit the machine.
    #[error("the machine has {expected} {of}, the frame {found} {what}")]
    Count {
        /// Parts of the machine.
        of: &'static str,
        /// Parts of the frame.
        what: &'static str,
        /// Number of parts of the machine.
        expected: usize,
        /// Number of parts in the frame.
        found: usize,
    },

    /// The address cannot be listened on: it is taken by another program, or is not this computer's.
    #[error("cannot serve the viewer at {address}: {source}")]
    Bind {
        /// The address asked for.
        address: SocketAddr,
        /// The cause.
        source: std::io::Error,
    },

    /// The web server cannot start at an address that is free.
    #[error("cannot start the web server at {address}: {source}")]
    Serve {
        /// The address asked for.
        address: SocketAddr,
        /// The cause.
        source: std::io::Error,
    },

    /// The viewer inside this binary is damaged.
    #[error("the viewer inside this program cannot be read: {0}")]
    Assets(#[from] re_web_viewer_server::WebViewerDataError),

    /// A recording cannot be opened.
    #[error("cannot open the recording {}: {source}", .path.display())]
    Open {
        /// The file asked for.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },

    /// A file is not a recording, or one of a version that this viewer cannot show.
    #[error("{} is not a rerun recording that this viewer can show", .path.display())]
    NotARecording {
        /// The file asked for.
        path: PathBuf,
        /// Why; `None` if it is a recording in which nothing was recorded.
        #[source]
        source: Option<rerun::external::re_log_encoding::DecodeError>,
    },
}

impl VizError {
    /// Checks the number of link poses.
    pub(crate) fn check_links(expected: usize, found: usize) -> Result<(), Self> {
        let error = Self::Count { of: "links", what: "link poses", expected, found };
        if expected == found { Ok(()) } else { Err(error) }
    }
}
