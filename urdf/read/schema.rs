//! Schema of URDF: required and optional attributes and elements, as far as the reader uses them.

/// Type of an attribute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    Text,
    /// So many numbers.
    Numbers(usize),
    /// Of an axis, from 0.
    Index,
    JointType,
}

impl Form {
    /// Description of the expected value, for messages.
    pub(super) const fn expected(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Numbers(1) => "a number",
            Self::Numbers(3) => "three numbers",
            Self::Numbers(_) => "four numbers",
            Self::Index => "a whole number from 0 to 255",
            Self::JointType => {
                "revolute, continuous, prismatic, fixed, floating, planar or spherical"
            }
        }
    }

    pub(super) fn fits(self, value: &str) -> bool {
        match self {
            Self::Text => true,
            Self::Index => value.parse::<u8>().is_ok(),
            Self::Numbers(count) => {
                value.split_whitespace().count() == count
                    && value.split_whitespace().all(|word| word.parse::<f64>().is_ok())
            }
            Self::JointType => {
                ["revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical"]
                    .contains(&value)
            }
        }
    }
}

/// An element: attributes that it must have, those it may have, elements that it has once, at most once, any number of times.
#[derive(Debug)]
pub(super) struct Rule {
    pub(super) required: &'static [(&'static str, Form)],
    pub(super) optional: &'static [(&'static str, Form)],
    pub(super) once: &'static [&'static str],
    pub(super) at_most_once: &'static [&'static str],
    pub(super) many: &'static [&'static str],
}

const NOTHING: Rule =
    Rule { required: &[], optional: &[], once: &[], at_most_once: &[], many: &[] };

/// The shapes of a `<geometry>`, which has one of them.
pub(super) const SHAPES: [&str; 5] = ["box", "cylinder", "capsule", "sphere", "mesh"];

const NUMBER: Form = Form::Numbers(1);
const THREE: Form = Form::Numbers(3);

/// Attributes that are numbers.
#[expect(clippy::indexing_slicing, reason = "both arrays have N elements")]
const fn numbers<const N: usize>(names: [&'static str; N]) -> [(&'static str, Form); N] {
    let mut attributes = [("", NUMBER); N];
    let mut index = 0;
    while index < N {
        attributes[index].0 = names[index];
        index += 1;
    }
    attributes
}

/// Rule of `element`. `limits_are_optional`: since URDF 1.2.
pub(super) fn rule(element: &str, limits_are_optional: bool) -> Option<Rule> {
    Some(match element {
        "robot" => {
            Rule { at_most_once: &["twin"], many: &["link", "joint", "material"], ..NOTHING }
        }
        "link" => Rule {
            required: &[("name", Form::Text)],
            at_most_once: &["inertial"],
            many: &["visual", "collision"],
            ..NOTHING
        },
        "inertial" => Rule { once: &["mass", "inertia"], at_most_once: &["origin"], ..NOTHING },
        "visual" => Rule { once: &["geometry"], at_most_once: &["origin", "material"], ..NOTHING },
        "collision" => Rule { once: &["geometry"], at_most_once: &["origin"], ..NOTHING },
        "geometry" => Rule { at_most_once: &SHAPES, ..NOTHING },
        "box" => Rule { required: &[("size", THREE)], ..NOTHING },
        "cylinder" | "capsule" => {
            Rule { required: &[("radius", NUMBER), ("length", NUMBER)], ..NOTHING }
        }
        "sphere" => Rule { required: &[("radius", NUMBER)], ..NOTHING },
        "mesh" => {
            Rule { required: &[("filename", Form::Text)], optional: &[("scale", THREE)], ..NOTHING }
        }
        "origin" => Rule {
            optional: &[
                ("xyz", THREE),
                ("rpy", THREE),
                ("quat_xyzw", Form::Numbers(4)),
                (crate::QUATERNION, Form::Numbers(4)),
            ],
            ..NOTHING
        },
        "mass" => Rule { required: &[("value", NUMBER)], ..NOTHING },
        "inertia" => Rule {
            required: const { &numbers(["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]) },
            ..NOTHING
        },
        "material" => Rule {
            required: &[("name", Form::Text)],
            at_most_once: &["color", "texture"],
            ..NOTHING
        },
        "color" => Rule { required: &[("rgba", Form::Numbers(4))], ..NOTHING },
        "texture" => Rule { required: &[("filename", Form::Text)], ..NOTHING },
        _ => return of_joint(element, limits_are_optional),
    })
}

fn of_joint(element: &str, limits_are_optional: bool) -> Option<Rule> {
    Some(match element {
        "joint" => Rule {
            required: &[("name", Form::Text), ("type", Form::JointType)],
            once: &["parent", "child"],
            at_most_once: &[
                "origin",
                "axis",
                "limit",
                "calibration",
                "dynamics",
                "mimic",
                "safety_controller",
            ],
            ..NOTHING
        },
        "parent" | "child" => Rule { required: &[("link", Form::Text)], ..NOTHING },
        "axis" => Rule { required: &[("xyz", THREE)], ..NOTHING },
        "limit" => {
            const ALL: &[(&str, Form)] = &numbers([
                "velocity",
                "lower",
                "upper",
                "effort",
                "acceleration",
                "deceleration",
                "jerk",
            ]);
            let (required, optional) = ALL.split_at(usize::from(!limits_are_optional));
            Rule { required, optional, ..NOTHING }
        }
        "calibration" => Rule { optional: &[("rising", NUMBER), ("falling", NUMBER)], ..NOTHING },
        "dynamics" => Rule { optional: &[("damping", NUMBER), ("friction", NUMBER)], ..NOTHING },
        "mimic" => Rule {
            required: &[("joint", Form::Text)],
            optional: &[("multiplier", NUMBER), ("offset", NUMBER)],
            ..NOTHING
        },
        "safety_controller" => Rule {
            required: &[("k_velocity", NUMBER)],
            optional: const { &numbers(["soft_lower_limit", "soft_upper_limit", "k_position"]) },
            ..NOTHING
        },
        _ => return of_twin(element),
    })
}

/// Rules of the elements in `<twin>`.
fn of_twin(element: &str) -> Option<Rule> {
    Some(match element {
        "twin" => Rule { many: &["drive", "passive", "loop"], ..NOTHING },
        "drive" => Rule {
            required: &[("joint", Form::Text)],
            optional: &[("axis", Form::Index)],
            many: &["part"],
            ..NOTHING
        },
        "part" => Rule { required: &[("axis", Form::Index), ("factor", NUMBER)], ..NOTHING },
        "passive" => Rule { required: &[("joint", Form::Text), ("rest", NUMBER)], ..NOTHING },
        "loop" => Rule {
            required: &[("from", Form::Text), ("to", Form::Text)],
            many: &["point"],
            ..NOTHING
        },
        "point" => Rule { required: &[("xyz", THREE)], ..NOTHING },
        _ => return None,
    })
}
