//! `[kinematics]`: nominal dimensions of a machine and their measured deviations.

use super::kind::{Family, Kind};
use crate::section::Section;
use std::f64::consts::PI;
use std::ops::RangeInclusive;
use twin_kinematics::gantry::{
    BeltLayout, Gantry2, Gantry3, GantryCutter2, GantryCutter3, GantryH2, Sense, ToolBeside,
};
use twin_kinematics::scara::{Elbow, Scara2, Scara3};
use twin_kinematics::tripod::{CalibratedTripod, Tripod, TripodDeviations, TripodDimensions};
use twin_kinematics::{DimensionError, Kinematics};

/// Lengths in mm that a machine on earth has.
pub(super) const LENGTH_MM: RangeInclusive<f64> = 1.0..=100_000.0;
/// Offsets of axes, mm.
const OFFSET_MM: RangeInclusive<f64> = -1e5..=1e5;
/// Angles, degrees.
const ANGLE_DEG: RangeInclusive<f64> = -360.0..=360.0;
/// Largest deviation of a measured length from its nominal value, mm: more is another machine.
const DEVIATION_MM: RangeInclusive<f64> = -20.0..=20.0;
/// Largest deviation of a measured angle from its nominal value, degrees.
const DEVIATION_DEG: RangeInclusive<f64> = -10.0..=10.0;

/// The dimensions of a machine with its deviations in them. SI.
#[derive(Clone, Debug)]
pub(super) enum Design {
    Gantry {
        offsets: [f64; 3],
        has_z: bool,
        /// Offset and sense of R.
        rotary: Option<(f64, Sense)>,
        beside: ToolBeside,
        belt: Option<BeltLayout>,
    },
    Scara {
        arms: [f64; 3],
        offsets: [f64; 3],
        elbow: Elbow,
        has_hand: bool,
    },
    Tripod {
        dimensions: TripodDimensions,
        deviations: TripodDeviations,
        offsets: [f64; 3],
    },
}

/// Reads `[kinematics]` and `[kinematics.deviations]`.
pub(super) fn read(kinematics: &Section<'_>, kind: &Kind) -> Option<Design> {
    let deviations = kinematics.section("deviations");
    let design = match kind.family {
        Family::Scara => scara(kinematics, &deviations, kind),
        Family::Tripod => tripod(kinematics, &deviations),
        Family::Gantry | Family::Cutter | Family::BesideTool(_) | Family::HBelt => {
            Some(gantry(kinematics, &deviations, kind))
        }
    };
    deviations.finish();
    design
}

/// Two or three numbers, as the kind has; what is not there is 0.
fn numbers(
    section: &Section<'_>,
    key: &str,
    range: RangeInclusive<f64>,
    count: usize,
) -> Option<[f64; 3]> {
    if count == 2 {
        section.numbers::<2>(key, range).map(|[first, second]| [first, second, 0.0])
    } else {
        section.numbers::<3>(key, range)
    }
}

/// Nominal values and what was measured beyond them.
fn added<const N: usize>(nominal: [f64; N], deviation: Option<[f64; N]>, unit: f64) -> [f64; N] {
    let mut deviation = deviation.unwrap_or([0.0; N]).into_iter();
    nominal.map(|value| (value + deviation.next().unwrap_or_default()) * unit)
}

const MM: f64 = 1e-3;
const DEG: f64 = PI / 180.0;

fn gantry(kinematics: &Section<'_>, deviations: &Section<'_>, kind: &Kind) -> Design {
    let count = if kind.moves_z { 3 } else { 2 };
    let offsets = numbers(kinematics, "offsets_mm", OFFSET_MM, count).unwrap_or_default();
    let measured = numbers(deviations, "offsets_mm", DEVIATION_MM, count);
    let with_deviation = |key: &str, ranges: [RangeInclusive<f64>; 2]| {
        let [range, deviation] = ranges;
        kinematics.number(key, range).unwrap_or_default()
            + deviations.number(key, deviation).unwrap_or_default()
    };
    let rotary = (kind.family == Family::Cutter).then(|| {
        let offset = with_deviation("offset_r_deg", [ANGLE_DEG, DEVIATION_DEG]) * DEG;
        let sense = kinematics.choice(
            "sense_r",
            &[("counterclockwise", Sense::CounterClockwise), ("clockwise", Sense::Clockwise)],
        );
        (offset, sense.unwrap_or_default())
    });
    let beside = match kind.family {
        Family::BesideTool(legs) => ToolBeside {
            angle: with_deviation("tool_angle_deg", [ANGLE_DEG, DEVIATION_DEG]) * DEG,
            ahead: with_deviation("tool_ahead_mm", [OFFSET_MM, DEVIATION_MM]) * MM,
            left: if legs == 2 {
                with_deviation("tool_left_mm", [OFFSET_MM, DEVIATION_MM]) * MM
            } else {
                0.0
            },
        },
        _ => ToolBeside::default(),
    };
    let belt = (kind.family == Family::HBelt).then(|| {
        let layout = |coordinates_exchanged, drives_exchanged| BeltLayout {
            coordinates_exchanged,
            drives_exchanged,
        };
        let layouts = [
            ("standard", layout(false, false)),
            ("coordinates_exchanged", layout(true, false)),
            ("drives_exchanged", layout(false, true)),
            ("both_exchanged", layout(true, true)),
        ];
        kinematics.choice("belt", &layouts).unwrap_or_default()
    });
    Design::Gantry {
        offsets: added(offsets, measured, MM),
        has_z: kind.moves_z,
        rotary,
        beside,
        belt,
    }
}

fn scara(kinematics: &Section<'_>, deviations: &Section<'_>, kind: &Kind) -> Option<Design> {
    let count = kind.outputs.len();
    let arms = if count == 2 {
        let arms = kinematics.required_numbers::<2>("arm_lengths_mm", LENGTH_MM);
        arms.map(|[first, second]| [first, second, 0.0])
    } else {
        // The third may be 0: the hand then only turns.
        let arms = kinematics.required_numbers::<3>("arm_lengths_mm", 0.0..=*LENGTH_MM.end());
        for arm in arms.into_iter().flatten().take(2).filter(|arm| !LENGTH_MM.contains(arm)) {
            let (low, high) = (LENGTH_MM.start(), LENGTH_MM.end());
            let message = format!("arms are {arm} mm long; the first two are {low} to {high} mm");
            kinematics.complain_at("arm_lengths_mm", message);
        }
        arms
    };
    let offsets = numbers(kinematics, "offsets_deg", ANGLE_DEG, count).unwrap_or_default();
    let elbow = kinematics
        .choice("elbow", &[("low", Elbow::Low), ("high", Elbow::High)])
        .unwrap_or(Elbow::Low);
    let measured_arms = numbers(deviations, "arm_lengths_mm", DEVIATION_MM, count);
    let measured_offsets = numbers(deviations, "offsets_deg", DEVIATION_DEG, count);
    Some(Design::Scara {
        arms: added(arms?, measured_arms, MM),
        offsets: added(offsets, measured_offsets, DEG),
        elbow,
        has_hand: count == 3,
    })
}

fn tripod(kinematics: &Section<'_>, measured: &Section<'_>) -> Option<Design> {
    let inner_radius = kinematics.required_number("inner_radius_mm", LENGTH_MM);
    let outer_radius = kinematics.required_number("outer_radius_mm", LENGTH_MM);
    let rod_length = kinematics.required_number("rod_length_mm", LENGTH_MM);
    let rod_distance = kinematics.required_number("rod_distance_mm", LENGTH_MM);
    let rotation = kinematics.number("rotation_deg", ANGLE_DEG).unwrap_or_default();
    let offsets = kinematics.numbers::<3>("offsets_mm", OFFSET_MM).unwrap_or_default();
    let angles = |key| added([0.0; 3], measured.numbers(key, DEVIATION_DEG), DEG);
    let lengths = |key| added([0.0; 3], measured.numbers(key, DEVIATION_MM), MM);
    let deviations = TripodDeviations {
        tower_angles: angles("tower_angles_deg"),
        platform_angles: angles("platform_angles_deg"),
        outer_radii: lengths("outer_radii_mm"),
        inner_radii: lengths("inner_radii_mm"),
        outer_distances: lengths("outer_distances_mm"),
        inner_distances: lengths("inner_distances_mm"),
        rod_lengths: added([0.0; 6], measured.numbers("rod_lengths_mm", DEVIATION_MM), MM),
    };
    let measured_offsets = measured.numbers::<3>("offsets_mm", DEVIATION_MM);
    Some(Design::Tripod {
        dimensions: TripodDimensions {
            inner_radius: inner_radius? * MM,
            outer_radius: outer_radius? * MM,
            rod_length: rod_length? * MM,
            rod_distance: rod_distance? * MM,
            rotation: rotation * DEG,
        },
        deviations,
        offsets: added(offsets, measured_offsets, MM),
    })
}

impl Design {
    /// The transform of the machine.
    pub(super) fn transform(&self) -> Result<Box<dyn Kinematics>, DimensionError> {
        Ok(match *self {
            Self::Gantry { offsets: [x, y, z], has_z, rotary, beside, belt } => {
                match (rotary, belt, has_z) {
                    (Some((r, sense)), _, true) => {
                        Box::new(GantryCutter3::new([x, y, z, r], sense)?)
                    }
                    (Some((r, sense)), _, false) => Box::new(GantryCutter2::new([x, y, r], sense)?),
                    (None, Some(layout), _) => Box::new(GantryH2::new([x, y], layout)?),
                    (None, None, true) => Box::new(Gantry3::with_tool_offset([x, y, z], beside)?),
                    (None, None, false) => Box::new(Gantry2::with_tool_offset([x, y], beside)?),
                }
            }
            Self::Scara { arms, offsets, elbow, has_hand: true } => {
                Box::new(Scara3::new(arms, offsets, elbow)?)
            }
            Self::Scara { arms: [first, second, _], offsets: [a, b, _], elbow, .. } => {
                Box::new(Scara2::new([first, second], [a, b], elbow)?)
            }
            Self::Tripod { dimensions, deviations, offsets } => {
                if deviations.is_zero() {
                    Box::new(Tripod::new(dimensions, offsets)?)
                } else {
                    Box::new(CalibratedTripod::new(dimensions.rods(&deviations)?, offsets)?)
                }
            }
        })
    }
}
