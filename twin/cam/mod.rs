//! Cams checked, drawn, run and tuned.

pub mod check;
pub mod edit;
mod lost;
pub mod picture;
pub mod run;
pub mod sample;
mod start;
#[cfg(test)]
mod tests;
pub mod tune;
mod usage;

pub use lost::lost;
