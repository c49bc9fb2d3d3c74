//! Clearance along a program: block by block as a table (CSV), and over time as a picture (SVG).
//!
//! Both are fed set-point by set-point and hold no more than a page shows, however long the program is.

mod csv;
mod picture;
#[cfg(test)]
mod tests;

pub use csv::ClearanceCsv;
pub use picture::ClearancePicture;
