//! Tool on a flange: below it or offset from its axis, with holder, payload and mass.

use super::{check_not_negative, check_positive, cuboid, paint, placed, upright};
use crate::inertial::turned;
use crate::{
    DimensionError, Inertial, Joint, JointDrive, JointKind, Link, Model, Solid, SolidShape,
};
use nalgebra::{Isometry3, Point3, Vector3};

/// Height of the arm that carries a tool beside the axis, m: less than what is kept clear above the highest flange.
const BRACKET: f64 = 0.012;

/// Largest distance of the end of a tool from its tip, m.
const ROUNDING: f64 = 1e-9;

/// A tool in the frame of its flange.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tool {
    /// Flange to tool tip, m.
    pub(super) tip: Vector3<f64>,
    /// m.
    pub(super) radius: f64,
    /// kg.
    pub(super) mass: f64,
    /// It cuts along x of the flange: a knife, not a mill.
    pub(super) blade: bool,
}

impl Model {
    /// Puts a tool on the link where the tip is: `tip` (m) from there in the frame of the flange, whose place in that link is
    /// `link_from_flange`, of `mass` (kg).
    ///
    /// # Errors
    /// [`DimensionError`] if the tip is above the flange, or a number is not finite.
    pub fn mount_tool(
        &mut self,
        link_from_flange: &Isometry3<f64>,
        tip: &Vector3<f64>,
        mass: f64,
    ) -> Result<(), DimensionError> {
        Tool::check(tip, mass)?;
        let length = 0.0 - tip.z;
        let tool = Tool { tip: *tip, radius: slender(length), mass, blade: false };
        self.tip.point = link_from_flange * Point3::from(*tip);
        let Some(link) = self.links.get_mut(self.tip.link) else { return Ok(()) };
        let solids: Vec<_> =
            tool.solids().into_iter().map(|solid| placed(solid, link_from_flange)).collect();
        if !link.collision.is_empty() {
            link.collision.extend(solids.iter().cloned());
        }
        link.solids.extend(solids);
        if mass > 0.0 {
            let own = if tool.length() > 0.0 {
                placed(tool.body(), link_from_flange).uniform(mass)
            } else {
                let center = self.tip.point;
                Inertial { mass, center, inertia: nalgebra::Matrix3::zeros() }
            };
            let parts: Vec<_> = link.inertial.into_iter().chain([own]).collect();
            link.inertial = Inertial::union(&parts);
        }
        Ok(())
    }

    /// Lets the link where the tip is carry `payload`, which is given in the frame of the flange, whose place in that link is
    /// `link_from_flange`. It has mass and no shape.
    ///
    /// # Errors
    /// [`DimensionError`] if its mass is not above 0, or a number is not finite.
    pub fn mount_payload(
        &mut self,
        link_from_flange: &Isometry3<f64>,
        payload: &Inertial,
    ) -> Result<(), DimensionError> {
        check_positive(&[("the mass of the payload", payload.mass)])?;
        if !payload.center.iter().chain(&payload.inertia).all(|value| value.is_finite()) {
            return Err(DimensionError::NotFinite { what: "the inertia of the payload" });
        }
        let Some(link) = self.links.get_mut(self.tip.link) else { return Ok(()) };
        let carried = Inertial {
            mass: payload.mass,
            center: link_from_flange * payload.center,
            inertia: turned(&payload.inertia, &link_from_flange.rotation),
        };
        let parts: Vec<_> = link.inertial.into_iter().chain([carried]).collect();
        link.inertial = Inertial::union(&parts);
        Ok(())
    }
}

/// The middle of a cylinder's lower end, m.
fn end_of(solid: &Solid) -> Option<Point3<f64>> {
    let SolidShape::Cylinder { length, .. } = solid.shape else { return None };
    Some(solid.origin * Point3::new(0.0, 0.0, -0.5 * length))
}

/// Radius of a tool of which only the length (m) is known, m.
fn slender(length: f64) -> f64 {
    (length / 10.0).clamp(1e-3, 8e-3)
}

/// Dimensions of a tool and its holder.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolShape {
    /// Diameter of the tool, m, if it is known.
    pub diameter: Option<f64>,
    /// Diameter and length (m) of what holds it, below the flange.
    pub holder: Option<[f64; 2]>,
}

impl ToolShape {
    /// The name of the link, and of the joint that fixes it.
    pub(crate) const HOLDER: &str = "holder";
}

impl Model {
    /// Diameter of the round tool that ends at the tip, m; none without one.
    pub fn tool_diameter(&self) -> Option<f64> {
        let solids = self.links.get(self.tip.link)?.solids.iter();
        let mut ends = solids.filter_map(|solid| match solid.shape {
            SolidShape::Cylinder { radius, .. } => {
                let end = end_of(solid)?;
                ((end - self.tip.point).norm() <= ROUNDING).then_some(2.0 * radius)
            }
            _ => None,
        });
        ends.next()
    }

    /// Replaces the round tool, or adds one: `tip` (m) from the flange in the frame of the flange, whose place in the link where the tip
    /// is is `link_from_flange`. Without `diameter` (m) the tool before gives it. Masses stay.
    pub fn change_tool(
        &mut self,
        link_from_flange: &Isometry3<f64>,
        tip: &Vector3<f64>,
        diameter: Option<f64>,
    ) {
        let radius = diameter.or_else(|| self.tool_diameter()).map(|diameter| 0.5 * diameter);
        let radius = radius.unwrap_or_else(|| slender(0.0 - tip.z));
        let body = Tool { tip: *tip, radius, mass: 0.0, blade: false }.body();
        let (body, before) = (placed(body, link_from_flange), self.tip.point);
        self.tip.point = link_from_flange * Point3::from(*tip);
        let Some(link) = self.links.get_mut(self.tip.link) else { return };
        let stays =
            |solid: &Solid| end_of(solid).is_none_or(|end| (end - before).norm() > ROUNDING);
        link.solids.retain(stays);
        if !link.collision.is_empty() {
            link.collision.retain(stays);
            link.collision.push(body.clone());
        }
        link.solids.push(body);
    }

    /// Gives the round tool that the model carries its diameter, and puts its holder above it, as a link of its own; `link_from_flange` is
    /// the place of the flange in the link where the tip is. False if it has no round tool to give a diameter to.
    pub fn shape_tool(&mut self, link_from_flange: &Isometry3<f64>, shape: &ToolShape) -> bool {
        let tip = self.tip.point;
        let Some(link) = self.links.get_mut(self.tip.link) else { return false };
        let mut shaped = shape.diameter.is_none();
        for solid in link.solids.iter_mut().chain(&mut link.collision) {
            let Solid { shape: SolidShape::Cylinder { radius, length }, origin, .. } = solid else {
                continue;
            };
            let end = *origin * Point3::new(0.0, 0.0, -0.5 * *length);
            if let Some(diameter) = shape.diameter.filter(|_| (end - tip).norm() <= ROUNDING) {
                *radius = 0.5 * diameter;
                shaped = true;
            }
        }
        if let Some([diameter, length]) = shape.holder {
            let holder = upright(0.0, 0.0, [-length, 0.0], 0.5 * diameter, paint::STEEL);
            let (links, along) = ([self.tip.link, self.links.len()], Vector3::z_axis());
            let fixed = (JointKind::Fixed, JointDrive::Fixed);
            let (name, flange) = (ToolShape::HOLDER, *link_from_flange);
            self.joints.push(Joint::new(name, fixed.0, links, flange, along, fixed.1));
            self.links.push(Link::new(name, None, vec![holder]));
        }
        shaped
    }
}

impl Tool {
    /// Distance of the tip below the flange, m.
    pub(super) fn length(&self) -> f64 {
        0.0 - self.tip.z
    }

    /// Horizontal distance of the tip from the flange, m.
    fn beside(&self) -> f64 {
        self.tip.x.hypot(self.tip.y)
    }

    /// That the tip is somewhere and not above the flange.
    pub(super) fn check(tip: &Vector3<f64>, mass: f64) -> Result<(), DimensionError> {
        if !tip.xy().iter().all(|value| value.is_finite()) {
            return Err(DimensionError::NotFinite { what: "the place of the tool" });
        }
        check_not_negative(&[
            ("the length of the tool", 0.0 - tip.z),
            ("the mass of the tool", mass),
        ])
    }

    /// From where to where the tool extends along x and y; in any direction if it turns.
    pub(super) fn extent(&self) -> [[f64; 2]; 2] {
        if self.blade {
            let all = self.beside() + self.radius;
            return [[-all, all]; 2];
        }
        let along = |tip: f64| [tip.min(0.0) - self.radius, tip.max(0.0) + self.radius];
        [along(self.tip.x), along(self.tip.y)]
    }

    /// The tool itself.
    fn body(&self) -> Solid {
        let [x, y, z] = self.tip.into();
        let radius = self.radius;
        if self.blade {
            let thin = 0.4 * radius;
            let (low, high) = ([x - radius, y - thin, z], [x + radius, y + thin, 0.0]);
            cuboid(low, high, paint::AMBER)
        } else {
            upright(x, y, [z, 0.0], radius, paint::AMBER)
        }
    }

    /// The tool, and the arm that carries it if it is beside the axis.
    pub(super) fn solids(&self) -> Vec<Solid> {
        let mut solids = Vec::new();
        if self.length() > 0.0 {
            solids.push(self.body());
        }
        let beside = self.beside();
        if beside > 0.0 {
            let half = self.radius;
            let arm = cuboid([-half, -half, 0.0], [beside + half, half, BRACKET], paint::GRAPHITE);
            let turn = Vector3::z() * self.tip.y.atan2(self.tip.x);
            solids.push(placed(arm, &Isometry3::rotation(turn)));
        }
        solids
    }

    /// Of the tool; its arm is paint.
    pub(super) fn inertial(&self) -> Inertial {
        self.body().uniform(self.mass)
    }
}
