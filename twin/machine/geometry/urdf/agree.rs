//! Consistency check of URDF chain and transform.

use super::{Given, Source, fit};
use crate::axis::AxisEntry;
use crate::geometry::rounded;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use twin_kinematics::{AxisVector, Kinematics, MachineAxes};
use twin_urdf::Model;

/// Positions tested, in addition to the ends and middles of the axes.
const PLACES: u32 = 64;
/// Distance from the tool of the point that shows the turn of a flange, m.
const OFFSET: f64 = 0.1;
/// As far as an axis without limits is looked at, rad or m.
const FAR: f64 = 10.0;

/// The largest difference, and where it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Difference {
    /// m.
    pub(super) length: f64,
    axes: AxisVector,
    transform: Point3<f64>,
    chain: Point3<f64>,
}

/// Flange of the transform in its link: z up, x as the transform has it at mid-travel.
pub(super) fn flange(given: &Given<'_>, machine: &MachineAxes, model: &Model) -> Isometry3<f64> {
    let middle = AxisVector::from_values(given.axes.iter().map(|entry| {
        let [low, high] = range(entry);
        low.midpoint(high)
    }));
    let direction = match flange_x(given, machine, &middle) {
        Some(direction) => direction.y.atan2(direction.x),
        None => 0.0,
    };
    let machine_from_flange = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), direction);
    let poses = model.link_poses(&middle);
    let machine_from_link = poses.get(model.tip.link).map(|pose| pose.rotation).unwrap_or_default();
    let link_from_flange = machine_from_link.inverse() * machine_from_flange;
    Isometry3::from_parts(nalgebra::Translation3::identity(), link_from_flange)
}

/// Direction of the flange's x axis, machine frame: from the tool tip to that of a tool at the distance [`OFFSET`].
fn flange_x(given: &Given<'_>, machine: &MachineAxes, axes: &AxisVector) -> Option<Vector3<f64>> {
    let tool = given.tool.tip + Vector3::x() * OFFSET;
    let other = given.design.transform().ok()?;
    let other = MachineAxes::new(other, given.sources.clone(), tool).ok()?;
    Some(other.forward(axes).ok()?.position - machine.forward(axes).ok()?.position)
}

/// Complains if the tips are further apart anywhere than the file allows.
pub(super) fn check(
    source: &Source,
    given: &Given<'_>,
    machine: &MachineAxes,
    model: &Model,
    flange: &Isometry3<f64>,
) -> Option<()> {
    let mut worst = largest(given.axes, |axes| {
        Some((machine.forward(axes).ok()?.position, model.tip_position(axes)))
    });
    let mut what = "the tool tip";
    if given.kind.turns_tool && worst.is_none_or(|worst| worst.length <= source.tolerance) {
        // Whether the tool turns alike.
        let along = flange * Vector3::x() * OFFSET;
        worst = largest(given.axes, |axes| {
            let transform = machine.forward(axes).ok()?.position + flange_x(given, machine, axes)?;
            let poses = model.link_poses(axes);
            let turned = poses.get(model.tip.link)?.rotation * along;
            Some((transform, model.tip_position(axes) + turned))
        });
        what = "a point 100 mm from the tool tip";
    }
    let Some(worst) = worst.filter(|worst| worst.length > source.tolerance) else {
        return Some(());
    };
    let places: Vec<_> = given
        .axes
        .iter()
        .zip(worst.axes.iter())
        .map(|(entry, position)| {
            let axis = &entry.axis;
            format!("{} {} {}", axis.name, rounded(axis.from_si(*position)), axis.unit())
        })
        .collect();
    let mm = |point: &Point3<f64>| {
        let [x, y, z] = [point.x, point.y, point.z].map(|value| rounded(value * 1e3));
        format!("X{x} Y{y} Z{z}")
    };
    let message = format!(
        "{} and [kinematics] are up to {} mm apart ({} mm are allowed): with {} {what} is at {} by the URDF and at {} by the \
         transform",
        source.path.display(),
        rounded(worst.length * 1e3),
        rounded(source.tolerance * 1e3),
        places.join(", "),
        mm(&worst.chain),
        mm(&worst.transform),
    );
    let help = fit::advice(source, given, model, &worst);
    given.body.complain_with_help("urdf", message, help);
    None
}

/// The largest difference between the two points that `points` gives, over the travel of all axes.
pub(super) fn largest(
    axes: &[AxisEntry],
    points: impl Fn(&AxisVector) -> Option<(Point3<f64>, Point3<f64>)>,
) -> Option<Difference> {
    let mut worst: Option<Difference> = None;
    for place in places(axes) {
        let Some((transform, chain)) = points(&place) else { continue };
        let length = (transform - chain).norm();
        // A value that is not a number does not agree.
        if worst.is_none_or(|worst| length.is_nan() || length > worst.length) {
            worst = Some(Difference { length, axes: place, transform, chain });
        }
    }
    worst
}

/// Range of an axis, m or rad.
fn range(entry: &AxisEntry) -> [f64; 2] {
    let [low, high] = entry.axis.position_limits;
    if entry.axis.limited { [low, high] } else { [low.max(-FAR), high.min(FAR)] }
}

/// All combinations of both ends and the middle of every axis, and places in between.
fn places(axes: &[AxisEntry]) -> impl Iterator<Item = AxisVector> {
    let count = axes.iter().fold(1_u32, |count, _| 3 * count);
    let at = move |parts: &dyn Fn(u32) -> f64| {
        AxisVector::from_values((0..).zip(axes).map(|(number, entry)| {
            let [low, high] = range(entry);
            low + (high - low) * parts(number)
        }))
    };
    let corners = move |corner: u32| at(&|number| f64::from(corner / 3_u32.pow(number) % 3) / 2.0);
    // A lattice (Roberts 2018): steps by powers of a number that no fractions come near.
    let between = move |place: u32| {
        at(&|number| {
            (f64::from(place) * 0.811_732_5_f64.powi(1 + i32::try_from(number).unwrap_or(0)))
                .fract()
        })
    };
    (0..count).map(corners).chain((1..=PLACES).map(between))
}
