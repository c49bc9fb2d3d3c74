//! Path preparation: stream adapters over path elements.
//!
//! Every adapter takes an iterator of `Result<PathElement, E>` and is one itself, so that adapters stack and what
//! went wrong upstream arrives downstream at its place in the program. The consumer chooses `E`; an adapter that can
//! find fault itself asks for `E: From<` its own error `>`.
//!
//! [`CheckVelocities`] comes last and hands out [`CheckedElement`]s, the only thing
//! [`crate::interpolate::LookAhead`] takes: what the manual reports at run time as `SMC_INT_NO_CHECKVELOCITIES`
//! (1006) does not compile here.

mod check_velocities;
#[cfg(test)]
mod tests;

pub use check_velocities::{CheckError, CheckVelocities, CheckedElement, Limit};
