//! Path elements to planned motion.
//!
//! [`controller`] is the controller's own plan from the programmed F and E (`SMC_Interpolator`). [`time_optimal`] keeps the
//! limits of every axis and uses them: in two passes within velocities and accelerations, with convex programs where
//! jerk is limited. Both are iterators over the elements before them, so that memory is bounded by the look-ahead window.
//!
//! Lengths are metres, times seconds.
//!
//! ```
//! use twin_gcode::din66025::{Decoder, DecoderOptions, Failure, Item};
//! use twin_path::Marks;
//! use twin_path::prepare::{CheckError, Notices, Preparation};
//! use twin_planner::controller::{DEFAULT_CYCLE_NS, Interpolator, LookAhead};
//!
//! // 100 mm at 50 mm/s and 500 mm/s²: s/v + v/a = 2 s + 0.1 s.
//! let program = std::io::Cursor::new("% line\nN10 G1 X100 F50 E500 E-500\n");
//! let elements = Decoder::with_jumps(program, DecoderOptions::default()).map(|item| match item? {
//!     Item::Element(element) => Ok(element),
//!     Item::Warning(warning) => Err(warning.to_string().into()),
//! });
//! let stages = Preparation::for_marks(Marks::default());
//! let path = stages.check(elements, 0.1, &Notices::default());
//! let mut setpoints = Interpolator::new(LookAhead::new(path), DEFAULT_CYCLE_NS);
//! let mut fastest = 0.0_f64;
//! for setpoint in setpoints.by_ref() {
//!     let setpoint: Result<_, Box<dyn std::error::Error>> = setpoint;
//!     fastest = fastest.max(setpoint?.path_velocity);
//! }
//! assert!((fastest - 0.05).abs() < 1e-9, "m/s");
//! assert!((setpoints.duration() - 2.1).abs() < 1e-9, "s");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod blended_path;
pub mod controller;
pub mod extremes;
pub mod planned_motion;
pub mod time_optimal;
