//! Solids and masses of a generated SCARA.

use super::{Arm, GAP, Hand, Scara};
use crate::generate::{cuboid, paint, placed, upright};
use crate::{Inertial, Link, Solid};
use nalgebra::{Isometry3, Point3, Vector3};

impl Arm {
    pub(super) fn top(&self) -> f64 {
        self.bottom + self.height
    }

    /// Height of the origin of its frame, machine frame.
    pub(super) fn middle(&self) -> f64 {
        self.bottom + self.height / 2.0
    }

    /// A beam with round ends.
    pub(super) fn beam(&self, color: [f64; 4]) -> Vec<Solid> {
        let (side, level) = (self.width / 2.0, self.height / 2.0);
        vec![
            cuboid([0.0, -side, -level], [self.length, side, level], color),
            upright(0.0, 0.0, [-level, level], side, color),
            upright(self.length, 0.0, [-level, level], side, color),
        ]
    }

    /// Of the box between the axes; the round ends are paint.
    pub(super) fn inertial(&self) -> Inertial {
        let size = Vector3::new(self.length, self.width, self.height);
        Inertial::uniform_box(self.mass, size, Point3::new(self.length / 2.0, 0.0, 0.0))
    }
}

impl Scara {
    pub(super) fn base(&self) -> Vec<Solid> {
        let half = 1.6 * self.column_radius;
        let plate = self.floor + 0.1 * (self.column_top - self.floor).min(2.0 * self.column_radius);
        vec![
            cuboid([-half, -half, self.floor], [half, half, plate], paint::SLATE),
            upright(0.0, 0.0, [plate, self.column_top], self.column_radius, paint::GRAPHITE),
        ]
    }

    pub(super) fn arm2(&self) -> Vec<Solid> {
        let arm = &self.second;
        let mut solids = arm.beam(paint::BLUE);
        // The cover of the motors leaves the quill free.
        let (side, start) = (0.4 * arm.width, -0.3 * arm.width);
        let end = (0.65 * arm.length).min(arm.length - 2.0 * self.quill_radius);
        if end > start {
            let level = arm.height / 2.0;
            solids.push(cuboid(
                [start, -side, level],
                [end, side, level + 0.7 * arm.height],
                paint::GRAPHITE,
            ));
        }
        solids
    }

    /// The quill. It carries the tool unless there is a hand.
    pub(super) fn quill(&self) -> Link {
        let bottom = self.hand.map_or(0.0, |hand| hand.height + GAP);
        let (heights, radius) = ([bottom, self.quill_length], self.quill_radius);
        let shaft = upright(0.0, 0.0, heights, radius, paint::STEEL);
        let mut parts = vec![shaft.uniform(self.quill_mass)];
        let mut solids = vec![shaft];
        if self.hand.is_none() {
            parts.push(self.tool.inertial());
            solids.extend(self.tool.solids());
        }
        Link::new("quill", Inertial::union(&parts), solids)
    }

    /// The hand with the tool; x is along it and z = 0 at its lower side, on the axis of the quill.
    pub(super) fn hand(&self, hand: &Hand) -> Link {
        let flange = Isometry3::translation(hand.length, 0.0, 0.0);
        let mut solids = hand.solids();
        solids.extend(self.tool.solids().into_iter().map(|solid| placed(solid, &flange)));
        let tool = self.tool.inertial();
        let tool = Inertial { center: flange * tool.center, ..tool };
        let inertial = Inertial::union(&[hand.inertial(), tool]);
        Link::new("hand", inertial, solids)
    }
}

impl Hand {
    /// With its round ends, m³.
    pub(super) fn volume(&self) -> f64 {
        let round = std::f64::consts::PI * (self.width / 2.0).powi(2);
        (self.length * self.width + round) * self.height
    }

    fn solids(&self) -> Vec<Solid> {
        let (side, heights) = (self.width / 2.0, [0.0, self.height]);
        let mut solids = vec![upright(0.0, 0.0, heights, side, paint::IVORY)];
        if self.length > 0.0 {
            solids.push(cuboid([0.0, -side, 0.0], [self.length, side, self.height], paint::IVORY));
            solids.push(upright(self.length, 0.0, heights, side, paint::IVORY));
        }
        solids
    }

    /// Of the box between axis and flange, or of the disc if there is nothing between them.
    fn inertial(&self) -> Inertial {
        let center = Point3::new(self.length / 2.0, 0.0, self.height / 2.0);
        if self.length > 0.0 {
            let size = Vector3::new(self.length, self.width, self.height);
            Inertial::uniform_box(self.mass, size, center)
        } else {
            Inertial::uniform_cylinder(self.mass, self.width / 2.0, self.height, center)
        }
    }
}
