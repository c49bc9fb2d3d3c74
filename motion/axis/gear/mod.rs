//! Couplings to a master axis: gears, cams and phasing (manual 5.4).

mod cam;
mod follower;
mod in_pos;
mod phasing;
mod velocity;

pub use cam::{CamIn, CamRun};
pub use in_pos::{GearInPos, GearInPosRun};
pub use phasing::Phasing;
pub use velocity::{Decouple, GearIn};
