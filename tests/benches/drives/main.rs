//! Benchmark of the drives: command rate and cycle lateness, on emulated devices at the pace of their wires, with the
//! drivers of the product.
//!
//! * Each family follows a plan for some seconds. Commands and samples are counted and compared with what the wire can
//!   carry, by the bytes of the exchanges, the silences between them and the devices' answering times.
//! * A program runs on the simulated machine and on a board. The lateness of each cycle is measured against its due
//!   time: with an ordinary and with a real-time thread, on an idle computer and on one with two busy threads for every
//!   core.

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
