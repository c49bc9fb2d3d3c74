//! `[[grippers]]`: suction cups, parallel grippers and magnets, and what closes and opens them.

use crate::section::Section;
use crate::switch_points::SWITCHES;
use nalgebra::{Isometry3, Point3, Unit, Vector3};
use twin_physics::Gripper;
use twin_urdf::Model;

/// Kind of a gripper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GripperKind {
    /// A suction cup.
    Suction,
    /// Two fingers.
    Parallel,
    /// An electromagnet.
    Magnet,
}

impl GripperKind {
    /// As in the file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Suction => "suction",
            Self::Parallel => "parallel",
            Self::Magnet => "magnet",
        }
    }
}

/// Signal that closes and opens a gripper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GripperSignal {
    /// Numbers of the M functions that close and open it.
    MFunctions([u16; 2]),
    /// Number of a switch of the path, 1 to 32: closed while it is on.
    Switch(u8),
}

/// Control of a gripper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GripperControl {
    /// Its kind.
    pub kind: GripperKind,
    /// Its signal.
    pub signal: GripperSignal,
    /// Delay of its valve, ns.
    pub delay_ns: i64,
}

/// M functions that stop or end programs, and that change tools.
const RESERVED: [u16; 9] = [0, 1, 2, 6, 30, 60, 61, 98, 99];

/// Reads one of `[[grippers]]` of a machine, whose flange is in the link of its tip; `known` are those before it.
pub(super) fn read(
    section: &Section<'_>,
    (known, controls): (&[Gripper], &[GripperControl]),
    machine: Option<(&Model, &Isometry3<f64>)>,
) -> Option<(Gripper, GripperControl)> {
    let name = section.required_text("name");
    let is_known = |name: &str| known.iter().any(|one| one.name == name);
    let name = name.filter(|name| {
        if is_known(name) {
            section.complain_at("name", "there is a gripper of this name already");
        }
        !is_known(name)
    });
    let kinds = [GripperKind::Suction, GripperKind::Parallel, GripperKind::Magnet];
    let kind = section.required_choice("kind", &kinds.map(|kind| (kind.name(), kind)));
    let link = section.text("link");
    let point = section.numbers::<3>("point_mm", -1e4..=1e4).map(|mm| Point3::from(mm) * 1e-3);
    let direction = section.numbers::<3>("direction", -1.0..=1.0);
    let reach = section.number("reach_mm", 0.0..=1000.0).unwrap_or(2.0) * 1e-3;
    let force = section.required_number("force_n", 1e-3..=1e9);
    let moment = section.number("moment_nm", 1e-6..=1e9).unwrap_or(f64::INFINITY);
    let delay_ms = section.integer("delay_ms", 0..=60_000).unwrap_or(0);
    let signal = signal(section, known, controls);
    let (model, flange) = machine?;
    let tip = model.links.get(model.tip.link).map(|link| link.name.as_str());
    let (link, point) = match link.filter(|name| Some(*name) != tip) {
        None => (model.tip.link, point.unwrap_or(model.tip.point)),
        Some(name) => {
            let link = model.links.iter().position(|link| link.name == name);
            if link.is_none() {
                let names: Vec<_> = model.links.iter().map(|link| link.name.as_str()).collect();
                let message =
                    format!("unknown link \"{name}\"; the links are {}", names.join(", "));
                section.complain_at("link", message);
            }
            if point.is_none() {
                section.complain("a gripper on another link than the tool tip's needs `point_mm`");
            }
            (link?, point?)
        }
    };
    let down = if link == model.tip.link { flange.rotation * -Vector3::z() } else { -Vector3::z() };
    let direction = Unit::try_new(direction.map_or(down, Vector3::from), 1e-6);
    if direction.is_none() {
        section.complain_at("direction", "`direction` has no length");
    }
    let name = name?.to_owned();
    let (direction, force) = (direction?, force?);
    let control = GripperControl { kind: kind?, signal: signal?, delay_ns: delay_ms * 1_000_000 };
    Some((Gripper { name, link, point, direction, reach, force, moment }, control))
}

/// Signal of the gripper of `section`.
fn signal(
    section: &Section<'_>,
    known: &[Gripper],
    controls: &[GripperControl],
) -> Option<GripperSignal> {
    let switch = section.integer("switch", 1..=i64::from(SWITCHES));
    let keys = ["close_m", "open_m"];
    let numbers = keys.map(|key| section.integer(key, 0..=65_535));
    let given = keys.map(|key| section.has(key));
    if section.has("switch") {
        if given.contains(&true) {
            section.complain_at("switch", "a gripper has either M functions or a `switch`");
            return None;
        }
        return Some(GripperSignal::Switch(u8::try_from(switch?).ok()?));
    }
    if given != [true; 2] {
        section.complain("a gripper needs `close_m` and `open_m`, or a `switch`");
        return None;
    }
    let [close, open] = numbers.map(|number| u16::try_from(number?).ok());
    let numbers = [close?, open?];
    let mut is_free = true;
    for (key, number) in keys.into_iter().zip(numbers) {
        let uses = |control: &GripperControl| match control.signal {
            GripperSignal::MFunctions(numbers) => numbers.contains(&number),
            GripperSignal::Switch(_) => false,
        };
        let other = known.iter().zip(controls).find(|(_, control)| uses(control));
        let message = if RESERVED.contains(&number) {
            format!("M{number} has a meaning of its own; take another number, such as M10")
        } else if let Some((other, _)) = other {
            format!("M{number} belongs to gripper \"{}\"", other.name)
        } else {
            continue;
        };
        section.complain_at(key, message);
        is_free = false;
    }
    if close == open {
        section.complain_at("open_m", "the same M function closes and opens the gripper");
        is_free = false;
    }
    is_free.then_some(GripperSignal::MFunctions(numbers))
}
