//! Number formats for messages, and for other programs.
//!
//! ```
//! use twin_number::{Short, exact_seconds, readable};
//!
//! // 240 mm/s that conversion from m/s has turned into 239.99999999999997.
//! assert_eq!(Short(239.999_999_999_999_97).to_string(), "240");
//! // An axis position of 361.12773 mm with six significant digits.
//! assert_eq!(readable(361.127_73, 6), "361.128");
//! // A time stamp of 1.5 s in nanoseconds.
//! assert_eq!(exact_seconds(1_500_000_000), "1.5");
//! ```

mod short;
#[cfg(test)]
mod tests;
mod text;

pub use short::Short;
pub use text::{
    apart, at_most, beside, counted, exact_seconds, fixed, readable, rounded, seconds, significant,
    without_dust,
};
