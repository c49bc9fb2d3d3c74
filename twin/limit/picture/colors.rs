//! Colours of axes and limits.

use super::KINDS;
use crate::page::color;
use plotters::style::RGBColor;

/// Colours of axes by place in the machine (Okabe and Ito 2008), those first that are dark enough for lines.
const AXES: [[u8; 3]; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [120, 90, 40],
    [120, 120, 120],
];

/// Colours of limits that are of no axis.
pub(super) const OTHERS: [[u8; 3]; KINDS.len()] = [
    [214, 218, 224],
    [160, 166, 176],
    [128, 112, 168],
    [110, 116, 126],
    [34, 38, 46],
    [176, 150, 110],
];

/// That of an axis by its place.
pub(super) fn color_of(axis: usize) -> RGBColor {
    color(AXES.get(axis % AXES.len()).copied().unwrap_or_default())
}
