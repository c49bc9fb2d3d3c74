//! Single axes: how they move from point to point and from velocity to velocity (manual chapters 2 and 5).
//!
//! All quantities are in the technical unit u of the axis, as SoftMotion has them: u, u/s, u/s², u/s³.

pub mod profile;
