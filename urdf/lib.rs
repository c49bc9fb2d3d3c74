//! A machine as links and joints: the one source of geometry for physics and pictures.

mod model;

pub use model::{Inertial, Joint, JointKind, Link, Model, Solid, SolidShape, Tip};
