//! Numbers as messages show them, and as other programs read them.

mod short;
mod text;

pub use short::Short;
pub use text::{
    apart, at_most, beside, counted, exact_seconds, fixed, readable, rounded, seconds, significant,
    without_dust,
};
