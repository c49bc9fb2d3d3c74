//! The product's server around a recording that is whole.

#[path = "../../../../viz/server/answers.rs"]
mod answers;
#[path = "../../../../viz/server/connections.rs"]
mod connections;
#[path = "../../../../viz/server/stream.rs"]
mod stream;

use std::path::PathBuf;
use std::sync::{Arc, atomic::AtomicBool};
use tokio::net::TcpListener;
use tokio::sync::watch;

/// The recording, as `viz/server` has it.
pub(crate) struct Source {
    path: PathBuf,
    complete: Arc<AtomicBool>,
}

/// Serves the recording in `path` until the runtime ends.
pub(crate) async fn serve(listener: TcpListener, path: PathBuf) {
    let source = Source { path, complete: Arc::new(AtomicBool::new(true)) };
    let (_stop, stopped) = watch::channel(false);
    let router = answers::router("fuzz", crate::WebViewerData, source, true, stopped.clone());
    connections::serve(listener, router, stopped).await;
}
