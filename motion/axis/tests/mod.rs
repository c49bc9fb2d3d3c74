//! How axes and their blocks behave, cycle by cycle.

mod blocks;
mod direct;
mod framework;
mod gears;
mod homing;
mod rig;
mod states;
mod switch;
mod targets;
