//! Blocks that power, move and stop an axis (manual 5.3).

mod planned;
mod power;
mod stop;
mod target;
mod velocity;

pub(crate) use planned::Planned;
pub use power::{Power, PowerStatus};
pub use stop::{Halt, Stop};
pub use target::{MoveAbsolute, MoveAdditive, MoveRelative};
pub use velocity::MoveVelocity;
