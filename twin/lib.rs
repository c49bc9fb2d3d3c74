//! A physics-backed digital twin for CNC machines.
//!
//! This library contains the code of the `twin` command; ARCHITECTURE.md describes its parts.

#[macro_use]
mod tell;

pub mod approach;
pub mod attached;
pub mod axis_kind;
pub mod cam;
pub mod check;
pub mod clock;
pub mod command;
pub mod compare;
pub mod coupled;
pub mod emulated;
pub mod finding;
pub mod hardware;
pub mod limit;
pub mod m_function;
pub mod machine;
pub mod number;
pub mod peak;
pub mod per_axis;
pub mod physics;
pub mod picture;
pub mod plant;
pub mod plot;
pub mod priority;
pub mod probe;
pub mod program;
pub mod real;
pub mod report;
pub mod section;
pub mod session;
pub mod setpoint;
pub mod setpoint_source;
pub mod simulated;
pub mod startup;
pub mod tappets;
pub mod workspace;

mod advice;
mod bounded;
mod by_hand;
mod in_loop;
mod job;
mod messages;
mod planning;
mod ring;
mod table;
mod text;
mod tolerance;
mod touch_probe;
