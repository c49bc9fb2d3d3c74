//! Colour palette: one colour per thing, the same in 3D and in the plots.
//!
//! From "Color Universal Design" by Okabe and Ito (2008), distinct for any colour vision.

use rerun::Color;

macro_rules! colors {
    ($($(#[$doc:meta])* $name:ident($red:literal, $green:literal, $blue:literal);)*) => {
        $($(#[$doc])* pub(crate) fn $name() -> Color {
            Color::from_rgb($red, $green, $blue)
        })*
    };
}

colors! {
    /// Set-point of the tool: sky blue.
    setpoint(86, 180, 233);
    /// The twin: bluish green.
    twin(0, 178, 130);
    /// The drives: orange.
    drives(230, 159, 0);
    /// Between drives and twin: reddish purple.
    between(204, 121, 167);
    /// Programmed cutting moves: light grey.
    cut(190, 196, 204);
    /// Limits: light grey, like programmed values.
    limit(190, 196, 204);
    /// Programmed rapids: yellow, drawn thin.
    rapid(240, 228, 66);
    /// Programmed probing moves: blue.
    probing(0, 114, 178);
    /// The path after preparation: vermilion.
    prepared(213, 94, 0);
}

/// Colour of a clearance, from `part` 1 (yellow) to contact, 0 or less (vermilion to red).
pub(crate) fn nearness(part: f64) -> Color {
    let steps = (1_u16..=16).take_while(|step| part <= 1.0 - f64::from(*step) / 16.0);
    mixed(rapid(), [230, 30, 45], steps.last().unwrap_or(0))
}

/// The same hue for the `index`-th axis: full, darker, lighter, and again.
pub(crate) fn shade(color: Color, index: usize) -> Color {
    match index % 4 {
        0 => color,
        1 => mixed(color, [255; 3], 9),
        2 => mixed(color, [0; 3], 7),
        _ => mixed(color, [255; 3], 4),
    }
}

/// A colour with `sixteenths` of `end`.
fn mixed(color: Color, end: [u8; 3], sixteenths: u16) -> Color {
    let [r, g, b, a] = color.to_array();
    let towards = |byte: u8, end: u8| {
        let mixed = (u16::from(byte) * (16 - sixteenths) + u16::from(end) * sixteenths) / 16;
        u8::try_from(mixed).unwrap_or(end)
    };
    let [red, green, blue] = end;
    Color::from_unmultiplied_rgba(towards(r, red), towards(g, green), towards(b, blue), a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearer_the_redder() {
        assert_eq!(nearness(1.0), rapid());
        assert_eq!(nearness(f64::NAN), rapid());
        assert_eq!(nearness(0.0), Color::from_rgb(230, 30, 45));
        assert_eq!(nearness(-3.0), nearness(0.0));
        let greens = [1.0, 0.8, 0.5, 0.2, 0.0].map(|part| nearness(part).to_array()[1]);
        assert!(greens.is_sorted_by(|far, near| far > near), "{greens:?}");
    }
}
