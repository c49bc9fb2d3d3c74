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
    /// Additional axis of this number (P Q U V W: 0 to 4; A B C of RS274 are P Q U), degrees, plus an angle, rad.
    Additional(u8, f64),
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
            ("tangential", Self::Path(ToPath::Tangential, 0.0)),
            ("opposite", Self::Path(ToPath::Opposite, 0.0)),
            ("right", Self::Path(ToPath::Right, 0.0)),
            ("left", Self::Path(ToPath::Left, 0.0)),
            ("fixed", Self::Fixed(0.0)),
        ];
        let additional =
            names.iter().filter_map(|name| Some((name, additional_axis::number(name)?)));
        words.extend(
            additional.map(|(name, number)| (name.as_str(), Self::Additional(number, 0.0))),
        );
        let is_scara = kind.starts_with("scara");
        let default = if is_scara { Self::Fixed(0.0) } else { Self::Path(ToPath::Tangential, 0.0) };
        let word = kinematics.choice("direction", &words).unwrap_or(default);
        let angle = kinematics.number("direction_deg", -360.0..=360.0);
        let angle = angle.unwrap_or_default().to_radians();
        match word {
            Self::Path(to_path, _) => Self::Path(to_path, angle),
            Self::Fixed(_) => Self::Fixed(angle),
            Self::Additional(number, _) => Self::Additional(number, angle),
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
