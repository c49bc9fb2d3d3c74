//! Fuzz target: any bytes as requests to the page's server, over a connection. Only requests that name this computer
//! get something, every answer has a policy, the connection ends, and the server answers the next one.
//!
//! The files of the server are compiled into this target: the crate around them needs all of rerun.

#![no_main]

extern crate self as re_web_viewer_server;

#[path = "http/server.rs"]
mod server;

use libfuzzer_sys::fuzz_target;
use std::cell::RefCell;
use std::net::{IpAddr, SocketAddr};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::runtime::{Builder, Runtime};

/// Stand-in for the files of rerun's viewer, which have 40 MB.
pub struct WebViewerData;

impl WebViewerData {
    pub fn viewer_js(&self) -> &[u8] {
        b"viewer"
    }
    pub fn viewer_wasm(&self) -> &[u8] {
        b"\0asm"
    }
    pub fn favicon(&self) -> &[u8] {
        b"icon"
    }
}

/// Content of the recording.
const RECORDING: &[u8] = b"RRF2 the recording of this run";

/// A request of the page for it, and the end of the answer.
const USUAL: &[u8] = b"GET /recording.rrd HTTP/1.1\r\nHost: localhost\r\n\r\n";
const RECORDING_CHUNK: &[u8] = b"RRF2 the recording of this run\r\n0\r\n\r\n";

thread_local! {
    static SERVER: RefCell<(Runtime, SocketAddr)> = RefCell::new(start());
}

fn start() -> (Runtime, SocketAddr) {
    let runtime = Builder::new_current_thread().enable_all().build().expect("a runtime");
    let path = std::env::temp_dir().join(format!("twin-fuzz-{}.rrd", std::process::id()));
    std::fs::write(&path, RECORDING).expect("a folder for temporary files");
    let listener = runtime.block_on(TcpListener::bind("127.0.0.1:0")).expect("a port");
    let address = listener.local_addr().expect("a listener");
    runtime.spawn(server::serve(listener, path));
    (runtime, address)
}

/// Answers to `requests` on a connection of their own. The server may end it before it has read everything.
async fn ask(address: SocketAddr, requests: &[u8]) -> Vec<u8> {
    let connection = TcpStream::connect(address).await.expect("a server");
    let (mut reader, mut writer) = connection.into_split();
    let mut answers = Vec::new();
    let write = async {
        let _ = writer.write_all(requests).await;
        let _ = writer.shutdown().await;
    };
    let (_, _) = tokio::join!(write, reader.read_to_end(&mut answers));
    answers
}

fuzz_target!(|requests: &[u8]| {
    let [answers, next] = SERVER.with_borrow(|(runtime, address)| {
        runtime.block_on(async { [ask(*address, requests).await, ask(*address, USUAL).await] })
    });
    assert!(next.ends_with(RECORDING_CHUNK), "no recording afterwards: {}", next.escape_ascii());
    let count = |part: &[u8]| answers.windows(part.len()).filter(|window| *window == part).count();
    let heads = count(b"HTTP/1.1 ") + count(b"HTTP/1.0 ");
    let known = ["200", "403", "404", "405", "413"].map(|status| {
        count(format!("HTTP/1.1 {status} ").as_bytes())
            + count(format!("HTTP/1.0 {status} ").as_bytes())
    });
    let by_router: usize = known.iter().sum();
    // Others come from HTTP itself: bad requests, and heads that are too long.
    assert!(heads - by_router <= 1, "{}", answers.escape_ascii());
    assert_eq!(count(b"content-security-policy: default-src 'none';"), by_router);
    assert!(count(RECORDING) <= by_router);
    assert!(known[0] == 0 || names_this_computer(requests), "{}", requests.escape_ascii());
});

/// True if a line of the requests is a `Host` of this computer.
fn names_this_computer(requests: &[u8]) -> bool {
    requests.split(|byte| *byte == b'\n').any(|line| {
        let line = String::from_utf8_lossy(line).trim().to_lowercase();
        let Some(host) = line.strip_prefix("host:").map(str::trim) else { return false };
        let name = match host.strip_prefix('[') {
            Some(rest) => rest.split(']').next(),
            None => host.split(':').next(),
        };
        let name = name.unwrap_or_default();
        name == "localhost" || name.parse::<IpAddr>().is_ok_and(|ip| ip.is_loopback())
    })
}
