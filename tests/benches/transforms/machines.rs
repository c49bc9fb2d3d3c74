//! Machines of every kind with positions within their reach, for benchmarks and for the allocation test.

use nalgebra::{SVector, Vector3};
use std::f64::consts::FRAC_PI_6;
use twin_kinematics::gantry::{
    BeltLayout, Gantry2, Gantry3, GantryCutter2, GantryCutter3, GantryH2, Sense, ToolBeside,
};
use twin_kinematics::scara::{Elbow, Scara2, Scara3};
use twin_kinematics::tripod::{CalibratedTripod, Tripod, TripodDeviations, TripodDimensions};
use twin_kinematics::{Kinematics, Transform};

/// A machine with tool positions within its reach, and the axes there.
pub struct Placed<T, const N: usize> {
    pub machine: T,
    pub tools: Vec<SVector<f64, N>>,
    pub axes: Vec<SVector<f64, N>>,
}

/// Visitor of every machine.
pub trait Visit {
    fn visit<T: Transform<N> + Kinematics, const N: usize>(
        &mut self,
        name: &'static str,
        placed: &Placed<T, N>,
    );
}

/// Goes through all machines, each with `count` places.
pub fn each(count: usize, visit: &mut impl Visit) {
    // Where a gantry may be, m, and how far a cutter may be turned, rad.
    const WAY: [f64; 2] = [-0.8, 0.8];
    const TURN: [f64; 2] = [-3.0, 3.0];
    let beside = ToolBeside { angle: 0.4, ahead: 0.03, left: -0.02 };
    let tip = Vector3::new(0.01, -0.02, -0.1);

    let gantry2 = Gantry2::new([0.1, 0.2]).expect("a gantry").holding(&tip);
    visit.visit("Gantry2", &by_axes(gantry2, count, [WAY; 2]));
    let gantry3 = Gantry3::new([0.1, 0.2, 0.3]).expect("a gantry").holding(&tip);
    visit.visit("Gantry3", &by_axes(gantry3, count, [WAY; 3]));
    let cutter2 = GantryCutter2::new([0.1, 0.2, 0.3], Sense::Clockwise).expect("a cutter");
    visit.visit("GantryCutter2", &by_axes(cutter2.holding(&tip), count, [WAY, WAY, TURN]));
    let cutter3 = GantryCutter3::new([0.1, 0.2, 0.3, 0.4], Sense::CounterClockwise);
    let cutter3 = cutter3.expect("a cutter").holding(&tip);
    visit.visit("GantryCutter3", &by_axes(cutter3, count, [WAY, WAY, WAY, TURN]));
    let tool2 = Gantry2::with_tool_offset([0.1, 0.2], beside).expect("a gantry").holding(&tip);
    visit.visit("Gantry2Tool", &by_axes(tool2, count, [WAY; 2]));
    let tool3 = Gantry3::with_tool_offset([0.1, 0.2, 0.3], beside).expect("a gantry").holding(&tip);
    visit.visit("Gantry3Tool", &by_axes(tool3, count, [WAY; 3]));
    visit.visit("GantryH2", &gantry_h2(count));
    visit.visit("Scara2", &scara2(count));
    visit.visit("Scara3", &scara3(count));
    visit.visit("Tripod", &tripod(count));
    let deviations = TripodDeviations {
        tower_angles: [0.01, -0.005, 0.002],
        outer_radii: [3e-4, -2e-4, 5e-4],
        rod_lengths: [1e-4, -2e-4, 3e-4, 2e-4, -1e-4, 4e-4],
        ..TripodDeviations::default()
    };
    let rods = DELTA.rods(&deviations).expect("a tripod");
    let measured = CalibratedTripod::new(rods, [0.01, 0.02, 0.03]).expect("a tripod").holding(&tip);
    visit.visit("CalibratedTripod", &by_tools(measured, count, PLATFORM));
}

/// A tripod like a printer's.
pub const DELTA: TripodDimensions = TripodDimensions {
    inner_radius: 0.06,
    outer_radius: 0.26,
    rod_length: 0.3,
    rod_distance: 0.05,
    rotation: FRAC_PI_6,
};

/// Where its platform goes.
const PLATFORM: [[f64; 2]; 3] = [[-0.055, 0.055], [-0.055, 0.055], [-0.2, 0.2]];

/// An H gantry with belts as LinuxCNC has them.
pub fn gantry_h2(count: usize) -> Placed<GantryH2, 2> {
    let layout = BeltLayout { coordinates_exchanged: true, drives_exchanged: false };
    by_axes(GantryH2::new([0.1, 0.2], layout).expect("a gantry"), count, [[-0.8, 0.8]; 2])
}

/// Two arms of a middle size, neither stretched nor folded.
pub fn scara2(count: usize) -> Placed<Scara2, 2> {
    let scara = Scara2::new([0.34, 0.25], [0.0; 2], Elbow::Low).expect("a SCARA");
    by_axes(scara, count, [[-2.5, 2.5], [0.3, 2.7]])
}

/// The same arms with a third.
pub fn scara3(count: usize) -> Placed<Scara3, 3> {
    let scara = Scara3::new([0.34, 0.25, 0.05], [0.0; 3], Elbow::Low).expect("a SCARA");
    by_axes(scara, count, [[-2.5, 2.5], [0.3, 2.7], [-2.5, 2.5]])
}

/// The tripod as designed.
pub fn tripod(count: usize) -> Placed<Tripod, 3> {
    let tripod = Tripod::new(DELTA, [0.01, 0.02, 0.03]).expect("a tripod");
    by_tools(tripod, count, PLATFORM)
}

/// Anywhere within `ranges` of the axes.
fn by_axes<T: Transform<N>, const N: usize>(
    machine: T,
    count: usize,
    ranges: [[f64; 2]; N],
) -> Placed<T, N> {
    let axes = spread(count, ranges);
    let tools = axes.iter().map(|axes| machine.to_tool(axes).expect("within reach")).collect();
    Placed { machine, tools, axes }
}

/// Anywhere within `ranges` of the tool.
fn by_tools<T: Transform<N>, const N: usize>(
    machine: T,
    count: usize,
    ranges: [[f64; 2]; N],
) -> Placed<T, N> {
    let tools = spread(count, ranges);
    let axes = tools.iter().map(|tool| machine.to_axes(tool).expect("within reach")).collect();
    Placed { machine, tools, axes }
}

/// `count` values anywhere in `ranges`, the same ones always.
pub fn spread<const N: usize>(count: usize, ranges: [[f64; 2]; N]) -> Vec<SVector<f64, N>> {
    let mut state = 1_u64;
    let mut next = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(state >> 32).unwrap_or_default()) / f64::from(u32::MAX)
    };
    let mut value = || SVector::from(ranges.map(|[low, high]| low + (high - low) * next()));
    (0..count).map(|_| value()).collect()
}
