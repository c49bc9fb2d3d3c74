//! Path elements to planned motion.
//!
//! [`controller`] is the controller's own plan from the programmed F and E (`SMC_Interpolator`). [`time_optimal`] keeps the
//! limits of every axis and uses them: Clarabel where jerk, torque or limits of the tool bind. Both are iterators over
//! the elements before them, so that memory is bounded by the look-ahead window.
//!
//! Lengths are metres, times seconds.

pub mod controller;
pub mod time_optimal;
