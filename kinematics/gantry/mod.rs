//! Gantries: axes that stand at right angles on each other (SoftMotion manual 8.2.1 to 8.2.3).

mod cartesian;

pub use cartesian::Gantry3;
