//! Joints of a generated tripod: the hanging of its rods and platform.

use super::{Rod, Tripod, TripodDimensions};
use crate::generate::{Driven, fixed};
use crate::{DimensionError, JointDrive, JointKind, Link, Loop, Model};
use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};

/// Reference positions of a tripod, with all carriages at height 0 and the platform level and in the middle.
#[derive(Clone, Debug)]
pub(super) struct Linkage {
    /// Frames of the carriages in the machine frame: x outward, in the middle of their rods' upper ends but at height 0.
    pub(super) carriages: [Isometry3<f64>; 3],
    /// Height of the platform.
    pub(super) platform: f64,
}

/// Hanging of a rod: its frame has z along the rod, up, and is that of its carriage turned by `swing` about y and then
/// by `tilt` about x.
struct Hanging {
    swing: f64,
    tilt: f64,
}

fn about(axis: &Unit<Vector3<f64>>, angle: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(axis, angle)
}

impl Linkage {
    pub(super) fn new(rods: &[Rod; 6]) -> Result<Self, DimensionError> {
        let mut sums = [(0_u8, Vector3::zeros()); 3];
        for rod in rods {
            let ends = rod.upper.iter().chain(rod.lower.iter()).chain([&rod.length]);
            if !ends.into_iter().all(|value| value.is_finite()) {
                return Err(DimensionError::NotFinite { what: "an end of a rod" });
            }
            if let Some((count, sum)) = sums.get_mut(rod.carriage) {
                *count += 1;
                *sum += rod.upper.coords;
            }
        }
        if sums.iter().any(|(count, _)| *count != 2) {
            let carriages = rods.each_ref().map(|rod| rod.carriage);
            return Err(DimensionError::RodsOfCarriages(carriages));
        }
        let frame = |(_, sum): (u8, Vector3<f64>)| {
            let turn = about(&Vector3::z_axis(), sum.y.atan2(sum.x));
            Isometry3::from_parts(Translation3::new(sum.x / 2.0, sum.y / 2.0, 0.0), turn)
        };
        let mut height = 0.0;
        for (number, rod) in rods.iter().enumerate() {
            height += platform_height(rod, number)? / 6.0;
        }
        Ok(Self { carriages: sums.map(frame), platform: height })
    }

    fn carriage(&self, rod: &Rod) -> Isometry3<f64> {
        self.carriages.get(rod.carriage).copied().unwrap_or_default()
    }

    /// The upper end of `rod` in the frame of its carriage.
    pub(super) fn upper(&self, rod: &Rod) -> Point3<f64> {
        self.carriage(rod).inverse_transform_point(&rod.upper)
    }

    fn hanging(&self, rod: &Rod) -> Hanging {
        let lower = rod.lower + Vector3::z() * self.platform;
        let down = self.carriage(rod).inverse_transform_vector(&(lower - rod.upper));
        let swing = (-down.x).atan2(-down.z);
        Hanging { swing, tilt: down.y.atan2(down.x.hypot(down.z)) }
    }
}

/// Height of the platform in the middle and level, below the carriage of `rod` at height 0, if it were to hang on this
/// rod alone, m.
pub(super) fn platform_height(rod: &Rod, number: usize) -> Result<f64, DimensionError> {
    let reach = (rod.upper - rod.lower).xy().norm();
    let squared = (rod.length - reach) * (rod.length + reach);
    if squared > 0.0 && rod.length > 0.0 {
        Ok(rod.upper.z - rod.lower.z - squared.sqrt())
    } else {
        Err(DimensionError::Rod { rod: number, length: rod.length, reach })
    }
}

impl Tripod {
    /// Adds carriages, rods and platform to `model`, which has its base.
    pub(super) fn join(&self, model: &mut Model, given: &TripodDimensions) {
        let carriages = self.linkage.carriages.iter().zip(&given.joints).zip(given.offsets);
        for (number, ((frame, joint), offset)) in (1..).zip(carriages) {
            let origin = Translation3::new(0.0, 0.0, -offset) * frame;
            let axis = Vector3::z_axis();
            model.joints.push(joint.joint(JointKind::Prismatic, axis, 0, number, origin));
            model.links.push(self.carriage(number - 1));
        }
        let mut rod_links = [0; 6];
        for ((number, rod), link) in (1..).zip(&self.rods).zip(&mut rod_links) {
            *link = self.hang_rod(model, number, rod);
        }
        let ([first, ..], [carrier, ..]) = (&self.rods, rod_links);
        let platform = self.hang_platform(model, first, carrier);
        for (rod, link) in self.rods.iter().zip(rod_links).skip(1) {
            let points = [Point3::new(0.0, 0.0, -rod.length), rod.lower];
            model.loops.push(Loop { links: [link, platform], points });
        }
        model.tip.link = platform;
    }

    fn hang_rod(&self, model: &mut Model, number: usize, rod: &Rod) -> usize {
        let Hanging { swing, tilt } = self.linkage.hanging(rod);
        let turn = about(&Vector3::y_axis(), swing);
        let upper = Translation3::from(self.linkage.upper(rod).coords);
        let swung = Isometry3::from_parts(upper, turn);
        let (carriage, y) = (1 + rod.carriage, Vector3::y_axis());
        let cross = add_passive(model, &format!("rod{number}_swing"), carriage, y, swung);
        let tilted =
            Isometry3::from_parts(Translation3::identity(), about(&Vector3::x_axis(), tilt));
        let link =
            add_passive(model, &format!("rod{number}_tilt"), cross, Vector3::x_axis(), tilted);
        if let Some(last) = model.links.last_mut() {
            *last = self.rod(number, rod);
        }
        link
    }

    /// The platform, on three joints that undo in reverse what the rod does: tilt, swing, and the turn about z, at 0
    /// while the platform is level.
    fn hang_platform(&self, model: &mut Model, rod: &Rod, carrier: usize) -> usize {
        let Hanging { swing, tilt } = self.linkage.hanging(rod);
        let (x, y, z) = (Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis());
        let end = Isometry3::from_parts(Translation3::new(0.0, 0.0, -rod.length), about(&x, -tilt));
        let first = add_passive(model, "platform_tilt", carrier, x, end);
        let second = add_passive(model, "platform_swing", first, y, Isometry3::identity());
        let level = about(&y, -swing) * self.linkage.carriage(rod).rotation.inverse();
        let level = Isometry3::from_parts(Translation3::identity(), level);
        let third = add_passive(model, "platform_turn", second, z, level);
        let child = model.links.len();
        let to_reference = Isometry3::from(-rod.lower.coords);
        model.joints.push(fixed("platform", third, child, to_reference));
        model.links.push(self.platform());
        child
    }
}

/// A revolute joint at 0 that nothing drives, and a link without body of the same name.
fn add_passive(
    model: &mut Model,
    name: &str,
    parent: usize,
    axis: Unit<Vector3<f64>>,
    origin: Isometry3<f64>,
) -> usize {
    let child = model.links.len();
    let driven = Driven::new(name, JointDrive::Passive { rest: 0.0 });
    model.joints.push(driven.joint(JointKind::Revolute, axis, parent, child, origin));
    model.links.push(Link::new(name, None, Vec::new()));
    child
}
