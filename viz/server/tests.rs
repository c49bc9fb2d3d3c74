//! Tests of the web server.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;

use tempfile::NamedTempFile;

use super::*;
use crate::scene::tests::record_three_frames;
use std::sync::atomic::Ordering;

const ANY_PORT: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 0);

/// A request as browsers make it, without keeping the connection.
fn ask(address: SocketAddr, method: &str, path: &str, host: &str) -> BufReader<TcpStream> {
    let mut connection = TcpStream::connect(address).unwrap();
    write!(connection, "{method} {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n")
        .unwrap();
    BufReader::new(connection)
}

/// Status and headers, which are read off.
fn head(answer: &mut impl BufRead) -> (u16, String) {
    let mut lines = answer.lines().map(Result::unwrap).take_while(|line| !line.is_empty());
    let status = lines.next().unwrap().split(' ').nth(1).unwrap().parse().unwrap();
    (status, lines.collect::<Vec<_>>().join("\n"))
}

/// One chunk (RFC 9112, section 7.1): its size in hexadecimal, the bytes, each ended by CR LF.
fn chunk(answer: &mut impl BufRead) -> Vec<u8> {
    let mut size = String::new();
    answer.read_line(&mut size).unwrap();
    let mut bytes = vec![0; usize::from_str_radix(size.trim_end(), 16).unwrap() + 2];
    answer.read_exact(&mut bytes).unwrap();
    assert_eq!(bytes.split_off(bytes.len() - 2), b"\r\n");
    bytes
}

fn chunks_to_end(answer: &mut impl BufRead) -> Vec<u8> {
    let mut all = Vec::new();
    loop {
        let chunk = chunk(answer);
        if chunk.is_empty() {
            return all;
        }
        all.extend(chunk);
    }
}

/// The whole recording, once it is complete.
pub(crate) fn download(address: SocketAddr) -> Vec<u8> {
    let mut answer = ask(address, "GET", "/recording.rrd", "localhost");
    assert_eq!(head(&mut answer).0, 200);
    chunks_to_end(&mut answer)
}

fn file_of(bytes: &[u8]) -> NamedTempFile {
    let mut file = NamedTempFile::new().unwrap();
    file.write_all(bytes).unwrap();
    file
}

fn status_of(viewer: &Viewer, method: &str, path: &str, host: &str) -> u16 {
    head(&mut ask(viewer.address(), method, path, host)).0
}

fn recording() -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rrd");
    record_three_frames(&path);
    std::fs::read(path).unwrap()
}

#[test]
fn a_recording_is_served_byte_for_byte_next_to_a_page_that_loads_it() {
    let bytes = recording();
    let file = file_of(&bytes);
    let viewer = view_recording(file.path(), ANY_PORT).unwrap();
    // Neither is reached from outside.
    assert!(viewer.address().ip().is_loopback() && DEFAULT_ADDRESS.ip().is_loopback());
    assert_eq!(viewer.url(), format!("http://{}/", viewer.address()));

    assert_eq!(download(viewer.address()), bytes);

    let mut answer = ask(viewer.address(), "GET", "/?renderer=webgl", "127.0.0.1:9090");
    let (status, headers) = head(&mut answer);
    assert_eq!(status, 200);
    assert!(headers.contains("connect-src 'self';"), "{headers}");
    let mut page = String::new();
    answer.read_to_string(&mut page).unwrap();
    for script in ["/re_viewer.js", "/page.js"] {
        assert!(page.contains(script), "{page}");
        assert_eq!(status_of(&viewer, "GET", script, "localhost"), 200);
    }
    let elsewhere = page.contains("http://") || page.contains("https://");
    assert!(!elsewhere, "the page must load nothing from elsewhere: {page}");

    // The viewer itself is in the binary.
    let mut answer = ask(viewer.address(), "GET", "/re_viewer_bg.wasm", "[::1]:9090");
    let (status, headers) = head(&mut answer);
    assert_eq!(status, 200);
    assert!(headers.contains("application/wasm"), "{headers}");
    let mut start = [0; 4];
    answer.read_exact(&mut start).unwrap();
    assert_eq!(&start, b"\0asm");
}

#[test]
fn pages_of_other_names_are_refused() {
    let file = file_of(&recording());
    let viewer = view_recording(file.path(), ANY_PORT).unwrap();
    for (method, path, host, expected) in [
        ("GET", "/recording.rrd", "evil.example:9090", 403),
        ("GET", "/", "192.0.2.1", 403),
        ("GET", "/etc/passwd", "localhost", 404),
        ("GET", "//recording.rrd", "localhost", 404),
        ("POST", "/", "localhost", 405),
    ] {
        assert_eq!(status_of(&viewer, method, path, host), expected, "{method} {path} {host}");
    }
}

/// Status of the answer to these bytes.
fn answer_to(viewer: &Viewer, request: &str) -> u16 {
    let mut connection = TcpStream::connect(viewer.address()).unwrap();
    connection.write_all(request.as_bytes()).unwrap();
    head(&mut BufReader::new(connection)).0
}

#[test]
fn requests_that_no_page_of_ours_makes_are_refused() {
    let file = file_of(&recording());
    let viewer = view_recording(file.path(), ANY_PORT).unwrap();
    for (line, headers, expected) in [
        ("GET /", "Host: localhost\r\nOrigin: http://localhost", 200),
        ("GET /", "Host: localhost\r\nOrigin: http://evil.example", 403),
        ("GET /", "Host: localhost\r\nOrigin: null", 403),
        ("GET /", "Host: localhost\r\nHost: evil.example", 403),
        ("GET /", "Host: [::1]evil.example", 403),
        ("GET /", "X: no host", 403),
        ("GET http://evil.example/", "Host: localhost", 403),
        ("GET /", "Host: localhost\r\nContent-Length: 100000000000000", 413),
        ("HEAD /", "Host: localhost", 405),
    ] {
        let request = format!("{line} HTTP/1.1\r\n{headers}\r\nConnection: close\r\n\r\n");
        assert_eq!(answer_to(&viewer, &request), expected, "{request}");
    }
    let long = format!("GET / HTTP/1.1\r\nHost: localhost\r\nX: {}\r\n\r\n", "x".repeat(1 << 16));
    assert_eq!(answer_to(&viewer, &long), 431);
}

/// Silent clients, half requests, and clients that never read what they asked for.
#[test]
fn slow_clients_keep_neither_others_waiting_nor_the_viewer_from_ending() {
    let file = file_of(b"");
    let source = Source::file(file.path().to_owned(), Arc::new(AtomicBool::new(false)));
    let viewer = Viewer::start(bind(ANY_PORT).unwrap(), "slow", source).unwrap();
    let slow = |number: usize| {
        let mut connection = TcpStream::connect(viewer.address()).unwrap();
        let request = "GET /re_viewer_bg.wasm HTTP/1.1\r\nHost: localhost\r\n\r\n";
        let sent = [0, 20, request.len()][number % 3];
        connection.write_all(&request.as_bytes()[..sent]).unwrap();
        connection
    };
    let slow: Vec<_> = (0..200).map(slow).collect();
    assert_eq!(status_of(&viewer, "GET", "/", "localhost"), 200);
    let (sender, ended) = std::sync::mpsc::sync_channel(1);
    let end = move || {
        drop(viewer);
        sender.send(()).unwrap();
    };
    std::thread::Builder::new().name("end".to_owned()).spawn(end).unwrap();
    // It takes a quarter of a second.
    ended.recv_timeout(std::time::Duration::from_secs(20)).unwrap();
    drop(slow);
}

#[test]
fn a_growing_recording_is_sent_as_it_grows() {
    let mut file = file_of(b"");
    let complete = Arc::new(AtomicBool::new(false));
    let source = Source::file(file.path().to_owned(), complete.clone());
    let viewer = Viewer::start(bind(ANY_PORT).unwrap(), "grows", source).unwrap();

    file.write_all(b"first").unwrap();
    let mut answer = ask(viewer.address(), "GET", "/recording.rrd", "localhost");
    head(&mut answer);
    assert_eq!(chunk(&mut answer), b"first");
    file.write_all(b"second").unwrap();
    assert_eq!(chunk(&mut answer), b"second");
    // What is written just before the end is not lost.
    file.write_all(b"last").unwrap();
    complete.store(true, Ordering::Release);
    assert_eq!(chunks_to_end(&mut answer), b"last");
}

#[test]
fn an_unfinished_recording_does_not_keep_the_viewer_from_ending() {
    let file = file_of(b"");
    let source = Source::file(file.path().to_owned(), Arc::new(AtomicBool::new(false)));
    let viewer = Viewer::start(bind(ANY_PORT).unwrap(), "unfinished", source).unwrap();
    let mut answer = ask(viewer.address(), "GET", "/recording.rrd", "localhost");
    head(&mut answer);
    drop(viewer);
    assert_eq!(chunks_to_end(&mut answer), b"");
}

#[test]
fn a_page_without_a_recording_of_its_own_leaves_no_file_behind() {
    let source = {
        let temporary = file_of(b"").into_temp_path();
        Source::temporary(temporary, Arc::new(AtomicBool::new(true)))
    };
    let path = source.path.clone();
    let viewer = Viewer::start(bind(ANY_PORT).unwrap(), "temporary", source).unwrap();
    assert!(path.exists());
    drop(viewer);
    assert!(!path.exists());
}

#[test]
fn a_taken_address_is_named() {
    let holder = TcpListener::bind(ANY_PORT).unwrap();
    let taken = holder.local_addr().unwrap();
    let error = view_recording(file_of(&recording()).path(), taken).unwrap_err();
    let VizError::Bind { source, .. } = &error else { panic!("{error:?}") };
    assert_eq!(source.kind(), std::io::ErrorKind::AddrInUse);
    assert_eq!(error.to_string(), format!("cannot serve the viewer at {taken}: {source}"));
}

#[test]
fn what_is_not_a_recording_is_refused() {
    for bytes in [&b""[..], b"G0 X0\nG1 X10 F100\n", b"RRF2", &[0; 4096]] {
        let viewer = view_recording(file_of(bytes).path(), ANY_PORT);
        assert!(matches!(viewer, Err(VizError::NotARecording { .. })), "{bytes:?}: {viewer:?}");
    }
    let missing = view_recording(Path::new("/nowhere/missing.rrd"), ANY_PORT);
    assert!(matches!(missing, Err(VizError::Open { .. })), "{missing:?}");
}
