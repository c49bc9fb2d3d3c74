//! What all pictures have in common: pixels, colours, letters.

use plotters::prelude::*;

/// plotters draws on whole pixels; this many of them are one of the picture.
const FINE: u32 = 10;

pub(crate) const INK: RGBColor = RGBColor(34, 38, 46);
pub(crate) const FAINT: RGBColor = RGBColor(110, 116, 126);
pub(crate) const MARK: RGBColor = RGBColor(214, 39, 40);
/// Lines behind everything else.
pub(crate) const GRID: RGBColor = RGBColor(226, 229, 234);

/// Pixels of the page as plotters counts them.
pub(crate) fn fine(pixels: f64) -> i32 {
    #[expect(clippy::cast_possible_truncation, reason = "places on a page")]
    let fine = (pixels * f64::from(FINE)).round() as i32;
    fine
}

/// The width of a line.
pub(crate) fn stroke(pixels: f64) -> u32 {
    fine(pixels).unsigned_abs()
}

pub(crate) fn color([red, green, blue]: [u8; 3]) -> RGBColor {
    RGBColor(red, green, blue)
}

pub(crate) fn font(pixels: f64, color: RGBColor) -> TextStyle<'static> {
    ("sans-serif", pixels * f64::from(FINE)).into_font().color(&color)
}

/// A picture of `width` × `height`, as plotters counts, at its size; inside it counts finer.
pub(crate) fn resized(text: &str, (width, height): (u32, u32)) -> String {
    let of_page = |pixels: u32| f64::from(pixels) / f64::from(FINE);
    text.replacen(
        &format!(r#"width="{width}" height="{height}""#),
        &format!(r#"width="{}" height="{}""#, of_page(width), of_page(height)),
        1,
    )
}
