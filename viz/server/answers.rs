//! Answers of the page's server: what is asked for by whom, and what is sent.

use std::net::IpAddr;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{Request, State};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HOST, ORIGIN, X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use re_web_viewer_server::WebViewerData;
use tokio::sync::{Semaphore, watch};
use tower_http::limit::RequestBodyLimitLayer;
use tower_http::set_header::SetResponseHeaderLayer;

use super::{Source, stream};

/// More readers of the recording than this at once are turned away.
const MOST_READERS: usize = 16;
/// The page may load from us and talk to us only. The viewer is WebAssembly and sets its own styles.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' 'unsafe-inline'; \
                      connect-src 'self'; img-src 'self' data: blob:; worker-src 'self' blob:; font-src 'self' data:; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const PAGE: &str = include_str!("page.html");
const SCRIPT: &str = include_str!("page.js");

/// Data of the answers.
struct Site {
    page: String,
    assets: Arc<WebViewerData>,
    source: Source,
    local_only: bool,
    readers: Arc<Semaphore>,
    stop: watch::Receiver<bool>,
}

/// The page with this title, and the recording, until `stop`. `local_only`: for browsers of this computer.
pub(super) fn router(
    title: &str,
    assets: WebViewerData,
    source: Source,
    local_only: bool,
    stop: watch::Receiver<bool>,
) -> Router {
    let is_finished = source.complete.load(Ordering::Acquire);
    let titled = PAGE.replace("{title}", &escape(title));
    let site = Arc::new(Site {
        page: titled.replace("{is-finished}", if is_finished { "true" } else { "false" }),
        assets: Arc::new(assets),
        source,
        local_only,
        readers: Arc::new(Semaphore::new(MOST_READERS)),
        stop,
    });
    let always = |name: HeaderName, value| {
        SetResponseHeaderLayer::overriding(name, HeaderValue::from_static(value))
    };
    Router::new()
        .route("/", get(page))
        .route("/index.html", get(page))
        .route("/page.js", get(|| async { (typed("text/javascript; charset=utf-8"), SCRIPT) }))
        .route("/re_viewer.js", get(viewer_script))
        .route("/re_viewer_bg.wasm", get(viewer))
        .route("/favicon.ico", get(icon))
        .route("/recording.rrd", get(recording))
        .layer(RequestBodyLimitLayer::new(0))
        .layer(from_fn_with_state(site.clone(), refuse_others))
        .layer(always(CONTENT_SECURITY_POLICY, POLICY))
        .layer(always(CACHE_CONTROL, "no-store"))
        .layer(always(X_CONTENT_TYPE_OPTIONS, "nosniff"))
        .layer(always(HeaderName::from_static("cross-origin-resource-policy"), "same-origin"))
        .with_state(site)
}

/// Refuses requests that do not come from the page of this server, and all methods but GET.
async fn refuse_others(State(site): State<Arc<Site>>, request: Request, next: Next) -> Response {
    if !is_ours(&request, site.local_only) {
        StatusCode::FORBIDDEN.into_response()
    } else if request.method() == Method::GET {
        next.run(request).await
    } else {
        StatusCode::METHOD_NOT_ALLOWED.into_response()
    }
}

/// True if the request names one host, which is this computer if `local_only`, and does not come from a page of another one. A
/// foreign page can make a name of its own stand for 127.0.0.1 (DNS rebinding) and would otherwise read the recording.
fn is_ours(request: &Request, local_only: bool) -> bool {
    let headers = request.headers();
    let Some(host) = only(headers, &HOST) else { return false };
    let Some(name) = host_name(host) else { return false };
    let names_us = || {
        name.eq_ignore_ascii_case("localhost")
            || name.parse::<IpAddr>().is_ok_and(|ip| ip.is_loopback())
    };
    let origin = only(headers, &ORIGIN).and_then(|origin| origin.strip_prefix("http://"));
    let from_us = origin == Some(host) || !headers.contains_key(ORIGIN);
    request.uri().authority().is_none() && from_us && (!local_only || names_us())
}

/// The value of a header that is there once.
fn only<'h>(headers: &'h HeaderMap, name: &HeaderName) -> Option<&'h str> {
    let mut values = headers.get_all(name).iter();
    let value = values.next().filter(|_| values.next().is_none());
    value.and_then(|value| value.to_str().ok())
}

/// Name or address of a `Host`, without its port; an IPv6 address without its brackets.
fn host_name(host: &str) -> Option<&str> {
    let (name, port) = match host.strip_prefix('[') {
        Some(rest) => {
            let (name, port) = rest.split_once(']')?;
            (name, port.strip_prefix(':').or(port.is_empty().then_some("0"))?)
        }
        None => host.split_once(':').unwrap_or((host, "0")),
    };
    port.parse::<u16>().ok().filter(|_| !name.is_empty()).map(|_| name)
}

async fn page(State(site): State<Arc<Site>>) -> Response {
    (typed("text/html; charset=utf-8"), site.page.clone()).into_response()
}

async fn viewer_script(State(site): State<Arc<Site>>) -> Response {
    asset("text/javascript; charset=utf-8", &site, WebViewerData::viewer_js)
}

async fn viewer(State(site): State<Arc<Site>>) -> Response {
    asset("application/wasm", &site, WebViewerData::viewer_wasm)
}

async fn icon(State(site): State<Arc<Site>>) -> Response {
    asset("image/x-icon", &site, WebViewerData::favicon)
}

async fn recording(State(site): State<Arc<Site>>) -> Response {
    let Ok(reader) = site.readers.clone().try_acquire_owned() else {
        return StatusCode::SERVICE_UNAVAILABLE.into_response();
    };
    let Ok(file) = std::fs::File::open(&site.source.path) else {
        return StatusCode::NOT_FOUND.into_response();
    };
    let growing = stream::growing(file, site.source.complete.clone(), site.stop.clone(), reader);
    (typed("application/octet-stream"), Body::from_stream(growing)).into_response()
}

fn typed(kind: &'static str) -> [(HeaderName, HeaderValue); 1] {
    [(CONTENT_TYPE, HeaderValue::from_static(kind))]
}

/// A file of rerun's viewer.
struct Asset(Arc<WebViewerData>, fn(&WebViewerData) -> &[u8]);

impl AsRef<[u8]> for Asset {
    fn as_ref(&self) -> &[u8] {
        (self.1)(&self.0)
    }
}

fn asset(kind: &'static str, site: &Site, file: fn(&WebViewerData) -> &[u8]) -> Response {
    (typed(kind), Bytes::from_owner(Asset(site.assets.clone(), file))).into_response()
}

/// For the title of the page.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::{escape, host_name};

    #[test]
    fn a_program_name_cannot_become_markup() {
        assert_eq!(escape("<script>&.cnc"), "&lt;script&gt;&amp;.cnc");
    }

    #[test]
    fn hosts_are_read_to_their_ends() {
        for (host, name) in [
            ("localhost", Some("localhost")),
            ("127.0.0.1:9090", Some("127.0.0.1")),
            ("[::1]", Some("::1")),
            ("[::1]:9090", Some("::1")),
            ("[::1]evil.com", None),
            ("[::1]:9090.evil.com", None),
            ("[::1", None),
            ("localhost:9090@evil.com", None),
            ("localhost:", None),
            (":9090", None),
            ("", None),
        ] {
            assert_eq!(host_name(host), name, "{host}");
        }
    }
}
