//! A machine as links and joints: the one source of geometry for physics and pictures.
//!
//! A [`Model`] is generated from the dimensions of a machine ([`ScaraDimensions`], [`GantryDimensions`]) or read from
//! URDF ([`Model::from_urdf`]), and written as URDF ([`Model::to_urdf`]). [`Model::link_poses`] says where its links
//! are.

mod error;
mod generate;
mod inertial;
mod model;
mod pose;

pub use error::DimensionError;
pub use generate::{GantryDimensions, MachineJoint, ScaraDimensions};
pub use model::{Inertial, Joint, JointKind, Link, Model, Solid, SolidShape, Tip};
