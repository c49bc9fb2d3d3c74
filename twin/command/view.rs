//! `twin view`: show a recording in the browser.

use super::{Failure, Status, options, run};
use std::net::SocketAddr;
use std::path::PathBuf;

/// Show a recording made with `twin run --record` in the built-in web viewer
///
/// Serves until Ctrl-C.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The recording
    #[arg(value_name = "FILE.rrd")]
    recording: PathBuf,

    /// Address of the page
    #[arg(long, value_name = "ADDR", default_value = options::DEFAULT_ADDRESS, value_parser = options::address)]
    serve: SocketAddr,
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let interrupt = run::Interrupt::catch_as_started()?;
    let viewer = twin_viz::view_recording(&arguments.recording, arguments.serve)?;
    stderr!("{} is shown at {}", arguments.recording.display(), viewer.url());
    stderr!("{}", interrupt.how_it_ends());
    interrupt.wait();
    Ok(Status::Fit)
}
