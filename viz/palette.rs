//! One colour per thing, the same in 3D and in the plots.
//!
//! From the palette of Okabe and Ito (2008), "Color Universal Design", which people with any colour vision can tell
//! apart.

use rerun::Color;

/// Where the tool should be: sky blue.
pub(crate) fn setpoint() -> Color {
    Color::from_rgb(86, 180, 233)
}

/// Where the physics machine has it: bluish green.
pub(crate) fn twin() -> Color {
    Color::from_rgb(0, 178, 130)
}

/// Where the drives have it: orange.
pub(crate) fn drives() -> Color {
    Color::from_rgb(230, 159, 0)
}

/// Between drives and twin: reddish purple.
pub(crate) fn between() -> Color {
    Color::from_rgb(204, 121, 167)
}

/// Programmed cutting moves: light grey.
pub(crate) fn cut() -> Color {
    Color::from_rgb(190, 196, 204)
}

/// What cannot be exceeded: light grey, as what is programmed.
pub(crate) fn limit() -> Color {
    cut()
}

/// Programmed rapids: yellow, drawn thin.
pub(crate) fn rapid() -> Color {
    Color::from_rgb(240, 228, 66)
}

/// Programmed probing moves: blue.
pub(crate) fn probing() -> Color {
    Color::from_rgb(0, 114, 178)
}

/// The path after preparation: vermilion.
pub(crate) fn prepared() -> Color {
    Color::from_rgb(213, 94, 0)
}

/// The same hue for the `index`-th axis: full, darker, lighter, and again.
pub(crate) fn shade(color: Color, index: usize) -> Color {
    let [r, g, b, a] = color.to_array();
    let towards = |byte: u8, end: u8, sixteenths: u16| {
        let mixed = (u16::from(byte) * (16 - sixteenths) + u16::from(end) * sixteenths) / 16;
        u8::try_from(mixed).unwrap_or(end)
    };
    let all = |end, sixteenths| {
        Color::from_unmultiplied_rgba(
            towards(r, end, sixteenths),
            towards(g, end, sixteenths),
            towards(b, end, sixteenths),
            a,
        )
    };
    match index % 4 {
        0 => color,
        1 => all(255, 9),
        2 => all(0, 7),
        _ => all(255, 4),
    }
}
