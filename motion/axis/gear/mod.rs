//! Axes that follow another one (manual 5.4) and switches along an axis (manual 5.5).

mod approach;
mod cam;
mod follower;
mod in_pos;
mod phasing;
mod switch;
mod switched;
mod velocity;

pub(crate) use approach::{Approach, Gap};
pub use cam::{CamIn, CamRun};
pub use in_pos::{GearInPos, GearInPosRun};
pub use phasing::Phasing;
pub use switch::{CamSwitch, DigitalCamSwitch, SwitchDirection, SwitchOutputs, TappetMode, Track};
pub use velocity::{Decouple, GearIn};
