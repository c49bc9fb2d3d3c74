//! Solids and masses of a generated tripod.

use super::linkage::platform_height;
use super::{CARRIAGE_DENSITY, CLEARANCE, PLATFORM_DENSITY, ROD_DENSITY, Rod, Tripod};
use crate::generate::{cuboid, paint, placed, upright};
use crate::{Inertial, Link, Solid, SolidShape};
use nalgebra::{Isometry3, Point3, Vector3};

/// Radius of the balls at the ends of a rod against that of the rod.
pub(super) const BALL: f64 = 1.8;
/// Between parts that pass each other, m.
const GAP: f64 = 0.003;

fn ball(center: &Point3<f64>, radius: f64) -> Solid {
    let origin = Isometry3::from(center.coords);
    Solid { shape: SolidShape::Sphere { radius }, origin, color: paint::STEEL }
}

impl Tripod {
    fn ball(&self) -> f64 {
        BALL * self.rod_radius
    }

    /// Outer edge of the carriage's plate in its frame, x.
    fn plate(&self, carriage: usize) -> [f64; 2] {
        let ends = self.rods_of(carriage).map(|rod| self.linkage.upper(rod).x);
        let inner = ends.fold(f64::NEG_INFINITY, f64::max) + 3.0 * self.ball();
        [inner, inner + 2.0 * self.ball()]
    }

    fn rods_of(&self, carriage: usize) -> impl Iterator<Item = &Rod> {
        self.rods.iter().filter(move |rod| rod.carriage == carriage)
    }

    /// Lower and upper edge of the carriage's plate in its frame.
    fn plate_heights(&self, carriage: usize) -> [f64; 2] {
        let heights = || self.rods_of(carriage).map(|rod| rod.upper.z);
        let low = heights().fold(f64::INFINITY, f64::min);
        let high = heights().fold(f64::NEG_INFINITY, f64::max);
        [low - 4.0 * self.ball(), high + 4.0 * self.ball()]
    }

    /// Height of the table: below the lowest tool tip.
    ///
    /// The rods' horizontal lengths h have Σh² = 3(r² + e²) with the platform at r from the middle, so one of them is at
    /// least the e of the middle, and hangs no lower than there.
    fn table(&self) -> f64 {
        let lowest = |rod: &Rod| {
            let [low, _] = self.travel.get(rod.carriage).copied().unwrap_or_default();
            low + platform_height(rod, 0).unwrap_or_default()
        };
        let platform = self.rods.iter().map(lowest).fold(f64::INFINITY, f64::min);
        platform - self.tool.length().max(self.ball()) - CLEARANCE
    }

    pub(super) fn base(&self) -> Vec<Solid> {
        let ball = self.ball();
        let (table, thick, width) = (self.table(), 2.0 * ball, 7.0 * ball);
        let mut top = table;
        let mut outer = 0.0_f64;
        let mut middles = Vec::with_capacity(3);
        let mut tables = f64::INFINITY;
        for (carriage, (frame, [_, high])) in
            self.linkage.carriages.iter().zip(self.travel).enumerate()
        {
            let ([_, back], [_, plate_top]) = (self.plate(carriage), self.plate_heights(carriage));
            let from_axis = frame.translation.vector.norm() + back;
            top = top.max(high + plate_top + CLEARANCE);
            outer = outer.max((from_axis + GAP + ball + width).hypot(width));
            tables = tables.min(from_axis - 4.0 * ball);
            middles.push(frame * Point3::new(back + GAP + ball + width / 2.0, 0.0, 0.0));
        }
        let floor = table - thick;
        let mut solids = vec![
            upright(0.0, 0.0, [floor, table], 0.8 * tables.max(ball), paint::SLATE),
            upright(0.0, 0.0, [floor - thick, floor], outer, paint::GRAPHITE),
        ];
        for (carriage, frame) in self.linkage.carriages.iter().enumerate() {
            let [_, back] = self.plate(carriage);
            let (rail, column) = (back + GAP, back + GAP + ball);
            let side = width / 2.0;
            let rail_low = [rail, -ball, floor];
            solids.extend([
                placed(cuboid(rail_low, [column, ball, top], paint::STEEL), frame),
                placed(
                    cuboid([column, -side, floor], [column + width, side, top], paint::IVORY),
                    frame,
                ),
            ]);
        }
        for (one, other) in middles.iter().zip(middles.iter().cycle().skip(1)) {
            let way = other - one;
            let (length, turn) = (way.norm(), Vector3::z() * way.y.atan2(way.x));
            let beam = cuboid(
                [0.0, -0.3 * width, top],
                [length, 0.3 * width, top + 0.4 * width],
                paint::GRAPHITE,
            );
            solids.push(placed(beam, &Isometry3::new(one.coords, turn)));
        }
        solids
    }

    /// A plate on the rail, with the upper joints of its rods before it.
    pub(super) fn carriage(&self, carriage: usize) -> Link {
        let radius = self.ball();
        let ([front, back], [low, high]) = (self.plate(carriage), self.plate_heights(carriage));
        let ends: Vec<_> = self.rods_of(carriage).map(|rod| self.linkage.upper(rod)).collect();
        let side = ends.iter().map(|end| end.y.abs()).fold(0.0, f64::max) + 2.0 * radius;
        let plate = cuboid([front, -side, low], [back, side, high], paint::BLUE);
        let inertial = plate.uniform(
            self.carriage_mass
                .unwrap_or(CARRIAGE_DENSITY * (back - front) * 2.0 * side * (high - low)),
        );
        let mut solids = vec![plate];
        for end in &ends {
            let half = 0.6 * radius;
            solids.push(cuboid(
                [end.x, end.y - half, end.z - half],
                [front, end.y + half, end.z + half],
                paint::GRAPHITE,
            ));
            solids.push(ball(end, radius));
        }
        let name = format!("carriage{}", carriage + 1);
        Link::new(name, Some(inertial), solids)
    }

    /// A rod between its balls, in the frame of its upper end.
    pub(super) fn rod(&self, number: usize, rod: &Rod) -> Link {
        let heights = [self.ball() - rod.length, -self.ball()];
        let tube = upright(0.0, 0.0, heights, self.rod_radius, paint::GRAPHITE);
        let volume = std::f64::consts::PI * self.rod_radius.powi(2) * rod.length;
        let inertial = tube.uniform(self.rod_mass.unwrap_or(ROD_DENSITY * volume));
        Link::new(format!("rod{number}"), Some(inertial), vec![tube])
    }

    /// The platform with the lower joints of the rods and the tool, in the frame of its reference point.
    pub(super) fn platform(&self) -> Link {
        let radius = self.ball();
        let height = self.rods.iter().map(|rod| rod.lower.z / 6.0).sum::<f64>();
        let heights = [height - radius, height + radius];
        let disc = upright(0.0, 0.0, heights, self.platform_radius, paint::IVORY);
        let volume = std::f64::consts::PI * self.platform_radius.powi(2) * 2.0 * radius;
        let mass = self.platform_mass.unwrap_or(PLATFORM_DENSITY * volume);
        let inertial = Inertial::union(&[disc.uniform(mass), self.tool.inertial()]);
        let mut solids = vec![disc];
        for Rod { lower, .. } in &self.rods {
            let (reach, half) = (lower.x.hypot(lower.y), 0.6 * radius);
            let arm = cuboid(
                [0.5 * self.platform_radius, -half, lower.z - half],
                [reach.max(self.platform_radius), half, lower.z + half],
                paint::GRAPHITE,
            );
            let turn = Vector3::z() * lower.y.atan2(lower.x);
            solids.push(placed(arm, &Isometry3::rotation(turn)));
            solids.push(ball(lower, radius));
        }
        solids.extend(self.tool.solids());
        Link::new("platform", inertial, solids)
    }
}
