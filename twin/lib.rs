//! A physics-backed digital twin for CNC machines.
//!
//! This library contains the code of the `twin` command; ARCHITECTURE.md describes its parts.

#[macro_use]
mod stderr;

pub mod attached;
pub mod cam;
pub mod check;
pub mod clock;
pub mod command;
pub mod compare;
pub mod emulated;
pub mod finding;
pub mod hardware;
pub mod limit;
pub mod live_view;
pub mod m_function;
pub mod peak;
pub mod per_axis;
pub mod plant;
pub mod priority;
pub mod probe;
pub mod program;
pub mod real;
pub mod report;
pub mod session;
pub mod setpoint;
pub mod setpoint_source;
pub mod simulated;
pub mod startup;
pub mod workspace;

mod bridge;
mod in_loop;
mod job;
mod messages;
mod planning;
mod repair_commands;
mod table;
mod tolerance;
mod touch_probe;
mod troubleshooting;
