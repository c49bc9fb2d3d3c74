//! Words of the controls that are not in the table.
//!
//! Feeds: `planner.c` of grblHAL and FluidNC, and Fanuc's operator's manual of the series 15i (parameter HTG).

use crate::rs274::control::{Control, Reading, row};
use crate::rs274::word::MWords;

impl Control {
    /// The lines before the first move: modes that the program relies on.
    pub(super) fn header(self) -> &'static str {
        match self {
            Self::Fanuc => "G21\nG17 G90 G94 G40 G49 G80 G54\n",
            _ => "G21 G17 G90 G94 G91.1\nG40 G49 G80 G54\n",
        }
    }

    /// Decimals of lengths (mm) and angles (degrees).
    pub(super) fn decimals(self) -> usize {
        // More are lost in increments of a micrometre.
        if self == Self::Fanuc { 3 } else { 4 }
    }

    /// What it does with `word` if the writer cannot use it.
    pub(super) fn refusal(self, word: &str) -> Option<&'static str> {
        // Words that others use for something else: Fanuc's pitch is F, and Mach3 has three names for A, B and C.
        let is_own = matches!((self, word), (Self::Fanuc, "G33") | (Self::Mach3, "U" | "V" | "W"));
        let number: Option<u16> = word.strip_prefix('M').and_then(|number| number.parse().ok());
        let others = number.and_then(|_| row("other M words"));
        let cell = row(word).or(others)?.cell(self)?;
        // User functions are macros in LinuxCNC, too; others there are means something else.
        let is_standard = |it| it < 10 || (it == 19 && self == Self::Fanuc);
        let is_other =
            cell.reading == Reading::Different && number.is_some_and(|it| !is_standard(it));
        let is_macro =
            self == Self::Mach3 && number.is_some_and(|it| it >= 100 || !MWords::knows(it));
        let refused = cell.reading == Reading::Refused || is_own || (is_other && !is_macro);
        refused.then_some(cell.reason)
    }
}
