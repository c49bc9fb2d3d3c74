//! Connections of the page's server: bounded in number, in size and in time, whatever clients do.

use std::pin::pin;
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use rustix::net::sockopt::set_tcp_user_timeout;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio::task::JoinSet;
use tokio::time::{sleep, timeout};

/// More connections than this at once are turned away.
const MOST: usize = 256;
/// Time for the head of a request, and between two requests.
const HEAD_TIME: Duration = Duration::from_secs(5);
/// Largest head of a request, bytes, and its lines.
const LARGEST_HEAD: usize = 16 * 1024;
const MOST_LINES: usize = 64;
/// Time in which a client has to take what is sent, ms.
const TAKING_MS: u32 = 30_000;
/// Time for answers under way when the server ends.
const GRACE: Duration = Duration::from_millis(250);
/// Time until the next try where the computer cannot accept a connection.
const RETRY: Duration = Duration::from_millis(100);

/// Serves until `stop`.
pub(super) async fn serve(listener: TcpListener, router: Router, mut stop: watch::Receiver<bool>) {
    let mut connections = JoinSet::new();
    loop {
        tokio::select! {
            _ = stop.changed() => break,
            accepted = listener.accept() => match accepted {
                Ok((stream, _)) if connections.len() < MOST => {
                    connections.spawn(answer(stream, router.clone(), stop.clone()));
                }
                // Closed at once.
                Ok(_) => {}
                Err(_) => sleep(RETRY).await,
            },
            Some(_) = connections.join_next() => {}
        }
    }
    drop(listener);
    let all = async { while connections.join_next().await.is_some() {} };
    // Answers that clients have not taken by then are dropped.
    drop(timeout(GRACE, all).await);
}

/// Answers the requests of one connection.
async fn answer(stream: TcpStream, router: Router, mut stop: watch::Receiver<bool>) {
    // Not every system has this limit; the number of connections is limited in any case.
    set_tcp_user_timeout(&stream, TAKING_MS).unwrap_or_default();
    let mut connection = pin!(
        http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(HEAD_TIME)
            .max_buf_size(LARGEST_HEAD)
            .max_headers(MOST_LINES)
            .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
    );
    // An error ends this connection only.
    tokio::select! {
        ended = connection.as_mut() => drop(ended),
        _ = stop.changed() => {
            connection.as_mut().graceful_shutdown();
            drop(connection.await);
        }
    }
}
