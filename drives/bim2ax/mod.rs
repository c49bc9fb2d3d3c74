//! BIBOX BIM2AX-BOCM, a module for two stepper axes behind a dual-port RAM.
//!
//! Source: "Module BIM2AX-BOCM, Manuel d'utilisation", MUT/0712/0206D, revision D of May 2013.

#[expect(dead_code, reason = "the emulated module reads the rest")]
mod axis;
pub mod bits;
#[expect(dead_code, reason = "the driver measures its exchanges")]
mod follow;
mod mode;
mod rehearsal;

pub use axis::{
    AxisSettings, Bench, Contact, EncoderBench, EncoderKind, MOST_POSITION, REFERENCES,
};
pub use mode::DriveMode;
pub use rehearsal::{Bim2AxRehearsal, RehearsalOptions};

/// Axes of a module.
pub const AXES: usize = 2;
