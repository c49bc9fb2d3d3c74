//! How axes and their blocks behave, cycle by cycle.

mod framework;
mod rig;
mod states;
mod targets;
