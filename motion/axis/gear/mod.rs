//! Couplings to a master axis: gears, cams and phasing (manual 5.4), and cam switches along an axis (manual 5.5).

mod cam;
mod cam_switch_track;
mod follower;
mod in_pos;
mod phasing;
mod switch;
mod track;
mod velocity;

pub use cam::{CamIn, CamRun};
pub use in_pos::{GearInPos, GearInPosRun};
pub use phasing::Phasing;
pub use switch::{DigitalCamSwitch, SwitchOutputs, TappetMode};
pub use track::{CamSwitch, SwitchDirection, Track};
pub use velocity::{Decouple, GearIn};
