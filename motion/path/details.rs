//! Optional details of an element: extra axes, switches, parameters of M functions.

use std::fmt;

/// The letters of the extra axes, in the order of every array of them.
pub const EXTRA_AXES: [char; 5] = ['P', 'Q', 'U', 'V', 'W'];

/// Positions of the extra axes P Q U V W in their technical units u, as programmed: mm or degrees, whatever the
/// machine hangs on them.
pub type ExtraPosition = [f64; 5];

/// The largest number of switches of one element (`MAX_SWITCHES`).
pub const MAX_SWITCHES: usize = 3;

/// Optional details of an element; boxed, so that elements without them stay small.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Details {
    /// The extra axes, from the first block on that names one.
    pub extra: Option<ExtraAxes>,
    /// Axes that move with the S profile (manual 3.2, letter S): without velocity and acceleration at both ends.
    pub s_profile: AxisMask,
    /// Switches along the element, in the order in which the path passes them.
    pub switches: Switches,
    /// Parameters of an M function.
    pub parameters: MParameters,
    /// The spindle along the element, if the decoder is to keep it.
    pub spindle: Option<Spindle>,
    /// The third extra axis is U of RS274, in mm, not C.
    pub third_is_u: bool,
    /// Words of the block, if the decoder is to keep them.
    pub words: Option<Words>,
}

/// The spindle along an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spindle {
    /// Speed S in force, whether or not it turns, revolutions per minute.
    pub speed: f64,
    /// The angle of the spindle leads the tool (threads).
    pub synchronized: bool,
}

/// Words of the block of RS274 that an element comes from, for a writer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Words {
    /// Whether the block names X, Y, Z, A, B, C, U, V and W.
    pub named: [bool; 9],
    /// Positions of X, Y and Z in the machine frame to which the element goes (G28, G30, G53), m.
    pub machine: [Option<f64>; 3],
}

impl Details {
    /// True if there is nothing in it.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// Extra axis positions at the two ends of an element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExtraAxes {
    /// At the start, u.
    pub start: ExtraPosition,
    /// At the end, u.
    pub end: ExtraPosition,
}

impl ExtraAxes {
    /// Euclidean length of the motion, u.
    pub fn length(&self) -> f64 {
        self.start
            .iter()
            .zip(self.end)
            .map(|(start, end)| (end - start).powi(2))
            .sum::<f64>()
            .sqrt()
    }
}

/// A set of axes, as in `SMC_POSINFO.wAuxData` and `wSProfile` (manual 6.5): bits 0 to 2 are X Y Z, 6 to 10 are
/// P Q U V W.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct AxisMask(pub u16);

impl AxisMask {
    /// Z alone (S3).
    pub const Z: Self = Self(1 << 2);
    /// P; Q U V W follow.
    const FIRST_EXTRA: u16 = 1 << 6;

    /// The extra axis number `index` of [`EXTRA_AXES`] alone.
    pub const fn extra(index: usize) -> Self {
        Self(if index < EXTRA_AXES.len() { Self::FIRST_EXTRA << index } else { 0 })
    }

    /// The axis of an S word, 3 = Z and 7 to 11 = P Q U V W; none for other numbers.
    pub const fn from_s_number(number: u8) -> Option<Self> {
        match number {
            3 | 7..=11 => Some(Self(1 << (number - 1))),
            _ => None,
        }
    }

    /// True if all axes of `other` are in it.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Both sets.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The axes that are not in `other`.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }
}

/// A switch point (H word, manual 3.2.1): when the path passes it, a bit is set or cleared.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Switch {
    /// Number of the switch, 1 to 32 (`dwSwitches` bit `number − 1`).
    pub number: u8,
    /// Switched on, else off.
    pub on: bool,
    /// Part of the element's length from its start, 0 to 1 (`dHelpPos`).
    pub at: f64,
}

/// The switches of an element: at most [`MAX_SWITCHES`], ordered by position.
#[derive(Clone, Copy, Default, PartialEq)]
pub struct Switches {
    items: [Switch; MAX_SWITCHES],
    count: u8,
}

impl Switches {
    /// Adds one, behind those at the same position; false if there is no room.
    #[must_use]
    pub fn add(&mut self, switch: Switch) -> bool {
        let count = usize::from(self.count);
        let Some(slot) = self.items.get_mut(count) else { return false };
        *slot = switch;
        self.count += 1;
        if let Some(items) = self.items.get_mut(..=count) {
            items.sort_by(|a, b| a.at.total_cmp(&b.at));
        }
        true
    }

    /// The switches, in order of position.
    pub fn as_slice(&self) -> &[Switch] {
        self.items.get(..usize::from(self.count)).unwrap_or_default()
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }
}

impl fmt::Debug for Switches {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.as_slice()).finish()
    }
}

/// Parameters of an M function (manual 3.2.2 and 6.2.10).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MParameters {
    /// K (`dT1`).
    pub k: Option<f64>,
    /// L (`dT2`).
    pub l: Option<f64>,
    /// The parameter set (`SMC_M_PARAMETERS` dP1 to dP8) that O names, or else the global `gSMC_MParameters`, among those
    /// given with the program.
    pub o: Option<[f64; 8]>,
}
