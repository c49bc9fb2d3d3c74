//! Web server of the page: rerun's web viewer and the recording, at one address.
//!
//! rerun has its own server, in two halves on two ports. It is not used: its page loads fonts from the internet and
//! reports its use, it loses the error when a port is taken, and it keeps the whole recording in memory. Here the page
//! may connect to this server only (`Content-Security-Policy`), and the recording is read from its file as it grows.

mod answers;
mod connections;
mod stream;

#[cfg(test)]
pub(crate) mod tests;

use std::io::Read;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread::JoinHandle;

use re_web_viewer_server::WebViewerData;
use rerun::external::re_log_encoding::Decoder;
use rerun::log::LogMsg;
use tempfile::TempPath;
use thread_priority::unix::{set_thread_priority_and_policy, thread_native_id};
use thread_priority::{NormalThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy};
use tokio::runtime;
use tokio::sync::watch;

use crate::error::{Result, VizError};

/// The customary address: port 9090 of this computer, which other computers cannot reach.
pub const DEFAULT_ADDRESS: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 9090);
/// Most bytes in which the first message of a recording ends.
const MOST_FIRST: u64 = 16 << 20;

/// A recording and whether more of it may come.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    path: PathBuf,
    complete: Arc<AtomicBool>,
    /// Removes the file when the page is gone.
    _temporary: Option<Arc<TempPath>>,
}

impl Source {
    pub(crate) fn file(path: PathBuf, complete: Arc<AtomicBool>) -> Self {
        Self { path, complete, _temporary: None }
    }

    pub(crate) fn temporary(path: TempPath, complete: Arc<AtomicBool>) -> Self {
        Self { path: path.to_path_buf(), complete, _temporary: Some(Arc::new(path)) }
    }
}

/// A page that shows a recording; it goes away when this is dropped.
#[derive(Debug)]
pub struct Viewer {
    address: SocketAddr,
    stop: watch::Sender<bool>,
    thread: Option<JoinHandle<()>>,
}

/// Binds the address early, so that a conflict shows at once.
/// Errors: [`VizError::Bind`] if it is taken or not ours.
pub(crate) fn bind(address: SocketAddr) -> Result<Bound> {
    let failed = |source| VizError::Bind { address, source };
    let listener = TcpListener::bind(address).map_err(failed)?;
    Ok(Bound { address: listener.local_addr().map_err(failed)?, listener })
}

/// An address that is ours, with the port that was really taken.
#[derive(Debug)]
pub(crate) struct Bound {
    address: SocketAddr,
    listener: TcpListener,
}

/// Serves a finished recording.
///
/// # Errors
/// [`VizError::Open`] if the file cannot be read, [`VizError::NotARecording`] if it is none, [`VizError::Bind`] if the
/// address is taken.
pub fn view_recording(path: &Path, address: SocketAddr) -> Result<Viewer> {
    let file = std::fs::File::open(path)
        .map_err(|source| VizError::Open { path: path.to_owned(), source })?;
    let not_a_recording = |source| VizError::NotARecording { path: path.to_owned(), source };
    let mut messages =
        Decoder::<LogMsg>::decode_eager(std::io::BufReader::new(file.take(MOST_FIRST)))
            .map_err(|source| not_a_recording(Some(source)))?;
    match messages.next() {
        Some(Ok(_)) => {}
        Some(Err(source)) => return Err(not_a_recording(Some(source))),
        None => return Err(not_a_recording(None)),
    }
    let title =
        path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    Viewer::start(
        bind(address)?,
        &title,
        Source::file(path.to_owned(), Arc::new(AtomicBool::new(true))),
    )
}

impl Viewer {
    /// Starts serving.
    pub(crate) fn start(bound: Bound, title: &str, source: Source) -> Result<Self> {
        let Bound { address, listener } = bound;
        let failed = |source| VizError::Serve { address, source };
        let (stop, stopped) = watch::channel(false);
        let local_only = address.ip().is_loopback();
        let assets = WebViewerData::load(None)?;
        let router = answers::router(title, assets, source, local_only, stopped.clone());
        let runtime =
            runtime::Builder::new_current_thread().enable_all().build().map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let listener = {
            let _entered = runtime.enter();
            tokio::net::TcpListener::from_std(listener).map_err(failed)?
        };
        let serve = move || {
            lower_priority();
            runtime.block_on(connections::serve(listener, router, stopped));
            runtime.shutdown_background();
        };
        let thread = std::thread::Builder::new().name("viewer".to_owned()).spawn(serve);
        Ok(Self { address, stop, thread: Some(thread.map_err(failed)?) })
    }

    /// The address being served at, with the port that was really taken.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// URL for a browser on this computer.
    pub fn url(&self) -> String {
        let mut address = self.address;
        if address.ip().is_unspecified() {
            address.set_ip(if address.is_ipv4() {
                IpAddr::V4(Ipv4Addr::LOCALHOST)
            } else {
                IpAddr::V6(std::net::Ipv6Addr::LOCALHOST)
            });
        }
        format!("http://{address}/")
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        self.stop.send_replace(true);
        if let Some(thread) = self.thread.take() {
            // A panic of the server's thread has been printed; there is nothing to add to it.
            drop(thread.join());
        }
    }
}

/// Gives the calling thread the lowest priority, so that the page does not delay a run.
fn lower_priority() {
    let policy = ThreadSchedulePolicy::Normal(NormalThreadSchedulePolicy::Idle);
    // Where the system refuses, the page is served all the same.
    drop(set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Min, policy));
}
