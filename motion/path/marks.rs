//! Marks of a path element: begin and end of path preparation.

/// Begin (with this element) and end (behind it) of path preparation: `SMC_GEOINFO.byInternMark`, bit by bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Marks(pub u8);

impl Marks {
    /// Tool radius correction ends behind this element (G40).
    pub const CORRECTION_END: Self = Self(1 << 0);
    /// Tool radius correction to the left begins with this element (G41).
    pub const CORRECTION_LEFT: Self = Self(1 << 1);
    /// Tool radius correction to the right begins with this element (G42).
    pub const CORRECTION_RIGHT: Self = Self(1 << 2);
    /// Smoothing or rounding ends behind this element (G50).
    pub const CORNERS_END: Self = Self(1 << 3);
    /// Smoothing by splines begins with this element (G51).
    pub const SMOOTHING: Self = Self(1 << 4);
    /// Rounding by arcs begins with this element (G52).
    pub const ROUNDING: Self = Self(1 << 5);
    /// Loop avoidance ends behind this element (G60).
    pub const LOOPS_END: Self = Self(1 << 6);
    /// Loop avoidance begins with this element (G61).
    pub const LOOPS: Self = Self(1 << 7);

    /// True if all of `other` are set.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Both.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Those not in `other`.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }
    /// Those that begin something with their element.
    pub const STARTS: Self = Self::CORRECTION_LEFT
        .with(Self::CORRECTION_RIGHT)
        .with(Self::SMOOTHING)
        .with(Self::ROUNDING)
        .with(Self::LOOPS);
}

/// Start marks and the mark that ends them.
pub(super) const PAIRS: [(Marks, Marks); 3] = [
    (Marks::CORRECTION_LEFT.with(Marks::CORRECTION_RIGHT), Marks::CORRECTION_END),
    (Marks::SMOOTHING.with(Marks::ROUNDING), Marks::CORNERS_END),
    (Marks::LOOPS, Marks::LOOPS_END),
];

impl Marks {
    /// Left for right.
    pub(super) fn mirrored(self) -> Self {
        let mut mirrored = self.without(Self::CORRECTION_LEFT).without(Self::CORRECTION_RIGHT);
        if self.contains(Self::CORRECTION_LEFT) {
            mirrored = mirrored.with(Self::CORRECTION_RIGHT);
        }
        if self.contains(Self::CORRECTION_RIGHT) {
            mirrored = mirrored.with(Self::CORRECTION_LEFT);
        }
        mirrored
    }

    /// The start marks that exclude one another with these.
    #[must_use]
    pub fn rivals(self) -> Self {
        let groups = PAIRS.iter().filter(|(starts, _)| self.0 & starts.0 != 0);
        groups.fold(Self::default(), |rivals, (starts, _)| rivals.with(*starts))
    }

    /// The start marks of what these end.
    #[must_use]
    pub fn begun(self) -> Self {
        let groups = PAIRS.iter().filter(|(_, end)| self.0 & end.0 != 0);
        groups.fold(Self::default(), |begun, (starts, _)| begun.with(*starts))
    }

    /// The marks that end what these begin.
    pub(super) fn endings(self) -> Self {
        let ends = PAIRS.iter().filter(|(starts, _)| self.0 & starts.0 != 0);
        ends.fold(Self::default(), |ends, (_, end)| ends.with(*end))
    }
}
