//! How fast drives are spoken to, and how well a run keeps time: on emulated devices at the pace of their wires, with
//! the drivers of the product.
//!
//! * Each family follows a plan for some seconds. Commands and samples are counted and compared with what the wire can
//!   carry, by the bytes of the exchanges, the silences between them and the devices' answering times.
//! * A program runs with a board beside the simulated machine. How late its cycles are taken up, each against the
//!   instant at which it is due: with an ordinary and with a real-time thread, on an idle computer and on one with
//!   two busy threads for every core.

#![allow(
    clippy::expect_used,
    clippy::cast_precision_loss,
    clippy::panic,
    missing_docs,
    reason = "a table that cannot be made has failed; counts are small"
)]

mod cycles;
mod load;
mod machines;
mod wires;

fn main() {
    if !std::env::args().any(|argument| argument == "--bench") {
        return; // cargo only tests that benchmarks can be run
    }
    cycles::table();
    println!();
    wires::table();
}
