//! SCARAs: arms that turn about vertical axes (SoftMotion manual 8.2.4 and 8.2.5).

mod chain;
mod three_link;
mod two_link;

pub use three_link::{Scara3, ThreeLinks};
pub use two_link::{Elbow, Scara2, TwoLinks};
