//! Solids and masses of a generated gantry.

use super::{CLEARANCE, Gantry};
use crate::generate::{cuboid, paint, upright};
use crate::{Inertial, Link, Solid};

/// Between parts that pass each other, m.
const GAP: f64 = 0.003;

impl Gantry {
    /// Width of the rails and posts.
    fn rail(&self) -> f64 {
        0.8 * self.beam[0]
    }

    /// Ends of the beam along y: the carriage stays between the rails.
    pub(super) fn beam_ends(&self) -> [f64; 2] {
        let [_, [low, high]] = self.occupied();
        let margin = CLEARANCE + self.rail();
        [low - margin, high + margin]
    }

    /// Range of carriage, quill and tool along x and y.
    fn occupied(&self) -> [[f64; 2]; 2] {
        let side = self.carriage_width / 2.0;
        let [[x0, x1], [y0, y1], _] = self.travel;
        let [[left, right], [back, front]] = self.tool.extent();
        let along =
            |low: f64, high: f64, from: f64, to: f64| [low + from.min(-side), high + to.max(side)];
        [along(x0, x1, left, right), along(y0, y1, back, front)]
    }

    /// Range of the two rails along y.
    fn rails(&self) -> [[f64; 2]; 2] {
        let [left, right] = self.beam_ends();
        [[left, left + self.rail()], [right - self.rail(), right]]
    }

    /// Back and front of the beam along x, from the axis of the quill.
    fn beam_sides(&self) -> [f64; 2] {
        let front = -(self.quill_width / 2.0 + GAP + self.plate + GAP);
        [front - self.beam[0], front]
    }

    /// Lower and upper side of the beam.
    fn beam_heights(&self) -> [f64; 2] {
        let bottom = self.travel[2][1] + CLEARANCE;
        [bottom, bottom + self.beam[1]]
    }

    /// Height of the trucks that carry the beam.
    fn truck(&self) -> f64 {
        0.5 * self.beam[0]
    }

    pub(super) fn base(&self) -> Vec<Solid> {
        let [travel_x, _, travel_z] = self.travel;
        let table = travel_z[0] - self.tool.length() - CLEARANCE;
        let rail_top = self.beam_heights()[0] - self.truck() - GAP;
        let rail_bottom = rail_top - 0.5 * self.rail();
        // The posts reach below the table even if the tool is short and the beam thick.
        let floor = (table - self.rail()).min(rail_bottom - self.rail());
        let [back, front] = self.beam_sides();
        let ends = [travel_x[0] + back - self.truck(), travel_x[1] + front + self.truck()];
        let [[x0, x1], [y0, y1]] = self.occupied();
        let mut solids = vec![cuboid([x0, y0, floor], [x1, y1, table], paint::SLATE)];
        for [left, right] in self.rails() {
            solids.push(cuboid(
                [ends[0], left, rail_bottom],
                [ends[1], right, rail_top],
                paint::STEEL,
            ));
            for start in [ends[0], ends[1] - self.rail()] {
                let end = start + self.rail();
                solids.push(cuboid(
                    [start, left, floor],
                    [end, right, rail_bottom],
                    paint::GRAPHITE,
                ));
            }
        }
        if self.belt {
            self.rails().iter().for_each(|rail| solids.extend(self.motor(*rail, ends, rail_top)));
        }
        solids
    }

    /// A motor at the back of a rail with its pulley, and the belt along the rail.
    fn motor(&self, [left, right]: [f64; 2], ends: [f64; 2], rail_top: f64) -> [Solid; 3] {
        let (middle, radius) = (f64::midpoint(left, right), 0.4 * self.rail());
        let (x, high) = (ends[0] - radius - GAP, rail_top + 0.4 * self.truck());
        // On the side away from the carriage.
        let side = if middle < f64::midpoint(self.travel[1][0], self.travel[1][1]) {
            [left - 2.0 * GAP, left - GAP]
        } else {
            [right + GAP, right + 2.0 * GAP]
        };
        [
            upright(x, middle, [rail_top - 3.0 * self.rail(), rail_top], radius, paint::GRAPHITE),
            upright(x, middle, [rail_top, high], 0.6 * radius, paint::STEEL),
            cuboid([x, side[0], rail_top], [ends[1], side[1], high], paint::GRAPHITE),
        ]
    }

    /// In a frame that moves along x with the flange.
    pub(super) fn bridge(&self) -> Link {
        let ([back, front], [bottom, top], [left, right]) =
            (self.beam_sides(), self.beam_heights(), self.beam_ends());
        let beam = cuboid([back, left, bottom], [front, right, top], paint::IVORY);
        let inertial = Some(beam.uniform(self.bridge_mass));
        let mut solids = vec![beam];
        let overhang = 0.8 * self.truck();
        for [left, right] in self.rails() {
            let low = [back - overhang, left, bottom - self.truck()];
            solids.push(cuboid(low, [front + overhang, right, bottom], paint::GRAPHITE));
        }
        Link::new("bridge", inertial, solids)
    }

    /// In a frame that moves along x and y with the flange.
    pub(super) fn carriage(&self) -> Link {
        let [bottom, top] = self.beam_heights();
        let front = -(self.quill_width / 2.0 + GAP);
        let (back, side) = (front - self.plate, self.carriage_width / 2.0);
        let plate = cuboid([back, -side, bottom], [front, side, top], paint::BLUE);
        let inertial = Some(plate.uniform(self.carriage_mass));
        // A saddle over the beam, with the motor of the quill on it.
        let saddle = cuboid(
            [back - 0.6 * self.beam[0], -side, top + GAP],
            [front, side, top + GAP + self.plate],
            paint::BLUE,
        );
        let motor = upright(
            back - 0.3 * self.beam[0],
            0.0,
            [top + GAP + self.plate, top + GAP + self.plate + self.quill_width],
            0.25 * self.beam[0],
            paint::GRAPHITE,
        );
        Link::new("carriage", inertial, vec![plate, saddle, motor])
    }

    /// The quill, in the frame of the flange. It carries the tool unless a head turns below it.
    pub(super) fn quill(&self) -> Link {
        let half = self.quill_width / 2.0;
        let bottom = self.head.map_or(0.0, |[height, _]| height + GAP);
        let quill = cuboid([-half, -half, bottom], [half, half, self.quill_length], paint::STEEL);
        let inertial = quill.uniform(self.quill_mass);
        if self.head.is_some() {
            return Link::new("quill", Some(inertial), vec![quill]);
        }
        self.with_tool("quill", quill, inertial)
    }

    /// The rotating head with the tool, in the frame of the flange.
    pub(super) fn head(&self) -> Link {
        let [height, mass] = self.head.unwrap_or_default();
        let radius = head_radius(self.quill_width);
        let head = upright(0.0, 0.0, [0.0, height], radius, paint::BLUE);
        let inertial = head.uniform(mass);
        self.with_tool("head", head, inertial)
    }

    fn with_tool(&self, name: &str, solid: Solid, inertial: Inertial) -> Link {
        let mut solids = vec![solid];
        solids.extend(self.tool.solids());
        let inertial = Inertial::union(&[inertial, self.tool.inertial()]);
        Link::new(name, inertial, solids)
    }
}

/// Of the head that turns below a quill of this width, m.
fn head_radius(quill_width: f64) -> f64 {
    0.46 * quill_width
}

/// m³.
pub(super) fn head_volume(quill_width: f64, height: f64) -> f64 {
    std::f64::consts::PI * head_radius(quill_width).powi(2) * height
}
