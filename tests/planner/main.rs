//! Planner test: time-optimal plans of whole paths on whole machines keep all limits, sampled every millisecond.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    unreachable_pub,
    reason = "a test that cannot be set up has failed; counts are far below 2^53"
)]

mod chunks;
mod corpus;
mod cutter;
mod long;
mod machines;
mod random;
mod replan;
mod run;
mod short;
mod some;
mod splice;
mod tool;
