//! SCARAs: arms that turn about vertical axes (SoftMotion manual 8.2.4 and 8.2.5).

#[cfg(test)]
mod tests;
mod two_link;

pub use two_link::{Elbow, Scara2};
