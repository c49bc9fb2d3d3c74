//! Cams checked, drawn, run and tuned.

pub(crate) mod check;
pub(crate) mod edit;
mod lost;
pub(crate) mod picture;
pub(crate) mod run;
pub(crate) mod sample;
mod start;
#[cfg(test)]
mod tests;
pub(crate) mod tune;
mod usage;

pub(crate) use lost::lost;
