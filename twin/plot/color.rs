//! Colours, line styles and fills.

use std::fmt;

/// Text and main lines.
pub const INK: Color = Color::rgb(34, 38, 46);
/// Frames, ticks and secondary text.
pub const FAINT: Color = Color::rgb(110, 116, 126);
/// Lines behind everything else.
pub(crate) const GRID: Color = Color::rgb(226, 229, 234);
/// Limits and marked places.
pub const MARK: Color = Color::rgb(214, 39, 40);
/// Lines that stand back: earlier states, references.
pub const BACK: Color = Color::rgb(160, 166, 176);

/// Okabe and Ito (2008), in an order that begins with those dark enough for lines.
const SERIES: [[u8; 3]; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [120, 90, 40],
    [120, 120, 120],
];

/// Viridis in tenths: readable with any colour vision, and in order without colours.
const VIRIDIS: [[u8; 3]; 11] = [
    [68, 1, 84],
    [72, 36, 117],
    [65, 68, 135],
    [53, 95, 141],
    [42, 120, 142],
    [33, 145, 140],
    [34, 168, 132],
    [68, 191, 112],
    [122, 209, 81],
    [189, 223, 38],
    [253, 231, 37],
];

/// A colour and its opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Color {
    rgb: [u8; 3],
    opacity: f64,
}

impl Color {
    /// Opaque, from red, green and blue.
    pub const fn rgb(red: u8, green: u8, blue: u8) -> Self {
        Self { rgb: [red, green, blue], opacity: 1.0 }
    }

    /// The same colour with an opacity from 0 to 1.
    #[must_use]
    pub const fn with_opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }

    /// The colour of the `index`-th series; after the last they repeat.
    pub fn series(index: usize) -> Self {
        let [red, green, blue] = SERIES.get(index % SERIES.len()).copied().unwrap_or_default();
        Self::rgb(red, green, blue)
    }

    /// From dark (0) to bright (1).
    #[expect(clippy::indexing_slicing, reason = "three channels of three")]
    pub fn viridis(part: f64) -> Self {
        let place = part.clamp(0.0, 1.0) * 10.0;
        let mut rows = VIRIDIS.iter().zip(VIRIDIS.iter().skip(1)).zip((0_u32..).map(f64::from));
        let found = rows.find(|(_, below)| place <= below + 1.0);
        let Some(((low, high), below)) = found else { return INK };
        let [red, green, blue] = std::array::from_fn(|channel| {
            let [low, high] = [low, high].map(|row| f64::from(row[channel]));
            byte(low + (high - low) * (place - below))
        });
        Self::rgb(red, green, blue)
    }

    /// From red, green and blue between 0 and 1.
    pub fn from_parts(parts: [f64; 3]) -> Self {
        let [red, green, blue] = parts.map(|part| byte(part * 255.0));
        Self::rgb(red, green, blue)
    }

    /// Red, green and blue.
    pub const fn channels(self) -> [u8; 3] {
        self.rgb
    }

    fn attribute(self, f: &mut fmt::Formatter<'_>, name: &str) -> fmt::Result {
        write!(f, " {name}=\"{self}\"")?;
        if self.opacity < 1.0 {
            write!(f, " {name}-opacity=\"{}\"", self.opacity)?;
        }
        Ok(())
    }
}

fn byte(value: f64) -> u8 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
    let byte = value.clamp(0.0, 255.0).round() as u8;
    byte
}

impl fmt::Display for Color {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [red, green, blue] = self.rgb;
        write!(f, "#{red:02X}{green:02X}{blue:02X}")
    }
}

/// Colour, width and dashes of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub color: Color,
    /// Pixels.
    pub width: f64,
    /// Length of dashes and gaps, pixels.
    pub dash: Option<[f64; 2]>,
}

impl Stroke {
    /// A line without gaps.
    pub const fn solid(color: Color, width: f64) -> Self {
        Self { color, width, dash: None }
    }

    /// A dashed line.
    pub const fn dashed(color: Color, width: f64) -> Self {
        Self { color, width, dash: Some([6.0, 4.0]) }
    }
}

/// Fill and edge of a shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Paint {
    /// The fill.
    pub fill: Option<Color>,
    /// The edge.
    pub edge: Option<Stroke>,
}

impl From<Stroke> for Paint {
    fn from(edge: Stroke) -> Self {
        Self { fill: None, edge: Some(edge) }
    }
}

impl From<Color> for Paint {
    fn from(fill: Color) -> Self {
        Self { fill: Some(fill), edge: None }
    }
}

/// A paint as attributes, in a picture of which `scale` pixels are one unit.
pub(super) struct Attributes(pub(super) Paint, pub(super) f64);

impl fmt::Display for Attributes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(Paint { fill, edge }, scale) = self;
        match fill {
            Some(fill) => fill.attribute(f, "fill")?,
            None => f.write_str(" fill=\"none\"")?,
        }
        let Some(Stroke { color, width, dash }) = edge else { return Ok(()) };
        color.attribute(f, "stroke")?;
        let length = |pixels: f64| format!("{:.6}", pixels / scale).parse().unwrap_or(0.0_f64);
        write!(f, " stroke-width=\"{}\"", length(*width))?;
        if let Some([dash, gap]) = dash {
            write!(f, " stroke-dasharray=\"{} {}\"", length(*dash), length(*gap))?;
        }
        Ok(())
    }
}
