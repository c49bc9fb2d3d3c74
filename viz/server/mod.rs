//! Web server of the page: rerun's web viewer and the recording, at one address.
//!
//! rerun has its own server, in two halves on two ports. It is not used: its page loads fonts from the internet and
//! reports its use, it loses the error when a port is taken, and it keeps the whole recording in memory. Here the page
//! may connect to this server only (`Content-Security-Policy`), and the recording is read from its file as it grows.

mod stream;

#[cfg(test)]
pub(crate) mod tests;

use std::io::Cursor;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::JoinHandle;

use re_web_viewer_server::WebViewerData;
use rerun::external::re_log_encoding::Decoder;
use rerun::log::LogMsg;
use tempfile::TempPath;
use tiny_http::{Header, Method, Request, Response, Server, StatusCode};

use crate::error::{Result, VizError};

/// The customary address: port 9090 of this computer, which other computers cannot reach.
pub const DEFAULT_ADDRESS: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 9090);

/// More pages than this at once are turned away.
const MOST_READERS: usize = 16;
/// The page may load from us and talk to us only. The viewer is WebAssembly and sets its own styles.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' 'unsafe-inline'; \
                      connect-src 'self'; img-src 'self' data: blob:; worker-src 'self' blob:; font-src 'self' data:; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const PAGE: &str = include_str!("page.html");
const SCRIPT: &str = include_str!("page.js");

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
pub struct Viewer {
    address: SocketAddr,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl std::fmt::Debug for Viewer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Viewer").field("address", &self.address).finish_non_exhaustive()
    }
}

struct Shared {
    server: Server,
    assets: WebViewerData,
    page: String,
    source: Source,
    local_only: bool,
    stop: AtomicBool,
    readers: AtomicUsize,
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
    let mut messages = Decoder::<LogMsg>::decode_eager(std::io::BufReader::new(file))
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
        let shared = Arc::new(Shared {
            server: Server::from_listener(listener, None).map_err(failed)?,
            assets: WebViewerData::load(None)?,
            page: PAGE.replace("{title}", &escape(title)).replace(
                "{is-finished}",
                if source.complete.load(Ordering::Acquire) { "true" } else { "false" },
            ),
            source,
            local_only: address.ip().is_loopback(),
            stop: AtomicBool::new(false),
            readers: AtomicUsize::new(0),
        });
        let thread = std::thread::Builder::new()
            .name("viewer".to_owned())
            .spawn({
                let shared = shared.clone();
                move || shared.serve()
            })
            .map_err(|error| failed(error.into()))?;
        Ok(Self { address, shared, thread: Some(thread) })
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
        self.shared.stop.store(true, Ordering::Release);
        self.shared.server.unblock();
        if let Some(thread) = self.thread.take() {
            // A panic of the server's thread has been printed; there is nothing to add to it.
            drop(thread.join());
        }
    }
}

impl Shared {
    fn serve(self: &Arc<Self>) {
        while !self.stop.load(Ordering::Acquire) {
            // An error is one broken connection; the next one may be well.
            if let Ok(request) = self.server.recv() {
                self.answer(request);
            }
        }
    }

    fn answer(self: &Arc<Self>, request: Request) {
        if self.local_only && !is_for_this_computer(&request) {
            return refuse(request, 403);
        }
        if *request.method() != Method::Get {
            return refuse(request, 405);
        }
        let path = request.url().split('?').next().unwrap_or_default().to_owned();
        let (kind, body): (&str, &[u8]) = match path.as_str() {
            "/" | "/index.html" => ("text/html; charset=utf-8", self.page.as_bytes()),
            "/page.js" => ("text/javascript; charset=utf-8", SCRIPT.as_bytes()),
            "/re_viewer.js" => ("text/javascript; charset=utf-8", self.assets.viewer_js()),
            "/re_viewer_bg.wasm" => ("application/wasm", self.assets.viewer_wasm()),
            "/favicon.ico" => ("image/x-icon", self.assets.favicon()),
            "/recording.rrd" => return self.send_recording(request),
            _ => return refuse(request, 404),
        };
        let headers = [
            ("Content-Type", kind),
            ("Content-Security-Policy", POLICY),
            ("Cache-Control", "no-store"),
        ];
        let headers = headers
            .into_iter()
            .filter_map(|(name, value)| Header::from_bytes(name, value).ok())
            .collect();
        // With a threshold above its length, the body is sent with its length, which the progress bar needs.
        let response =
            Response::new(StatusCode(200), headers, Cursor::new(body), Some(body.len()), None)
                .with_chunked_threshold(usize::MAX);
        // The browser may have gone: nobody is left to tell.
        drop(request.respond(response));
    }

    /// The recording has a thread per reader: it may take as long as the program.
    fn send_recording(self: &Arc<Self>, request: Request) {
        if self.readers.fetch_add(1, Ordering::AcqRel) >= MOST_READERS {
            self.readers.fetch_sub(1, Ordering::AcqRel);
            return refuse(request, 503);
        }
        let shared = self.clone();
        let spawned =
            std::thread::Builder::new().name("viewer-recording".to_owned()).spawn(move || {
                // An error is a browser that has gone, or a recording that was removed: the page says so itself.
                drop(stream::send(
                    request,
                    &shared.source.path,
                    &shared.source.complete,
                    &shared.stop,
                ));
                shared.readers.fetch_sub(1, Ordering::AcqRel);
            });
        if spawned.is_err() {
            self.readers.fetch_sub(1, Ordering::AcqRel);
        }
    }
}

/// True if the request names this computer as its host. A foreign page can make a name of its own stand for 127.0.0.1
/// (DNS rebinding) and would otherwise read the recording.
fn is_for_this_computer(request: &Request) -> bool {
    let host = request.headers().iter().find(|header| header.field.equiv("Host"));
    let name = host.map(|header| {
        let host = header.value.as_str();
        host.strip_prefix('[')
            .and_then(|rest| rest.split(']').next())
            .or(host.split(':').next())
            .unwrap_or(host)
    });
    name.is_some_and(|name| {
        name.eq_ignore_ascii_case("localhost")
            || name.parse::<IpAddr>().is_ok_and(|ip| ip.is_loopback())
    })
}

fn refuse(request: Request, status: u16) {
    // The browser may have gone: nobody is left to tell.
    drop(request.respond(Response::empty(status)));
}

/// For the title of the page.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
