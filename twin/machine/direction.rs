//! Tool direction, for machines that can turn the tool.

use crate::additional_axis;
use crate::section::Section;
use twin_kinematics::ToPath;
use twin_path::EXTRA_AXES;
use twin_planner::controller::ToolSetpoint;

/// Source of the tool direction (`[kinematics]`, `direction`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DirectionRule {
    /// The path, as `SMC_CalcDirectionFromVector` has it, turned by so much more, rad.
    Path(ToPath, f64),
    /// It stays so, rad in the work frame.
    Fixed(f64),
    /// The additional axis of this number, in degrees: P Q U V W are 0 to 4 (in RS274 A B C are P Q U), turned by so much
    /// more, rad.
    Additional(u8, f64),
}

#[derive(Clone, Copy)]
enum Word {
    Path(ToPath),
    Fixed,
    Additional(u8),
}

impl DirectionRule {
    /// Reads the keys `direction` and `direction_deg` of `[kinematics]` for a machine of this kind.
    pub(super) fn read(kinematics: &Section<'_>, turns_tool: bool, kind: &str) -> Self {
        if !turns_tool {
            for key in ["direction", "direction_deg"] {
                if kinematics.has(key) {
                    kinematics.accept(key);
                    kinematics
                        .complain_at(key, format!("`{key}`: a {kind} does not turn its tool"));
                }
            }
            return Self::Fixed(0.0);
        }
        let names = EXTRA_AXES.map(|letter| letter.to_string());
        let mut words = vec![
            ("tangential", Word::Path(ToPath::Tangential)),
            ("opposite", Word::Path(ToPath::Opposite)),
            ("right", Word::Path(ToPath::Right)),
            ("left", Word::Path(ToPath::Left)),
            ("fixed", Word::Fixed),
        ];
        let additional =
            names.iter().filter_map(|name| Some((name, additional_axis::number(name)?)));
        words.extend(additional.map(|(name, number)| (name.as_str(), Word::Additional(number))));
        let default =
            if kind.starts_with("scara") { Word::Fixed } else { Word::Path(ToPath::Tangential) };
        let word = kinematics.choice("direction", &words).unwrap_or(default);
        let angle = kinematics.number("direction_deg", -360.0..=360.0);
        let angle = angle.unwrap_or_default().to_radians();
        match word {
            Word::Path(to_path) => Self::Path(to_path, angle),
            Word::Fixed => Self::Fixed(angle),
            Word::Additional(number) => Self::Additional(number, angle),
        }
    }

    /// The direction (rad) at a set-point, its rate and its acceleration.
    pub fn at(&self, tool: &ToolSetpoint) -> [f64; 3] {
        match *self {
            Self::Path(to_path, angle) => {
                let heading = &tool.heading;
                [heading.along + to_path.offset() + angle, heading.rate, heading.acceleration]
            }
            Self::Fixed(angle) => [angle, 0.0, 0.0],
            Self::Additional(number, angle) => {
                let extra = &tool.extra;
                let [direction, rate, acceleration] =
                    [&extra.position, &extra.velocity, &extra.acceleration].map(|values| {
                        values.get(usize::from(number)).copied().unwrap_or_default().to_radians()
                    });
                [direction + angle, rate, acceleration]
            }
        }
    }

    /// The direction at which a program starts, rad in the work frame.
    pub(crate) fn at_start(&self) -> f64 {
        match *self {
            Self::Path(to_path, angle) => to_path.offset() + angle,
            Self::Fixed(angle) | Self::Additional(_, angle) => angle,
        }
    }

    /// The additional axis that turns the tool.
    pub const fn additional(&self) -> Option<u8> {
        match *self {
            Self::Additional(number, _) => Some(number),
            Self::Path(..) | Self::Fixed(_) => None,
        }
    }
}
