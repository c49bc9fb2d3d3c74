//! A physics-backed digital twin for CNC machines.
//!
//! This library contains the code of the `twin` command; ARCHITECTURE.md describes its parts.
//!
//! ```
//! use twin::check::{CheckOptions, check};
//! use twin::finding::{Rule, unfit};
//! use twin::limit::Limits;
//! use twin::program::{Dialect, ProgramFile};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A SCARA that reaches 450 mm; its programs start at (300, 0, 20) mm.
//! let machine = twin_machine::Machine::load("../machines/scara2.toml".as_ref())?;
//! let file = tempfile::NamedTempFile::with_suffix(".cnc")?;
//! let checked = |text: &str| -> Result<_, Box<dyn std::error::Error>> {
//!     std::fs::write(file.path(), text)?;
//!     let program = ProgramFile::new(file.path(), Some(Dialect::Din66025), Default::default())?;
//!     let options = CheckOptions { limits: Limits::Programmed, ..CheckOptions::default() };
//!     Ok(check(&machine, &program, options, &mut |_| {})?)
//! };
//! // By F and E alone, 40 mm at 50 mm/s and 500 mm/s² take 0.8 s + 0.1 s.
//! let near = checked("% near\nN10 G1 X340 F50 E500 E-500\n")?;
//! assert!(!unfit(&near.findings));
//! assert!((near.length - 0.04).abs() < 1e-12 && near.duration_ns / 1_000_000 == 900);
//! // 500 mm is out of reach, in line 2.
//! let far = checked("% far\nN10 G1 X500 F50 E500 E-500\n")?;
//! assert!(unfit(&far.findings));
//! assert!(far.findings.iter().any(|one| one.rule == Rule::Reach && one.line == 2));
//! # Ok(())
//! # }
//! ```

#[macro_use]
mod stderr;

pub mod approach;
pub mod attached;
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
pub mod program;
pub mod real;
pub mod report;
pub mod session;
pub mod setpoint;
pub mod setpoint_source;
pub mod simulated;
pub mod spindle;
pub mod startup;
pub mod workspace;

mod bridge;
mod cam;
mod in_loop;
mod job;
mod messages;
mod planning;
mod repair_commands;
mod rule;
mod table;
mod tolerance;
mod touch_probe;
mod troubleshooting;
