//! Colours of what is told apart by its place in a list.

use crate::page::color;
use plotters::style::RGBColor;

/// Okabe and Ito (2008), those first that are dark enough for lines.
const COLORS: [[u8; 3]; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [120, 90, 40],
    [120, 120, 120],
];

/// That of the `index`-th; behind the last they begin again.
pub(crate) fn color_of(index: usize) -> RGBColor {
    color(COLORS.get(index % COLORS.len()).copied().unwrap_or_default())
}
