//! How axes and their blocks behave, cycle by cycle.

mod blocks;
mod direct;
mod framework;
mod gears;
mod homing;
mod invariants;
mod rig;
mod states;
mod switch;
mod tables;
mod targets;
