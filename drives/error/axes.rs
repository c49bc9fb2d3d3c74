//! Axes by what their family calls them.

use std::fmt;

/// Axes of one device, as its manual calls them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// X Y Z A B: bit 0 = X … bit 4 = B (InterpCNC).
    Letters(u8),
    /// From 1: bit 0 = axis 1 (BIM2AX).
    Numbers(u8),
    /// The only one of its address, which is named before (SmartDRIVE).
    Only,
}

impl Axes {
    /// Whether it is the axis of this place, from 0, among those of its device.
    pub fn contains(self, place: usize) -> bool {
        match self {
            Self::Letters(mask) | Self::Numbers(mask) => place < 8 && mask >> place & 1 == 1,
            Self::Only => true,
        }
    }

    /// Unit of their counters, as the manuals call it.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Letters(_) => "steps",
            Self::Numbers(_) | Self::Only => "µsteps",
        }
    }

    /// At the end of a message, after what is so of them: ", axes X and Z".
    pub(super) fn listed(self) -> String {
        if self == Self::Only { String::new() } else { format!(", {self}") }
    }
}

impl fmt::Display for Axes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (mask, names) = match self {
            Self::Letters(mask) => (mask, "XYZAB"),
            Self::Numbers(mask) => (mask, "12345678"),
            Self::Only => return f.write_str("the axis"),
        };
        let here = |(place, _): &(usize, char)| mask >> place & 1 == 1;
        let chosen: Vec<char> =
            names.chars().enumerate().filter(here).map(|(_, name)| name).collect();
        f.write_str(if chosen.len() == 1 { "axis " } else { "axes " })?;
        for (place, name) in chosen.iter().enumerate() {
            let separator = match self {
                Self::Numbers(_) if place > 0 => ", ",
                _ => "",
            };
            write!(f, "{separator}{name}")?;
        }
        Ok(())
    }
}
