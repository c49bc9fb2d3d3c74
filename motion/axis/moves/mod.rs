//! Motion blocks: power, moves and stops of an axis (manual 2.2, 5.3).

mod continuous;
mod direct;
mod home;
mod planned;
mod power;
mod probe;
mod reset;
mod stop;
mod superimposed;
mod table;
mod target;
mod velocity;

pub use continuous::{MoveContinuousAbsolute, MoveContinuousRelative};
pub(crate) use direct::exceeds;
pub use direct::{ControlAxis, ControlAxisBy, ControlOutputs, Follow, Watched};
pub use home::Home;
pub use planned::{Planned, PlannedMotion};
pub use power::{Power, PowerStatus};
pub use probe::{AbortTrigger, Probed, TouchProbe, Trigger};
pub use reset::Reset;
pub use stop::{Halt, Stop};
pub use superimposed::{MoveSuperImposed, SuperImposed};
pub use table::{AccelerationProfile, Points, PositionProfile, TableRun, VelocityProfile};
pub use target::{MoveAbsolute, MoveAdditive, MoveRelative};
pub use velocity::MoveVelocity;
